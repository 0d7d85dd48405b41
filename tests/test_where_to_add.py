"""Where things are added: a copy of the project with one thing more, in the files it should take.

Each addition is made to the copy as a developer would make it; the cases in `tests/additions` then
run against the copy, in a process of its own.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.places import ROOT

NEEDED = ("faceedit_app", "assets", "models", "tests", "docs")

OUTER_BROW = """
    Control(
        "outer_brow",
        "Outer brow height",
        "Distance from the character's left eye to the end of the brow. Up raises it.",
        region="upper",
        key="",
        color="#009e73",
    ),
"""
WINK = {
    "version": 1,
    "name": "Wink",
    "hint": "The left eye winks",
    "menu": "Win&k",
    "key": "Ctrl+Alt+W",
    "icon": "blink",
    "button": True,
    "alone": "playhead",
    "seconds": 0.2,
    "edits": [
        {
            "control": "left_eyelid",
            "op": "set",
            "start": 0,
            "end": 0.2,
            "falloff": 0.1,
            "value": 0,
        }
    ],
}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the project, with what Python has compiled of it."""
    root = tmp_path / "project"
    for name in NEEDED:  # not what is being compiled
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("*.pyc.*"))
    shutil.copy(ROOT / "pyproject.toml", root)
    return root


def run_tests(project: Path, *tests: str) -> None:
    """Run tests on the copy."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist"]
    env = os.environ | {"PYTHONPATH": str(project), "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(
        [*command, *tests], cwd=project, env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-8000:] + done.stderr[-2000:]


@pytest.mark.timeout(300)
def test_a_ninth_control_takes_a_row_of_the_table_a_character_and_a_model(project: Path) -> None:
    table = project / "faceedit_app" / "core" / "controls.py"
    rows, end = table.read_text(encoding="utf-8").split("\n)\n\nCONTROL_IDS")
    table.write_text(f"{rows}{OUTER_BROW.rstrip()}\n)\n\nCONTROL_IDS{end}", encoding="utf-8")
    run_tests(project, "tests/additions/ninth_control.py", "tests/core/test_controls.py")


@pytest.mark.timeout(300)
def test_a_fix_takes_one_preset_file(project: Path) -> None:
    presets = project / "faceedit_app" / "editing" / "help" / "presets"
    (presets / "13_wink.json").write_text(json.dumps(WINK), encoding="utf-8")
    run_tests(
        project,
        "tests/additions/another_fix.py",
        "tests/ui/test_actions.py::test_the_table_is_sound",
        "tests/ui/test_fix_commands.py::test_every_fix_is_one_step_and_ready_to_be_weakened",
        "tests/editing/test_fixes.py",
    )
