"""The table of character formats."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from faceedit_app.characters.bounded import Damaged
from faceedit_app.characters.character import Character
from faceedit_app.characters.copies import without_copies
from faceedit_app.characters.fbx import read_fbx
from faceedit_app.characters.fbx_tree import MAGIC
from faceedit_app.characters.gltf import read_gltf
from faceedit_app.characters.obj import read_obj, read_one_obj
from faceedit_app.characters.vrm import read_vrm
from faceedit_app.core import on_disk
from faceedit_app.core.errors import FileError, reason_of

_HEAD = 1 << 16  # bytes that show the kind of a file
_LONGEST_JSON = 1 << 26
_REMEDY = "choose a GLB, glTF, VRM, binary FBX or OBJ with blendshapes"
SCAN_REMEDY = "use an OBJ, PLY, STL or GLB of a neutral face"
# Files that people try, and how to convert them.
_KNOWN = {
    ".blend": "a Blender file; in Blender, File > Export > glTF 2.0",
    ".ma": "a Maya scene; export it as FBX",
    ".mb": "a Maya scene; export it as FBX",
    ".usd": "a USD scene; export it as GLB",
    ".usda": "a USD scene; export it as GLB",
    ".usdc": "a USD scene; export it as GLB",
    ".usdz": "a USD scene; export it as GLB",
    ".max": "a 3ds Max scene; export it as FBX",
    ".uasset": "an Unreal asset; in Unreal, Asset Actions > Export as FBX",
    ".pmx": "a MikuMikuDance model; convert it to VRM",
    ".stl": "a mesh without blendshapes; export a head that has them as GLB",
    ".ply": "a mesh without blendshapes; export a head that has them as GLB",
    ".zip": "an archive; unpack it first",
}


@dataclass(frozen=True)
class CharacterFormat:
    """A kind of character file.

    Attributes:
        name: shown to the user.
        endings: of file names, with the dot, in lower case.
        sniff: whether a path with these first bytes (b"" for a folder) is of this kind.
        read: reads the file; raises FileError and Damaged.
    """

    name: str
    endings: tuple[str, ...]
    sniff: Callable[[Path, bytes], bool]
    read: Callable[[Path], Character]


def _is_gltf(path: Path, head: bytes) -> bool:
    is_json = path.suffix.lower() == ".gltf" or (head.lstrip()[:1] == b"{" and b'"asset"' in head)
    return head[:4] == b"glTF" or is_json


def _is_vrm(path: Path, head: bytes) -> bool:
    named = path.suffix.lower() == ".vrm" or b'"VRMC_vrm"' in head or b'"VRM"' in head
    return named and _is_gltf(path, head)


def _is_fbx(path: Path, head: bytes) -> bool:
    return head.startswith(MAGIC[:18]) or path.suffix.lower() == ".fbx"


def _is_obj(path: Path, head: bytes) -> bool:
    return on_disk.is_folder(path) or path.suffix.lower() == ".obj"


FORMATS: tuple[CharacterFormat, ...] = (
    CharacterFormat("VRM", (".vrm",), _is_vrm, read_vrm),
    CharacterFormat("glTF", (".glb", ".gltf"), _is_gltf, read_gltf),
    CharacterFormat("FBX", (".fbx",), _is_fbx, read_fbx),
    CharacterFormat("OBJ", (".obj",), _is_obj, read_obj),
)


def is_character(path: Path) -> bool:
    """Whether the name of a file, or what a folder holds, is that of a character."""
    if on_disk.is_folder(path):
        return any(path.glob("*.obj")) or any(path.glob("*.OBJ"))
    return any(path.suffix.lower() in kind.endings for kind in FORMATS)


def read_character(path: Path | str, with_shapes: bool = True) -> Character:
    """Open any character; its kind is recognised by its content, then by its name.

    Args:
        path: the file or folder.
        with_shapes: whether other OBJ files beside an OBJ file are its shapes.

    Raises:
        FileError: it is not a character, is damaged, or its kind or version is not supported.
    """
    path = Path(path)
    head = _head(path)
    for kind in FORMATS:
        if kind.sniff(path, head):
            is_alone = kind.read is read_obj and not with_shapes and on_disk.is_file(path)
            found = _read(replace(kind, read=read_one_obj) if is_alone else kind, path)
            return without_copies(found)
    known = _KNOWN.get(path.suffix.lower())
    if known is not None:
        problem, _, remedy = known.partition("; ")
        raise FileError(path, f"is {problem}", remedy)
    if not with_shapes:
        raise FileError(path, "is not a scan that FaceEdit can read", SCAN_REMEDY)
    raise FileError(path, "is not a character file that FaceEdit can read", _REMEDY)


def _read(kind: CharacterFormat, path: Path) -> Character:
    try:
        return kind.read(path)
    except Damaged as error:
        raise FileError(path, f"is damaged: {error}", "export it again") from error
    except (
        KeyError,
        TypeError,
        IndexError,
        ValueError,
        AttributeError,
        OverflowError,
        RecursionError,
    ) as error:  # something is not where the format requires it
        raise FileError(path, f"is not a valid {kind.name} file", "export it again") from error
    except MemoryError as error:
        raise FileError(path, "needs more memory than there is", "export a smaller one") from error


def _head(path: Path) -> bytes:
    """The first bytes of a file; b"" for a folder."""
    try:
        if path.is_dir():
            return b""
        if not path.exists():
            raise FileError(path, "does not exist", "check the path")
        if not path.is_file():
            raise FileError(path, "is not a regular file", _REMEDY)
        with path.open("rb") as file:
            head = file.read(20)
            if head[:4] != b"glTF":
                return head + file.read(_HEAD)
            # The whole JSON: only there is a VRM marked as one.
            return head + file.read(min(int.from_bytes(head[12:16], "little"), _LONGEST_JSON))
    except OSError as error:
        reason = reason_of(error)
        raise FileError(path, f"cannot be read ({reason})", "check the path") from error
    except ValueError as error:  # a path with a zero character
        raise FileError(Path("?"), "is not a path", "check the path") from error
