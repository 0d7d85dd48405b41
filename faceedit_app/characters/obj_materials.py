"""The materials of OBJ files, from the MTL files that they name."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path, PureWindowsPath

from faceedit_app.characters.bounded import read_file
from faceedit_app.characters.character import Surface, Texture
from faceedit_app.core import on_disk
from faceedit_app.core.errors import FileError

# An option of a texture, with its values, before the name of the file.
_OPTION = re.compile(
    r"-(?:(?:blendu|blendv|cc|clamp)\s+(?:on|off)|(?:imfchan|type)\s+\S+|(?:bm|boost|texres)\s+\S+"
    r"|mm(?:\s+[-+.\de]+){2}|[ost](?:\s+[-+.\de]+){1,3})\s+",
    re.IGNORECASE,
)
_GREY = (0.8, 0.8, 0.8, 1.0)


def read_materials(path: Path, library: str) -> tuple[dict[str, Surface], tuple[str, ...]]:
    """Read the materials of an OBJ file.

    Args:
        path: the OBJ file.
        library: the MTL file that it names; empty if it names none.

    Returns:
        The materials by name, and a sentence if their file is missing.
    """
    if not library:
        return {}, ()
    content = _beside(path, library)
    if content is None:
        name = PureWindowsPath(library).name
        return {}, (f"its materials, {name[:60]}, are missing: put the file beside it",)
    surfaces: dict[str, Surface] = {}
    name = ""
    for line in content.decode("utf-8", "replace").splitlines():
        key, _, value = line.strip().partition(" ")
        value = value.strip()
        if key == "newmtl":
            name = value[:60]
            surfaces[name] = Surface(name)
        elif name and key == "Kd" and surfaces[name].texture is None:
            surfaces[name] = replace(surfaces[name], color=_color(value))
        elif name and key.lower() == "map_kd" and value:
            texture = _texture(path, value)
            surfaces[name] = replace(surfaces[name], texture=texture, color=(1.0, 1.0, 1.0, 1.0))
    return surfaces, ()


def _texture(path: Path, value: str) -> Texture:
    """The picture that a line names; its options are skipped."""
    while (option := _OPTION.match(value)) is not None:
        value = value[option.end() :]
    value = value.strip('"')
    return Texture(PureWindowsPath(value).name[:60], _beside(path, value) or b"")


def _beside(path: Path, name: str) -> bytes | None:
    """A file that an OBJ file names: by its relative path, or by its bare name beside it.

    Names are compared without case, as on the systems where many of these files are written.
    """
    named = PureWindowsPath(name.strip('"'))
    inside = not named.is_absolute() and not named.drive and not named.root
    places = [path.parent.joinpath(*named.parts)] if inside else []
    for place in (*places, path.parent / named.name):
        try:
            return read_file(_as_spelled(place))
        except (FileError, ValueError):
            continue
    return None


def _as_spelled(place: Path) -> Path:
    """The file of a folder whose name is that of `place` but for its case."""
    if on_disk.exists(place) or not on_disk.is_folder(place.parent):
        return place
    wanted = place.name.casefold()
    return next((p for p in place.parent.iterdir() if p.name.casefold() == wanted), place)


def _color(text: str) -> tuple[float, float, float, float]:
    try:
        red, green, blue = (min(max(float(x), 0.0), 1.0) for x in text.split()[:3])
    except ValueError:
        return _GREY
    return red, green, blue, 1.0
