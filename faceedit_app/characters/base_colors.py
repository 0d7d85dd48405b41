"""The base colours of a rig, as formats of 3D programs want them: by vertex, material, picture."""

from __future__ import annotations

import io

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats, Pixels
from faceedit_app.core.rig import Material, Rig

_PLAIN = (0.8, 0.8, 0.8)  # of a material without faces


def png_of(picture: Pixels) -> bytes:
    """A picture (H, W, 4) as PNG."""
    from PIL import Image  # only characters of other makers have textures

    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, "PNG")
    return buffer.getvalue()


def material_color(rig: Rig, material: Material) -> Doubles:
    """(3,) the mean of the vertex colours of a material, linear."""
    corners = rig.faces[material.start : material.stop].ravel()
    if not len(corners):
        return np.array(_PLAIN)
    mean: Doubles = rig.colors[corners, :3].clip(0, 1).mean(axis=0, dtype=np.float64)
    return mean


def vertex_colors(rig: Rig) -> Floats:
    """(V, 3) colours of the vertices with those of their textures, linear."""
    colors = rig.colors[:, :3].copy()
    if rig.uv is None:
        return colors
    for material in rig.materials:
        if material.texture is not None:
            picture = rig.textures[material.texture]
            used = np.unique(rig.faces[material.start : material.stop])
            height, width = picture.shape[:2]
            column, row = (np.floor(rig.uv[used] * [width, height]).astype(np.int64)).T
            colors[used] *= linear(picture[row % height, column % width, :3] / 255.0)
    return colors


def linear(srgb: Doubles | Floats) -> Floats:
    """sRGB colours, 0..1, as linear ones."""
    high = ((srgb + 0.055) / 1.055) ** 2.4
    return np.where(srgb <= 0.04045, srgb / 12.92, high).astype(np.float32)


def srgb(colors: Floats | Doubles) -> Doubles:
    """Linear colours as sRGB, 0..1."""
    bounded = colors.clip(0, 1).astype(np.float64)
    high = 1.055 * bounded ** (1 / 2.4) - 0.055
    result: Doubles = np.where(bounded <= 0.0031308, 12.92 * bounded, high)
    return result
