"""A neutral rest lies below all edits of curves: what they ask for is what the face shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.faces import talking_clip
from support.sessions import session_by_networks

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.calibrating import neutral_at
from faceedit_app.editing.session import EditSession

REST = {"jawOpen": 0.2, "eyeBlinkLeft": 0.25, "eyeBlinkRight": 0.25}
OPENING, LID = CONTROL_INDEX["mouth_opening"], CONTROL_INDEX["left_eyelid"]
HELD = Edit(("mouth_opening",), Op.SET, 1.0, 1.6, 0.2, 6.0)
RAISED = Edit(("left_eyelid", "right_eyelid"), Op.OFFSET, 2.0, 2.4, 0.2, -1.5)


def squinting() -> Clip:
    """A talking face whose rest has an open jaw and half-closed lids."""
    clip = talking_clip()
    weights = clip.weights.copy()
    for name, rest in REST.items():
        column = clip.channels.index(name)
        weights[:, column] = rest + (1 - rest) * weights[:, column]
    return replace(clip, weights=weights)


def neutral(session: EditSession) -> Edit:
    edit = neutral_at(session, 0.0, 0.0, session.take.clip.duration)
    assert edit is not None
    return edit


def held_frames(session: EditSession, edit: Edit) -> np.ndarray:
    times = session.take.clip.times
    return np.flatnonzero((times >= edit.start) & (times <= edit.end))


def test_a_curve_is_where_it_was_put_before_or_after() -> None:
    results = []
    for first in (True, False):
        session = session_by_networks(squinting())
        edit = neutral(session)
        for each in (edit, HELD) if first else (HELD, edit):
            session.add(each)
        rows = held_frames(session, HELD)
        np.testing.assert_allclose(session.asked[rows, OPENING], 6.0, atol=1e-4)
        np.testing.assert_allclose(session.achieved[rows, OPENING], 6.0, atol=0.6)
        results.append(session.weights)
    np.testing.assert_array_equal(results[0], results[1])


def test_a_drag_after_it_starts_from_the_curve_that_is_shown() -> None:
    session = session_by_networks(squinting())
    session.add(neutral(session))
    shown = session.achieved[:, LID].copy()
    session.add(RAISED)
    rows = held_frames(session, RAISED)
    wanted = np.maximum(shown[rows] - 1.5, 0.0)
    np.testing.assert_allclose(session.asked[rows, LID], wanted, atol=0.01)
    outside = session.take.clip.times > RAISED.span[1] + 0.3
    np.testing.assert_array_equal(session.achieved[outside, LID], shown[outside])


@pytest.mark.parametrize("change", [-3.0, 4.0])
def test_what_edits_do_at_the_frame_is_no_part_of_its_rest(change: float) -> None:
    session = session_by_networks(squinting())
    alone = neutral(session)
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.0, 0.3, 0.1, change))
    edit = neutral(session)
    assert [rest for rest, _ in edit.amounts] == pytest.approx([rest for rest, _ in alone.amounts])


def test_a_reset_after_it_brings_the_take_back_and_one_before_does_not() -> None:
    from faceedit_app.core.controls import MAIN_CONTROLS

    reset = Edit(MAIN_CONTROLS, Op.RESET, 1.0, 2.0, 0.0)
    session = session_by_networks(squinting())
    tracked = session.weights.copy()
    edit = neutral(session)
    session.add(edit)
    flat = session.weights.copy()
    session.add(reset)
    rows = held_frames(session, reset)
    np.testing.assert_array_equal(session.weights[rows], tracked[rows])
    other = session_by_networks(squinting())
    other.add(reset)
    other.add(edit)
    np.testing.assert_array_equal(other.weights[rows], flat[rows])


def test_it_changes_its_own_channels_within_its_range_and_nothing_else() -> None:
    session = session_by_networks(squinting())
    before = session.weights.copy()
    session.add(replace(neutral(session), start=1.0, end=2.0, falloff=0.2))
    times = session.take.clip.times
    outside = (times < 0.8 - 1e-6) | (times > 2.2 + 1e-6)
    np.testing.assert_array_equal(session.weights[outside], before[outside])
    mine = [ARKIT_INDEX[name] for name in session.edits[0].channels]
    others = np.setdiff1d(np.arange(52), [*mine, ARKIT_INDEX["mouthClose"]])
    np.testing.assert_array_equal(session.weights[:, others], before[:, others])
    session.undo()
    np.testing.assert_array_equal(session.weights, before)
