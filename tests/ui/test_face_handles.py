"""Handles on the face: drag a corner, a lip or a lid in the picture, and the curve follows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from support.character_files import write_glb
from support.waiting import run_events
from support.windows import Bench, editor_of, session_of, trigger

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Op
from faceedit_app.ui.face.handles import POINTS, FaceHandles
from faceedit_app.ui.face.viewport import Viewport
from faceedit_app.ui.start.window import MainWindow

LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    window = bench.editing()
    window.timeline.go_to_time(1.2)
    bench.qtbot.waitUntil(lambda: viewport_of(window).can_draw)
    trigger(window, "camera_mouth")
    run_events()
    return window


def handles_of(window: MainWindow) -> FaceHandles:
    assert window.editor is not None
    return window.editor.face.handles


def viewport_of(window: MainWindow) -> Viewport:
    assert window.editor is not None
    return window.editor.face.viewport


def move(viewport: Viewport, at: QPoint, keys: Qt.KeyboardModifier, held: bool = True) -> None:
    where = QPointF(viewport.mapToGlobal(at))
    buttons = LEFT if held else Qt.MouseButton.NoButton
    kind, none = QEvent.Type.MouseMove, Qt.MouseButton.NoButton
    QApplication.sendEvent(viewport, QMouseEvent(kind, QPointF(at), where, none, buttons, keys))


def drag(
    window: MainWindow,
    control: str,
    by: QPoint,
    keys: Qt.KeyboardModifier = NONE,
    release: bool = True,
) -> None:
    viewport = viewport_of(window)
    start = handles_of(window).places[control].toPoint()
    QTest.mousePress(viewport, LEFT, keys, start)
    for step in range(1, 7):
        move(viewport, start + by * step / 6, keys)
    if release:
        QTest.mouseRelease(viewport, LEFT, keys, start + by)


def test_every_handle_lies_on_its_part_of_the_face(window: MainWindow) -> None:
    places = handles_of(window).places
    assert set(places) == set(POINTS)
    assert places["upper_lip"].y() < places["mouth_opening"].y()
    # The character's left is on the right of the picture.
    assert places["left_corner"].x() > places["right_corner"].x()
    assert places["left_eyelid"].y() < places["upper_lip"].y()


def test_the_lower_lip_pulled_down_opens_the_mouth(window: MainWindow) -> None:
    session, camera = session_of(window), viewport_of(window).camera
    frame = window.timeline.frame
    drag(window, "mouth_opening", QPoint(0, 30))
    (edit,) = session.edits
    assert (edit.controls, edit.op) == (("mouth_opening",), Op.OFFSET)
    assert edit.value > 0.5
    assert edit.start == session.take.clip.times[frame]
    assert edit.falloff == window.timeline.own_falloffs[0]
    assert session.asked[frame, 0] == pytest.approx(session.tracked[frame, 0] + edit.value)
    assert viewport_of(window).camera == camera, "the camera stays"
    trigger(window, "undo")
    assert session.edits == ()


@pytest.mark.parametrize(
    ("by", "control"), [(QPoint(0, 30), "mouth_opening"), (QPoint(24, 4), "jaw_side")]
)
def test_the_chin_opens_the_mouth_downwards_and_moves_the_jaw_sideways(
    window: MainWindow, by: QPoint, control: str
) -> None:
    trigger(window, "reset_camera")
    run_events()
    session, frame = session_of(window), window.timeline.frame
    drag(window, "jaw_side", by)
    (edit,) = session.edits
    assert edit.controls == (control,)
    assert edit.value > 0.5
    assert editor_of(window).curves.shown.is_unfolded is (control == "jaw_side")
    assert edit.start == session.take.clip.times[frame]
    assert window.timeline.frame == frame
    trigger(window, "undo")
    assert session.edits == ()


def test_lips_that_first_close_on_the_character_still_open_when_pulled_down(
    window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Near rest, closing on the user's character moves the lip up although more is asked for."""
    handles = handles_of(window)
    moved = handles._moved
    monkeypatch.setattr(
        handles, "_moved", lambda hand, mm: moved(hand, mm) * (-1.0 if mm < 2.0 else 1.0)
    )
    drag(window, "mouth_opening", QPoint(0, 30))
    assert session_of(window).edits[0].value > 0.5


def test_the_handle_stays_under_the_pointer(window: MainWindow) -> None:
    """As well as the face can follow: it is not pulled past where the hand is."""
    start = handles_of(window).places["mouth_opening"]
    drag(window, "mouth_opening", QPoint(0, 20))
    run_events()
    moved = handles_of(window).places["mouth_opening"] - start
    assert 8 < moved.y() < 32


def test_corners_go_together_unless_a_key_says_otherwise(window: MainWindow) -> None:
    session = session_of(window)
    drag(window, "left_corner", QPoint(14, -8))
    assert session.edits[0].controls == ("left_corner", "right_corner")
    trigger(window, "undo")
    both = Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.ControlModifier
    for keys in (Qt.KeyboardModifier.AltModifier, both):
        drag(window, "left_corner", QPoint(14, -8), keys)
        assert session.edits[0].controls == ("left_corner",)
        trigger(window, "undo")


def test_a_lid_pulled_down_closes_the_eyes(window: MainWindow) -> None:
    trigger(window, "camera_eyes")
    run_events()
    session, frame = session_of(window), window.timeline.frame
    drag(window, "left_eyelid", QPoint(0, 14))
    (edit,) = session.edits
    assert edit.controls == ("left_eyelid", "right_eyelid")
    assert edit.value < -0.5
    lid = CONTROL_INDEX["right_eyelid"]
    assert session.achieved[frame, lid] < session.tracked[frame, lid] - 0.3


def test_a_drag_beside_the_handles_orbits(window: MainWindow) -> None:
    viewport = viewport_of(window)
    camera = viewport.camera
    start = QPoint(20, viewport.height() - 20)
    QTest.mousePress(viewport, LEFT, NONE, start)
    move(viewport, start + QPoint(30, 0), NONE)
    QTest.mouseRelease(viewport, LEFT, NONE, start + QPoint(30, 0))
    assert viewport.camera != camera
    assert session_of(window).edits == ()


def test_esc_drops_the_drag_and_a_click_changes_nothing(window: MainWindow) -> None:
    session, camera = session_of(window), viewport_of(window).camera
    drag(window, "mouth_opening", QPoint(0, 30), release=False)
    run_events()
    trigger(window, "deselect")
    assert session.edits == ()
    np.testing.assert_array_equal(session.asked, session.tracked)
    place = handles_of(window).places["mouth_opening"].toPoint()
    QTest.mouseRelease(viewport_of(window), LEFT, NONE, place)
    QTest.mouseClick(viewport_of(window), LEFT, NONE, place)
    assert session.edits == ()
    assert not session.can_undo
    assert viewport_of(window).camera == camera


def test_handles_show_while_the_pointer_is_on_the_edited_face(window: MainWindow) -> None:
    handles, viewport = handles_of(window), viewport_of(window)
    assert not handles.isVisible()
    place = handles.places["left_corner"].toPoint()
    move(viewport, place, NONE, held=False)
    assert handles.isVisible()
    assert viewport.cursor().shape() is Qt.CursorShape.OpenHandCursor
    QApplication.sendEvent(viewport, QEvent(QEvent.Type.Leave))
    assert not handles.isVisible()
    trigger(window, "show_tracked")
    move(viewport, place, NONE, held=False)
    assert not handles.isVisible(), "the tracked face is not edited"


@pytest.fixture
def with_character(window: MainWindow, bench: Bench, tmp_path: Path) -> MainWindow:
    """The window with a head of another maker, seen from the front."""
    window.commands.file.character.open(write_glb(tmp_path / "head.glb"))
    bench.qtbot.waitUntil(lambda: window.document.character is not None)
    bench.qtbot.waitUntil(lambda: viewport_of(window).can_draw)
    trigger(window, "reset_camera")
    run_events()
    return window


@pytest.mark.parametrize(
    ("control", "by", "controls"),
    [
        ("left_brow", QPoint(0, -6), ("left_brow", "right_brow")),
        ("right_brow", QPoint(0, 8), ("left_brow", "right_brow")),
        ("jaw_side", QPoint(6, 0), ("jaw_side",)),
        ("mouth_opening", QPoint(0, 12), ("mouth_opening",)),
    ],
)
def test_handles_of_another_character_follow_the_pointer(
    with_character: MainWindow, control: str, by: QPoint, controls: tuple[str, ...]
) -> None:
    window = with_character
    assert set(handles_of(window).places) == set(POINTS)
    start = handles_of(window).places[control]
    drag(window, control, by)
    run_events()
    (edit,) = session_of(window).edits
    assert set(edit.controls) == set(controls)
    moved = handles_of(window).places[control] - start
    along = QPointF.dotProduct(moved, QPointF(by)) / QPointF.dotProduct(QPointF(by), QPointF(by))
    assert 0.4 < along < 1.6
