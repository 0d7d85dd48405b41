"""Time that is cut out or inserted: what changes, what does not, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.places import SHARED
from support.takes import make_livelink_csv

from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.edits.clock import CROSSFADE
from faceedit_app.editing.edits.splice import LONGEST_INSERT, Splice, splice
from faceedit_app.formats import livelink
from faceedit_app.formats.faceless import Faceless
from faceedit_app.formats.gaps import find_gaps
from faceedit_app.formats.opening import open_take

PHONE = SHARED / "data" / "livelink" / "S07-001.csv"
RATE = 30.0
EASE = 0.15


def wavy(seconds: float = 4.0) -> Clip:
    """A clip whose channels move, each in its own way, and whose head turns."""
    times = np.arange(round(seconds * RATE)) / RATE
    jaw = 0.4 + 0.3 * np.sin(5 * times)
    weights = np.stack([jaw, 0.5 * jaw, 0.2 + 0.2 * np.cos(3 * times)], axis=1)
    turns = np.outer(0.1 * times, np.arange(9))
    names = ("jawOpen", "mouthClose", "mouthFunnel")
    return Clip(weights.astype(np.float32), names, times, RATE, rotations=turns.astype(np.float32))


CLIP = wavy()


def test_a_cut_changes_nothing_beyond_where_both_sides_are_mixed() -> None:
    found = splice(CLIP, [Splice(1.0, 2.0)]).clip
    assert len(found) == len(CLIP) - 30
    np.testing.assert_allclose(np.diff(found.times), 1 / RATE, atol=1e-9)
    before, after = CLIP.times < 1.0 - CROSSFADE, CLIP.times > 2.0 + CROSSFADE
    for one, other in ((found.weights, CLIP.weights), (found.rotations, CLIP.rotations)):
        assert one is not None
        assert other is not None
        assert np.array_equal(one[: before.sum()], other[before])
        assert np.array_equal(one[-after.sum() :], other[after])
    steps = np.abs(np.diff(found.weights, axis=0)).max()
    assert steps < 3 * np.abs(np.diff(CLIP.weights, axis=0)).max()


def test_inserted_time_is_a_rest_with_the_pose_of_its_frame() -> None:
    made = splice(CLIP, [Splice(2.0, 2.0, 1.0)])
    found = made.clip
    assert len(found) == len(CLIP) + 30
    resting = (found.times > 2.0 + EASE) & (found.times < 3.0 - EASE)
    assert np.ptp(found.weights[resting], axis=0).max() == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(found.weights[75], CLIP.weights[60], atol=1e-6)
    assert np.array_equal(found.weights[:55], CLIP.weights[:55])
    assert np.array_equal(found.weights[96:], CLIP.weights[66:])
    assert (np.abs(np.diff(found.weights, axis=0)) < 0.06).all()


def test_several_are_made_at_the_times_of_the_take() -> None:
    made = splice(CLIP, [Splice(3.0, 3.0, 0.5), Splice(0.0, 0.5), Splice(1.0, 1.5)])
    assert len(made.clip) == len(CLIP) - 15
    np.testing.assert_allclose(
        made.at(np.array([0.2, 0.5, 0.9, 1.2, 1.5, 2.9, 3.0, 3.5])),
        [0.0, 0.0, 0.4, 0.5, 0.5, 1.9, 2.5, 3.0],
        atol=1e-9,
    )
    np.testing.assert_allclose(
        made.moments(np.array([0.0, 0.4, 0.6, 1.9, 2.2, 2.6])), [0.5, 0.9, 1.6, 2.9, 3.0, 3.1]
    )


@pytest.mark.parametrize(
    ("one", "frames"),
    [
        (Splice(0.0, 1.0), slice(30, None)),
        (Splice(3.0, CLIP.duration), slice(None, 90)),
    ],
    ids=str,
)
def test_a_cut_at_an_end_leaves_the_rest_to_the_bit(one: Splice, frames: slice) -> None:
    found = splice(CLIP, [one]).clip
    assert np.array_equal(found.weights, CLIP.weights[frames])
    assert found.times[0] == 0.0


@pytest.mark.parametrize("at", [0.0, CLIP.duration])
def test_time_inserted_at_an_end_holds_that_frame(at: float) -> None:
    made = splice(CLIP, [Splice(at, at, 0.5)])
    held = made.clip.weights[:15] if at == 0 else made.clip.weights[-15:]
    assert (held == CLIP.weights[0 if at == 0 else -1]).all()
    assert len(made.clip) == len(CLIP) + 15


ranges = st.tuples(st.floats(0, 4), st.floats(0, 4), st.sampled_from((0.0, 0.0, 0.02, 0.3, 2.0)))


@given(st.lists(ranges, min_size=1, max_size=4))
def test_any_splices_give_a_take_without_jumps_or_a_refusal(
    given_: list[tuple[float, float, float]],
) -> None:
    wanted = [Splice(a, a, s) if s else Splice(min(a, b), max(a, b)) for a, b, s in given_]
    try:
        made = splice(CLIP, wanted)
    except FaceEditError:
        return
    found = made.clip
    assert (np.diff(found.times) > 0.9 / RATE).all()
    assert found.weights.shape == (len(found.times), 3)
    assert (found.weights >= CLIP.weights.min(axis=0) - 1e-6).all()
    assert (found.weights <= CLIP.weights.max(axis=0) + 1e-6).all()
    assert (found.weights[:, 1] <= found.weights[:, 0] + 1e-6).all()  # lips before the jaw
    moments = np.linspace(0, CLIP.duration, 50)
    assert (np.diff(made.at(moments)) >= -1e-9).all()


@given(st.lists(ranges, min_size=1, max_size=4), st.integers(1, 100), st.integers(1, 40))
def test_any_splices_around_a_gap_give_a_take_without_foreign_frames_or_a_refusal(
    given_: list[tuple[float, float, float]], first: int, missing: int
) -> None:
    clip = with_gap(first, min(first + missing, len(CLIP) - 1))
    wanted = [Splice(a, a, s) if s else Splice(min(a, b), max(a, b)) for a, b, s in given_]
    try:
        made = splice(clip, wanted)
    except FaceEditError:
        return
    found = made.clip
    assert found.times[0] == 0.0
    assert (np.diff(found.times) > 0.9 / RATE).all()
    ends = made.pieces[-1].end + made.pieces[-1].later
    assert found.duration == pytest.approx(ends)
    # If each lost frame has a row, the new take has neither holes nor two rows at one time.
    lost = CLIP.times[~np.isin(CLIP.times, clip.times)]
    rows = made.without_face(Faceless(np.arange(len(lost)), lost))
    times = np.concatenate([found.times, rows.times])
    np.testing.assert_allclose(np.sort(times), np.arange(len(times)) / RATE, atol=1e-6)
    assert (np.diff(rows.times) > 0).all()
    moments = np.linspace(0, clip.duration, 50)
    assert (np.diff(made.at(moments)) >= -1e-9).all()


@pytest.mark.parametrize(
    ("wanted", "says"),
    [
        ([], "Nothing"),
        ([Splice(1.0, 1.0)], "over 0 s"),
        ([Splice(2.0, 1.0)], "over 0 s"),
        ([Splice(1.0, 9.0)], "outside the take"),
        ([Splice(9.0, 9.0, 1.0)], "outside the take"),
        ([Splice(0.0, CLIP.duration)], "Nothing would be left"),
        ([Splice(1.0, 2.0), Splice(1.5, 2.5)], "cut out already"),
        ([Splice(1.0, 1.0, LONGEST_INSERT + 1)], "can be inserted"),
        ([Splice(1.0, 1.0, float("nan"))], "can be inserted"),
    ],
    ids=str,
)
def test_what_cannot_be_is_one_line(wanted: list[Splice], says: str) -> None:
    with pytest.raises(FaceEditError, match=says):
        splice(CLIP, wanted)


def with_gap(first: int, stop: int, clip: Clip = CLIP) -> Clip:
    """The clip without some frames, whose weights are far from the others'."""
    kept = np.delete(np.arange(len(clip)), range(first, stop))
    turns = None if clip.rotations is None else clip.rotations[kept]
    times = clip.times[kept]
    gaps = find_gaps(times, clip.rate)
    return replace(clip, weights=clip.weights[kept], times=times, gaps=gaps, rotations=turns)


@pytest.mark.parametrize(
    ("one", "before", "missing"),
    [
        (Splice(0.8, 1.2), 24, 24),  # into the gap
        (Splice(0.8, 1.0), 24, 30),  # up to it
        (Splice(1.2, 1.8), 30, 12),  # inside
        (Splice(1.51, 1.52), 30, 29),  # a frame of it
        (Splice(1.8, 2.2), 30, 24),  # out of it
        (Splice(2.0, 2.4), 30, 30),  # from its end
        (Splice(29.5 / 30, 2.01), 30, 0),  # all of it
        (Splice(0.8, 2.4), 24, 0),  # it, and frames around it
        (Splice(1.5, 1.5, 1.0), 30, 60),
        (Splice(1.0, 1.0, 1.0), 30, 60),
        (Splice(29 / 30, 29 / 30, 1.0), 60, 30),  # a frame has a face, also beside a gap
        (Splice(2.0, 2.0, 1.0), 30, 30),
    ],
    ids=str,
)
def test_in_a_gap_as_much_time_is_cut_out_or_inserted_as_elsewhere(
    one: Splice, before: int, missing: int
) -> None:
    clip, whole = with_gap(30, 60), splice(CLIP, [one])
    made = splice(clip, [one])
    assert made.clip.duration == pytest.approx(whole.clip.duration)
    assert [(gap.frame + 1, gap.missing) for gap in made.clip.gaps] == [(before, missing)][:missing]
    moments = np.linspace(0.0, clip.duration, 121)
    np.testing.assert_allclose(made.at(moments), whole.at(moments), atol=1e-9)
    # Frames beyond the place, and those beyond the gap, keep their weights to the bit.
    far = (clip.times < one.start - EASE) | (clip.times > one.end + EASE)
    if missing:
        far |= (clip.times > 1.5) if one.end < 1.9 else (clip.times < 1.5)
    shown = np.searchsorted(made.clip.times, made.at(clip.times[far]) - 1e-6)
    assert np.array_equal(made.clip.weights[shown], clip.weights[far])
    assert bool(made.notes) == bool(one.seconds and missing == 60)


@pytest.mark.parametrize(
    ("one", "left", "says"),
    [
        (Splice(0.0, 1.5), slice(30, None), "begin where the face is lost, so 0.00 to 2.00 s"),
        (
            Splice(1.5, CLIP.duration),
            slice(None, 30),
            "end where the face is lost, so 1.00 to 4.00",
        ),
    ],
    ids=str,
)
def test_a_take_that_would_begin_or_end_in_a_gap_says_what_is_cut_out(
    one: Splice, left: slice, says: str
) -> None:
    clip = with_gap(30, 60)
    made = splice(clip, [one])
    assert np.array_equal(made.clip.weights, clip.weights[left])
    assert made.clip.times[0] == 0.0
    (note,) = made.notes
    assert says in note


def test_the_face_rests_between_those_around_a_single_lost_frame() -> None:
    clip = with_gap(30, 31)
    found = splice(clip, [Splice(1.0, 1.0, 1.0)]).clip
    assert [gap.missing for gap in found.gaps] == [1]
    assert found.duration == pytest.approx(5.0)
    resting = found.weights[(found.times > 1.0 + EASE) & (found.times < 2.0 - EASE)]
    np.testing.assert_allclose(resting, np.tile(CLIP.weights[30], (len(resting), 1)), atol=2e-3)


def test_gaps_and_timecodes_go_with_the_frames(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv", seconds=3.0, dropped=(40, 41))
    clip = open_take(path).clip
    found = splice(clip, [Splice(1.0, 1.5)]).clip
    assert [gap.missing for gap in found.gaps] == [gap.missing for gap in clip.gaps] == [2]
    assert clip.timecodes is not None
    assert found.timecodes == clip.timecodes[: len(found)]


def test_the_tracker_s_confidence_goes_with_its_frames() -> None:
    sure = np.linspace(0.0, 1.0, len(CLIP)).astype(np.float32)
    clip = replace(CLIP, confidence=sure)
    found = splice(clip, [Splice(0.5, 1.0)]).clip
    assert found.confidence is not None
    cut = len(clip) - len(found)
    first = clip.frame_at(0.5)
    np.testing.assert_array_equal(found.confidence, np.delete(sure, range(first, first + cut)))


@pytest.mark.skipif(not PHONE.is_file(), reason="no recordings of a phone here")
def test_rows_of_a_phone_keep_their_bytes_before_and_their_weights_after() -> None:
    clip = open_take(PHONE).clip
    found = splice(clip, [Splice(1.0, 1.5)]).clip
    old, new = PHONE.read_bytes().splitlines(), livelink.write(found).splitlines()
    assert new[1:27] == old[1:27]
    weights = [line.split(b",", 2)[2] for line in old[-1900:]]
    assert [line.split(b",", 2)[2] for line in new[-1900:]] == weights
