"""Files that only an attacker or a damaged disk writes: the window shows or refuses them."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.places import SHARED
from support.takes import make_livelink_csv
from support.waiting import run_events
from support.windows import Bench, open_path, session_of

from faceedit_app.core.errors import FileError
from faceedit_app.editing.files.project import read_project
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.look import guard
from faceedit_app.ui.start.window import MainWindow

HOSTILE = SHARED / "cases" / "hostile"


def paint(window: MainWindow) -> None:
    """Paint everything; what cannot be painted fails the test."""
    run_events()
    assert not window.grab().isNull()
    run_events()
    assert not guard._reported


@pytest.fixture(autouse=True)
def nothing_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "_reported", set[str]())


def test_edits_that_scale_by_a_million_sixty_times_are_shown(bench: Bench) -> None:
    edit = {"control": "mouth_opening", "op": "scale", "start": 0, "end": 3, "falloff": 0.2}
    path = bench.folder / "edits.json"
    path.write_text(json.dumps({"version": 1, "edits": [edit | {"value": 1e6}] * 60}))
    window = bench.editing()
    window.commands.file.load_edits(path)
    assert len(session_of(window).edits) == 60
    paint(window)
    for shown in (session_of(window).asked, session_of(window).weights):
        assert np.isfinite(shown).all()
    window.actions_["fit_values"].trigger()
    paint(window)


def test_weights_as_large_as_a_take_can_have_are_shown(bench: Bench) -> None:
    lines = make_livelink_csv(bench.folder / "large.csv", seconds=1.0).read_text().splitlines()
    cells = [line.split(",") for line in lines]
    jaw, smile = (cells[0].index(name) for name in ("JawOpen", "MouthSmileLeft"))
    for number, row in enumerate(cells[1:]):
        row[jaw], row[smile] = ("9.99", "-9.99") if number % 2 else ("-9.99", "9.99")
    path = bench.folder / "large.csv"
    path.write_text("\n".join(map(",".join, cells)) + "\n")
    window = bench.window(path)
    paint(window)


def test_a_weight_that_no_face_can_have_is_named_with_its_line(bench: Bench) -> None:
    path = make_livelink_csv(bench.folder / "one.csv", seconds=1.0)
    lines = path.read_text().splitlines()
    cells = lines[7].split(",")
    window = bench.editing()
    for value in ("1e18", "1e30", "3e38", "10.5", "-11"):
        cells[lines[0].split(",").index("JawOpen")] = value
        lines[7] = ",".join(cells)
        path.write_text("\n".join(lines) + "\n")
        bench.errors.clear()
        window.commands.file.open_if_saved(path)
        bench.qtbot.waitUntil(lambda: bool(bench.errors))
        assert "one.csv, line 8: jawOpen" in bench.errors[0]
        assert open_path(window) == bench.take, "what was open stays open"


@pytest.mark.parametrize(
    ("ui", "more"),
    [
        ({"falloff_out": [1, 2], "unit": {"a": []}, "mirror_film": "yes"}, {}),
        ({"falloff_out": -3, "unit": 7}, {"visible": [0, 0]}),
        ({"falloff_out": 1e300}, {"visible": [-1e6, 1e6]}),
        ({"unit": "\u202e", "other": [[[[1]]]]}, {"selection": [5, 1e6]}),
        ({"falloff_out": None, "unit": None, "mirror_film": []}, {"visible": [2.9, 1e6]}),
    ],
)
def test_a_view_of_another_shape_opens_or_is_refused(
    bench: Bench, ui: dict[str, Any], more: dict[str, Any]
) -> None:
    window = bench.editing()
    path = bench.answers["save_project"] = bench.folder / "scene.faceedit"
    window.actions_["save"].trigger()
    document = json.loads(path.read_text())
    document["view"] |= {"ui": ui, "playhead": 1e6, "falloff": 1e6} | more
    path.write_text(json.dumps(document))
    bench.answers["unsaved"] = dialogs.Unsaved.DISCARD  # one that cannot be read holds no edits
    window.commands.file.open_if_saved(path)
    opened: list[Path] = []
    window.workspace.opener.opened.connect(opened.append)
    bench.qtbot.waitUntil(lambda: bool(opened or bench.errors))
    paint(window)


@pytest.mark.skipif(not HOSTILE.is_dir(), reason="needs the samples in shared/cases/hostile")
@pytest.mark.parametrize("ending", ["*.csv", "*.faceedit", "*.json"])
def test_known_samples_open_or_are_refused_in_one_line(bench: Bench, ending: str) -> None:
    window = bench.editing()
    opened: list[Path] = []
    window.workspace.opener.opened.connect(opened.append)
    window.workspace.opener.rate_needed.disconnect()
    window.workspace.opener.rate_needed.connect(lambda needed, _: bench.errors.append(str(needed)))
    for path in sorted(HOSTILE.glob(ending)):
        opened.clear()
        bench.errors.clear()
        if ending == "*.json":
            window.commands.file.load_edits(path)
        else:
            if ending == "*.faceedit" and not _take_is_there(path):
                continue
            window.commands.file.open(path)
            bench.qtbot.waitUntil(lambda: bool(opened or bench.errors), timeout=15_000)
        paint(window)
        assert all(len(error) <= 300 and error.isprintable() for error in bench.errors)


def _take_is_there(project: Path) -> bool:
    try:
        return read_project(project).take.exists()
    except FileError:
        return True  # it is refused before its take matters


@pytest.mark.skipif(os.name != "posix", reason="names are Unicode there")
def test_a_name_that_is_not_utf8_works_or_is_refused(bench: Bench) -> None:
    path = bench.folder / os.fsdecode(b"caf\xe9.csv")
    path.write_bytes(bench.take.read_bytes())
    window = bench.window(path)
    session = session_of(window)
    session.reset(0.5, 1.0)
    exported = bench.answers["export"] = bench.folder / os.fsdecode(b"\xe9dited.csv")
    window.actions_["export"].trigger()
    assert exported.exists() or bench.errors
    project = bench.answers["save_project"] = bench.folder / os.fsdecode(b"sc\xe8ne.faceedit")
    window.actions_["save"].trigger()
    assert not bench.errors
    assert read_project(project).take == path
    paint(window)
