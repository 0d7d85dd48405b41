"""Where things are added: a copy of the project with one thing more, in the files it should take.

Each addition is made to the copy as a developer would make it; the cases in `tests/additions` then
run against the copy, in a process of its own.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.places import ROOT

NEEDED = ("faceedit_app", "assets", "models", "tests", "docs")

# A control that networks may listen to, and optional ones with regions of their own.
CONTROLS = """
    Control(
        "tongue_out",
        "Tongue",
        "Distance from the back of the head to the tip of the tongue. Up puts it out.",
        region="tongue_region",
        key="",
        color="#d55e00",
        optional=True,
    ),
    Control(
        "lips_side",
        "Lips to the side",
        "How far the upper lip is from the middle. Up moves it to the character's left.",
        region="lips_region",
        key="",
        color="#d55e00",
        optional=True,
        sideways=True,
    ),
    Control(
        "outer_brow",
        "Outer brow height",
        "Distance from the character's left eye to the end of the brow. Up raises it.",
        region="upper",
        key="",
        color="#f0e442",
    ),
"""
REGIONS = """
TONGUE = _region("tongue_region", "Tongue", "Tongue", "tongueOut")
LIPS = _region("lips_region", "Lips", "Lips", *_both("mouth"))
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


def insert(path: Path, text: str, before: str) -> None:
    """Put text into a file where a developer would."""
    content = path.read_text(encoding="utf-8")
    assert content.count(before) == 1
    path.write_text(content.replace(before, text + before), encoding="utf-8")


def run_tests(project: Path, *tests: str) -> None:
    """Run tests on the copy."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist"]
    command.append(
        f"--basetemp={project.parent / 'temporary'}"
    )  # no files of earlier runs to remove
    env = os.environ | {"PYTHONPATH": str(project), "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(
        [*command, *tests], cwd=project, env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-8000:] + done.stderr[-2000:]


@pytest.mark.timeout(300)
def test_controls_take_rows_of_the_tables_and_a_fix_one_preset_file(project: Path) -> None:
    """Both in one copy: a process that runs tests takes seconds to start."""
    package = project / "faceedit_app"
    insert(package / "core" / "controls.py", CONTROLS.rstrip(), before="\n)\n\nCONTROL_IDS")
    insert(package / "core" / "regions.py", REGIONS, before="\nREGIONS: ")
    insert(package / "core" / "regions.py", ", TONGUE, LIPS", before=")\n# The name of the group")
    presets = package / "editing" / "help" / "presets"
    (presets / "13_wink.json").write_text(json.dumps(WINK), encoding="utf-8")
    run_tests(
        project,
        "tests/additions/more_controls.py",
        "tests/core/test_controls.py",
        "tests/additions/another_fix.py",
        "tests/ui/test_actions.py::test_the_table_is_sound",
        "tests/ui/test_fix_commands.py::test_every_fix_is_one_step_and_ready_to_be_weakened",
        "tests/editing/test_fixes.py",
    )


def test_another_character_that_ships_takes_no_other_code() -> None:
    named = {
        path.relative_to(ROOT).as_posix()
        for folder in ("faceedit_app", "assets", "packaging")
        for path in (ROOT / folder).rglob("*.py")
        if re.search(r"assets/character\.", path.read_text(encoding="utf-8"))
    }
    # The builder's documentation names the file that it writes.
    assert named - {"assets/builder/landmarks.py"} == {"faceedit_app/core/resources.py"}
