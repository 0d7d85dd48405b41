"""USD text (`.usda`) with a character, its blendshapes, and the animation of a take.

A SkelRoot with one mesh, a BlendShape for each shape, and a SkelAnimation with the weights
(UsdSkel). Metres, Y up; vertex colours are the display colour; textures are left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from faceedit_app.characters.scene import Scene
from faceedit_app.core.arrays import Floats

_STILL = 1e-7  # metres


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

{shapes}
    }}

    def Skeleton "Skeleton" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {{
        uniform token[] joints = []
        rel skel:animationSource = </Face/Skeleton/Animation>

        def SkelAnimation "Animation"
        {{
            uniform token[] blendShapes = [{quoted}]
            float[] blendShapeWeights.timeSamples = {{
{samples}
            }}
        }}
    }}
}}
"""
    return text.encode()


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
