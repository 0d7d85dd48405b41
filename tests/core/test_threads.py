"""Results do not depend on the number of threads, nor on what is loaded first."""

from __future__ import annotations

import os
import platform
import subprocess
import sys

import pytest

EXPORT = """
import hashlib, sys, tempfile
from pathlib import Path

if sys.argv[1] == "numpy first":
    import numpy

from faceedit_app.characters.glb import read_rig
from faceedit_app.core.resources import shipped
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.networks.engine import Engine

rig, take = read_rig(shipped("assets/character.glb")), open_take(shipped("assets/demo_take.csv"))
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


@pytest.mark.skipif(
    platform.machine().lower() not in ("x86_64", "amd64"), reason="the kernels are those of x86"
)
@pytest.mark.parametrize("kernels", ["Haswell", "Prescott"])
def test_export_has_the_same_bytes_on_any_number_of_threads(kernels: str) -> None:
    # On one thread, the last bits of these kernels' products are not those of two or four.
    found = {
        (order, threads): exported(
            order, OPENBLAS_CORETYPE=kernels, OPENBLAS_NUM_THREADS=str(threads)
        )
        for order, threads in zip((*ORDERS, *ORDERS), (1, 2, 4, 2, 4, 1), strict=True)
    }
    assert len(set(found.values())) == 1, found
