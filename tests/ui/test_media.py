"""Sound and film in the real window: added, dropped, found, placed by their clocks."""

from __future__ import annotations

import pytest
from support.films import make_broadcast_wav, make_film, make_wav
from support.media import FakeOutput, settle, with_media
from support.takes import make_livelink_csv
from support.windows import Bench, drop, editor_of, trigger

from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start.window import MainWindow


def test_a_sound_is_added_from_the_menu_and_removed(
    bench: Bench, devices: list[FakeOutput], monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    editor = editor_of(window)
    assert not editor.sound.isVisible()
    assert not window.actions_["remove_sound"].isEnabled()
    path = make_wav(bench.folder / "voice.wav")
    monkeypatch.setattr(dialogs, "ask_media", lambda *_: path)
    trigger(window, "add_media")
    bench.qtbot.waitUntil(lambda: len(devices) == 1)
    settle(bench, window)
    assert editor.sound.isVisible()
    assert not editor.film.isVisible()
    assert window.status.currentMessage() == "Added voice.wav"
    trigger(window, "remove_sound")
    assert not editor.sound.isVisible()
    assert devices[0].closed
    assert window.media.placement == Placement()


def test_a_film_brings_its_own_sound_and_takes_it_away(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", sound=1.0))
    editor = editor_of(window)
    assert editor.film.isVisible()
    assert editor.sound.isVisible()
    assert window.media.sound is not None
    trigger(window, "remove_film")
    assert window.media.sound is None
    assert not editor.film.isVisible()


def test_a_sound_file_is_preferred_to_the_sound_of_a_film(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    sound = make_wav(bench.folder / "clean.wav")
    window = with_media(bench, sound, make_film(bench.folder / "a.mp4", sound=1.0))
    assert window.media.sound is not None
    assert window.media.sound.path == sound
    window.media.remove_film()
    assert window.media.sound is not None


def test_another_film_brings_another_sound_or_none(bench: Bench, devices: list[FakeOutput]) -> None:
    first = make_film(bench.folder / "a.mp4", sound=1.0)
    second = make_film(bench.folder / "b.mp4", sound=0.5)
    window = with_media(bench, first, second)
    assert window.media.sound is not None
    assert window.media.sound.path == second
    said = window.status.currentMessage()
    assert said.startswith("b.mp4 replaces a.mp4; Undo brings it back; File > Track a film")
    trigger(window, "undo")
    assert window.media.placement.film == MediaFile(first)
    trigger(window, "redo")
    settle(bench, window)
    window.media.add(make_film(bench.folder / "c.mp4"))
    settle(bench, window)
    assert window.media.film is not None
    assert window.media.sound is None


def test_a_film_without_sound(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4"))
    assert editor_of(window).film.isVisible()
    assert not editor_of(window).sound.isVisible()
    assert not devices
    assert not bench.errors


def test_files_are_dropped(bench: Bench, devices: list[FakeOutput]) -> None:
    window = bench.editing()
    drop(editor_of(window).curves, make_wav(bench.folder / "voice.wav"))
    settle(bench, window)
    assert window.media.sound is not None
    assert window.document.session is not None


def test_a_take_and_its_film_are_dropped_at_once(bench: Bench, devices: list[FakeOutput]) -> None:
    window = bench.window()
    film = make_film(bench.folder / "other_name.mp4", sound=0.5)
    drop(window, film, bench.take)
    bench.qtbot.waitUntil(lambda: window.media.film is not None, timeout=10_000)
    settle(bench, window)
    assert window.document.path == bench.take


def test_a_sound_without_a_take_waits_for_one(bench: Bench) -> None:
    window = bench.window()
    drop(window, make_wav(bench.folder / "a.wav"))
    assert window.status.currentMessage() == "Open a take first, then drop a.wav on it"


def test_what_lies_beside_a_take_is_opened_with_it_and_goes_with_it(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    make_film(bench.take.with_suffix(".mov"), sound=0.3)
    window = bench.editing()
    bench.qtbot.waitUntil(lambda: window.media.sound is not None, timeout=10_000)
    settle(bench, window)
    assert window.media.film is not None
    assert window.status.currentMessage() == "Opened take.mov, found beside the take"
    other = make_livelink_csv(bench.folder / "another.csv", seconds=1.0)
    window.commands.file.open(other)
    bench.qtbot.waitUntil(lambda: window.document.path == other)
    assert window.media.film is None
    assert window.media.sound is None


def test_bad_files_are_one_line(bench: Bench, devices: list[FakeOutput]) -> None:
    window = bench.editing()
    bad = bench.folder / "a.mov"
    bad.write_bytes(b"not a film at all" * 10)
    window.media.add(bad)
    settle(bench, window)
    assert len(bench.errors) == 1
    assert "cannot be read as a" in bench.errors[0]
    assert "\n" not in bench.errors[0]


def test_a_bad_file_beside_the_take_does_not_get_in_the_way(bench: Bench) -> None:
    window = bench.editing()
    other = make_livelink_csv(bench.folder / "another.csv", seconds=1.0)
    other.with_suffix(".wav").write_bytes(b"RIFF nonsense")
    window.commands.file.open(other)
    bench.qtbot.waitUntil(lambda: window.document.path == other)
    settle(bench, window)
    assert not bench.errors
    assert window.banner.isVisible()
    assert "another.wav" in window.banner.text.text()


def test_a_film_with_timecode_is_placed_by_it(bench: Bench, devices: list[FakeOutput]) -> None:
    window = bench.editing()
    for timecode, offset in (("{}", 0.0), ("{}:15", 0.5), ("03:00:00:00", 0.0), ("", 0.0)):
        _add_film_with_timecode(bench, window, timecode, offset)
        trigger(window, "remove_film")


def _add_film_with_timecode(bench: Bench, window: MainWindow, timecode: str, offset: float) -> None:
    session = window.document.session
    assert session is not None
    assert session.take.clip.timecodes is not None
    first = session.take.clip.timecodes[0]
    whole_second = first[:8]
    spelled = timecode.format(whole_second if ":15" in timecode else whole_second + ":00")
    film = bench.folder / f"{len(list(bench.folder.glob('*.mov')))}.mov"
    make_film(film, 60, 30, sound=1.0, timecode=spelled)
    window.media.add(film)
    settle(bench, window)
    begun = float(first[9:]) / 60  # seconds within the take's first second
    assert window.media.film is not None
    expected = offset - begun if spelled and "03:" not in spelled else 0.0
    assert window.media.film.offset == pytest.approx(expected, abs=1e-3)
    assert window.media.sound is not None
    assert window.media.sound.offset == window.media.film.offset


@pytest.mark.parametrize(("later", "offset"), [(0.5, 0.5), (-0.25, -0.25), (3600.0, 0.0)])
@pytest.mark.parametrize("beside", [False, True])
def test_a_broadcast_wav_is_placed_by_its_clock(
    bench: Bench, devices: list[FakeOutput], later: float, offset: float, beside: bool
) -> None:
    began = 12 * 3600.0  # the take's first timecode
    path = bench.take.with_suffix(".wav") if beside else bench.folder / "boom.wav"
    make_broadcast_wav(path, began + later)
    window = bench.editing()
    if not beside:
        window.media.add(path)
    bench.qtbot.waitUntil(lambda: window.media.sound is not None, timeout=10_000)
    assert window.media.sound is not None
    assert window.media.sound.offset == pytest.approx(offset, abs=0.02)
    assert window.isWindowModified() is not beside
    if not beside:  # moved by hand, it stays there
        window.media.move_sound(1.0)
        trigger(window, "undo")
        assert window.media.sound.offset == pytest.approx(offset, abs=0.02)
