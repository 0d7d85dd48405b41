"""The edited face, tinted where and how far it is from the tracked one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QToolButton
from support.faces import shipped_rig
from support.renderers import need_opengl, opened_renderer
from support.rigs import ball
from support.takes import make_livelink_csv
from support.windows import Bench, add_edit, drag_curve, open_path, trigger

from faceedit_app import render
from faceedit_app.core.rig import Rig
from faceedit_app.render import FaceRenderer, default_camera, open_renderer
from faceedit_app.render.difference import FULL, Tinter, ramp, tint_of
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.face.pane import FacePane
from faceedit_app.ui.face.viewport import Viewport
from faceedit_app.ui.look.palette import ACCENT, ORANGE
from faceedit_app.ui.start.window import MainWindow

SIZE = 96
# Linear RGB as seen without one kind of cone: Machado, Oliveira and Fernandes (2009).
EYES = {
    "all cones": np.eye(3),
    "no red": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "no green": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "no blue": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def seen(colors: np.ndarray, eyes: str) -> np.ndarray:
    """(..., 3) sRGB in 0..1 -> (..., 3) CIELAB, as some eyes see it."""
    linear = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    linear = np.clip(linear @ EYES[eyes].T, 0.0, 1.0)
    x, y, z = np.moveaxis(linear @ XYZ.T / [0.9505, 1.0, 1.089], -1, 0)
    x, y, z = (np.where(v > 0.008856, np.cbrt(v), 7.787 * v + 16 / 116) for v in (x, y, z))
    return np.stack((116 * y - 16, 500 * (x - y), 200 * (y - z)), axis=-1)


def srgb(name: str) -> np.ndarray:
    return np.array([int(name[at : at + 2], 16) / 255 for at in (1, 3, 5)])


# --- the colours ---------------------------------------------------------------------------------


def test_the_tint_tells_millimetres() -> None:
    others = np.array([[0, 0, 0], [0.1, 0.2, 0.3], [0.1, 0, 0], [0, 0, 0.05]], np.float32)
    moved = np.array([[0, 0, 0], [0, 0.6, 0.8], [1, 0, 0], [0, 3, 4]], np.float32)
    tint = tint_of(others + moved * np.float32(FULL / 2000), others)
    np.testing.assert_allclose(tint, [0.0, 0.5, 0.5, 1.0], atol=1e-4)
    assert tint[0] == 0.0
    assert tint.dtype == np.float32


def test_without_a_tint_colours_are_the_characters() -> None:
    colors = shipped_rig().colors
    tinter, none = Tinter(colors), np.zeros(len(colors), np.float32)
    np.testing.assert_allclose(tinter(none), colors, atol=1e-6)
    full = tinter(none + 1)
    np.testing.assert_allclose(full[:, :3], np.broadcast_to(full[0, :3], (len(full), 3)), atol=1e-6)
    np.testing.assert_allclose(full[:, 3], colors[:, 3], atol=1e-6)


@pytest.mark.parametrize("eyes", EYES)
def test_everybody_can_read_the_ramp(eyes: str) -> None:
    steps = seen(ramp(shipped_rig(), 9), eyes)
    assert (np.diff(steps[:, 0]) < -1).all(), "darker all the way"
    apart = np.linalg.norm(np.diff(steps, axis=0), axis=1)
    assert apart.min() > 4
    assert apart.max() < 2 * apart.min(), "equal steps look about equal"
    # What the window means by blue and orange is not on the face: 40 is far more than a nuance.
    for other in (ramp(shipped_rig(), 1)[0], srgb(ACCENT), srgb(ORANGE)):
        assert np.linalg.norm(steps[-1] - seen(other, eyes)) > 39


# --- the picture ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def rig() -> Rig:
    return ball()


@pytest.fixture(scope="module")
def renderer(rig: Rig) -> Iterator[FaceRenderer]:
    yield from opened_renderer(rig, SIZE)


@pytest.mark.parametrize("smooth", [True, False])
def test_only_what_moved_is_tinted_in_quick_and_fine_pictures(
    renderer: FaceRenderer, rig: Rig, smooth: bool
) -> None:
    camera, opened = default_camera(rig), rig.vertices(np.array([1.0], np.float32))
    plain = renderer.draw(opened, camera, smooth).copy().astype(int)
    tint = tint_of(opened, rig.neutral)
    tinted = renderer.draw(opened, camera, smooth, tint).copy().astype(int)
    differs = np.abs(tinted - plain).max(axis=2) > 4
    assert differs[SIZE * 5 // 8, SIZE // 2]
    assert not differs[: SIZE // 4].any()
    blue, _, red = tinted[differs][:, :3].T
    assert (blue > red - 40).mean() > 0.9
    is_red = plain[differs][:, 2] > plain[differs][:, 0]
    assert is_red.mean() > 0.9, "BGRA: skin is red, but for edges, which are partly background"


@pytest.mark.parametrize("smooth", [True, False])
def test_nothing_of_a_tint_stays(renderer: FaceRenderer, rig: Rig, smooth: bool) -> None:
    camera, full = default_camera(rig), np.ones(len(rig.neutral), np.float32)
    plain = renderer.draw(rig.neutral, camera, smooth).copy()
    tinted = renderer.draw(rig.neutral, camera, smooth, full).copy()
    none = renderer.draw(rig.neutral, camera, smooth, 0 * full).copy()
    assert np.abs(tinted.astype(int) - plain).max() > 60
    assert np.abs(none.astype(int) - plain).max() <= 1
    np.testing.assert_array_equal(renderer.draw(rig.neutral, camera, smooth), plain)


def test_a_tint_draws_no_more_than_a_new_view_and_none_costs_nothing(
    renderer: FaceRenderer, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    from faceedit_app.render.model import Stream
    from faceedit_app.render.painter import Painter

    camera, full = default_camera(rig), np.ones(len(rig.neutral), np.float32)
    fills: list[object] = []
    draws: list[object] = []
    fill, draw = Stream.fill, Painter._bind_and_draw_primitive
    monkeypatch.setattr(Stream, "fill", lambda *a: (fills.append(a), fill(*a)))
    monkeypatch.setattr(Painter, "_bind_and_draw_primitive", lambda *a: (draws.append(a), draw(*a)))

    def cost(tint: np.ndarray | None, turned: float = 0.0) -> tuple[int, int]:
        fills.clear()
        draws.clear()
        renderer.draw(rig.neutral, camera.orbit(turned, 0.0), smooth=False, tint=tint)
        return len(fills), len(draws)

    # From a new place: positions and normals; what is still, what moves and the backdrop.
    cost(None, turned=0.1)
    assert cost(None) == (2, 3)
    cost(None)  # what is still is kept from now on
    # Colours of what is still and of what moves; once after a tint the plain ones are put back.
    counts = [cost(tint) for tint in (None, full, full, None, None)]
    assert counts == [(2, 1), (4, 3), (4, 3), (4, 3), (2, 1)]


# --- in the window -------------------------------------------------------------------------------


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    """A window on a take whose mouth is opened around 1.2 s, with the playhead there."""
    window = bench.editing()
    add_edit(window, 12.0)
    window.timeline.go_to_time(1.2)
    window.grab()
    return window


def face_of(window: MainWindow) -> FacePane:
    assert window.editor is not None
    return window.editor.face


def tints(bench: Bench, window: MainWindow) -> list[np.ndarray | None]:
    """Of the faces in the next picture, from left to right."""
    tints = bench.renderers[-1].tints
    tints.clear()
    face_of(window).viewport.redraw()
    window.grab()
    return [*tints]


def is_tinted(tint: np.ndarray | None) -> bool:
    return tint is not None and tint.max() > 0.2


def test_it_is_off_until_it_is_asked_for(bench: Bench, window: MainWindow) -> None:
    face, action = face_of(window), window.actions_["show_difference"]
    assert not action.isChecked()
    assert tints(bench, window) == [None]
    assert face.viewport.legend.isHidden()
    QTest.keyClick(window, Qt.Key.Key_T, Qt.KeyboardModifier.ControlModifier)
    assert action.isChecked()
    assert not face.viewport.legend.isHidden()
    assert is_tinted(tints(bench, window)[0])
    trigger(window, "show_difference")
    assert not action.isChecked()
    assert tints(bench, window) == [None]
    assert face.viewport.legend.isHidden()


def test_it_tells_how_far_the_face_is_from_the_tracked_one(
    bench: Bench, window: MainWindow
) -> None:
    session, rig = window.document.session, shipped_rig()
    assert session is not None
    trigger(window, "show_difference")
    frame = window.timeline.frame
    now, before = (rig.vertices(session.rig_weights(frame, tracked)) for tracked in (False, True))
    apart = 1000 * np.linalg.norm(now - before, axis=1)
    (tint,) = tints(bench, window)
    assert tint is not None
    assert apart.max() > 2
    np.testing.assert_allclose(tint, np.minimum(apart / FULL, 1), atol=1e-3)
    window.timeline.go_to_time(2.8)  # where no edit reaches
    (tint,) = tints(bench, window)
    assert tint is not None
    assert not tint.any()


def test_it_follows_edits_and_what_floats(bench: Bench, window: MainWindow) -> None:
    trigger(window, "show_difference")
    before = tints(bench, window)[0]
    trigger(window, "undo")
    (none,) = tints(bench, window)
    assert none is not None
    assert not none.any()
    trigger(window, "redo")
    np.testing.assert_array_equal(tints(bench, window)[0], before)
    trigger(window, "undo")
    drawn = bench.renderers[-1].tints
    drawn.clear()
    drag_curve(window, 0, 1.2, 40)
    window.grab()
    assert is_tinted(drawn[-1])


def test_what_is_hurried_in_a_drag_is_tinted(bench: Bench, window: MainWindow) -> None:
    trigger(window, "show_difference")
    viewport, drawn = face_of(window).viewport, bench.renderers[-1].tints
    viewport.redraw()
    drawn.clear()
    viewport.hurry()
    assert is_tinted(drawn[0])
    window.grab()
    assert len(drawn) == 1, "painting takes what was begun"


def test_of_two_faces_the_edited_one_is_tinted(bench: Bench, window: MainWindow) -> None:
    face = face_of(window)
    trigger(window, "show_difference")
    trigger(window, "show_both")
    left, right = tints(bench, window)
    assert left is None
    assert is_tinted(right)
    trigger(window, "show_tracked")
    assert tints(bench, window) == [None]
    assert face.viewport.legend.isHidden(), "nothing to explain"
    trigger(window, "show_edited")
    assert is_tinted(tints(bench, window)[0])
    face.glance(True)
    assert tints(bench, window) == [None]
    face.glance(False)
    assert is_tinted(tints(bench, window)[0])


def test_asking_for_it_brings_the_edited_face(window: MainWindow) -> None:
    trigger(window, "show_tracked")
    trigger(window, "show_difference")
    assert not face_of(window).shows_tracked
    assert window.actions_["show_edited"].isChecked()


def test_it_is_remembered(bench: Bench, window: MainWindow) -> None:
    trigger(window, "show_difference")
    assert bench.preferences().difference()
    again = bench.editing()
    assert again.actions_["show_difference"].isChecked()
    assert face_of(again).shows_difference
    trigger(again, "show_difference")
    assert not bench.preferences().difference()


def test_nothing_of_the_last_take_stays(bench: Bench, window: MainWindow) -> None:
    trigger(window, "show_difference")
    other = make_livelink_csv(bench.folder / "other.csv", seconds=2.0)
    bench.answers["unsaved"] = dialogs.Unsaved.DISCARD
    window.commands.file.open_if_saved(other)
    bench.qtbot.waitUntil(lambda: open_path(window) == other)
    (tint,) = tints(bench, window)
    assert tint is not None
    assert not tint.any()


def test_another_character_starts_without_the_weights_of_the_last(
    bench: Bench, window: MainWindow
) -> None:
    trigger(window, "show_difference")
    viewport = face_of(window).viewport
    viewport.open(ball())
    assert viewport.legend.isHidden()
    window.grab()
    assert bench.renderers[-1].tints == [None]


def test_without_a_face_there_is_no_legend(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, window: MainWindow
) -> None:
    trigger(window, "show_difference")
    viewport = face_of(window).viewport
    monkeypatch.setattr(render, "open_renderer", bench.no_gl)
    viewport.open(shipped_rig())
    assert viewport.legend.isHidden()


def test_the_legend_is_clear_of_the_switches(window: MainWindow) -> None:
    face = face_of(window)
    trigger(window, "show_difference")
    legend, buttons = face.viewport.legend, face.findChildren(QToolButton)
    assert buttons
    for width in (240, 300, 420, 700):
        face.setFixedSize(width, 400)
        QApplication.processEvents()
        assert face.viewport.rect().contains(legend.geometry())
        for button in buttons:
            place = QRect(button.mapTo(face, QPoint(0, 0)), button.size())
            assert not place.intersects(legend.geometry()), width


def test_in_a_narrow_pane_the_legend_is_below_the_face(window: MainWindow) -> None:
    face = face_of(window)
    face.setFixedSize(290, 300)
    for both in (False, True):
        trigger(window, "show_both" if both else "show_difference")
        place = face.viewport.legend.geometry()
        assert place.top() > 250
        assert (abs(place.center().x() - 145) <= 1) == both, "between the names, or beside the neck"


def test_the_legend_shows_the_ramp_and_lets_the_mouse_through(window: MainWindow) -> None:
    face = face_of(window)
    trigger(window, "show_difference")
    legend = face.viewport.legend
    image = legend.grab().toImage()
    ratio = image.devicePixelRatio()
    row = [
        image.pixelColor(round(x * ratio), round(10 * ratio)) for x in (8, legend.width() // 2, 118)
    ]
    reds = [color.red() for color in row]
    assert reds == sorted(reds, reverse=True)
    assert row[0].red() > row[0].blue() + 50
    assert row[2].blue() > row[2].red() + 50
    assert legend.testAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)


def test_the_real_face_is_tinted(
    bench: Bench, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    need_opengl()
    monkeypatch.setattr(render, "open_renderer", open_renderer)
    viewport = face_of(window).viewport
    viewport.open(shipped_rig())
    assert viewport.can_draw, viewport.message
    plain = violet_part(viewport)
    trigger(window, "show_difference")
    assert violet_part(viewport) > plain + 0.02
    trigger(window, "show_both")
    assert violet_part(viewport, right=False) < plain + 0.005
    assert violet_part(viewport, right=True) > plain + 0.02
    trigger(window, "show_difference")
    assert violet_part(viewport) < plain + 0.005
    viewport.close_renderer()


def violet_part(viewport: Viewport, right: bool | None = None) -> float:
    """How much of the picture's middle height, or of that of one half, is bluer than red."""
    viewport.legend.hide()
    image = viewport.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    pixels = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), -1, 4).astype(int)
    half = pixels.shape[1] // 2
    columns = slice(None) if right is None else slice(half, None) if right else slice(0, half)
    part = pixels[image.height() // 3 :, columns]
    return float(((part[..., 0] > part[..., 2] + 25) & (part[..., 0] > 80)).mean())
