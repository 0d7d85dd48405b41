"""Turn the head in a GLB of another maker: its head's joint, or all of it if it has none."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from faceedit_app.characters.face_frame import FaceFrame
from faceedit_app.characters.gltf_nodes import node_places, own_place
from faceedit_app.characters.turning import quaternions, turns
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.head import Head
from faceedit_app.core.rig import Rig

_HEAD = re.compile(r"(?<!fore)(?<!over)head(?!.?(top|end|nub|tip|light|phone|set|band))", re.I)


@dataclass(frozen=True)
class HeadTurns:
    """The turns of a head in the coordinates of a file.

    Attributes:
        pivot: (3,) where the neck turns, if the file has no joint there.
        matrices: (T, 3, 3).
    """

    pivot: Doubles
    matrices: Doubles = field(repr=False)

    @classmethod
    def of(cls, frame: FaceFrame, rig: Rig, rotations: Floats) -> HeadTurns:
        """The turns of a take.

        Args:
            frame: of the character in the file.
            rig: the character as it is shown.
            rotations: (T, 9) radians, as in `Clip.rotations`.
        """
        pivot = frame.origin + Head(rig).pivot @ frame.axes / frame.scale
        return cls(pivot, frame.axes.T @ turns(rotations) @ frame.axes)


def turning_node(document: dict[str, Any], heads: HeadTurns) -> tuple[int, Floats]:
    """The node to rotate, and its rotations (T, 4), x, y, z, w.

    Without a joint of the head, all roots of the scene move into a new node that turns.
    """
    nodes = document["nodes"]
    joint = _head_joint(document)
    if joint is None:
        return _wrapped(document, heads), quaternions(heads.matrices)
    places = node_places(nodes)
    parent = next((k for k, n in enumerate(nodes) if joint in (n.get("children") or [])), None)
    above = np.eye(3) if parent is None else rotation_of(places[parent])
    split_matrix(nodes[joint])
    own = Rotation.from_quat(nodes[joint].get("rotation", (0.0, 0.0, 0.0, 1.0))).as_matrix()
    return joint, quaternions(above.T @ heads.matrices @ above @ own)


def _head_joint(document: Mapping[str, Any]) -> int | None:
    """The head's joint in the skins of meshes with blendshapes: that nearest the root."""
    nodes = document["nodes"]
    joints: set[int] = set()
    for node in nodes:
        if "mesh" in node and "skin" in node:
            mesh = document["meshes"][node["mesh"]]
            if any(primitive.get("targets") for primitive in mesh["primitives"]):
                joints.update(document["skins"][node["skin"]]["joints"])
    found = [k for k in joints if _HEAD.search(str(nodes[k].get("name", "")))]
    parents = {child: k for k, node in enumerate(nodes) for child in node.get("children") or []}

    def depth(number: int) -> int:
        return 1 + depth(parents[number]) if number in parents else 0

    return min(found, key=lambda k: (depth(k), k), default=None)


def _wrapped(document: dict[str, Any], heads: HeadTurns) -> int:
    """Move the roots of all scenes below a new node at the pivot; returns its number."""
    nodes, pivot = document["nodes"], heads.pivot.tolist()
    children = {child for node in nodes for child in node.get("children") or []}
    roots = [k for k in range(len(nodes)) if k not in children]
    turned = len(nodes)
    nodes.append({"name": "head turn", "translation": pivot, "children": [turned + 1]})
    nodes.append({"translation": [-x for x in pivot], "children": roots})
    for scene in document.get("scenes", []):
        scene["nodes"] = [turned]
    return turned


def rotation_of(place: Doubles) -> Doubles:
    """(3, 3) the rotation of a place (4, 4), without shear; if mirrored, of its first two axes."""
    left, _, right = np.linalg.svd(place[:3, :3])
    turned: Doubles = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    return turned


def split_matrix(node: dict[str, Any]) -> None:
    """Replace the matrix of a node, which cannot be animated, by its parts."""
    if node.get("matrix") is None:
        return
    place = own_place(node)
    del node["matrix"]
    turned = rotation_of(place)
    node["translation"] = place[:3, 3].tolist()
    node["rotation"] = Rotation.from_matrix(turned).as_quat().tolist()
    node["scale"] = np.diag(turned.T @ place[:3, :3]).tolist()
