"""Where sound and film are placed: kept in projects, undone and redone, back after a crash."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from support.curves import let_go, move_with, surface
from support.faces import random_engine
from support.films import make_film, make_wav
from support.media import FakeOutput, drag, mouse, settle, with_media
from support.windows import Bench, drag_curve, editor_of, press_key, session_of, trigger

from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start.window import MainWindow

# --- kept in projects ------------------------------------------------------------------------


def test_a_placement_is_shown_again(bench: Bench, devices: list[FakeOutput]) -> None:
    film = make_film(bench.folder / "a.mp4", sound=0.5)
    window = with_media(bench, film, make_wav(bench.folder / "voice.wav"))
    window.media.move_film(0.25)
    window.media.move_sound(-0.125)
    placement = window.media.placement
    assert placement == Placement(
        MediaFile(bench.folder / "voice.wav", -0.125),
        MediaFile(film, 0.25),
    )
    window.media.clear()
    window.media.show(placement)
    assert window.media.placement == placement  # while it is still being read, too
    settle(bench, window)
    assert window.media.placement == placement
    assert window.media.film is not None


def test_a_placement_whose_files_are_gone_is_kept_for_when_they_are_back(bench: Bench) -> None:
    window = bench.editing()
    gone = Placement(MediaFile(bench.folder / "gone.wav", 1.0))
    window.media.show(gone)
    assert "gone.wav" in window.banner.text.text()
    assert window.media.placement == gone
    window.media.show(Placement())
    settle(bench, window)
    assert window.media.placement == Placement()
    assert not bench.errors


# --- undone and redone -----------------------------------------------------------------------


def step_back_and_forward(bench: Bench, window: MainWindow, *places: Placement) -> None:
    """Undo through all places, the last first, and redo through them again."""
    session = window.document.session
    assert session is not None
    assert window.media.placement == places[-1]
    for way, expected in (("undo", places[-2::-1]), ("redo", places[1:])):
        for placed in expected:
            trigger(window, way)
            assert window.media.placement == placed
            settle(bench, window)
            assert window.media.placement == placed
            for kind in ("sound", "film"):
                there, wanted = getattr(window.media, kind), getattr(placed, kind)
                assert (there and there.path) == (wanted and wanted.path)
    assert not bench.errors


def test_adding_moving_and_removing_are_one_step_each(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = bench.editing()
    assert not window.isWindowModified()
    assert not window.actions_["undo"].isEnabled()
    film = make_film(bench.folder / "a.mp4", sound=1.0)
    window.media.add(film)
    settle(bench, window)
    assert window.isWindowModified()
    added = Placement(MediaFile(film), MediaFile(film))
    assert window.media.placement == added
    strip = editor_of(window).sound
    press_key(strip.offset, Qt.Key.Key_Up, 5)
    moved = Placement(MediaFile(film, 0.05), MediaFile(film, 0.05))
    assert window.media.placement == moved
    trigger(window, "undo")
    assert window.media.placement == added, "five presses are one step"
    trigger(window, "redo")
    drag(strip.waveform, 100, 160, Qt.KeyboardModifier.AltModifier)
    dragged = window.media.placement
    assert dragged != moved
    trigger(window, "remove_film")
    step_back_and_forward(bench, window, Placement(), added, moved, dragged, Placement())
    assert not window.actions_["redo"].isEnabled()


def test_a_dropped_drag_of_the_sound_is_no_step(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    session = window.document.session
    assert session is not None
    before, wave = session.state, editor_of(window).sound.waveform
    mouse(wave, QEvent.Type.MouseButtonPress, 50, Qt.KeyboardModifier.AltModifier)
    mouse(wave, QEvent.Type.MouseMove, 150, Qt.KeyboardModifier.AltModifier)
    session.use_engine(random_engine(3))  # the networks are loaded meanwhile: the drag goes on
    assert window.media.placement.sound != MediaFile(bench.folder / "voice.wav")
    QTest.keyClick(wave, Qt.Key.Key_Escape)
    assert session.state == before
    assert window.media.placement == before.media


def test_what_lies_beside_the_take_is_no_step_until_it_is_moved(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    make_wav(bench.take.with_suffix(".wav"))
    window = bench.editing()
    settle(bench, window)
    found = Placement(MediaFile(bench.take.with_suffix(".wav")))
    assert window.media.placement == found
    assert not window.isWindowModified()
    assert not window.actions_["undo"].isEnabled()
    editor_of(window).sound.offset.setValue(0.5)
    QTest.keyClick(editor_of(window).sound.offset, Qt.Key.Key_Return)
    assert window.isWindowModified()
    step_back_and_forward(bench, window, found, replace_sound(found, 0.5))
    trigger(window, "undo")
    assert not window.isWindowModified()


def replace_sound(placement: Placement, offset: float) -> Placement:
    assert placement.sound is not None
    return Placement(MediaFile(placement.sound.path, offset), placement.film)


def test_steps_of_sound_and_of_curves_are_undone_in_their_order(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    session = window.document.session
    assert session is not None
    drag_curve(window, 0, 1.0, 20)
    editor_of(window).sound.offset.setValue(0.2)
    drag_curve(window, 0, 2.0, 20)  # while the number may still be turned
    assert len(session.edits) == 2
    places = []
    while session.can_undo:
        trigger(window, "undo")
        places.append((len(session.edits), window.media.placement.sound))
    voice = bench.folder / "voice.wav"
    assert places[-1] == (0, None)
    assert set(places[:-1]) >= {(1, MediaFile(voice)), (0, MediaFile(voice))}
    while session.can_redo:
        trigger(window, "redo")
    assert (len(session.edits), window.media.placement.sound) == (2, MediaFile(voice, 0.2))


def test_a_sound_that_arrives_during_a_drag_leaves_the_drag_alone(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = bench.editing()
    session, editor = window.document.session, editor_of(window)
    assert session is not None
    plot = editor.curves.plots[0]
    start = plot.rect().center()
    QTest.mousePress(surface(plot), Qt.MouseButton.LeftButton, pos=start)
    move_with(plot, start - QPoint(0, 30))
    bench.qtbot.waitUntil(lambda: session.is_previewing)
    window.media.add(make_wav(bench.folder / "voice.wav"))
    settle(bench, window)
    assert window.media.sound is not None
    assert session.is_previewing
    assert not session.can_undo
    let_go(plot, start - QPoint(0, 30))
    assert len(session.edits) == 1
    assert session.state.media == window.media.placement
    trigger(window, "undo")
    assert (len(session.edits), window.media.sound) == (1, None)


def test_an_export_keeps_no_sound_and_a_project_does(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    assert window.isWindowModified()
    editor_of(window).sound.offset.setValue(0.75)
    bench.answers["save_project"] = bench.folder / "p.faceedit"
    trigger(window, "save")
    assert not window.isWindowModified()
    again = bench.window(bench.folder / "p.faceedit")
    settle(bench, again)
    assert again.media.placement == Placement(MediaFile(bench.folder / "voice.wav", 0.75))
    assert not again.isWindowModified()
    assert not again.actions_["undo"].isEnabled()
    editor_of(again).sound.offset.setValue(0.5)
    trigger(again, "undo")
    assert again.media.placement == Placement(MediaFile(bench.folder / "voice.wav", 0.75))


def test_after_a_crash_the_sound_is_back_where_it_was(
    bench: Bench, devices: list[FakeOutput], monkeypatch: pytest.MonkeyPatch
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    editor_of(window).sound.offset.setValue(0.3)
    moved = Placement(MediaFile(bench.folder / "voice.wav", 0.3))
    bench.qtbot.waitUntil(lambda: session_of(window).state.media == moved)
    journal = next((bench.folder / "journals").glob("*.jsonl"))
    content = journal.read_bytes()
    window.leave()
    journal.with_name("crashed.jsonl").write_bytes(content)
    monkeypatch.setattr(dialogs, "ask_recover", lambda *_: dialogs.Recover.RECOVER)
    again = bench.window(bench.take)
    settle(bench, again)
    assert again.media.placement == Placement(MediaFile(bench.folder / "voice.wav", 0.3))
    assert again.media.sound is not None
    assert again.isWindowModified()
    message = "Recovered your work on take.csv; a single Undo takes it all back"
    assert again.status.currentMessage() == message
    trigger(again, "undo")
    assert again.media.placement == Placement()
    assert not again.actions_["undo"].isEnabled()


def test_a_late_answer_for_an_earlier_take_is_dropped(bench: Bench) -> None:
    window = bench.editing()
    window.media.add(make_wav(bench.folder / "voice.wav"))
    window.media.clear()
    settle(bench, window)
    assert window.media.sound is None
