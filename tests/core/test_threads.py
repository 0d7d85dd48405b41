"""Results do not depend on the number of threads, nor on what is loaded first."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

from faceedit_app.core.resources import DEMO_TAKE, shipped

EXPORT = """
import hashlib, sys, tempfile
from pathlib import Path

if sys.argv[1] == "numpy first":
    import numpy

from faceedit_app.characters.glb import read_rig
from faceedit_app.core.resources import CHARACTER, DEMO_TAKE, shipped
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.networks.engine import Engine

rig, take = read_rig(shipped(CHARACTER)), open_take(shipped(DEMO_TAKE))
if sys.argv[1] == "networks first":  # as the command line does
    session = EditSession(take, rig, Engine.load(shipped("models"), rig))
else:  # as the window does
    session = EditSession(take, rig)
    session.use_engine(Engine.load(shipped("models"), rig))
session.add(Edit(("mouth_opening", "left_corner"), Op.OFFSET, 2.0, 3.0, 0.2, 4.0))
with tempfile.TemporaryDirectory() as folder:
    session.export(Path(folder, "edited.csv"))
    print(hashlib.sha256(Path(folder, "edited.csv").read_bytes()).hexdigest())
"""
ORDERS = ("networks first", "take first", "numpy first")


def exported(order: str, **variables: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", EXPORT, order],
        env=os.environ | variables,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


X86 = pytest.mark.skipif(
    platform.machine().lower() not in ("x86_64", "amd64"), reason="the kernels are those of x86"
)


@X86
@pytest.mark.parametrize("kernels", ["Haswell", "Prescott"])
def test_export_has_the_same_bytes_on_any_number_of_threads(kernels: str) -> None:
    # On one thread, the last bits of these kernels' products are not those of two or four.
    found = {
        (order, threads): exported(
            order, OPENBLAS_CORETYPE=kernels, OPENBLAS_NUM_THREADS=str(threads)
        )
        for order, threads in zip(ORDERS, (4, 2, 1), strict=True)
    }
    assert len(set(found.values())) == 1, found


def faceedit(*arguments: str | Path, **variables: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "faceedit_app", *map(str, arguments)],
        env=os.environ | variables,
        capture_output=True,
        text=True,
        check=False,
        timeout=200,
    )
    assert done.returncode == 0, done.stderr


@X86
@pytest.mark.timeout(500)
def test_window_and_command_line_export_the_same_bytes(tmp_path: Path) -> None:
    take, exports = shipped(DEMO_TAKE), dict[str, bytes]()
    homes = {name: str(tmp_path) for name in ("HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME")}
    for kernels, in_window, on_command_line in (("Haswell", "4", "1"), ("Prescott", "1", "2")):
        folder = tmp_path / kernels
        folder.mkdir()
        chosen = homes | {"OPENBLAS_CORETYPE": kernels}
        window = {"FACEEDIT_SMOKE": str(folder), "QT_QPA_PLATFORM": "offscreen"}
        faceedit(take, **chosen, **window, OPENBLAS_NUM_THREADS=in_window)
        output = folder / "applied.csv"
        edits = ("apply", take, folder / "edits.json", "-o", output)
        faceedit(*edits, **chosen, OPENBLAS_NUM_THREADS=on_command_line)
        exports[kernels] = output.read_bytes()
        assert (folder / "edited.csv").read_bytes() == exports[kernels], kernels
        assert exports[kernels] != take.read_bytes()
    cells = [[line.split(b",") for line in export.splitlines()] for export in exports.values()]
    differ = [(a, b) for rows in zip(*cells, strict=True) for a, b in zip(*rows, strict=True)]
    different = [abs(float(a) - float(b)) for a, b in differ if a != b]
    assert len(different) <= 10, "between processors, only rounding may differ"
    assert max(different, default=0.0) < 1.1e-5
