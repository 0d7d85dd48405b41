"""The turns of a head in USD: a skeleton of two joints, and the rotation of the head's."""

from __future__ import annotations

import numpy as np

from faceedit_app.characters.turning import Turning
from faceedit_app.core.arrays import Doubles, Floats

_IDENTITY = "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"
_JOINTS = '"body", "body/head"'


def skin(turning: Turning | None) -> str:
    """How far each vertex of the mesh follows the joints; empty if the head stays straight."""
    if turning is None:
        return ""
    share = turning.share.astype(np.float64)
    weights = numbers(np.stack((1.0 - share, share), axis=1).astype(np.float32).ravel())
    return f"""        matrix4d primvars:skel:geomBindTransform = {_IDENTITY}
        int[] primvars:skel:jointIndices = [{", ".join(["0, 1"] * len(share))}] (
            elementSize = 2
            interpolation = "vertex"
        )
        float[] primvars:skel:jointWeights = [{weights}] (
            elementSize = 2
            interpolation = "vertex"
        )
"""


def joints(turning: Turning | None) -> str:
    """The joints of the skeleton."""
    if turning is None:
        return "        uniform token[] joints = []"
    x, y, z = (f"{value:.7g}" for value in turning.pivot.tolist())
    head = f"((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({x}, {y}, {z}, 1))"
    return f"""        uniform token[] joints = [{_JOINTS}]
        uniform matrix4d[] bindTransforms = [{_IDENTITY}, {head}]
        uniform matrix4d[] restTransforms = [{_IDENTITY}, {head}]"""


def turns(turning: Turning | None, codes: Doubles) -> str:
    """The rotation of the head's joint at each time code (T,)."""
    if turning is None:
        return ""
    x, y, z = (f"{value:.7g}" for value in turning.pivot.tolist())
    rows = "\n".join(
        f"                {code:.10g}: [(1, 0, 0, 0), ({w:.9g}, {i:.9g}, {j:.9g}, {k:.9g})],"
        for code, (i, j, k, w) in zip(codes.tolist(), turning.quaternions.tolist(), strict=True)
    )
    return f"""            uniform token[] joints = [{_JOINTS}]
            float3[] translations = [(0, 0, 0), ({x}, {y}, {z})]
            half3[] scales = [(1, 1, 1), (1, 1, 1)]
            quatf[] rotations.timeSamples = {{
{rows}
            }}
"""


def numbers(values: Floats) -> str:
    """Numbers that read back as the same float32."""
    return ", ".join(f"{value:.9g}" for value in values.tolist())
