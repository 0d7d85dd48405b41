"""Copy, paste and mirror of a range."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.faces import talking_clip
from support.sessions import session_by_rig

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Company, Edit, Op
from faceedit_app.editing.help.clipboard import TOLERANCE, Copied, copy_range, simplify
from faceedit_app.editing.session import EditSession

MOUTH, WIDTH = CONTROL_INDEX["mouth_opening"], CONTROL_INDEX["mouth_width"]


def session(frames: int = 600) -> EditSession:
    return session_by_rig(talking_clip(frames))


def _alone(*controls: str) -> Edit:
    """An edit that nothing follows."""
    return Edit(controls, Op.OFFSET, 2.0, 2.5, 0.2, 3.0, companions=Company.STAY)


def test_what_followed_is_copied_and_pasted_as_it_was() -> None:
    open_session = session()
    open_session.add(Edit(("left_corner", "right_corner"), Op.OFFSET, 2.0, 2.5, 0.2, 3.0))
    open_session.add(*copy_range(open_session, 1.8, 2.7).paste(6.0, falloff=0.0))
    change = open_session.asked - open_session.tracked
    assert np.abs(change[120:150, WIDTH]).min() > 0.1
    np.testing.assert_allclose(change[360:414], change[108:162], atol=2 * TOLERANCE)


def test_change_is_pasted_on_top_of_what_is_there() -> None:
    open_session = session()
    open_session.add(Edit(("mouth_opening",), Op.OFFSET, 2.0, 2.5, 0.2, 3.0))
    copied = copy_range(open_session, 1.8, 2.7)
    (edit,) = copied.paste(6.0, falloff=0.0)
    assert (edit.op, edit.controls) == (Op.ADD, ("mouth_opening",))
    assert (edit.start, edit.end) == (6.0, pytest.approx(6.9))
    open_session.add(edit)
    change = (open_session.asked - open_session.tracked)[:, MOUTH]
    np.testing.assert_allclose(change[360:414], change[108:162], atol=2 * TOLERANCE)


def test_curve_is_pasted_in_place_of_what_is_there() -> None:
    open_session = session()
    copied = copy_range(open_session, 2.0, 3.0, ("mouth_width", "mouth_opening"), Copied.CURVE)
    assert [control for control, _ in copied.curves] == ["mouth_opening", "mouth_width"]
    open_session.add(*copied.paste(6.0))
    np.testing.assert_allclose(
        open_session.asked[360:421, [MOUTH, WIDTH]],
        open_session.tracked[120:181, [MOUTH, WIDTH]],
        atol=2 * TOLERANCE,
    )


def test_mirror_swaps_left_and_right_and_leaves_the_middle() -> None:
    open_session = session()
    open_session.add(_alone("left_corner", "mouth_width"))
    copied = copy_range(open_session, 2.0, 2.5)
    assert [c for c, _ in copied.mirrored().curves] == ["mouth_width", "right_corner"]
    assert copied.mirrored().mirrored() == copied


def test_controls_that_changed_alike_are_one_edit() -> None:
    open_session = session()
    open_session.add(_alone("left_corner", "right_corner"))
    (edit,) = copy_range(open_session, 2.0, 2.5).paste(4.0)
    assert edit.controls == ("left_corner", "right_corner")


def test_nothing_to_copy_is_nothing_to_paste() -> None:
    for start, end in ((2.0, 3.0), (-5.0, -4.0), (99.0, 100.0)):
        copied = copy_range(session(), start, end)
        assert copied.is_empty
        assert copied.paste(1.0) == ()


def test_one_frame_can_be_copied() -> None:
    copied = copy_range(session(), 2.0, 2.0, what=Copied.CURVE)
    assert len(copied.paste(3.0)) == 8


@given(st.lists(st.floats(-50, 50), min_size=1, max_size=60))
@settings(deadline=None, derandomize=True)
def test_simplified_curve_is_the_curve_to_within_the_tolerance(values: list[float]) -> None:
    seconds = np.arange(len(values)) / 30
    points = simplify(seconds, np.array(values))
    kept = np.array(points)
    assert (np.diff(kept[:, 0]) > 0).all()
    np.testing.assert_allclose(
        np.interp(seconds, kept[:, 0], kept[:, 1]), values, atol=TOLERANCE + 0.01
    )


def test_straight_line_is_two_points() -> None:
    assert len(simplify(np.arange(100.0), np.arange(100.0))) == 2


def test_ten_minutes_are_copied_without_a_wait() -> None:
    open_session = session(36_000)
    began = time.process_time()
    copied = copy_range(open_session, 0.0, 600.0, what=Copied.CURVE)
    edits = copied.paste(0.0)
    assert time.process_time() - began < 5.0  # of the processor
    assert len(edits) == 8
