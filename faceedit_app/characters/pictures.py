"""Decode the textures of characters: all that Pillow reads (PNG, JPEG, WebP, ...), and KTX2."""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence

import numpy as np
from PIL import Image

from faceedit_app.characters.character import MeshPart, Texture
from faceedit_app.core.arrays import Pixels

LARGEST = 2048  # pixels per side; larger pictures are scaled down
_MOST_PIXELS = 16384 * 16384
_KTX2 = b"\xabKTX 20\xbb"


class Unreadable(Exception):
    """A picture cannot be decoded; the text is a sentence for the user."""


def decode(texture: Texture) -> Pixels:
    """(H, W, 4) uint8, sRGB and alpha, top row first; no side is longer than `LARGEST`.

    Raises:
        Unreadable: it is missing, damaged, too large or of an unsupported kind.
    """
    if not texture.content:
        raise Unreadable(f"the texture {texture.name} is missing")
    if texture.content.startswith(_KTX2):
        return _ktx2(texture)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow warns of large pictures
            file = Image.open(io.BytesIO(texture.content))
            if file.width * file.height > _MOST_PIXELS:
                raise Unreadable(f"the texture {texture.name} is too large")
            file.draft("RGB", (LARGEST, LARGEST))
            image = file.convert("RGBA")
    except Unreadable:
        raise
    except Exception as error:  # the decoders raise all kinds
        raise Unreadable(f"the texture {texture.name} cannot be read") from error
    image.thumbnail((LARGEST, LARGEST))
    return np.array(image, np.uint8)


def _ktx2(texture: Texture) -> Pixels:
    """A Basis Universal picture, at the largest level that is small enough."""
    try:
        import opengl_basisu
    except ImportError as error:
        raise Unreadable(
            f"the texture {texture.name} is KTX2; pip install opengl_basisu, or export PNG"
        ) from error
    try:
        picture = opengl_basisu.open(texture.content)
        level = 0
        while max(picture.level_size(level)) > LARGEST and level + 1 < picture.levels:
            level += 1
        if max(picture.level_size(level)) > LARGEST:
            raise Unreadable(f"the texture {texture.name} is too large")
        pixels = picture.transcode("rgba8", level=level).data
    except Unreadable:
        raise
    except Exception as error:  # the library's own kinds, and ValueError
        raise Unreadable(f"the texture {texture.name} cannot be read") from error
    return np.ascontiguousarray(pixels, np.uint8)


def read_textures(parts: Sequence[MeshPart]) -> tuple[list[Pixels], list[int | None], list[str]]:
    """The pictures, the number of each part's, and sentences about unreadable ones."""
    pictures: list[Pixels] = []
    known: dict[bytes, int | None] = {}
    numbers: list[int | None] = []
    faults: list[str] = []
    for part in parts:
        texture = part.surface.texture
        if texture is None or part.uv is None:
            numbers.append(None)
            continue
        if texture.content not in known:
            try:
                pictures.append(decode(texture))
                known[texture.content] = len(pictures) - 1
            except Unreadable as error:
                known[texture.content] = None
                faults.append(str(error))
        numbers.append(known[texture.content])
    return pictures, numbers, faults
