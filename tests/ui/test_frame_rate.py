"""Takes whose time only the user can know, and takes that cannot answer all curves."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtWidgets import QWidget
from support import recordings
from support.windows import (
    Bench,
    add_edit,
    bench,
    drop,
    open_path,
    session_of,
    trigger,
    trigger_enabled,
)

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files.project import read_project
from faceedit_app.editing.history import RATE
from faceedit_app.ui.commands import dialogs, file_kinds
from faceedit_app.ui.commands.unsaved import question_about
from faceedit_app.ui.start.window import MainWindow

__all__ = ["bench"]

MIDDLE = [name for name in ARKIT_CHANNELS if not name.endswith(("Left", "Right"))]


class Asked:
    """Answers the question for a frame rate, and remembers what was asked."""

    def __init__(self, answer: float | None) -> None:
        self.answer = answer
        self.questions: list[tuple[str, float, float]] = []

    def __call__(self, _: QWidget, question: str, frames: float, rate: float) -> float | None:
        self.questions.append((question, frames, rate))
        return self.answer


@pytest.fixture
def answered(monkeypatch: pytest.MonkeyPatch) -> Callable[[float | None], Asked]:
    def answer(rate: float | None) -> Asked:
        asked = Asked(rate)
        monkeypatch.setattr(dialogs, "ask_rate", asked)
        return asked

    return answer


@pytest.fixture
def untimed(tmp_path: Path) -> Path:
    """90 frames without times."""
    path = tmp_path / "untimed.csv"
    path.write_text("jawOpen\n" + "".join(f"{0.004 * n:.3f}\n" for n in range(90)))
    return path


def wait_for(bench: Bench, window: MainWindow, path: Path) -> None:
    bench.qtbot.waitUntil(lambda: window.document.path == path, timeout=10_000)


def test_a_take_without_times_is_asked_about_and_opens(
    bench: Bench, untimed: Path, answered: Callable[[float | None], Asked]
) -> None:
    asked = answered(30.0)
    window = bench.window()
    drop(window, untimed)
    wait_for(bench, window, untimed)
    (question,) = asked.questions
    assert question == (
        "untimed.csv has no column with times. What is its frame rate?",
        90,
        60.0,
    )
    assert session_of(window).take.clip.duration == pytest.approx(3)
    assert "30 fps" in window.status.facts.text()
    assert bench.errors == []


def test_the_face_model_is_loaded_while_a_question_waits(
    bench: Bench, untimed: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A start with a take that has no frame rate, and an answer that takes long."""
    window = bench.window(start=False)
    settled: list[bool] = []
    window.settled.connect(lambda: settled.append(True))

    def think(*_: object) -> float:
        bench.qtbot.waitUntil(lambda: bool(settled), timeout=15_000)
        return 30.0

    monkeypatch.setattr(dialogs, "ask_rate", think)
    window.start(untimed)
    wait_for(bench, window, untimed)
    assert bench.errors == []


def test_who_gives_no_rate_keeps_the_open_take(
    bench: Bench, untimed: Path, answered: Callable[[float | None], Asked]
) -> None:
    asked = answered(None)
    window = bench.editing()
    drop(window, untimed)
    bench.qtbot.waitUntil(lambda: len(asked.questions) == 1)
    assert open_path(window) == bench.take
    assert not window.workspace.opener.is_reading


def test_another_rate_is_a_step_and_edits_stay_on_their_frames(
    bench: Bench, answered: Callable[[float | None], Asked]
) -> None:
    window = bench.editing()
    add_edit(window)
    session = session_of(window)
    window.timeline.go_to_frame(50)
    asked = answered(30.0)
    trigger(window, "frame_rate")
    assert asked.questions[0][1:] == pytest.approx((180, 60.0))
    again = session_of(window)
    assert (again.take.clip.rate, again.take.fps) == (30, 30)
    assert [(edit.start, edit.end) for edit in again.edits] == [(2.0, pytest.approx(2.8))]
    assert window.isWindowModified()
    assert window.timeline.frame == 50
    assert "Undo takes that back" in window.statusBar().currentMessage()
    names = (*session.history[0], "Frame rate 30 fps")
    assert again.history == (names, ())
    add_edit(window, 5.0)
    trigger_enabled(window, "undo", "undo")
    assert "Undid: Frame rate 30 fps" in window.statusBar().currentMessage()
    assert session_of(window).take.fps is None
    assert session_of(window).edits == session.edits, "to the bit"
    trigger_enabled(window, "redo", "redo")
    assert session_of(window).take.clip.rate == 30
    assert [edit.start for edit in session_of(window).edits] == [2.0, 1.0]
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    own_times = "out.csv: it keeps the take's own times, which say 60 fps and not 30 fps"
    assert own_times in window.banner.text.text()
    window.commands.edit.travel(-3)
    assert session_of(window).edits == ()
    assert session_of(window).take.clip.rate == 60
    assert session_of(window).is_saved


def test_a_rate_alone_is_not_lost_without_a_word(
    bench: Bench, answered: Callable[[float | None], Asked]
) -> None:
    window = bench.editing()
    bench.answers |= {
        "save_project": bench.folder / "scene.faceedit",
        "unsaved": dialogs.Unsaved.CANCEL,
    }
    answered(48.0)
    trigger(window, "frame_rate")
    assert question_about(window.document) == (
        "The frame rate that you gave take.csv is not saved in a project.",
        "If you discard it, the take opens as before.",
    )
    assert not window.close()
    trigger(window, "save")
    assert session_of(window).is_saved
    assert read_project(bench.folder / "scene.faceedit").fps == 48
    trigger(window, "undo")
    assert window.isWindowModified()
    assert session_of(window).unsaved == (RATE,)


def test_a_rate_whose_take_was_replaced_meanwhile_stays_and_the_window_says_why(
    bench: Bench, answered: Callable[[float | None], Asked]
) -> None:
    window = bench.editing()
    answered(48.0)
    trigger(window, "frame_rate")
    session = session_of(window)
    bench.take.write_bytes(bench.take.read_bytes() + b"\n")
    trigger(window, "undo")
    assert session_of(window) is session
    assert session.undo_name == "Frame rate 48 fps"
    assert "take.csv has been replaced since it was opened" in window.banner.text.text()
    assert "Undid" not in window.statusBar().currentMessage()


def test_the_length_at_another_rate_counts_the_gaps_of_the_take(
    bench: Bench, answered: Callable[[float | None], Asked]
) -> None:
    """Its times are also uneven, as a phone writes them: so is what the transport shows."""
    lines = bench.take.read_text().splitlines()
    late = re.sub(r"\.\d+", ".669", lines[-1], count=1)
    bench.take.write_text("\n".join([*lines[:60], *lines[90:-1], late]) + "\n")
    window = bench.window(bench.take)
    asked = answered(30.0)
    trigger(window, "frame_rate")
    _, frames, rate = asked.questions[0]
    assert frames == pytest.approx(180.5, abs=0.01)
    clip = session_of(window).take.clip
    assert len(clip) == 150
    assert frames / clip.rate == pytest.approx(clip.duration), "as the dialog said"
    trigger(window, "undo")
    assert frames / rate == pytest.approx(session_of(window).take.clip.duration)


def test_the_question_says_what_another_rate_changes_and_the_same_rate_changes_nothing(
    bench: Bench, answered: Callable[[float | None], Asked]
) -> None:
    window = bench.editing()
    session, asked = session_of(window), answered(60.0)
    fill = Edit(CONTROL_IDS, Op.FILL, 1.0, 1.4, 0.0)
    reset, raised = replace(fill, op=Op.RESET), Edit(("mouth_opening",), Op.OFFSET, 2, 2.2, 0.1, 3)
    off, stay = replace(raised, enabled=False), " Edits stay on their frames, but"
    for edits, said in {
        (): "",
        (reset, off): "",
        (fill,): f"{stay} fills get other motion.",
        (raised,): f"{stay} may look slightly different.",
        (
            fill,
            raised,
        ): f"{stay} fills get other motion, and other edits may look slightly different.",
    }.items():
        session.put(edits)
        trigger(window, "frame_rate")
        assert asked.questions.pop()[0] == f"What is the frame rate of take.csv?{said}"
        assert session_of(window) is session
        assert not window.workspace.opener.is_reading


def test_a_project_opens_at_the_rate_it_was_saved_with(
    bench: Bench, untimed: Path, answered: Callable[[float | None], Asked]
) -> None:
    asked = answered(25.0)
    window = bench.window()
    drop(window, untimed)
    wait_for(bench, window, untimed)
    bench.answers["save_project"] = project = bench.folder / "scene.faceedit"
    trigger(window, "save")
    assert read_project(project).fps == 25
    other = bench.window(project)
    assert session_of(other).take.clip.rate == 25
    assert len(asked.questions) == 1


def test_a_json_take_opens_where_edits_would_be_loaded(bench: Bench, tmp_path: Path) -> None:
    window = bench.editing()
    take, edits = tmp_path / "export.json", tmp_path / "edits.json"
    take.write_text(recordings.audio2face(recordings.face()), encoding="utf-8")
    edit = {"control": "mouth_opening", "op": "offset", "start": 0.1, "end": 0.2}
    edits.write_text(json.dumps({"version": 1, "edits": [edit | {"falloff": 0, "value": 3}]}))
    drop(window, edits)
    assert len(session_of(window).edits) == 1
    bench.answers["unsaved"] = dialogs.Unsaved.DISCARD
    drop(window, take)
    wait_for(bench, window, take)
    assert session_of(window).take.format == "Audio2Face JSON"


def test_the_export_of_a_json_take_is_suggested_as_json(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    take = tmp_path / "export.json"
    take.write_text(recordings.audio2face(recordings.face()), encoding="utf-8")
    window = bench.window(take)
    suggested: list[Path] = []

    def ask(_: QWidget, suggestion: Path) -> None:
        suggested.append(suggestion)

    monkeypatch.setattr(dialogs, "ask_export", ask)
    trigger(window, "export")
    assert [path.name for path in suggested] == ["export_edited.json"]


def test_file_dialogs_offer_takes_of_every_format() -> None:
    endings = ["csv", "tsv", "json", "jsonl", "txt", "ndjson", "glb", "anim", "usda"]
    assert file_kinds.takes_pattern() == " ".join(f"*.{e} *.{e.upper()}" for e in endings)


def test_a_curve_that_the_take_cannot_answer_takes_no_mouse_and_says_why(
    bench: Bench, tmp_path: Path
) -> None:
    path = tmp_path / "middle.csv"
    row = ",".join(["0.1"] * len(MIDDLE))
    rows = "".join(f"{n / 30:.4f},{row}\n" for n in range(60))
    path.write_text(f"time_s,{','.join(MIDDLE)}\n{rows}")
    window = bench.window(path)
    page = window.editor
    assert page is not None
    eye, mouth = CONTROL_INDEX["left_eyelid"], CONTROL_INDEX["mouth_opening"]
    why = "“Left eye opening” cannot be changed: the take has no eyeBlinkLeft"
    assert not page.curves.plots[eye].isEnabled()
    assert why in page.curves.headers[eye].toolTip()
    assert page.curves.plots[mouth].isEnabled()
    window.banner.dismiss()  # what it says of the face model, which tests do without
    session_of(window).add(Edit(CONTROL_IDS, Op.RESET, 0.5, 0.8, 0.1, 0.0))
    assert not window.banner.isVisible(), "it asks for no curve in particular"
    session_of(window).add(Edit(("left_eyelid", "mouth_opening"), Op.OFFSET, 0.5, 0.8, 0.1, 3.0))
    assert why in window.banner.text.text()
    session_of(window).undo()
    assert not window.banner.isVisible(), "nothing asks for it any more"
    session_of(window).redo()
    assert why in window.banner.text.text()
    window.banner.dismiss()
    session_of(window).undo()
    session_of(window).redo()
    assert not window.banner.isVisible(), "who has dismissed it knows"


def test_another_take_has_its_curves_back(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "jaw.csv"
    path.write_text("time_s,jawOpen\n" + "".join(f"{n / 30:.4f},0.1\n" for n in range(60)))
    window = bench.window(path)
    page = window.editor
    assert page is not None
    assert not all(plot.isEnabled() for plot in page.curves.plots)
    window.workspace.warning.emit("What only jaw.csv lacks")
    drop(window, bench.take)
    wait_for(bench, window, bench.take)
    assert all(plot.isEnabled() for plot in page.curves.plots)
    assert "jaw.csv" not in window.banner.text.text()
    assert "The face model could not be loaded" in window.banner.text.text(), "still true"
