"""Fill: a stretch of the take is made again from the take's own motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.sessions import demo_take, session_by_networks, session_by_rig

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.clip import Clip, Gap
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIDS, LIP_OPENING
from faceedit_app.editing.edits.describe import describe
from faceedit_app.editing.edits.edit import Edit, Op, from_json, to_json
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.editing.session import EditSession

FILL = Edit(CONTROL_IDS, Op.FILL, 4.0, 5.5, 0.0)


def rows_of(session: EditSession, edit: Edit = FILL) -> slice:
    first, stop = np.searchsorted(
        session.take.clip.times, (edit.span[0] - 1e-9, edit.span[1] + 1e-9)
    )
    return slice(int(first), int(stop))


def jumps(weights: Floats, rows: slice) -> Doubles:
    """(2, 52) the second difference at both ends of a stretch."""
    second = np.diff(weights.astype(np.float64), n=2, axis=0)
    ends: Doubles = np.abs(second[[rows.start - 2, rows.start - 1, rows.stop - 2, rows.stop - 1]])
    return ends


def frozen(first: int, stop: int) -> Clip:
    """The demo take in which the face was lost for some frames."""
    clip = demo_take().clip
    weights = clip.weights.copy()
    weights[first:stop] = weights[first - 1]
    return replace(clip, weights=weights)


def test_a_fill_changes_its_range_and_nothing_else() -> None:
    session = session_by_rig(demo_take())
    session.add(FILL)
    rows = rows_of(session)
    before = demo_take().clip.arkit_weights()
    outside = np.ones(len(before), np.bool_)
    outside[rows] = False
    assert np.array_equal(session.weights[outside], before[outside])
    assert (session.weights[rows] != before[rows]).any(axis=1).mean() > 0.9


@pytest.mark.parametrize("seed", range(4))
def test_both_ends_join_without_a_jump(seed: int) -> None:
    session = session_by_rig(demo_take())
    own = np.abs(np.diff(session.weights.astype(np.float64), n=2, axis=0)).max()
    session.add(replace(FILL, seed=seed))
    assert jumps(session.weights, rows_of(session)).max() <= own


def test_a_lost_face_moves_again_like_the_rest_of_the_take() -> None:
    clip = frozen(240, 300)
    session = session_by_rig(clip)
    start, end = clip.times[240], clip.times[299]
    session.add(Edit(CONTROL_IDS, Op.FILL, float(start), float(end), 0.0))
    moved = np.diff(session.weights[240:300], axis=0).std()
    usual = np.diff(session.weights[:240], axis=0).std()
    assert 0.3 * usual < moved < 3 * usual
    everything = clip.arkit_weights()
    low, high = everything.min(axis=0), everything.max(axis=0)
    assert (session.weights >= low - 1e-5).all()
    assert (session.weights <= high + 1e-5).all()


def test_four_variations_differ_and_each_is_the_same_every_time() -> None:
    results = []
    for seed in (0, 1, 2, 3, 0, 1, 2, 3):
        session = session_by_rig(demo_take())
        session.add(replace(FILL, seed=seed))
        results.append(session.weights.copy())
    for one, again in zip(results[:4], results[4:], strict=True):
        assert np.array_equal(one, again)
    for i in range(4):
        for k in range(i):
            assert np.abs(results[i] - results[k]).max() > 0.05


def test_a_curve_drawn_in_the_range_stays_whichever_came_first() -> None:
    hold = Edit((LIP_OPENING,), Op.SET, 4.5, 4.8, 0.1, 3.0)
    results = []
    for edits in ((hold, FILL), (FILL, hold)):
        session = session_by_networks(demo_take())
        session.put(edits)
        rows = rows_of(session, replace(hold, falloff=0.0))
        kept = session.achieved[rows, CONTROL_INDEX[LIP_OPENING]]
        assert np.abs(kept - 3.0).max() < 0.5
        results.append(session.weights.copy())
    assert np.array_equal(results[0], results[1])


def test_edits_act_on_the_filled_motion() -> None:
    session = session_by_networks(demo_take())
    session.add(FILL)
    filled = session.achieved.copy()
    session.add(Edit((LIP_OPENING,), Op.OFFSET, 4.6, 5.0, 0.1, 2.0))
    rows = rows_of(session, Edit((LIP_OPENING,), Op.OFFSET, 4.6, 5.0, 0.0))
    column = CONTROL_INDEX[LIP_OPENING]
    assert session.asked[rows, column] == pytest.approx(filled[rows, column] + 2.0, abs=0.01)


def test_a_reset_takes_a_fill_away_to_the_bit() -> None:
    session = session_by_rig(demo_take())
    session.add(FILL)
    session.reset(4.0, 5.5)
    assert np.array_equal(session.weights, demo_take().clip.arkit_weights())


def test_a_reset_of_one_curve_brings_that_curve_back() -> None:
    session = session_by_networks(demo_take())
    session.add(FILL)
    session.reset(4.2, 5.2, (LIP_OPENING,))
    rows = rows_of(session, Edit((LIP_OPENING,), Op.RESET, 4.2, 5.2, 0.0))
    column = CONTROL_INDEX[LIP_OPENING]
    assert np.abs(session.achieved[rows, column] - session.tracked[rows, column]).max() < 1.0


def test_a_fill_of_the_lids_leaves_the_mouth() -> None:
    session = session_by_rig(demo_take())
    session.add(replace(FILL, controls=LIDS))
    before = demo_take().clip.weights
    names = demo_take().clip.channels
    jaw, lid = names.index("jawOpen"), names.index("eyeBlinkLeft")
    after = session.clip_weights()
    assert np.array_equal(after[:, jaw], before[:, jaw])
    assert not np.array_equal(after[:, lid], before[:, lid])


def test_strength_goes_part_of_the_way() -> None:
    full, half = (session_by_rig(demo_take()) for _ in range(2))
    full.add(FILL)
    half.add(replace(FILL, strength=0.5))
    rows = rows_of(full)
    middle = 0.5 * (full.weights[rows] + demo_take().clip.arkit_weights()[rows])
    assert np.abs(half.weights[rows] - middle).max() < 1e-4


def test_a_second_fill_beside_the_first_joins_it() -> None:
    session = session_by_rig(demo_take())
    own = np.abs(np.diff(session.weights.astype(np.float64), n=2, axis=0)).max()
    step = 1.0 / demo_take().clip.rate
    second = Edit(CONTROL_IDS, Op.FILL, 5.5 + step, 6.5, 0.0)
    session.put((FILL, second))
    assert jumps(session.weights, rows_of(session, second)).max() <= 1.1 * own


@pytest.mark.parametrize("span", [(0.0, 1.0), (9.0, 20.0)])
def test_a_fill_at_an_end_of_the_take_continues_from_the_other_side(
    span: tuple[float, float],
) -> None:
    session = session_by_rig(demo_take())
    session.add(Edit(CONTROL_IDS, Op.FILL, *span, 0.0))
    assert np.isfinite(session.weights).all()
    assert (np.abs(np.diff(session.weights, axis=0)) < 0.5).all()


def test_a_fill_of_the_whole_take_changes_nothing() -> None:
    session = session_by_rig(demo_take())
    session.add(Edit(CONTROL_IDS, Op.FILL, 0.0, 20.0, 0.0))
    assert np.abs(session.weights - demo_take().clip.arkit_weights()).max() < 1e-5


def test_without_other_motion_a_fill_is_a_smooth_way_across() -> None:
    clip = demo_take().clip
    short = replace(clip, weights=clip.weights[:40], times=clip.times[:40], timecodes=None, gaps=())
    session = session_by_rig(short)
    start, end = float(clip.times[6]), float(clip.times[34])
    session.add(Edit(CONTROL_IDS, Op.FILL, start, end, 0.0))
    assert np.abs(np.diff(session.weights, axis=0)).max() < 0.2


def test_motion_runs_through_a_gap() -> None:
    clip = demo_take().clip
    kept = np.r_[0:200, 215 : len(clip)]
    clip = replace(
        clip,
        weights=clip.weights[kept],
        times=clip.times[kept],
        gaps=(Gap(199, 15),),
        timecodes=None,
    )
    session = session_by_rig(clip)
    start, end = float(clip.times[199]) - 0.1, float(clip.times[200]) + 0.1
    session.add(Edit(CONTROL_IDS, Op.FILL, start, end, 0.0))
    assert np.isfinite(session.weights).all()
    assert session.changed_frames() > 5


def test_motion_follows_a_guide() -> None:
    """The loudness of the sound asks for an opening; the donors come near it."""
    session = session_by_rig(demo_take())
    rows, column = rows_of(session), CONTROL_INDEX[LIP_OPENING]
    times, opening = demo_take().clip.times, session.tracked[:, column]
    shape = opening[60 : 60 + rows.stop - rows.start].astype(np.float64)
    points = tuple(zip(times[rows].tolist(), shape.tolist(), strict=True))
    session.add(FILL)
    free = session.achieved[rows, column].copy()
    session.put([replace(FILL, points=points)])
    guided = session.achieved[rows, column]
    assert np.abs(guided - shape).mean() < np.abs(free - shape).mean()


def test_parts_come_out_as_in_the_whole_and_order_of_gestures_does_not_matter() -> None:
    edits = (
        FILL,
        Edit(CONTROL_IDS, Op.FILL, 7.5, 9.0, 0.1, seed=2),
        Edit((LIP_OPENING,), Op.SMOOTH, 5.0, 8.0, 0.2, 0.1),
    )
    whole = session_by_networks(demo_take())
    whole.put(edits)
    slow = session_by_networks(demo_take())
    for i in (2, 1, 0):
        slow.put([edits[i]])
    slow.put(edits[:1])
    slow.put(edits)
    assert np.array_equal(whole.weights, slow.weights)
    slow.undo()
    slow.redo()
    assert np.array_equal(whole.weights, slow.weights)


def test_resynthesize_keeps_fills() -> None:
    session = session_by_networks(demo_take(), mode=Mode.RESYNTHESIZE)
    session.add(FILL)
    filled = session.weights.copy()
    preserved = session_by_networks(demo_take())
    preserved.add(FILL)
    assert np.array_equal(filled, preserved.weights)


def test_a_fill_is_read_and_written() -> None:
    edit = replace(FILL, seed=3, points=((4.0, 2.0), (5.5, 8.0)))
    assert from_json(to_json(edit)) == edit
    assert from_json(to_json(FILL)) == FILL
    assert describe(edit) == "Fill"
    with pytest.raises(ValueError, match="seed"):
        Edit((LIP_OPENING,), Op.OFFSET, 0.0, 1.0, 0.0, seed=1)
    with pytest.raises(ValueError, match="whole number"):
        from_json(to_json(FILL) | {"seed": 1.5})
