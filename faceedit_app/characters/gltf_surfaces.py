"""The surfaces of a glTF file: base colour, texture and texture coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.bounded import finite
from faceedit_app.characters.character import Surface, Texture
from faceedit_app.characters.gltf_buffers import GltfFile, Json
from faceedit_app.core.arrays import Floats
from faceedit_app.core.errors import FileError

_MASK = 0.5
_BLEND = 0.3  # blended surfaces are drawn where their alpha is above this


def _base_color(material: Json) -> Json:
    """The JSON of the base colour's texture; empty if there is none."""
    metal = material.get("pbrMetallicRoughness") or {}
    old = (material.get("extensions") or {}).get("KHR_materials_pbrSpecularGlossiness") or {}
    use = metal.get("baseColorTexture") or old.get("diffuseTexture") or {}
    return use if isinstance(use, dict) else {}


def placed_uv(material: Json, arrays: Mapping[str, NDArray[Any]]) -> Floats | None:
    """(V, 2) texture coordinates of the base colour, transformed; None if there are none.

    Args:
        material: its JSON.
        arrays: the attributes of a primitive, by name.
    """
    use = _base_color(material)
    transform = (use.get("extensions") or {}).get("KHR_texture_transform") or {}
    uv = arrays.get(f"TEXCOORD_{transform.get('texCoord', use.get('texCoord', 0))}")
    if uv is None or uv.shape[1] != 2:
        return None
    placed = uv.astype(np.float64) * np.asarray(transform.get("scale", (1, 1)), np.float64)
    if turn := float(transform.get("rotation", 0.0)):
        sine, cosine = np.sin(turn), np.cos(turn)
        placed = placed @ np.array([[cosine, -sine], [sine, cosine]])
    placed = placed + np.asarray(transform.get("offset", (0, 0)), np.float64)
    return finite(placed.astype(np.float32), "texture coordinates")


def surface_of(document: GltfFile, material: Json) -> Surface:
    """How a material is drawn."""
    metal = material.get("pbrMetallicRoughness") or {}
    old = (material.get("extensions") or {}).get("KHR_materials_pbrSpecularGlossiness") or {}
    color = metal.get("baseColorFactor") or old.get("diffuseFactor") or (1, 1, 1, 1)
    red, green, blue, alpha = (min(max(float(c), 0.0), 1.0) for c in color)
    mode = material.get("alphaMode", "OPAQUE")
    cutoff = {"MASK": float(material.get("alphaCutoff", _MASK)), "BLEND": _BLEND}.get(mode, 0.0)
    return Surface(
        name=str(material.get("name") or "")[:60],
        color=(red, green, blue, alpha),
        texture=_texture(document, _base_color(material)),
        # glTF's default of 1 for metal assumes a texture that FaceEdit does not read.
        roughness=min(max(float(metal.get("roughnessFactor", 0.6)), 0.0), 1.0),
        metallic=min(max(float(metal.get("metallicFactor", 0.0)), 0.0), 1.0),
        cutoff=min(cutoff, 1.0),
    )


def _texture(document: GltfFile, use: Json) -> Texture | None:
    """The base colour's picture; without bytes if it is missing.

    A character opens even if its pictures are missing.
    """
    if use.get("index") is None:
        return None
    name = "picture"
    try:
        texture = document.entry("textures", use["index"])
        extensions = texture.get("extensions") or {}
        sources = [texture.get("source")]  # PNG or JPEG, which every reader supports
        for extension in ("EXT_texture_webp", "KHR_texture_basisu"):
            sources.append(extensions.get(extension, {}).get("source"))
        image = document.entry("images", next(s for s in sources if s is not None))
        name = str(image.get("name") or image.get("uri") or image.get("mimeType") or name)[:60]
        if image.get("bufferView") is not None:
            return Texture(name, document.bytes_of(image["bufferView"]))
        return Texture(name, document.file(str(image["uri"])))
    except (FileError, ValueError, TypeError, KeyError, AttributeError, StopIteration):
        return Texture(name, b"")


def colors_of(stored: NDArray[Any] | None) -> Floats | None:
    """(V, 4) float32 of a colour attribute with or without alpha."""
    if stored is None or stored.shape[1] not in (3, 4):
        return None
    colors = np.ones((len(stored), 4), np.float32)
    colors[:, : stored.shape[1]] = np.clip(stored, 0.0, 1.0)
    return colors
