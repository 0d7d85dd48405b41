"""USD text (`.usda`) with a character, its blendshapes, and the animation of a take.

A SkelRoot with one mesh, a BlendShape for each shape, and a SkelAnimation with the weights
(UsdSkel). Metres, Y up; materials have their base colour. A package (`.usdz`) also has the
textures; text has their colours at the vertices, as the display colour.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import numpy as np

from faceedit_app.characters.base_colors import png_of, vertex_colors
from faceedit_app.characters.scene import Scene
from faceedit_app.characters.usd_materials import materials, package, picture_path, subsets
from faceedit_app.characters.usd_turning import joints, numbers, skin, turns
from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.rig import Rig

_STILL = 1e-7  # metres


def scene_usdz(scene: Scene, name: str) -> bytes:
    """A scene as a USD package, with its textures.

    Args:
        name: of the animation, for the file's comment.
    """
    pictures = scene.rig.textures
    files = [(picture_path(k), png_of(picture)) for k, picture in enumerate(pictures)]
    return package([("face.usda", scene_usda(scene, name, packed=True)), *files])


def scene_usda(scene: Scene, name: str, packed: bool = False) -> bytes:
    """A scene as USD text.

    Args:
        name: of the animation, for the file's comment.
        packed: whether the textures are beside it in a package.
    """
    codes = scene.times * scene.rate
    whole = np.round(codes)
    codes = np.where(np.abs(codes - whole) < 1e-3, whole, codes)
    surfaces = _identifiers(material.name for material in scene.rig.materials)
    tokens = _identifiers(scene.shapes)
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
{_head(scene, tokens, surfaces)}
{materials(scene.rig, surfaces, packed)}
{_skeleton(scene, tokens, codes)}}}
"""
    return text.encode()


def _head(scene: Scene, tokens: Sequence[str], surfaces: list[str]) -> str:
    """The mesh with its blendshapes."""
    rig = scene.rig
    targets = ", ".join(f"</Face/Head/{token}>" for token in tokens)
    shapes = "\n".join(
        _blend_shape(token, moves) for token, moves in zip(tokens, rig.deltas, strict=True)
    )
    return f"""    def Mesh "Head" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {{
        uniform bool doubleSided = 1
        uniform token subdivisionScheme = "none"
        int[] faceVertexCounts = [{", ".join(["3"] * len(rig.faces))}]
        int[] faceVertexIndices = [{", ".join(map(str, rig.faces.ravel().tolist()))}]
        point3f[] points = {_points(rig.neutral)}
        float3[] extent = {_points(np.stack([rig.neutral.min(0), rig.neutral.max(0)]))}
        color3f[] primvars:displayColor = {_points(vertex_colors(rig))} (
            interpolation = "vertex"
        )
{_texture_coordinates(rig)}        uniform token subsetFamily:materialBind:familyType = "partition"
        uniform token[] skel:blendShapes = [{_listed(tokens)}]
        rel skel:blendShapeTargets = [{targets}]
        rel skel:skeleton = </Face/Skeleton>
{skin(scene.turning)}
{shapes}
{subsets(rig, surfaces)}
    }}
"""


def _skeleton(scene: Scene, tokens: Sequence[str], codes: Times) -> str:
    """The joints, and the animation of weights and head at time codes (T,)."""
    samples = "\n".join(
        f"                    {code:.10g}: [{numbers(row)}],"
        for code, row in zip(codes.tolist(), scene.weights, strict=True)
    )
    return f"""    def Skeleton "Skeleton" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {{
{joints(scene.turning)}
        rel skel:animationSource = </Face/Skeleton/Animation>

        def SkelAnimation "Animation"
        {{
            uniform token[] blendShapes = [{_listed(tokens)}]
            float[] blendShapeWeights.timeSamples = {{
{samples}
            }}
{turns(scene.turning, codes)}
        }}
    }}
"""


def _listed(tokens: Sequence[str]) -> str:
    return ", ".join(f'"{token}"' for token in tokens)


def _texture_coordinates(rig: Rig) -> str:
    if rig.uv is None:
        return ""
    flipped = rig.uv.astype(np.float64) * [1, -1] + [0, 1]  # USD counts from the lower left corner
    pairs = ", ".join(f"({u:.7g}, {v:.7g})" for u, v in flipped.tolist())
    return f"""        texCoord2f[] primvars:st = [{pairs}] (
            interpolation = "vertex"
        )
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


def _points(points: Floats) -> str:
    """Points (N, 3) to a tenth of a micrometre."""
    rounded = np.round(points.astype(np.float64), 7) + 0.0  # no -0
    rows = (f"({x:.7g}, {y:.7g}, {z:.7g})" for x, y, z in rounded.tolist())
    return f"[{', '.join(rows)}]"
