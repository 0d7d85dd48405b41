"""The picture of the face: when it is drawn, and how the mouse moves the camera."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from support.faces import shipped_rig
from support.renderers import need_opengl
from support.waiting import wait_for_timers
from support.windows import Bench, FakeRenderer, drag, editor_of, session_of, trigger

from faceedit_app import render
from faceedit_app.core.errors import Unavailable
from faceedit_app.ui.face.resolution import DRAGGED, PLAYED, Quality
from faceedit_app.ui.face.viewport import Viewport
from faceedit_app.ui.look.palette import ACCENT, BACKGROUND
from faceedit_app.ui.start.window import MainWindow

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def viewport(bench: Bench) -> Viewport:
    """A viewport on the screen, drawn smoothly and at rest."""
    viewport = Viewport()
    bench.qtbot.addWidget(viewport)
    viewport.resize(300, 360)
    with bench.qtbot.waitExposed(viewport):
        viewport.show()
    viewport.open(shipped_rig())
    bench.qtbot.waitUntil(lambda: bool(bench.renderers[0].calls))
    wait_for_timers(viewport)
    bench.renderers[0].calls.clear()
    return viewport


def weights(jaw: float) -> np.ndarray:
    rig = shipped_rig()
    out = np.zeros(len(rig.channels), np.float32)
    out[rig.channel_index["jawOpen"]] = jaw
    return out


def settle(bench: Bench) -> FakeRenderer:
    """Let what is due be painted, without waiting for the smooth picture."""
    QApplication.processEvents()
    return bench.renderers[0]


def test_many_changes_cost_one_picture(bench: Bench, viewport: Viewport) -> None:
    for jaw in np.linspace(0, 1, 20):
        viewport.show_weights(weights(float(jaw)))
    assert len(settle(bench).calls) == 1


def test_nothing_is_drawn_while_nothing_changes(bench: Bench, viewport: Viewport) -> None:
    viewport.update()
    assert len(settle(bench).calls) == 0


def test_rough_while_it_changes_and_smooth_when_idle(bench: Bench, viewport: Viewport) -> None:
    viewport.quality.forget()  # how fast smooth ones would be
    viewport.show_weights(weights(0.5))
    assert [smooth for *_, smooth in settle(bench).calls] == [False]
    wait_for_timers(viewport)
    assert [smooth for *_, smooth in bench.renderers[0].calls] == [False, True]


def test_where_smooth_pictures_are_fast_there_are_no_others(
    bench: Bench, viewport: Viewport
) -> None:
    """The edges do not flicker, and at rest nothing is drawn again."""
    viewport.quality.play(1e-3)  # pictures a second
    for jaw in (0.3, 0.6, 0.9):
        viewport.show_weights(weights(jaw))
        settle(bench)
    wait_for_timers(viewport)
    assert [smooth for *_, smooth in bench.renderers[0].calls] == [True, True, True]


def test_playback_tries_smooth_pictures_and_goes_on_with_rough_ones_if_they_are_slow() -> None:
    quality, frame = Quality(), PLAYED / 30.0
    assert not quality.is_smooth, "a drag does not try"
    quality.play(60.0)
    assert not quality.is_smooth, "there is no time to try"
    quality.play(30.0)
    for took, after in ((5.0, True), (0.9, True), (1.1, True), (1.1, True), (1.1, False)):
        quality.drew(took * frame, smooth=True)
        assert quality.is_smooth is after, took
    quality.drew(0.1 * frame, smooth=False)
    assert not quality.is_smooth
    quality.play(30.0)
    assert quality.is_smooth
    for took in (0.5 * DRAGGED, 2.0 * DRAGGED, 2.0 * DRAGGED):
        quality.drew(took, smooth=True)
    quality.rest()
    assert quality.is_smooth, "fast enough for a drag too"
    quality.forget()
    assert not quality.is_smooth


def test_rough_pictures_of_playback_are_doubled_unless_that_is_slow() -> None:
    quality, frame = Quality(), PLAYED / 30.0
    assert not quality.is_doubled, "a drag has no time for it"
    quality.play(60.0)
    assert not quality.is_doubled
    quality.play(30.0)
    for took, after in ((5.0, True), (0.9, True), (1.1, True), (1.1, True), (1.1, False)):
        quality.drew(took * frame, smooth=False, doubled=True)
        assert quality.is_doubled is after, took
    quality.play(30.0)
    assert quality.is_doubled
    quality.rest()
    assert not quality.is_doubled


def test_the_viewport_knows_when_it_is_played(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    viewport, playback = editor_of(window).face.viewport, window.workspace.playback
    quality, said = viewport.quality, list[str]()
    monkeypatch.setattr(quality, "play", lambda rate: said.append(f"play at {rate:.0f}"))
    monkeypatch.setattr(quality, "rest", lambda: said.append("rest"))
    monkeypatch.setattr(viewport, "hurry", lambda: said.append("draw now"))
    playback.play()
    window.timeline.go_to_frame(7)  # and so the face is drawn while the curves are painted
    playback.pause()
    window.timeline.go_to_frame(8)
    assert said == [f"play at {session_of(window).take.clip.rate:.0f}", "draw now", "rest"]


def test_what_the_next_picture_needs_is_done_once_nobody_waits(
    bench: Bench, viewport: Viewport
) -> None:
    wait_for_timers(viewport)
    renderer = settle(bench)
    for jaw in (0.2, 0.4, 0.6):
        known = renderer.prepared
        viewport.show_weights(weights(jaw))
        viewport.hurry()  # a picture that is being drawn is left alone
        viewport.grab()
        assert renderer.prepared == known
        bench.qtbot.waitUntil(partial(lambda known: renderer.prepared > known, known))


def test_the_picture_has_the_screens_pixels(bench: Bench, viewport: Viewport) -> None:
    wait_for_timers(viewport)
    viewport.resize(310, 370)
    settle(bench)
    wait_for_timers(viewport)
    ratio = viewport.devicePixelRatioF()
    assert bench.renderers[0].calls[-1][0] == (round(310 * ratio), round(370 * ratio))


def test_a_hidden_viewport_draws_nothing(bench: Bench, viewport: Viewport) -> None:
    viewport.hide()
    settle(bench).calls.clear()
    viewport.show_weights(weights(0.5))
    wait_for_timers(viewport)
    assert bench.renderers[0].calls == []


def test_left_drag_turns_around_the_face(bench: Bench, viewport: Viewport) -> None:
    home = viewport.camera
    drag(viewport, QPoint(40, 0), Qt.MouseButton.LeftButton)
    assert viewport.camera.yaw < home.yaw
    assert viewport.camera.target == home.target
    assert len(settle(bench).calls) == 1


@pytest.mark.parametrize("button", [Qt.MouseButton.MiddleButton, Qt.MouseButton.RightButton])
def test_other_drags_move_the_view(viewport: Viewport, button: Qt.MouseButton) -> None:
    home = viewport.camera
    drag(viewport, QPoint(40, 30), button)
    assert viewport.camera.yaw == home.yaw
    # The face follows the pointer: the camera goes the other way.
    assert viewport.camera.target[0] < home.target[0]
    assert viewport.camera.target[1] > home.target[1]


def test_the_wheel_zooms_and_a_double_click_resets(viewport: Viewport) -> None:
    home = viewport.camera
    at = QPointF(viewport.rect().center())
    wheel = QWheelEvent(
        at,
        viewport.mapToGlobal(at),
        QPoint(),
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(viewport, wheel)
    assert viewport.camera.distance < home.distance
    QTest.mouseDClick(viewport, Qt.MouseButton.LeftButton)
    assert viewport.camera == home


def test_a_chosen_camera_survives_a_resize(viewport: Viewport) -> None:
    drag(viewport, QPoint(40, 0), Qt.MouseButton.LeftButton)
    chosen = viewport.camera
    viewport.resize(500, 300)
    QApplication.processEvents()
    assert viewport.camera == chosen


def test_a_slow_computer_gets_coarser_pictures_while_things_move(
    bench: Bench, viewport: Viewport
) -> None:
    viewport.quality.forget()
    viewport.quality.drew(1.0, smooth=False)
    viewport.show_weights(weights(0.5))
    rough = settle(bench).calls[-1][0]
    wait_for_timers(viewport)
    smooth = bench.renderers[0].calls[-1][0]
    assert rough[0] < smooth[0]


@pytest.mark.parametrize(
    "error",
    [
        Unavailable("The face cannot be drawn: the context was lost; restart"),
        OSError("the context was lost"),
    ],
)
def test_losing_opengl_while_drawing_is_said(
    bench: Bench, viewport: Viewport, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(bench.renderers[0], "draw", fail)
    viewport.show_weights(weights(0.5))
    settle(bench)
    assert viewport.message.startswith("The face cannot be drawn: the context was lost")
    assert not viewport.can_draw
    viewport.grab()


def test_closing_frees_the_renderer(bench: Bench, viewport: Viewport) -> None:
    viewport.close()
    assert not bench.renderers[0].open


def test_the_real_renderer_shows_a_face(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    from faceedit_app.render.renderer import open_renderer

    need_opengl()
    monkeypatch.setattr(render, "open_renderer", open_renderer)
    viewport = Viewport()
    bench.qtbot.addWidget(viewport)
    viewport.resize(240, 280)
    viewport.open(shipped_rig())
    assert viewport.can_draw, viewport.message
    with bench.qtbot.waitExposed(viewport):
        viewport.show()
    image = viewport.grab().toImage()
    middle, corner = image.pixelColor(120, 140), image.pixelColor(4, 4)
    assert middle.red() > corner.red() + 40, "skin is lighter than the backdrop"
    assert middle.red() > middle.blue()
    viewport.close()


# --- by keys -------------------------------------------------------------------------------------


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    """A window on a take, with the keyboard at the face."""
    window = bench.editing()
    window.activateWindow()
    bench.qtbot.waitActive(window)
    QTest.keyClick(window, Qt.Key.Key_9)
    assert face_of(window).hasFocus()
    return window


def face_of(window: MainWindow) -> Viewport:
    assert window.editor is not None
    return window.editor.face.viewport


NONE, SHIFT = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier


def test_arrows_turn_the_face_as_a_drag_would_and_the_playhead_stays(window: MainWindow) -> None:
    face = face_of(window)
    for key, way in (
        (Qt.Key.Key_Right, QPoint(20, 0)),
        (Qt.Key.Key_Left, QPoint(-20, 0)),
        (Qt.Key.Key_Up, QPoint(0, -20)),
        (Qt.Key.Key_Down, QPoint(0, 20)),
    ):
        cameras = []
        for by_key in (True, False):
            face.reset_camera()
            before = face.camera
            if by_key:
                QTest.keyClick(face, key)
            else:
                drag(face, way, LEFT)
            cameras.append((face.camera.yaw - before.yaw, face.camera.pitch - before.pitch))
        assert np.abs(cameras).max() > 0.05
        np.testing.assert_array_equal(np.sign(cameras[0]), np.sign(cameras[1]))
    assert window.timeline.frame == 0


def test_shift_and_arrows_move_the_view(window: MainWindow) -> None:
    face = face_of(window)
    before = face.camera
    QTest.keyClick(face, Qt.Key.Key_Right, SHIFT)
    QTest.keyClick(face, Qt.Key.Key_Up, SHIFT)
    assert face.camera.target[0] < before.target[0], "the face goes right"
    assert face.camera.target[1] < before.target[1], "and up"
    assert face.camera.yaw == before.yaw
    assert window.timeline.frame == 0


@pytest.mark.parametrize("closer", [Qt.Key.Key_Plus, Qt.Key.Key_Equal])
def test_plus_and_minus_zoom_the_face_and_not_the_curves(
    window: MainWindow, closer: Qt.Key
) -> None:
    face, view = face_of(window), window.timeline.view
    before = face.camera.distance
    QTest.keyClick(face, closer, SHIFT if closer == Qt.Key.Key_Plus else NONE)
    assert face.camera.distance < before
    QTest.keyClick(face, Qt.Key.Key_Minus)
    assert face.camera.distance == pytest.approx(before)
    assert window.timeline.view == view


def test_other_keys_are_still_the_windows(bench: Bench, window: MainWindow) -> None:
    face = face_of(window)
    QTest.keyClick(face, Qt.Key.Key_Right)
    QTest.keyClick(face, Qt.Key.Key_0)
    assert face.camera.yaw == 0
    QTest.keyClick(face, Qt.Key.Key_End)
    assert window.timeline.frame == window.timeline.frames - 1
    QTest.keyClick(face, Qt.Key.Key_Home)
    QTest.keyClick(face, Qt.Key.Key_Space)
    assert window.playback.playing
    QTest.keyClick(face, Qt.Key.Key_Space)
    assert not window.playback.playing
    QTest.keyClick(face, Qt.Key.Key_Home)
    QTest.keyClick(face, Qt.Key.Key_Escape)
    assert not face.hasFocus()
    QTest.keyClick(window.focusWidget(), Qt.Key.Key_Right)
    assert window.timeline.frame == 1


def test_the_focus_is_seen_and_the_mouse_does_not_take_it(bench: Bench, window: MainWindow) -> None:
    face = face_of(window)
    edges = (0, face.height() // 2), (face.width() // 2, face.height() - 1)
    assert all(face.grab().toImage().pixelColor(*at) == QColor(ACCENT) for at in edges)
    trigger(window, "show_both")
    assert face.hasFocus()
    picture, beside = face.grab().toImage(), QPoint(face.width() // 4, face.height() // 2)
    assert picture.pixelColor(beside) != QColor(BACKGROUND), "the frame hides the faces"
    QTest.keyClick(face, Qt.Key.Key_Escape)
    assert not any(face.grab().toImage().pixelColor(*at) == QColor(ACCENT) for at in edges)
    drag(face, QPoint(30, 0), LEFT)
    assert not face.hasFocus()
