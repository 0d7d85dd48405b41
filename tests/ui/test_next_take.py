"""What happens when another take is opened: nothing left on is carried over, nothing old stays."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtTest import QTest
from support.takes import make_livelink_csv
from support.windows import Bench, open_path, session_of, trigger

from faceedit_app.core.rig import Rig
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.media.words_dialog import WordsDialog
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state import loading
from faceedit_app.ui.state.playback import SPEEDS
from faceedit_app.ui.state.timeline import DEFAULT_FALLOFF


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


@pytest.fixture
def other(bench: Bench) -> Path:
    folder = bench.folder / "elsewhere"
    folder.mkdir()
    return make_livelink_csv(folder / "other.csv", seconds=2.0)


def open_take(bench: Bench, window: MainWindow, path: Path) -> None:
    window.commands.file.open(path)
    bench.qtbot.waitUntil(lambda: window.document.path == path)


def leave_settings_on(window: MainWindow) -> None:
    assert window.editor is not None
    trigger(window, "link")
    trigger(window, "loop")
    window.editor.transport.speed.setCurrentIndex(SPEEDS.index(0.5))
    window.timeline.set_falloffs(0.0, 0.0)


def settings(window: MainWindow) -> tuple[bool, bool, float, tuple[float, float]]:
    line, playback = window.timeline, window.playback
    return window.tools.linked, playback.loop, playback.speed, (line.falloff, line.falloff_out)


def test_what_a_take_left_on_is_not_carried_into_the_next(
    bench: Bench, window: MainWindow, other: Path
) -> None:
    assert window.editor is not None
    leave_settings_on(window)
    assert settings(window) == (False, True, 0.5, (0.0, 0.0))
    open_take(bench, window, other)
    usual = (DEFAULT_FALLOFF, DEFAULT_FALLOFF)
    assert settings(window) == (True, False, 1.0, usual)
    assert window.editor.transport.speed.currentText() == "1×"
    assert window.actions_["link"].isChecked()
    assert not window.actions_["loop"].isChecked()


def test_a_chosen_edit_is_not_carried_into_the_next(
    bench: Bench, window: MainWindow, other: Path
) -> None:
    window.timeline.set_falloffs(0.3, 0.4)
    trigger(window, "fix_smile")
    assert window.timeline.shows_edit
    window.document.session = None  # its edits need not be saved
    open_take(bench, window, other)
    assert window.timeline.selection is None
    assert not window.timeline.shows_edit
    assert window.timeline.falloff == DEFAULT_FALLOFF


def test_the_same_take_at_another_rate_keeps_its_settings(
    bench: Bench, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    leave_settings_on(window)
    before = session_of(window)
    monkeypatch.setattr(dialogs, "ask_rate", lambda *_: 30.0)
    trigger(window, "frame_rate")
    bench.qtbot.waitUntil(lambda: window.document.session is not before)
    assert settings(window)[:3] == (False, True, 0.5)


def test_dialogs_open_beside_the_take(
    bench: Bench, window: MainWindow, other: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Path] = []
    for name in ("open", "load_edits", "media"):
        monkeypatch.setattr(dialogs, f"ask_{name}", lambda _w, folder: asked.append(folder))
    open_take(bench, window, other)
    for command in ("open", "load_edits", "add_media"):
        trigger(window, command)
    assert asked == [other.parent] * 3


@pytest.mark.parametrize("is_damaged", [False, True])
def test_a_take_that_loads_slowly_clears_the_old_one_and_shows_that_it_loads(
    bench: Bench,
    window: MainWindow,
    other: Path,
    is_damaged: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert window.editor is not None
    may_go_on, read = threading.Event(), loading.open_session

    def slowly(path: Path, rig: Rig, fps: float | None = None) -> EditSession:
        may_go_on.wait(30)
        return read(path, rig, fps)

    monkeypatch.setattr(loading, "open_session", slowly)
    page, start, status = window.editor, window.start_page, window.status
    old, said = open_path(window), status.facts.text()
    if is_damaged:
        other.write_text("nothing\n")
    window.banner.offer("The rest is not neutral", "Make it neutral", lambda: None)
    window.commands.file.open(other)
    try:
        assert page.isVisible(), "a quick one changes nothing"
        bench.qtbot.waitUntil(start.isVisible)
        assert not page.isVisible()
        assert window.banner.isHidden(), "it is about the old take"
        assert other.name in start.loading.text()
        status.clearMessage()  # as one that passes does
        assert not status.facts.isVisible()
    finally:
        may_go_on.set()
    bench.qtbot.waitUntil(page.isVisible)
    assert open_path(window) == (old if is_damaged else other)
    assert not status.facts.isHidden()
    assert (status.facts.text() == said) is is_damaged
    assert status.gaps.isHidden(), "it has none to show again"


def test_the_title_changes_with_curves_and_face(
    bench: Bench, window: MainWindow, other: Path
) -> None:
    editor, seen = window.editor, list[str]()
    assert editor is not None
    page = editor

    class Watch(QObject):
        def eventFilter(self, watched: QObject, event: QEvent) -> bool:
            if event.type() == QEvent.Type.Paint and open_path(window) == other:
                seen.append("face" if watched is page.face.viewport else "curves")
            return False

    watch = Watch(window)
    shown = (page.face.viewport, page.curves.plots[0].viewport())
    for widget in shown:
        widget.installEventFilter(watch)
    window.windowTitleChanged.connect(seen.append)
    window.commands.file.open(other)
    bench.qtbot.waitUntil(lambda: window.windowTitle().startswith(other.name))
    before = seen[: seen.index(window.windowTitle())]
    assert {"face", "curves"} <= {*before}
    for widget in shown:
        widget.removeEventFilter(watch)
    window.windowTitleChanged.disconnect(seen.append)


def test_if_it_cannot_be_opened_the_old_one_is_back(
    bench: Bench, window: MainWindow, tmp_path: Path
) -> None:
    assert window.editor is not None
    old, bad = open_path(window), tmp_path / "bad.csv"
    bad.write_text("nothing\n")
    window.commands.file.open(bad)
    bench.qtbot.waitUntil(lambda: bool(bench.errors))
    assert window.editor.isVisible()
    assert open_path(window) == old


def test_words_that_were_typed_and_not_timed_stay_with_their_take(
    bench: Bench, window: MainWindow, other: Path
) -> None:
    def asked() -> WordsDialog:
        trigger(window, "words")
        return window.findChildren(WordsDialog)[-1]

    dialog = asked()
    dialog.text.setPlainText("hello")
    QTest.keyClick(dialog.text, Qt.Key.Key_Escape)
    open_take(bench, window, other)
    dialog = asked()
    assert dialog.text.toPlainText() == ""
    dialog.reject()
    open_take(bench, window, bench.take)
    dialog = asked()
    assert dialog.text.toPlainText() == "hello"
    assert "no times" in dialog.message.text()
    dialog.text.clear()
    dialog.reject()
    assert not window.workspace.drafts
