"""Steps, undo and redo: the edits decide, not the way to them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.edits import offset
from support.faces import talking_clip
from support.sessions import assert_believable, engine, session_by_networks, session_by_rig
from support.takes import livelink_names, make_livelink_csv

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.request import affected
from faceedit_app.formats.opening import open_take

LIDS = ("left_eyelid", "right_eyelid")
CLOSE, JAW = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]


# --- steps -------------------------------------------------------------------------------------


def test_drag_is_one_step_however_often_it_is_previewed() -> None:
    session = session_by_networks(talking_clip())
    before = session.weights.copy()
    for millimetres in (1.0, 2.0, 3.0):
        session.preview(offset("mouth_opening", 1.0, 1.2, millimetres))
        assert session.changed_frames() > 0
    assert session.edits == ()
    assert not session.can_undo
    session.commit()
    assert session.edits == (offset("mouth_opening", 1.0, 1.2, 3.0),)
    session.undo()
    np.testing.assert_array_equal(session.weights, before)
    assert not session.can_undo
    assert session.can_redo


def test_cancelled_drag_leaves_nothing() -> None:
    session = session_by_networks(talking_clip())
    session.preview(offset("mouth_opening", 1.0, 1.2, 5.0))
    session.cancel()
    np.testing.assert_array_equal(session.weights, session.take.clip.weights)
    session.commit()
    assert not session.can_undo


def test_undo_and_redo_go_through_the_same_states() -> None:
    session = session_by_networks(talking_clip())
    states = [session.weights.copy()]
    steps: list[Callable[[], None]] = [
        lambda: session.add(offset("mouth_opening", 0.5, 0.8, 4.0)),
        lambda: session.add(offset("left_eyelid", 0.7, 1.2, -2.0), offset("lower_lip", 2, 2.1, 1)),
        lambda: session.configure(Settings(Mode.RESYNTHESIZE)),
        lambda: session.configure(Settings(Mode.RESYNTHESIZE, 0.5)),
        lambda: session.reset(0.6, 0.9),
        lambda: session.configure(Settings()),
    ]
    for step in steps:
        step()
        states.append(session.weights.copy())
    assert len({state.tobytes() for state in states}) == len(states)
    for expected in states[-2::-1]:
        session.undo()
        np.testing.assert_array_equal(session.weights, expected)
    session.undo()  # nothing left: nothing happens
    for expected in states[1:]:
        session.redo()
        np.testing.assert_array_equal(session.weights, expected)
    session.redo()


def test_new_step_forgets_what_was_undone() -> None:
    session = session_by_networks(talking_clip())
    session.add(offset("mouth_opening", 1.0, 1.2, 5.0))
    session.undo()
    session.add(offset("mouth_width", 1.0, 1.2, 1.0))
    assert not session.can_redo


def test_same_settings_again_are_no_step() -> None:
    session = session_by_networks(talking_clip())
    session.configure(Settings())
    assert not session.can_undo


def test_networks_that_arrive_late_answer_like_those_that_were_there() -> None:
    edits = (offset("mouth_opening", 0.5, 0.8, 4.0), offset(LIDS, 1.5, 1.8, -3.0))
    late = session_by_rig(talking_clip())
    late.add(*edits)
    assert not late.has_engine
    late.use_engine(engine())
    early = session_by_networks(talking_clip())
    early.add(*edits)
    np.testing.assert_array_equal(late.weights, early.weights)
    np.testing.assert_array_equal(late.achieved, early.achieved)


# --- the way there leaves no trace -------------------------------------------------------------

_OPS = (Op.OFFSET, Op.SET, Op.SCALE, Op.SMOOTH, Op.RESET)


@st.composite
def some_edits(draw: st.DrawFn) -> Edit:
    controls = draw(st.lists(st.sampled_from(CONTROL_IDS), min_size=1, max_size=3, unique=True))
    op = draw(st.sampled_from(_OPS))
    start = draw(st.integers(-4, 55)) / 10
    length, falloff = draw(st.sampled_from([0.0, 0.1, 0.7])), draw(st.sampled_from([0.0, 0.2]))
    value = draw(st.sampled_from([-6.0, -1.0, 2.0, 8.0]))
    amount = abs(value) / 10 if op in (Op.SCALE, Op.SMOOTH) else value
    return Edit(tuple(controls), op, start, start + length, falloff, amount)


ACTIONS = st.one_of(
    st.tuples(st.just("add"), some_edits()),
    st.tuples(st.just("preview"), some_edits()),
    st.tuples(st.sampled_from(["commit", "cancel", "undo", "redo"]), st.none()),
    st.tuples(
        st.just("configure"),
        st.builds(Settings, st.sampled_from(Mode), st.sampled_from([0.0, 1.0])),
    ),
)


@given(st.lists(ACTIONS, min_size=2, max_size=12))
@settings(
    deadline=None,
    derandomize=True,
    max_examples=25,
    suppress_health_check=list(HealthCheck),
)
def test_result_depends_on_the_edits_and_not_on_the_way_to_them(
    actions: list[tuple[str, object]],
) -> None:
    clip = talking_clip(180, 30.0, seed=5)
    session = session_by_networks(clip)
    for name, argument in actions:
        getattr(session, name)(*(() if argument is None else (argument,)))
    session.cancel()
    fresh = session_by_networks(clip)
    fresh.configure(session.settings)
    fresh.add(*session.edits)
    for live in ("weights", "asked", "achieved"):
        assert getattr(session, live).tobytes() == getattr(fresh, live).tobytes(), live
    assert session.changed_frames() == fresh.changed_frames()
    assert_believable(session)
    # And what no edit reaches is the take, in the default mode.
    if session.settings.mode is Mode.PRESERVE:
        beyond = np.ones(len(clip), bool)
        for first, last in map(affected, session.edits):
            beyond &= (clip.times < first) | (clip.times > last)
        np.testing.assert_array_equal(session.weights[beyond], clip.weights[beyond])


def test_exports_of_two_ways_to_the_same_edits_have_the_same_bytes(tmp_path: Path) -> None:
    weights = np.clip(np.random.default_rng(0).random((180, 52)), 0, 1)
    take = open_take(make_livelink_csv(tmp_path / "a.csv", weights=weights, names=livelink_names()))
    edits = [offset("mouth_opening", 0.3, 0.6, 5.0), offset(LIDS, 1.6, 1.9, -4.0)]
    straight = session_by_networks(take)
    straight.add(*edits)
    wandering = session_by_networks(take)
    wandering.preview(offset("mouth_opening", 0.2, 2.0, -5.0))
    wandering.configure(Settings(Mode.RESYNTHESIZE))
    wandering.cancel()
    wandering.add(edits[0])
    wandering.add(offset("upper_lip", 0.1, 2.5, 1.0))
    wandering.undo()
    wandering.configure(Settings())
    wandering.preview(edits[1])
    wandering.commit()
    straight.export(tmp_path / "straight.csv")
    wandering.export(tmp_path / "wandering.csv")
    content = (tmp_path / "straight.csv").read_bytes()
    assert content == (tmp_path / "wandering.csv").read_bytes()
    assert content != (tmp_path / "a.csv").read_bytes()
