"""One way to make a gesture: sliders, numbers and keys preview, commit and cancel alike."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QFocusEvent, QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QSlider, QStyle, QStyleOptionSlider, QWidget
from support.films import make_wav
from support.windows import (
    Bench,
    add_edit,
    double_click,
    drag_curve,
    editor_of,
    press_key,
    session_of,
    step_names,
    trigger,
    with_undone_slider,
)

from faceedit_app.ui.start.window import MainWindow

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return with_undone_slider(bench)


def handle(slider: QSlider) -> QPoint:
    """The middle of a slider's handle."""
    option = QStyleOptionSlider()
    slider.initStyleOption(option)
    style, part = slider.style(), QStyle.SubControl.SC_SliderHandle
    return style.subControlRect(QStyle.ComplexControl.CC_Slider, option, part, slider).center()


def mouse(widget: QWidget, kind: QEvent.Type, at: QPoint) -> None:
    button = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseMove else LEFT
    held = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseButtonRelease else LEFT
    everywhere = QPointF(widget.mapToGlobal(at))
    keys = Qt.KeyboardModifier.NoModifier
    QApplication.sendEvent(widget, QMouseEvent(kind, QPointF(at), everywhere, button, held, keys))


def press(slider: QSlider) -> QPoint:
    at = handle(slider)
    mouse(slider, QEvent.Type.MouseButtonPress, at)
    return at


def move(slider: QSlider, start: QPoint, pixels: int) -> None:
    """Bring the handle to so many pixels from where it was pressed."""
    mouse(slider, QEvent.Type.MouseMove, start + QPoint(pixels, 0))


def release(slider: QSlider, start: QPoint, pixels: int) -> None:
    mouse(slider, QEvent.Type.MouseButtonRelease, start + QPoint(pixels, 0))


def turn(widget: QWidget, notches: int) -> None:
    at = QPointF(widget.rect().center())
    for _ in range(abs(notches)):
        delta = QPoint(0, 120 if notches > 0 else -120)
        QApplication.sendEvent(
            widget,
            QWheelEvent(
                at,
                QPointF(widget.mapToGlobal(at.toPoint())),
                QPoint(),
                delta,
                Qt.MouseButton.NoButton,
                Qt.KeyboardModifier.NoModifier,
                Qt.ScrollPhase.NoScrollPhase,
                False,
            ),
        )


# --- sliders -------------------------------------------------------------------------------------


def test_a_slider_that_is_dragged_back_is_no_step_and_costs_no_redo(
    bench: Bench, window: MainWindow
) -> None:
    """It dropped the earlier redo, and offered the 60 % on the way there in its place."""
    session, slider = session_of(window), editor_of(window).settings_bar.exactness
    assert step_names(session) == ("Mouth opening +6.0 mm", "Natural to exact")
    start = press(slider)
    move(slider, start, -35)
    bench.qtbot.waitUntil(lambda: session.is_previewing)
    assert slider.value() < 40
    assert session.settings.reach == 1.0, "it is shown, and not kept"
    move(slider, start, 0)
    release(slider, start, 0)
    assert slider.value() == 50
    assert not session.is_previewing
    assert step_names(session) == ("Mouth opening +6.0 mm", "Natural to exact")
    trigger(window, "redo")
    assert session.settings.reach == pytest.approx(0.98)
    assert session.settings.naturalness == 1.0


def test_a_click_elsewhere_takes_the_keys_from_a_slider(window: MainWindow) -> None:
    """End set Exact for the whole take, after a click on the face."""
    session, editor = session_of(window), editor_of(window)
    slider, before = editor.settings_bar.exactness, session.state
    window.activateWindow()
    for clicked in (editor.face.viewport, editor.curves, editor.curves.plots[0]):
        slider.setFocus(Qt.FocusReason.TabFocusReason)
        assert slider.hasFocus()
        QTest.mouseClick(clicked, LEFT, pos=QPoint(1, 1))
        focused = QApplication.focusWidget()
        assert focused is not None
        assert focused is not slider
        QTest.keyClick(focused, Qt.Key.Key_End)
    assert session.state == before


def test_a_drag_of_a_slider_is_one_step_with_its_name(bench: Bench, window: MainWindow) -> None:
    session, slider = session_of(window), editor_of(window).settings_bar.exactness
    start = press(slider)
    for pixels in (-10, -20, -30):
        move(slider, start, pixels)
        bench.qtbot.waitUntil(lambda: session.is_previewing)
    release(slider, start, -30)
    kept = slider.value() / 100
    assert kept < 0.4
    assert session.settings.exactness == pytest.approx(kept)
    assert step_names(session) == ("Natural to exact", "")
    trigger(window, "undo")
    assert step_names(session) == ("Mouth opening +6.0 mm", "Natural to exact")
    assert (session.settings.reach, slider.value()) == (1.0, 50)
    trigger(window, "redo")
    assert session.settings.exactness == pytest.approx(kept)
    assert slider.value() == round(100 * kept)


@pytest.mark.parametrize("which", ["natural", "strength"])
@pytest.mark.parametrize("command", ["deselect", "undo"])
def test_esc_and_undo_drop_the_drag_of_a_slider(
    bench: Bench, window: MainWindow, which: str, command: str
) -> None:
    session, editor = session_of(window), editor_of(window)
    editor.edits.select(0)
    slider = editor.settings_bar.exactness if which == "natural" else editor.edits.strength
    before, weights, value = session.state, session.weights.copy(), slider.value()
    start = press(slider)
    move(slider, start, -30)
    bench.qtbot.waitUntil(lambda: session.is_previewing)
    trigger(window, command)
    assert not session.is_previewing
    assert (session.state, slider.value()) == (before, value)
    move(slider, start, -20)  # the button is still down
    assert (session.state, slider.value()) == (before, value)
    release(slider, start, -20)
    assert (session.state, slider.value()) == (before, value)
    assert (session.weights == weights).all()
    assert step_names(session) == ("Mouth opening +6.0 mm", "Natural to exact")
    start = press(slider)  # it works as before
    move(slider, start, -30)
    release(slider, start, -30)
    assert session.undo_name == ("Natural to exact" if which == "natural" else "Edit strength")


@pytest.mark.parametrize("how", ["keys", "wheel"])
def test_ticks_of_a_slider_are_one_step(window: MainWindow, how: str) -> None:
    session, slider = session_of(window), editor_of(window).settings_bar.exactness
    if how == "keys":
        press_key(slider, Qt.Key.Key_Left, 4)
    else:
        turn(slider, -4)
    assert slider.value() < 47
    assert session.settings.exactness == pytest.approx(slider.value() / 100)
    trigger(window, "undo")
    assert session.settings.exactness == 0.5
    assert session.undo_name == "Mouth opening +6.0 mm"


def test_ticks_that_lead_back_are_no_step_and_cost_no_redo(window: MainWindow) -> None:
    session, slider = session_of(window), editor_of(window).settings_bar.exactness
    press_key(slider, Qt.Key.Key_Left, 3)
    assert step_names(session) == ("Natural to exact", "")
    press_key(slider, Qt.Key.Key_Right, 3)
    assert step_names(session) == ("Mouth opening +6.0 mm", "Natural to exact")


@pytest.mark.parametrize("which", ["natural", "strength"])
def test_a_double_click_on_a_slider_goes_back_to_its_start(window: MainWindow, which: str) -> None:
    session, editor = session_of(window), editor_of(window)
    editor.edits.select(0)
    slider = editor.settings_bar.exactness if which == "natural" else editor.edits.strength
    start, end = slider.value(), QPoint(slider.width() - 3, slider.height() // 2)
    before, steps = session.state, step_names(session)
    QTest.mouseClick(slider, Qt.MouseButton.LeftButton, pos=end)
    assert slider.value() > start
    slider.left.emit()
    for _ in range(2):  # from elsewhere, and from its start
        double_click(slider)
        assert (slider.value(), session.state) == (start, before)
    trigger(window, "undo")
    assert slider.value() == start + 10, "it is one step"
    trigger(window, "undo")
    assert step_names(session)[0] == steps[0]


@pytest.mark.parametrize("between", ["focus", "pointer", "drag", "other slider", "save"])
def test_ticks_end_where_something_comes_between(
    bench: Bench, window: MainWindow, between: str
) -> None:
    session, editor = session_of(window), editor_of(window)
    slider = editor.settings_bar.exactness
    press_key(slider, Qt.Key.Key_Left, 2)
    match between:
        case "focus":
            QApplication.sendEvent(slider, QFocusEvent(QEvent.Type.FocusOut))
        case "pointer":
            QApplication.sendEvent(slider, QEvent(QEvent.Type.Leave))
        case "drag":
            drag_curve(window, 0, 2.5, 20)
        case "other slider":
            editor.edits.select(0)
            press_key(editor.edits.strength, Qt.Key.Key_Left)
        case "save":
            bench.answers["save_project"] = bench.folder / "p.faceedit"
            trigger(window, "save")
    kept = session.state
    press_key(slider, Qt.Key.Key_Left)
    assert session.settings.exactness == pytest.approx(0.47)
    trigger(window, "undo")
    assert session.state == kept


def test_strength_by_keys_is_one_step_for_the_edits_that_are_selected(window: MainWindow) -> None:
    session, editor = session_of(window), editor_of(window)
    add_edit(window, 3.0)
    editor.edits.select(0)
    press_key(editor.edits.strength, Qt.Key.Key_Left, 3)
    editor.edits.select(1)
    press_key(editor.edits.strength, Qt.Key.Key_Left, 2)
    assert [edit.strength for edit in session.edits] == pytest.approx([0.97, 0.98])
    assert session.undo_name == "Edit strength"
    trigger(window, "undo")
    assert [edit.strength for edit in session.edits] == pytest.approx([0.97, 1.0])
    trigger(window, "undo")
    assert [edit.strength for edit in session.edits] == [1.0, 1.0]


# --- numbers -------------------------------------------------------------------------------------


def test_an_offset_by_arrows_is_one_step_that_enter_ends(bench: Bench) -> None:
    window = bench.editing()
    window.media.add(make_wav(bench.folder / "voice.wav"))
    bench.qtbot.waitUntil(lambda: session_of(window).can_undo, timeout=10_000)
    session, box = session_of(window), editor_of(window).sound.offset
    assert session.undo_name == "Add sound"
    press_key(box, Qt.Key.Key_Up, 3)
    assert session.undo_name == "Move sound"
    QTest.keyClick(box, Qt.Key.Key_Return)
    press_key(box, Qt.Key.Key_Up, 2)
    assert box.value() == pytest.approx(0.05)
    trigger(window, "undo")
    assert box.value() == pytest.approx(0.03)
    trigger(window, "undo")
    assert box.value() == 0.0
    assert step_names(session) == ("Add sound", "Move sound")


def test_a_sound_that_is_dragged_back_is_no_step_and_costs_no_redo(bench: Bench) -> None:
    window = bench.editing()
    window.media.add(make_wav(bench.folder / "voice.wav"))
    session = session_of(window)
    bench.qtbot.waitUntil(lambda: session.can_undo, timeout=10_000)
    drag_curve(window, 0, 1.0, 20)
    trigger(window, "undo")
    redo, weights = session.redo_name, session.weights.copy()
    assert redo.startswith("Mouth opening")
    wave, alt = editor_of(window).sound.waveform, Qt.KeyboardModifier.AltModifier
    start = QPoint(100, 20)
    QTest.mousePress(wave, LEFT, alt, start)
    for pixels in (60, 0):
        at = QPointF(start + QPoint(pixels, 0))
        none = Qt.MouseButton.NoButton
        event = QMouseEvent(QEvent.Type.MouseMove, at, wave.mapToGlobal(at), none, LEFT, alt)
        QApplication.sendEvent(wave, event)
        assert session.is_previewing
        assert session.state.media == window.media.placement or pixels
    QTest.mouseRelease(wave, LEFT, alt, start)
    assert not session.is_previewing
    assert step_names(session) == ("Add sound", redo)
    assert (session.weights == weights).all()


def test_both_ends_of_a_typed_range_are_one_step(window: MainWindow) -> None:
    session, editor = session_of(window), editor_of(window)
    editor.edits.select(0)
    was, fields = session.edits, editor.curves.fields
    for box, key in ((fields.start, Qt.Key.Key_Down), (fields.end, Qt.Key.Key_Up)):
        press_key(box, key, 2)
        QTest.keyClick(box, Qt.Key.Key_Return)
    (edit,) = session.edits
    assert (edit.start, edit.end) == pytest.approx((was[0].start - 0.1, was[0].end + 0.1))
    press_key(fields.fade_in, Qt.Key.Key_Up)
    trigger(window, "undo")
    assert session.edits == (edit,), "a falloff is another step"
    trigger(window, "undo")
    assert session.edits == was


def test_a_typed_range_of_an_edit_is_one_step_until_enter(window: MainWindow) -> None:
    session, editor = session_of(window), editor_of(window)
    editor.edits.select(0)
    box = editor.curves.fields.end
    press_key(box, Qt.Key.Key_Up, 3)
    assert session.edits[0].end == pytest.approx(1.55)
    assert session.undo_name == "Range"
    QTest.keyClick(box, Qt.Key.Key_Return)
    editor.edits.select(0)
    press_key(box, Qt.Key.Key_Up)
    trigger(window, "undo")
    assert session.edits[0].end == pytest.approx(1.55)
    trigger(window, "undo")
    assert session.edits[0].end == pytest.approx(1.4)
    assert session.undo_name == "Mouth opening +6.0 mm"


def test_an_edge_of_the_selection_leaves_a_proposal_to_its_own_button(
    bench: Bench, window: MainWindow
) -> None:
    session, editor = session_of(window), editor_of(window)
    window.timeline.select((1.0, 2.0))
    editor.proposal.offer("A proposal", session.edits, "Fix problem")
    before = session.state
    editor.curves.fields.end.setValue(2.2)
    assert session.state == before
    assert editor.proposal.is_open
    trigger(window, "accept_fix")
    assert session.undo_name == "Fix problem"
