"""Shorter and longer copies of a take, written and opened in the window."""

from __future__ import annotations

from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot
from support.films import make_film, make_wav
from support.speech import said
from support.windows import Bench, session_of, trigger

from faceedit_app.formats.opening import open_take
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.edits.splice_dialog import SpliceDialog
from faceedit_app.ui.start.window import MainWindow


def dialog_of(window: MainWindow) -> SpliceDialog:
    (dialog,) = (d for d in window.findChildren(SpliceDialog) if d.isVisible())
    return dialog


def open_offered(window: MainWindow, qtbot: QtBot, path: Path) -> None:
    qtbot.waitUntil(lambda: window.banner.button.text() == "Open it", timeout=15_000)
    assert path.name in window.banner.text.text()
    window.banner.button.click()
    qtbot.waitUntil(lambda: session_of(window).take.path == path, timeout=15_000)


def test_the_selection_is_cut_out_into_a_new_take(bench: Bench, qtbot: QtBot) -> None:
    make_wav(bench.take.with_suffix(".wav"))
    window = bench.editing()
    qtbot.waitUntil(lambda: window.workspace.media.sound is not None, timeout=15_000)
    before = bench.take.read_bytes()
    session = session_of(window)
    session.say(said(("map", "M AE P"), ("fish", "F IH SH"), start=2.0))
    frames = len(session.take.clip)
    assert not window.actions_["cut_shorter"].isEnabled()
    window.timeline.select((0.5, 1.5))
    path = bench.answers["export"] = bench.folder / "short.csv"
    trigger(window, "cut_shorter")
    dialog = dialog_of(window)
    assert not dialog.number.isVisible()
    assert not dialog.film.isVisible()
    dialog.write.click()
    bench.answers["unsaved"] = dialogs.Unsaved.DISCARD
    open_offered(window, qtbot, path)
    again = session_of(window)
    assert len(again.take.clip) == frames - 60
    assert again.words is not None
    assert again.words.words[0].start == pytest.approx(1.0, abs=1e-3)
    assert path.with_suffix(".wav").is_file()
    assert bench.take.read_bytes() == before


def test_time_is_inserted_at_the_playhead_as_the_take_is_shown(bench: Bench, qtbot: QtBot) -> None:
    window = bench.editing()
    make_film(bench.folder / "film.mp4")
    window.workspace.media.add(bench.folder / "film.mp4")
    qtbot.waitUntil(lambda: window.workspace.media.film is not None, timeout=15_000)
    window.timeline.go_to_time(1.0)
    trigger(window, "unit_frames")
    path = bench.answers["export"] = bench.folder / "long.csv"
    trigger(window, "insert_longer")
    dialog = dialog_of(window)
    assert dialog.number.text() == "30.0 frames"
    dialog.number.setValue(45.0)
    dialog.film.setChecked(False)
    dialog.write.click()
    bench.answers["unsaved"] = dialogs.Unsaved.DISCARD
    open_offered(window, qtbot, path)
    assert window.timeline.selection == pytest.approx((1.0, 1.75))
    assert open_take(path).clip.duration == pytest.approx(3.75, abs=0.01)
    assert sorted(p.name for p in bench.folder.glob("long.*")) == ["long.csv"]


def test_what_cannot_be_written_is_said_and_cancel_writes_nothing(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    trigger(window, "insert_longer")
    dialog_of(window).reject()
    monkeypatch.setattr(dialogs, "ask_export", lambda *_: bench.take)  # whatever is said
    trigger(window, "insert_longer")
    dialog_of(window).write.click()
    assert "is the open take" in bench.errors[0]
    assert session_of(window).take.path == bench.take


def test_the_name_that_is_suggested_is_free(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    window = bench.editing()
    suggested: list[Path] = []
    monkeypatch.setattr(dialogs, "ask_export", lambda _parent, path: suggested.append(path))
    for taken in (None, f"{bench.take.stem}_shorter.csv", f"{bench.take.stem}_shorter_2.wav"):
        if taken is not None:
            (bench.take.parent / taken).touch()
        window.timeline.select((0.5, 1.5))
        trigger(window, "cut_shorter")
        dialog_of(window).write.click()
    stem = f"{bench.take.stem}_shorter"
    assert [path.name for path in suggested] == [f"{stem}.csv", f"{stem}_2.csv", f"{stem}_3.csv"]
