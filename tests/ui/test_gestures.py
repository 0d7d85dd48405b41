"""What the mouse means, what the axes say and what is drawn of a curve: without Qt."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faceedit_app.core.clip import Clip
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves.gestures import (
    CurveDrag,
    Pan,
    RulerDrag,
    Span,
    WheelAction,
    span_at,
    stepped_falloff,
    wheel_action,
)
from faceedit_app.ui.curves.lines import offsets
from faceedit_app.ui.curves.scale import Scale
from faceedit_app.ui.curves.ticks import frame_ticks, nice_step, time_label, time_steps
from faceedit_app.ui.curves.tools import Press, move
from faceedit_app.ui.curves.value_range import fitted, grown, stretched

CLIP = Clip(np.zeros((600, 1), np.float32), ("jawOpen",), np.arange(600) / 60.0, 60.0)
SCALE = Scale(width=500, height=100, view=(0.0, 10.0), values=(0.0, 20.0))  # 0.2 mm a pixel


def drag_from(x: float = 100.0, y: float = 50.0) -> CurveDrag:
    span, limits = Span(2.0, 2.0, 0.3), (0.0, 40.0)
    mine = ("mouth_opening",)
    return move(Press(mine[0], mine, (x, y), 2.0, SCALE, span, 10.0, 8.0, limits, CLIP))


# --- dragging a curve ----------------------------------------------------------------------


def test_dragging_up_adds_the_millimetres_under_the_hand() -> None:
    edit = drag_from().moved(100, 40, fine=False).moved(100, 25, fine=False).edit(0.3)
    assert edit is not None
    assert edit.value == pytest.approx(5.0)
    assert edit == Edit(("mouth_opening",), Op.OFFSET, 2.0, 2.0, 0.3, edit.value)


def test_dragging_down_takes_away() -> None:
    edit = drag_from().moved(100, 60, fine=False).edit(0.0)
    assert edit is not None
    assert edit.value == pytest.approx(-2.0)


def test_fine_is_ten_times_as_steady_and_does_not_jump() -> None:
    coarse = drag_from().moved(100, 30, fine=False)
    fine = coarse.moved(100, 20, fine=True)
    assert fine.value - coarse.value == pytest.approx(0.1 * 2.0)
    assert fine.moved(100, 10, fine=False).value == pytest.approx(fine.value + 2.0)


def test_a_hand_that_trembles_only_clicks() -> None:
    drag = drag_from().moved(102, 47, fine=False)
    assert drag.is_click
    assert drag.edit(0.2) is None


def test_a_sideways_drag_is_neither_an_edit_nor_a_click() -> None:
    drag = drag_from().moved(180, 51, fine=False)
    assert not drag.is_click
    assert drag.edit(0.2) is None


def test_back_to_where_it_began_is_no_edit() -> None:
    drag = drag_from().moved(100, 30, fine=False).moved(100, 50, fine=False)
    assert drag.moving
    assert drag.edit(0.2) is None


def test_a_press_inside_the_selection_edits_all_of_it() -> None:
    assert span_at(2.5, (2.0, 3.0), 0.1) == Span(2.0, 3.0, 0.1)
    assert span_at(3.5, (2.0, 3.0), 0.1) == Span(3.5, 3.5, 0.1)
    assert span_at(2.5, None, 0.1).ends == (2.4, 2.6)


# --- wheel, pan, ruler ---------------------------------------------------------------------


def test_what_the_wheel_means() -> None:
    assert wheel_action(dragging=True, shift=True, ctrl=True) is WheelAction.FALLOFF
    assert wheel_action(dragging=False, shift=True, ctrl=False) is WheelAction.PAN
    assert wheel_action(dragging=False, shift=False, ctrl=True) is WheelAction.ZOOM_VALUES
    assert wheel_action(dragging=False, shift=False, ctrl=False) is WheelAction.ZOOM_TIME


def test_falloff_goes_down_to_nothing_and_up_again() -> None:
    falloff = 0.2
    for _ in range(40):
        falloff = stepped_falloff(falloff, -1)
    assert falloff == 0.0
    assert stepped_falloff(0.0, -1) == 0.0
    assert stepped_falloff(0.0, 1) == pytest.approx(0.02)
    assert stepped_falloff(0.2, 1) == pytest.approx(0.24)


def test_pan_keeps_the_time_under_the_pointer() -> None:
    pan = Pan(100, (2.0, 4.0), 0.004)
    first, last = pan.moved(150)
    assert first + 150 * 0.004 == pytest.approx(2.0 + 100 * 0.004)
    assert last - first == pytest.approx(2.0)


def test_a_selection_may_be_dragged_either_way() -> None:
    assert RulerDrag(3.0, True).selection(1.0) == (1.0, 3.0)
    assert RulerDrag(3.0, True).selection(4.0) == (3.0, 4.0)


# --- axes ----------------------------------------------------------------------------------


def test_scale_there_and_back() -> None:
    assert SCALE.time_at(SCALE.x_of(3.3)) == pytest.approx(3.3)
    assert SCALE.value_at(SCALE.y_of(7.7)) == pytest.approx(7.7)
    assert SCALE.y_of(20.0) == 0.0


def test_an_axis_never_magnifies_noise() -> None:
    low, high = fitted(10.0, 10.01)
    assert high - low >= 2.0
    low, high = fitted(10.0, 12.0, least=8.0)
    assert (low + high) / 2 == pytest.approx(11.0)
    assert high - low > 8.0


@given(st.floats(-50, 50), st.floats(0, 50))
def test_an_axis_grows_and_never_shrinks(low: float, height: float) -> None:
    shown = (0.0, 10.0)
    first, last = grown(shown, low, low + height)
    assert first <= min(shown[0], low)
    assert last >= max(shown[1], low + height)
    assert grown(shown, 1.0, 9.0) == shown


@given(st.floats(-50, 50))
def test_an_axis_stretches_no_further_than_it_must(value: float) -> None:
    shown = (0.0, 10.0)
    low, high = stretched(shown, value)
    assert low < value < high
    assert low == shown[0] or high == shown[1]
    if 1.0 <= value <= 9.0:
        assert (low, high) == shown


@pytest.mark.parametrize(("smallest", "step"), [(0.9, 1), (1, 1), (1.1, 2), (3, 5), (6, 10)])
def test_nice_steps(smallest: float, step: float) -> None:
    assert nice_step(smallest) == pytest.approx(step)


@pytest.mark.parametrize(
    ("smallest", "step", "fine"), [(0.9, 1, 0.2), (2.0, 2, 0.5), (12, 15, 5), (61, 120, 30)]
)
def test_steps_of_time(smallest: float, step: float, fine: float) -> None:
    assert time_steps(smallest) == pytest.approx((step, fine))


@pytest.mark.parametrize(
    ("seconds", "step", "label"),
    [
        (0, 1, "0 s"),
        (2.5, 0.5, "2.5 s"),
        (0.25, 0.05, "0.25 s"),
        (65, 5, "1:05"),
        (59.96, 0.02, "59.96 s"),
        (65.5, 0.5, "1:05.5"),
        (3725, 5, "1:02:05"),
    ],
)
def test_times_are_written_as_people_do(seconds: float, step: float, label: str) -> None:
    assert time_label(seconds, step) == label


def test_frames_have_round_numbers() -> None:
    times = np.arange(1000) / 50
    numbered, marked = frame_ticks(times, (0.0, 20.0), 500, 34, 9)
    assert [frame + 1 for frame in numbered] == list(range(100, 1001, 100))
    assert [frame + 1 for frame in marked[:4]] == [20, 40, 60, 80]
    # There is room for every second number, and for a mark at each frame.
    numbered, marked = frame_ticks(times, (1.0, 1.5), 500, 34, 9)
    assert [frame + 1 for frame in numbered[:2]] == [52, 54]
    assert [frame + 1 for frame in marked[:2]] == [51, 53]
    assert len(numbered) + len(marked) == 26


# --- lines ---------------------------------------------------------------------------------


def test_wide_lines_are_made_of_thin_ones() -> None:
    assert offsets(1.0) == [(0.0, 0.0)]
    for width in (1.8, 3.6):
        xs = [x for x, _ in offsets(width)]
        ys = [y for _, y in offsets(width)]
        for spread in (xs, ys):
            assert 0.7 * (width - 1) <= max(spread) - min(spread) <= width - 1 + 1e-9
