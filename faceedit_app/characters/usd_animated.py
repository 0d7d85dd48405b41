"""USD text (`.usda`) with a character, its blendshapes, and the animation of a take.

A SkelRoot with one mesh, a BlendShape for each shape, and a SkelAnimation with the weights
(UsdSkel). Metres, Y up; vertex colours are the display colour; textures are left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from faceedit_app.characters.scene import Scene
from faceedit_app.characters.turning import Turning
from faceedit_app.core.arrays import Doubles, Floats

_STILL = 1e-7  # metres
_IDENTITY = "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"
_JOINTS = '"body", "body/head"'


def scene_usda(scene: Scene, name: str) -> bytes:
    """A scene as USD text.

    Args:
        name: of the animation, for the file's comment.
    """
    rig = scene.rig
    tokens = _identifiers(scene.shapes)
    codes = scene.times * scene.rate
    whole = np.round(codes)
    codes = np.where(np.abs(codes - whole) < 1e-3, whole, codes)
    shapes = "\n".join(
        _blend_shape(token, moves) for token, moves in zip(tokens, rig.deltas, strict=True)
    )
    samples = "\n".join(
        f"                    {code:.10g}: [{_numbers(row)}],"
        for code, row in zip(codes.tolist(), scene.weights, strict=True)
    )
    quoted = ", ".join(f'"{token}"' for token in tokens)
    targets = ", ".join(f"</Face/Head/{token}>" for token in tokens)
    text = f"""#usda 1.0
(
    defaultPrim = "Face"
    doc = {_quoted(f"{name}, written by FaceEdit")}
    upAxis = "Y"
    metersPerUnit = 1
    timeCodesPerSecond = {scene.rate:.10g}
    framesPerSecond = {scene.rate:.10g}
    startTimeCode = {codes[0]:.10g}
    endTimeCode = {codes[-1]:.10g}
)

def SkelRoot "Face"
{{
    def Mesh "Head" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {{
        uniform bool doubleSided = 1
        uniform token subdivisionScheme = "none"
        int[] faceVertexCounts = [{", ".join(["3"] * len(rig.faces))}]
        int[] faceVertexIndices = [{", ".join(map(str, rig.faces.ravel().tolist()))}]
        point3f[] points = {_points(rig.neutral)}
        float3[] extent = {_points(np.stack([rig.neutral.min(0), rig.neutral.max(0)]))}
        color3f[] primvars:displayColor = {_points(rig.colors[:, :3])} (
            interpolation = "vertex"
        )
        uniform token[] skel:blendShapes = [{quoted}]
        rel skel:blendShapeTargets = [{targets}]
        rel skel:skeleton = </Face/Skeleton>
{_skin(scene.turning)}
{shapes}
    }}

    def Skeleton "Skeleton" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {{
{_joints(scene.turning)}
        rel skel:animationSource = </Face/Skeleton/Animation>

        def SkelAnimation "Animation"
        {{
            uniform token[] blendShapes = [{quoted}]
            float[] blendShapeWeights.timeSamples = {{
{samples}
            }}
{_turns(scene.turning, codes)}
        }}
    }}
}}
"""
    return text.encode()


def _skin(turning: Turning | None) -> str:
    """How far each vertex follows the joints, the body's and the head's."""
    if turning is None:
        return ""
    share = turning.share.astype(np.float64)
    weights = _numbers(np.stack((1.0 - share, share), axis=1).astype(np.float32).ravel())
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


def _joints(turning: Turning | None) -> str:
    if turning is None:
        return "        uniform token[] joints = []"
    x, y, z = (f"{value:.7g}" for value in turning.pivot.tolist())
    head = f"((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({x}, {y}, {z}, 1))"
    return f"""        uniform token[] joints = [{_JOINTS}]
        uniform matrix4d[] bindTransforms = [{_IDENTITY}, {head}]
        uniform matrix4d[] restTransforms = [{_IDENTITY}, {head}]"""


def _turns(turning: Turning | None, codes: Doubles) -> str:
    """The rotation of the head's joint at each time code."""
    if turning is None:
        return ""
    x, y, z = (f"{value:.7g}" for value in turning.pivot.tolist())
    turns = (
        f"                {code:.10g}: [(1, 0, 0, 0), ({w:.9g}, {i:.9g}, {j:.9g}, {k:.9g})],"
        for code, (i, j, k, w) in zip(codes.tolist(), turning.quaternions.tolist(), strict=True)
    )
    rows = "\n".join(turns)
    return f"""            uniform token[] joints = [{_JOINTS}]
            float3[] translations = [(0, 0, 0), ({x}, {y}, {z})]
            half3[] scales = [(1, 1, 1), (1, 1, 1)]
            quatf[] rotations.timeSamples = {{
{rows}
            }}
"""


def _blend_shape(token: str, moves: Floats) -> str:
    moved = np.flatnonzero(np.abs(moves).max(axis=1) > _STILL)
    return f"""        def BlendShape "{token}"
        {{
            uniform vector3f[] offsets = {_points(moves[moved])}
            uniform int[] pointIndices = [{", ".join(map(str, moved.tolist()))}]
        }}
"""


def _identifiers(names: Iterable[str]) -> list[str]:
    """Names as USD identifiers, each once."""
    out: list[str] = []
    for name in names:
        plain = re.sub(r"\W", "_", name, flags=re.ASCII)
        plain = f"_{plain}" if not plain or plain[0].isdigit() else plain
        number = 1
        while (unique := plain if number == 1 else f"{plain}_{number}") in out:
            number += 1
        out.append(unique)
    return out


def _quoted(text: str) -> str:
    plain = "".join(c if c.isprintable() else "?" for c in text)
    return '"' + plain.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _numbers(values: Floats) -> str:
    """Numbers that read back as the same float32."""
    return ", ".join(f"{value:.9g}" for value in values.tolist())


def _points(points: Floats) -> str:
    """Points (N, 3) to a tenth of a micrometre."""
    rounded = np.round(points.astype(np.float64), 7) + 0.0  # no -0
    rows = (f"({x:.7g}, {y:.7g}, {z:.7g})" for x, y, z in rounded.tolist())
    return f"[{', '.join(rows)}]"
