"""Where FBX files place their models: the transforms of the FBX SDK."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from faceedit_app.characters.bounded import finite
from faceedit_app.characters.fbx_tree import Record
from faceedit_app.core.arrays import Doubles

Properties = Mapping[str, tuple[Any, ...]]

_ORDERS = ("XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX")  # of RotationOrder 0 to 5


def properties_of(record: Record) -> Properties:
    """The properties of an object, by name."""
    table = record.first("Properties70")
    return {str(p.values[0]): p.values[4:] for p in (table.all("P") if table else ()) if p.values}


def vector(properties: Properties, name: str, default: tuple[float, float, float]) -> Doubles:
    """(3,) a property; the default if it is missing."""
    values = properties.get(name, default)
    if len(values) < 3 or not all(isinstance(v, (int, float)) for v in values[:3]):
        return np.array(default)
    return finite(np.array(values[:3], np.float64), name)


def local_place(properties: Properties) -> Doubles:
    """(4, 4) a model's own transform, as the FBX SDK composes it.

    Translation, rotation pivot and offset, pre- and post-rotation, scaling pivot and offset.
    """
    order = properties.get("RotationOrder", (0,))
    which = order[0] if order and isinstance(order[0], int) and 0 <= order[0] < 6 else 0
    zero, one = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    pivot, scaling_pivot = (vector(properties, n, zero) for n in ("RotationPivot", "ScalingPivot"))
    rotation = _rotation(vector(properties, "Lcl Rotation", zero), _ORDERS[which])
    before = _rotation(vector(properties, "PreRotation", zero), "XYZ")
    after = _rotation(vector(properties, "PostRotation", zero), "XYZ")
    scale = np.diag((*vector(properties, "Lcl Scaling", one), 1.0))
    steps = (
        _shift(vector(properties, "Lcl Translation", zero)),
        _shift(vector(properties, "RotationOffset", zero)),
        _shift(pivot),
        before,
        rotation,
        after.T,
        _shift(-pivot),
        _shift(vector(properties, "ScalingOffset", zero)),
        _shift(scaling_pivot),
        scale,
        _shift(-scaling_pivot),
    )
    place = np.eye(4)
    for step in steps:
        place = place @ step
    return place


def geometric_place(properties: Properties) -> Doubles:
    """(4, 4) the transform of a model's mesh alone, which its children do not have."""
    zero, one = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    turned = _shift(vector(properties, "GeometricTranslation", zero)) @ _rotation(
        vector(properties, "GeometricRotation", zero), "XYZ"
    )
    scaling = vector(properties, "GeometricScaling", one)
    place: Doubles = turned @ np.diag((*scaling, 1.0))
    return place


def _shift(by: Doubles) -> Doubles:
    place = np.eye(4)
    place[:3, 3] = by
    return place


def _rotation(degrees: Doubles, order: str) -> Doubles:
    """(4, 4) rotation by Euler angles about the fixed axes, in the order of application."""
    place = np.eye(4)
    for axis in order:
        number = "XYZ".index(axis)
        angle = np.radians(degrees[number])
        a, b = [(1, 2), (2, 0), (0, 1)][number]
        turn = np.eye(4)
        turn[a, a] = turn[b, b] = np.cos(angle)
        turn[a, b], turn[b, a] = -np.sin(angle), np.sin(angle)
        place = turn @ place
    return place
