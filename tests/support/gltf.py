"""Checks that a GLB file is valid: a few rules by hand, all of them by Khronos' validator."""

from __future__ import annotations

import functools
import json
import os
import shutil
import struct
import subprocess
from pathlib import Path
from typing import Any

from support.places import ROOT

_HEADER, _JSON, _BINARY = 0x46546C67, 0x4E4F534A, 0x004E4942
_SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}  # bytes, by component type
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
# Prints the errors, one line of JSON.
_VALIDATE = """
const bytes = new Uint8Array(require('fs').readFileSync(process.argv[1]));
require('gltf-validator').validateBytes(bytes, { maxIssues: 0 }).then(report => {
  const errors = report.issues.messages.filter(message => message.severity === 0);
  console.log(JSON.stringify(errors.map(e => `${e.pointer}: ${e.code}: ${e.message}`)));
});
"""
NO_VALIDATOR = (
    "node with the package gltf-validator is not there "
    "(npm install --global gltf-validator; NODE_PATH=$(npm root --global))"
)


def parts(content: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON and the binary part of a GLB file."""
    magic, version, length = struct.unpack_from("<III", content)
    assert (magic, version, length) == (_HEADER, 2, len(content))
    size, kind = struct.unpack_from("<II", content, 12)
    assert kind == _JSON
    document: dict[str, Any] = json.loads(content[20 : 20 + size])
    rest = content[20 + size :]
    size, kind = struct.unpack_from("<II", rest)
    assert kind == _BINARY
    return document, rest[8 : 8 + size]


def accessor_errors(content: bytes) -> list[str]:
    """What is wrong with the accessors of a GLB file and the views that they read through."""
    document, binary = parts(content)
    views = document["bufferViews"]
    errors = [
        f"bufferViews/{i}: not inside the buffer, or empty"
        for i, view in enumerate(views)
        if not 0 < view["byteLength"] <= len(binary) - view.get("byteOffset", 0)
    ]

    def read(place: str, reader: dict[str, Any], count: int, width: int) -> None:
        """Check that `count` elements of `width` numbers lie in the view that `reader` names."""
        size = _SIZES[reader["componentType"]]
        view, offset = views[reader["bufferView"]], reader.get("byteOffset", 0)
        if (view.get("byteOffset", 0) + offset) % size:
            errors.append(f"{place}: does not begin at a multiple of {size} bytes")
        if offset + count * width * size > view["byteLength"]:
            errors.append(f"{place}: reads beyond its buffer view")

    for i, accessor in enumerate(document["accessors"]):
        place, count = f"accessors/{i}", accessor["count"]
        width = _WIDTHS[accessor["type"]]
        if count < 1:
            errors.append(f"{place}: is empty")
        if "bufferView" in accessor:
            read(place, accessor, count, width)
        elif "byteOffset" in accessor:
            errors.append(f"{place}: has a byteOffset without a bufferView")
        if sparse := accessor.get("sparse"):
            kind = accessor["componentType"]
            if not 0 < sparse["count"] <= count:
                errors.append(f"{place}: replaces no element, or more than there are")
            read(f"{place}/sparse/indices", sparse["indices"], sparse["count"], 1)
            values = {"componentType": kind} | sparse["values"]
            read(f"{place}/sparse/values", values, sparse["count"], width)
    return errors


@functools.lru_cache(maxsize=1)
def has_validator() -> bool:
    """Whether node is there and finds Khronos' validator."""
    if shutil.which("node") is None:
        return False
    command = ["node", "-e", "require('gltf-validator')"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, check=False).returncode == 0


def validator_errors(path: Path) -> list[str]:
    """The errors that Khronos' validator finds in a file; call `has_validator` first."""
    run = subprocess.run(
        ["node", "-e", _VALIDATE, os.fspath(path)],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
        check=True,
        timeout=60,
    )
    errors: list[str] = json.loads(run.stdout)
    return errors
