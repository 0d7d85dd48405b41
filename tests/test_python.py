"""The interface for Python, and the recipes of its page."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.places import ROOT
from support.takes import make_livelink_csv, make_plain_csv

import faceedit_app
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.edits.edit import Op
from faceedit_app.formats.opening import open_take

NOTHING: Any = None  # where an argument must be something else
TEXT: Any = "a"
PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
RECIPES = dict(re.findall(r"^## ([^\n]+)\n\n```python\n(.*?)```", PAGE, re.MULTILINE | re.DOTALL))


@pytest.fixture
def take(tmp_path: Path) -> faceedit_app.Take:
    return faceedit_app.open(make_livelink_csv(tmp_path / "take.csv"))


def test_there_are_five_recipes() -> None:
    assert len(RECIPES) == 5


@pytest.mark.parametrize("make", [make_livelink_csv, make_plain_csv], ids=["head", "no head"])
@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_runs_as_it_is(
    name: str, make: Callable[[Path], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = make(tmp_path / "take.csv").read_bytes()
    monkeypatch.chdir(tmp_path)
    exec(compile(RECIPES[name], name, "exec"), {})
    written = [path for path in tmp_path.rglob("*") if path.is_file() and path.name != "take.csv"]
    written += (tmp_path / "edited").glob("*.csv")
    assert written
    assert (tmp_path / "take.csv").read_bytes() == before


def test_an_edit_is_that_of_the_window(take: faceedit_app.Take) -> None:
    take.edit("Mouth opening", by=5.0, start=0.5, end=0.7, falloff=0.1, strength=0.5)
    [edit] = take.edits
    assert (edit.controls, edit.op, edit.value) == (("mouth_opening",), Op.OFFSET, 5.0)
    assert (edit.start, edit.end, edit.falloff, edit.strength) == (0.5, 0.7, 0.1, 0.5)
    assert not np.array_equal(take.weights, take.tracked)
    take.undo()
    np.testing.assert_array_equal(take.weights, take.tracked)


def test_a_retime_keeps_the_number_of_frames_and_all_that_follows(
    take: faceedit_app.Take, tmp_path: Path
) -> None:
    take.retime([(0.6, 0.6), (0.8, 0.9)], end=1.2)
    [edit] = take.edits
    assert (edit.op, edit.end, edit.pins) == (Op.RETIME, 1.2, ((0.6, 0.6), (0.8, 0.9)))
    outside = (take.times <= 0.6) | (take.times >= 1.2)
    np.testing.assert_array_equal(take.weights[outside], take.tracked[outside])
    assert not np.array_equal(take.weights, take.tracked)
    take.export(tmp_path / "out.csv")
    assert len(open_take(tmp_path / "out.csv").clip) == len(take.times)
    with pytest.raises(FaceEditError, match="cross"):
        take.retime([(0.6, 0.8), (0.7, 0.7)])


def test_what_is_exported_is_what_the_take_holds(take: faceedit_app.Take, tmp_path: Path) -> None:
    take.edit(["left_eyelid", "right_eyelid"], to=0.0, start=0.9, end=1.0)
    take.export(tmp_path / "out.csv")
    again = open_take(tmp_path / "out.csv").clip
    assert again.channels == take.channels
    np.testing.assert_allclose(again.weights, take.weights, atol=1e-9)
    with pytest.raises(FaceEditError, match="is the recording itself"):
        take.export(take.path)


def test_fixing_leaves_fewer_problems(tmp_path: Path) -> None:
    take = faceedit_app.open(ROOT / "assets" / "demo_take.csv")
    before = len(take.problems())
    assert before == 2
    assert take.fix("lips") + take.fix("blinks") == 2
    assert take.problems() == []
    assert take.fix() == 0


def test_wrong_words_and_numbers_are_one_line(take: faceedit_app.Take) -> None:
    for wrong in (
        lambda: take.edit("nose", by=1.0),
        lambda: take.edit("mouth_opening"),
        lambda: take.edit("mouth_opening", by=1.0, to=2.0),
        lambda: take.edit("mouth_opening", by=1.0, start=2.0, end=1.0),
        lambda: take.edit("mouth_opening", by=1.0, strength=3.0),
        lambda: take.edit("mouth_opening", by=1.0, start=300, end=400),
        lambda: take.preset("smile", start=300, end=400),
        lambda: take.fix("teeth"),
        lambda: take.preset("grimace"),
        lambda: take.preset("blink"),
        lambda: take.preset("smile", strength=9.0),
        lambda: take.settings(mode="wild"),
        lambda: take.film("a.mp4", view="side"),
        lambda: faceedit_app.open("nowhere.csv"),
    ):
        with pytest.raises(FaceEditError) as error:
            wrong()
        assert len(str(error.value).splitlines()) == 1
    assert take.edits == ()


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda take, f: take.export(f, fps=0), "cannot have 0 frames per second; give 1 to 1000"),
        (lambda take, f: take.export(f, fps=-1), "give 1 to 1000"),
        (lambda take, f: take.export(f, fps=float("nan")), "fps=nan: must be a number"),
        (lambda take, f: take.export(f, fps=1e9), "give 1 to 1000"),
        (lambda take, f: take.film(f, fps=0), "give 1 to 1000"),
        (lambda take, f: take.export(None), "None: must be the name of a file"),
        (lambda take, f: take.export(take.path), "or give overwrite=True, which keeps a copy"),
        (lambda take, f: take.save_edits(take.path), "read here"),
        (lambda take, f: take.load_edits(f).export(f), "read here"),
        (lambda take, f: take.make_neutral(at=99), "is outside the take"),
        (lambda take, f: take.make_neutral(at=float("nan")), "at=nan: must be a number"),
        (lambda take, f: take.retime([(1, 1), (1, "2")]), "pin='2': must be a number"),
        (lambda take, f: take.retime([1]), "pins must be pairs of seconds"),
        (lambda take, f: take.edit("mouth_opening", by="3"), "by='3': must be a number"),
        (lambda take, f: take.edit("mouth_opening", by=3, start=None), "start=None: must be"),
        (lambda take, f: take.edit(3, by=3), "must be names"),
        (lambda take, f: take.edit(["jawOpen", "mouth_width"], by=3), "cannot be mixed in one"),
        (lambda take, f: take.preset("smile", start="a"), "start='a': must be a number"),
        (lambda take, f: take.preset(3), "3: must be the name of a file"),
        (lambda take, f: faceedit_app.open(NOTHING), "None: must be the name of a file"),
        (lambda take, f: faceedit_app.open(take.path, fps=TEXT), "fps='a': must be a number"),
    ],
)
def test_what_cannot_be_is_said_and_changes_nothing(
    tmp_path: Path, wrong: Callable[[Any, Path], object], says: str
) -> None:
    take = faceedit_app.open(make_livelink_csv(tmp_path / "take.csv"))
    edits = tmp_path / "edits.csv"
    edits.write_text(json.dumps({"version": 1, "edits": []}))
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(FaceEditError) as error:
        wrong(take, edits)
    assert says in str(error.value)
    assert "--" not in str(error.value)
    assert take.edits == ()
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_rate_that_is_needed_is_asked_for_as_python_does(tmp_path: Path) -> None:
    path = tmp_path / "bare.csv"
    path.write_text("jawOpen,eyeBlinkLeft\n" + "0.1,0.2\n" * 20)
    with pytest.raises(FaceEditError, match="such as fps="):
        faceedit_app.open(path)


def test_a_moment_at_two_times_is_a_pause(take: faceedit_app.Take) -> None:
    take.retime([(0.8, 0.8), (0.8, 1.1)])
    still = take.weights[(take.times >= 0.8) & (take.times <= 1.1)]
    np.testing.assert_allclose(still, np.broadcast_to(still[0], still.shape), atol=0.02)


def test_importing_the_package_loads_nothing_more() -> None:
    code = "import sys, faceedit_app; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        faceedit_app.nothing  # noqa: B018


def test_channels_are_edited_and_a_frame_is_made_neutral(tmp_path: Path) -> None:
    take = faceedit_app.open(make_livelink_csv(tmp_path / "take.csv", 2.0))
    jaw = take.channels.index("jawOpen")
    take.edit("jawOpen", times=0.5).edit(["headYaw", "headPitch"], by=5.0)
    assert np.ptp(take.weights[:, jaw]) < 0.6 * np.ptp(take.tracked[:, jaw])
    rest = int(take.weights[:, jaw].argmin())
    take.make_neutral(at=float(take.times[rest]))
    assert take.weights[rest, jaw] == 0
    with pytest.raises(FaceEditError, match="channels have no set"):
        take.edit("jawOpen", to=0.5)
    bare = faceedit_app.open(make_plain_csv(tmp_path / "bare.csv"))
    with pytest.raises(FaceEditError, match="the take has no headYaw to change"):
        bare.edit("headYaw", by=5.0)
