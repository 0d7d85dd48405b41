"""The glTF 2.0 container: its JSON, its buffers, and the arrays in them.

The JSON is read directly, not by pygltflib's classes, which support neither compressed buffer views
nor malformed files. All sizes are checked against the bytes that exist.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.bounded import MOST_VERTICES, Damaged, finite, read_file, whole
from faceedit_app.core.errors import FileError
from faceedit_app.core.texts import plain_line

Json = dict[str, Any]

_DTYPES: dict[int, Any] = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_JSON, _BINARY = 0x4E4F534A, 0x004E4942
# The best compression of meshoptimizer: one control byte for 256 rows.
_MOST_EXPANSION = 2048
_READ = frozenset(
    (
        *_MESHOPT,
        "KHR_draco_mesh_compression",
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_texture_basisu",
        "EXT_texture_webp",
        "VRM",
    )
)
# Extensions that do not change the place of a vertex.
_HARMLESS = (
    "KHR_materials_",
    "KHR_lights_",
    "KHR_animation",
    "KHR_xmp",
    "VRMC_",
    "MSFT_",
    "ADOBE_",
)
REMEDY = "export it again as glTF 2.0 (.glb)"


class GltfFile:
    """An open glTF file.

    Args:
        path: a `.glb`, `.vrm` or `.gltf` file.

    Attributes:
        json: its JSON part.

    Raises:
        FileError: it cannot be read, or is newer than FaceEdit supports.
        Damaged: it contradicts itself.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        content = read_file(path)
        if content[:4] == b"glTF":
            text, self._binary = _chunks(content)
        else:
            text, self._binary = content, b""
        self.json = _parse(text)
        self._views: dict[int, tuple[bytes, int | None]] = {}
        self._buffers: dict[int, bytes] = {}
        self._check_version()

    def all(self, kind: str) -> list[Any]:
        """All entries of a kind, such as `meshes`; empty if the file has none."""
        entries = self.json.get(kind, [])
        if not isinstance(entries, list):
            raise Damaged(f"{kind} is not a list")
        return entries

    def entry(self, kind: str, index: Any) -> Json:
        """One entry of a kind."""
        entries = self.all(kind)
        found = entries[whole(index, f"a number in {kind}", len(entries) - 1)]
        if not isinstance(found, dict):
            raise Damaged(f"one of its {kind} is not described")
        return found

    def array(self, index: Any, normalize: bool = True) -> NDArray[Any]:
        """Read an accessor.

        Args:
            index: the number of the accessor.
            normalize: convert normalised integers to 0..1 or -1..1, as float32.

        Returns:
            (n, width) of the accessor's own type, or float32.
        """
        accessor = self.entry("accessors", index)
        dtype = _dtype(accessor.get("componentType"))
        width = _WIDTHS.get(accessor.get("type", ""))
        if width is None:
            raise Damaged("an accessor has an unknown type")
        count = whole(accessor.get("count"), "the count of an accessor", 3 * MOST_VERTICES)
        if accessor.get("bufferView") is None:
            values = np.zeros((count, width), dtype)
        else:
            offset = accessor.get("byteOffset") or 0
            values = self._rows(accessor["bufferView"], offset, count, dtype, width)
        if accessor.get("sparse"):
            values = self._sparse(accessor["sparse"], values)
        if dtype == np.float32:
            return finite(values, "numbers in an accessor")
        if normalize and accessor.get("normalized"):
            most = np.float32(np.iinfo(dtype).max)
            unit: NDArray[Any] = np.maximum(values.astype(np.float32) / most, np.float32(-1.0))
            return unit
        return values

    def count(self, index: Any) -> int:
        """The number of elements of an accessor, without reading it."""
        accessor = self.entry("accessors", index)
        return whole(accessor.get("count"), "the count of an accessor", 3 * MOST_VERTICES)

    def is_backed(self, index: Any) -> bool:
        """Whether an accessor has numbers in the file; else they are all zero."""
        return self.entry("accessors", index).get("bufferView") is not None

    def bytes_of(self, view: Any) -> bytes:
        """The bytes of a buffer view, such as a picture or a compressed mesh."""
        return self._view(view)[0]

    def file(self, uri: str) -> bytes:
        """The content of a URI: embedded data, or a file next to this one."""
        if uri.startswith("data:"):
            head, _, text = uri.partition(",")
            if not head.endswith(";base64"):
                raise Damaged("it holds data that is not base64")
            try:
                return base64.b64decode(text, validate=True)
            except (binascii.Error, ValueError) as error:
                raise Damaged("it holds data that is not base64") from error
        if ":" in uri.split("/")[0]:
            raise Damaged(f"it needs {uri[:60]}, which is not a file next to it")
        try:
            return read_file(self.path.parent / unquote(uri))
        except FileError as error:  # damage may make a name of anything, megabytes of data too
            problem = f"needs {plain_line(uri, 60)}, which {error.problem}"
            raise FileError(self.path, problem, "copy it there too, or export as .glb") from error

    def _sparse(self, sparse: Json, values: NDArray[Any]) -> NDArray[Any]:
        count = whole(sparse.get("count"), "the count of a sparse accessor", len(values))
        where, what = sparse["indices"], sparse["values"]
        kind = _dtype(where.get("componentType"))
        rows = self._rows(where["bufferView"], where.get("byteOffset") or 0, count, kind, 1)[:, 0]
        if kind.kind != "u" or (count and rows.max() >= len(values)):
            raise Damaged("a sparse accessor names a vertex that does not exist")
        values = values.copy()
        values[rows] = self._rows(
            what["bufferView"], what.get("byteOffset") or 0, count, values.dtype, values.shape[1]
        )
        return values

    def _rows(
        self, view: Any, offset: Any, count: int, dtype: np.dtype[Any], width: int
    ) -> NDArray[Any]:
        """(count, width) read from a buffer view, which must contain all of it."""
        data, stride = self._view(view)
        row = dtype.itemsize * width
        stride = row if stride is None else stride
        offset = whole(offset, "an offset", len(data))
        if stride < row or (count and offset + stride * (count - 1) + row > len(data)):
            raise Damaged("an accessor reaches beyond its buffer")
        shape = (count, width)
        return np.ndarray(shape, dtype, data, offset, (stride, dtype.itemsize)).copy()

    def _view(self, index: Any) -> tuple[bytes, int | None]:
        """The decompressed bytes of a buffer view, and their stride; cached."""
        view = self.entry("bufferViews", index)
        if index not in self._views:
            self._views[index] = self._decoded(view)
        return self._views[index]

    def _decoded(self, view: Json) -> tuple[bytes, int | None]:
        extensions = view.get("extensions") or {}
        packed = next((extensions[name] for name in _MESHOPT if name in extensions), None)
        if packed is not None:
            return self._meshopt(packed)
        stride = view.get("byteStride")
        if stride is not None:
            stride = whole(stride, "a stride", 252, 1)
        return self._slice(view), stride

    def _meshopt(self, packed: Json) -> tuple[bytes, int | None]:
        data = self._slice(packed)
        stride = whole(packed.get("byteStride"), "a stride", 256, 1)
        count = whole(packed.get("count"), "a count", 3 * MOST_VERTICES)
        if count * stride > _MOST_EXPANSION * len(data):
            raise Damaged("a compressed buffer claims more than it can hold")
        mode = packed.get("mode")
        try:
            import meshopt
        except ImportError as error:
            raise FileError(
                self.path, "is compressed (meshopt)", "pip install meshopt, or export without it"
            ) from error
        try:
            values = meshopt.decode_gltf_buffer(
                data, count, stride, mode, packed.get("filter", "NONE")
            )
        except Exception as error:  # the library raises several kinds of its own
            raise Damaged("a compressed buffer cannot be decoded") from error
        return np.ascontiguousarray(values).tobytes(), stride if mode == "ATTRIBUTES" else None

    def _slice(self, view: Json) -> bytes:
        data = self._buffer(view.get("buffer", 0))
        offset = whole(view.get("byteOffset") or 0, "an offset", len(data))
        length = whole(view.get("byteLength"), "a length", len(data) - offset)
        return data[offset : offset + length]

    def _buffer(self, index: Any) -> bytes:
        buffer = self.entry("buffers", index)
        uri = buffer.get("uri")
        if uri is None:
            return self._binary
        if index not in self._buffers:
            self._buffers[index] = self.file(str(uri))
        return self._buffers[index]

    def _check_version(self) -> None:
        version = str((self.json.get("asset") or {}).get("version", ""))
        if version.split(".")[0] != "2":
            problem = f"is glTF {version[:10]}" if version else "does not say which glTF it is"
            raise FileError(self.path, problem, REMEDY)
        for name in self.all("extensionsRequired"):
            if name not in _READ and not str(name).startswith(_HARMLESS):
                problem = f"needs the glTF extension {str(name)[:60]}, which FaceEdit does not know"
                raise FileError(self.path, problem, "export it without that extension")


def _dtype(component: Any) -> np.dtype[Any]:
    if component not in _DTYPES:
        raise Damaged("an accessor has an unknown number type")
    dtype: np.dtype[Any] = np.dtype(_DTYPES[component])
    return dtype


def _chunks(content: bytes) -> tuple[bytes, bytes]:
    """The JSON and the binary chunk of a GLB."""
    if len(content) < 20:
        raise Damaged("it is cut short")
    version, length = struct.unpack_from("<II", content, 4)
    if version != 2:
        raise Damaged(f"it is glTF {version}")
    if length > len(content):
        raise Damaged("it is cut short")
    chunks: dict[int, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<II", content, place)
        if place + 8 + size > length:
            raise Damaged("it is cut short")
        chunks.setdefault(kind, content[place + 8 : place + 8 + size])
        place += 8 + size
    if _JSON not in chunks:
        raise Damaged("it has no JSON")
    return chunks[_JSON], chunks.get(_BINARY, b"")


def _parse(text: bytes) -> Json:
    try:
        document = json.loads(text, parse_constant=_no_constant)
    except RecursionError as error:
        raise Damaged("its JSON is nested too deep") from error
    except (UnicodeDecodeError, ValueError) as error:
        raise Damaged("its JSON cannot be read") from error
    if not isinstance(document, dict):
        raise Damaged("its JSON is not an object")
    return document


def _no_constant(name: str) -> None:
    raise ValueError(name)
