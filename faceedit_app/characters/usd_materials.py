"""The materials of a character in USD text: a UsdPreviewSurface and a subset of faces for each."""

from __future__ import annotations

import io
import zipfile

import numpy as np

from faceedit_app.characters.base_colors import material_color, vertex_colors
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.rig import Material, Rig

_ALIGNED = 64  # bytes; where USD maps a file of a package into memory
_EXTRA = b"\x86\x19"  # the kind of extra field that USD's own tools pad with
_EARLIEST = (1980, 1, 1, 0, 0, 0)


def picture_path(k: int) -> str:
    """Where a package keeps a texture, by its number in `Rig.textures`."""
    return f"textures/texture{k + 1}.png"


def subsets(rig: Rig, names: list[str]) -> str:
    """Which faces of the mesh have which material."""
    return "\n".join(
        f"""        def GeomSubset "Faces_{name}" (
            prepend apiSchemas = ["MaterialBindingAPI"]
        )
        {{
            uniform token elementType = "face"
            uniform token familyName = "materialBind"
            int[] indices = [{", ".join(map(str, range(material.start, material.stop)))}]
            rel material:binding = </Face/Materials/{name}>
        }}
"""
        for name, material in zip(names, rig.materials, strict=True)
        if material.stop > material.start
    )


def materials(rig: Rig, names: list[str], packed: bool) -> str:
    """The materials; in a package with their textures, otherwise with their mean colours."""
    inner = "\n".join(
        _material(rig, name, material, packed)
        for name, material in zip(names, rig.materials, strict=True)
        if material.stop > material.start
    )
    return f"""    def Scope "Materials"
    {{
{inner}
    }}
"""


def _material(rig: Rig, name: str, material: Material, packed: bool) -> str:
    path = f"/Face/Materials/{name}"
    textured = packed and material.texture is not None and rig.uv is not None
    red, green, blue = (
        material_color(rig, material) if textured else _mean(rig, material)
    ).tolist()
    color = f"color3f inputs:diffuseColor = ({red:.6g}, {green:.6g}, {blue:.6g})"
    reader = ""
    if textured and material.texture is not None:
        color = f"color3f inputs:diffuseColor.connect = <{path}/Picture.outputs:rgb>"
        reader = f"""
            def Shader "Place"
            {{
                uniform token info:id = "UsdPrimvarReader_float2"
                string inputs:varname = "st"
                float2 outputs:result
            }}

            def Shader "Picture"
            {{
                uniform token info:id = "UsdUVTexture"
                asset inputs:file = @{picture_path(material.texture)}@
                float4 inputs:scale = ({red:.6g}, {green:.6g}, {blue:.6g}, 1)
                token inputs:sourceColorSpace = "sRGB"
                token inputs:wrapS = "repeat"
                token inputs:wrapT = "repeat"
                float2 inputs:st.connect = <{path}/Place.outputs:result>
                float3 outputs:rgb
            }}
"""
    return f"""        def Material "{name}"
        {{
            token outputs:surface.connect = <{path}/Surface.outputs:surface>

            def Shader "Surface"
            {{
                uniform token info:id = "UsdPreviewSurface"
                {color}
                float inputs:metallic = {material.metallic:.6g}
                float inputs:roughness = {material.roughness:.6g}
                token outputs:surface
            }}
{reader}        }}
"""


def _mean(rig: Rig, material: Material) -> Doubles:
    """(3,) the mean colour of a material's faces with their textures, linear."""
    corners = rig.faces[material.start : material.stop].ravel()
    mean: Doubles = vertex_colors(rig)[corners].clip(0, 1).mean(axis=0, dtype=np.float64)
    return mean


def package(files: list[tuple[str, bytes]]) -> bytes:
    """A USD package (`.usdz`): files that are stored, not compressed, at multiples of 64 bytes.

    The first one is the scene. The same files always give the same bytes.
    """
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, content in files:
            entry = zipfile.ZipInfo(name, _EARLIEST)
            start = buffer.tell() + 30 + len(name.encode()) + 4
            padding = -start % _ALIGNED
            entry.extra = _EXTRA + padding.to_bytes(2, "little") + b"\0" * padding
            archive.writestr(entry, content)
    return buffer.getvalue()
