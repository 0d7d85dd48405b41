"""Edits of a whole take: what changes, what must not, and that the way there leaves no trace."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.edits import offset
from support.faces import talking_clip
from support.sessions import assert_believable, session_by_networks, session_by_rig
from support.takes import make_livelink_csv

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX
from faceedit_app.core.regions import REGIONS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.request import affected
from faceedit_app.formats.opening import open_take

MOUTH = CONTROL_INDEX["mouth_opening"]
LIDS = ("left_eyelid", "right_eyelid")
CLOSE, JAW = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]


def columns(*regions: str) -> list[int]:
    return [ARKIT_INDEX[c] for region in REGIONS if region.id in regions for c in region.channels]


# --- what must not change ----------------------------------------------------------------------


def test_session_without_edits_is_the_take() -> None:
    session = session_by_networks(talking_clip())
    np.testing.assert_array_equal(session.clip_weights(), session.take.clip.weights)
    np.testing.assert_array_equal(session.achieved, session.tracked)
    np.testing.assert_array_equal(session.asked, session.tracked)
    assert session.changed_frames() == 0
    assert session.is_saved


@pytest.mark.parametrize("rate", [12.0, 25.0, 60.0, 120.0])
@pytest.mark.parametrize("control", ["mouth_width", "right_eyelid"])
def test_preserve_leaves_frames_that_no_edit_reaches_bit_for_bit(control: str, rate: float) -> None:
    clip = talking_clip(round(6 * rate), rate)
    session = session_by_networks(clip)
    edit = offset(control, 2.5, 2.8, -3.0)
    session.add(edit)
    first, last = affected(edit)
    beyond = (clip.times < first) | (clip.times > last)
    assert beyond.sum() > 3 * rate
    np.testing.assert_array_equal(session.weights[beyond], clip.weights[beyond])
    np.testing.assert_array_equal(session.asked[beyond], session.tracked[beyond])
    np.testing.assert_array_equal(session.achieved[beyond], session.tracked[beyond])
    inside = (clip.times >= 2.5) & (clip.times <= 2.8)
    assert (session.weights[inside] != clip.weights[inside]).any(axis=1).all()
    assert 0 < session.changed_frames() <= (~beyond).sum()


@pytest.mark.parametrize("mode", list(Mode))
def test_channels_of_other_regions_and_carried_ones_never_change(mode: Mode) -> None:
    session = session_by_networks(talking_clip(), mode=mode)
    session.add(offset("mouth_opening", 1.0, 1.3, 6.0))
    changed = (session.weights != session.take.clip.weights).any(axis=0)
    with_mouth = {c for r in REGIONS for c in r.accompanying}
    along = with_mouth | {"eyeSquintLeft", "eyeSquintRight"}
    assert set(np.flatnonzero(changed)) <= {*columns("lower"), *(ARKIT_INDEX[c] for c in along)}
    assert changed[columns("lower")].all()


def test_corrective_beyond_the_jaw_is_untouched_by_an_edit_of_the_eyes() -> None:
    clip = talking_clip(seed=3)
    clip.weights[:, CLOSE] = clip.weights[:, JAW] + 0.123456
    session = session_by_networks(clip)
    session.add(offset(LIDS, 0.5, 2.5, -2.0))
    lower = columns("lower")
    np.testing.assert_array_equal(session.weights[:, lower], clip.weights[:, lower])


@pytest.mark.parametrize("mode", list(Mode))
def test_resynthesis_and_preserving_reach_over_their_own_frames(mode: Mode) -> None:
    session = session_by_networks(talking_clip(), mode=mode)
    session.add(offset(LIDS, 1.0, 1.3, -3.0))
    changed = (session.weights != session.take.clip.weights).any(axis=1)
    assert changed.all() == (mode is Mode.RESYNTHESIZE)
    assert not (session.weights != session.take.clip.weights)[:, columns("lower")].any()


def test_channels_that_the_take_lacks_stay_absent_and_the_rest_is_edited() -> None:
    absent = {"mouthClose", "mouthFunnel", "eyeBlinkLeft", "browInnerUp"}
    channels = tuple(c for c in ARKIT_CHANNELS[::-1] if c not in absent)
    session = session_by_networks(talking_clip(channels=channels))
    session.add(offset("mouth_opening", 1.0, 1.5, 5.0), offset(LIDS, 1.0, 1.5, -3.0))
    assert not session.weights[:, [ARKIT_INDEX[c] for c in absent]].any()
    assert session.clip_weights().shape == session.take.clip.weights.shape
    assert session.changed_frames() > 20


def test_corrective_stays_where_the_take_has_no_jaw() -> None:
    channels = tuple(c for c in ARKIT_CHANNELS if c != "jawOpen")
    session = session_by_networks(talking_clip(channels=channels))
    session.add(offset("mouth_opening", 1.0, 1.5, -5.0))
    assert (session.weights[:, CLOSE] <= session.take.clip.arkit_weights()[:, CLOSE]).all()


def test_take_without_a_single_modelled_channel_changes_nothing() -> None:
    session = session_by_networks(talking_clip(channels=("tongueOut", "jawLeft")))
    session.add(offset(("mouth_opening", "left_eyelid"), 1.0, 1.5, 5.0))
    np.testing.assert_array_equal(session.clip_weights(), session.take.clip.weights)


def test_tracked_weights_above_one_stay_where_nothing_is_edited_and_end_where_it_is() -> None:
    clip = talking_clip(300)
    blink = ARKIT_INDEX["eyeBlinkLeft"]
    clip.weights[:, blink] = 1.05
    session = session_by_networks(clip)
    session.add(offset(LIDS, 2.0, 2.4, 2.0))
    held = (clip.times >= 2.0) & (clip.times <= 2.4)
    first, last = affected(session.edits[0])
    beyond = (clip.times < first) | (clip.times > last)
    assert (session.weights[beyond, blink] == np.float32(1.05)).all()
    assert session.weights[held, blink].max() <= 1.0
    assert np.isfinite(session.weights).all()


# --- what was asked for ------------------------------------------------------------------------


@pytest.mark.parametrize("naturalness", [0.0, 1.0])
@pytest.mark.parametrize("has_engine", [True, False])
def test_face_goes_where_it_was_asked(has_engine: bool, naturalness: float) -> None:
    clip = talking_clip(240)
    session = session_by_networks(clip) if has_engine else session_by_rig(clip)
    session.configure(Settings(naturalness=naturalness))
    session.add(offset("mouth_opening", 1.5, 2.5, 3.0))
    held = (clip.times >= 1.5) & (clip.times <= 2.5)
    wanted = session.asked[held, MOUTH] - session.tracked[held, MOUTH]
    got = session.achieved[held, MOUTH] - session.tracked[held, MOUTH]
    np.testing.assert_allclose(wanted, 3.0, atol=1e-4)
    # These networks answer nonsense; reach alone brings the mouth there.
    assert np.median(np.abs(got - wanted)) < 0.3


def test_naturalness_changes_the_answer() -> None:
    answers = []
    for naturalness in (0.0, 0.5, 1.0):
        session = session_by_networks(talking_clip(), naturalness=naturalness)
        session.add(offset("mouth_width", 1.0, 1.5, -2.0))
        answers.append(session.weights.copy())
    for one, other in ((0, 1), (1, 2), (0, 2)):
        assert np.abs(answers[one] - answers[other]).max() > 5e-4


@pytest.mark.parametrize("naturalness", [-0.1, 1.5, float("nan"), float("inf")])
def test_naturalness_outside_its_range_is_refused(naturalness: float) -> None:
    with pytest.raises(ValueError, match="naturalness"):
        Settings(naturalness=naturalness)


WILD: dict[str, tuple[Edit, ...]] = {
    "mouth wide for two frames": (offset("mouth_opening", 1.0, 1.0 + 1 / 60, 80.0, 0.0),),
    "lids shut for the whole take": (offset(LIDS, -1.0, 99.0, -20.0),),
    "everything to nothing": (Edit(CONTROL_IDS, Op.SET, 0.0, 99.0, 0.0, 0.0),),
    "everything a metre apart": (Edit(CONTROL_IDS, Op.SET, 0.5, 1.5, 0.0, 1000.0),),
    "scaled to pieces": (Edit(CONTROL_IDS, Op.SCALE, 0.5, 1.5, 0.2, 500.0),),
    "as large as numbers may be": (Edit(CONTROL_IDS, Op.OFFSET, -1e6, 1e6, 1e6, 1e6),) * 3,
}


@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.parametrize("naturalness", [0.0, 1.0])
@pytest.mark.parametrize("name", WILD)
def test_wild_edit_still_gives_a_face(name: str, naturalness: float, mode: Mode) -> None:
    session = session_by_networks(talking_clip(150), mode=mode, naturalness=naturalness)
    session.add(*WILD[name])
    assert_believable(session)
    assert session.changed_frames() > 0


@pytest.mark.parametrize("start", [-8.0, 30.0])
def test_edit_beyond_the_ends_of_the_take_changes_nothing(start: float) -> None:
    session = session_by_networks(talking_clip())
    session.add(offset("mouth_opening", start, start + 1, 8.0))
    np.testing.assert_array_equal(session.weights, session.take.clip.weights)


def test_edit_across_the_end_of_the_take_changes_its_end() -> None:
    session = session_by_networks(talking_clip())
    session.add(offset("mouth_opening", 2.8, 40.0, 4.0), offset("left_eyelid", -9.0, 0.1, -2.0))
    assert_believable(session)
    changed = (session.weights != session.take.clip.weights).any(axis=1)
    assert changed[0]
    assert changed[-1]
    assert not changed[60:90].any()


@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.parametrize("frames", [1, 2, 3])
def test_take_of_hardly_any_frames_can_be_edited(frames: int, mode: Mode) -> None:
    session = session_by_networks(talking_clip(frames), mode=mode)
    for op, value in ((Op.OFFSET, 3.0), (Op.SMOOTH, 0.1), (Op.SCALE, 1.5), (Op.SET, 5.0)):
        session.add(Edit(CONTROL_IDS, op, 0.0, 0.1, 0.1, value))
        assert_believable(session)
    assert session.changed_frames() == frames


def test_take_with_gaps_and_uneven_times_can_be_edited() -> None:
    random = np.random.default_rng(0)
    steps = random.uniform(0.01, 0.03, 200)
    steps[[50, 51, 120]] = (0.5, 2.0, 4.0)
    times = np.concatenate([[0.0], np.cumsum(steps)])
    clip = talking_clip(rate=50.0, times=times)
    session = session_by_networks(clip)
    gap = float(times[51])
    session.add(offset("mouth_opening", gap - 0.2, gap + 0.3, 5.0), offset(LIDS, 9.0, 9.2, -3.0))
    assert_believable(session)
    assert session.changed_frames() > 10
    beyond = np.ones(len(times), bool)
    for first, last in map(affected, session.edits):
        beyond &= (times < first) | (times > last)
    np.testing.assert_array_equal(session.weights[beyond], clip.weights[beyond])


def test_reset_returns_the_face_to_the_take() -> None:
    session = session_by_networks(talking_clip())
    session.add(offset(CONTROL_IDS, 0.5, 2.5, 2.0))
    session.reset(1.0, 2.0)
    inside = (session.take.clip.times >= 1.0) & (session.take.clip.times <= 2.0)
    np.testing.assert_array_equal(session.weights[inside], session.take.clip.weights[inside])
    np.testing.assert_array_equal(session.achieved[inside], session.tracked[inside])
    assert session.changed_frames() > 0
    session.reset(-10.0, 100.0)
    assert session.changed_frames() == 0
    np.testing.assert_array_equal(session.weights, session.take.clip.weights)


def test_smoothing_asks_for_the_same_whatever_else_is_edited() -> None:
    """A Gaussian of half a second reads two seconds to either side, in any window."""
    clip = talking_clip(900)
    smooth = Edit(("mouth_opening",), Op.SMOOTH, 5.0, 6.0, 0.0, 0.5)
    alone = session_by_networks(clip)
    alone.add(smooth)
    expected = alone.asked[300:361, MOUTH].copy()
    without_engine = session_by_rig(clip)
    without_engine.add(smooth)
    np.testing.assert_allclose(without_engine.asked[300:361, MOUTH], expected, atol=1e-3)
    alone.add(offset("left_eyelid", 6.1, 14.0, -1.0))
    np.testing.assert_allclose(alone.asked[300:361, MOUTH], expected, atol=1e-3)


# --- files -------------------------------------------------------------------------------------


def test_export_without_edits_is_the_file_itself(tmp_path: Path) -> None:
    source = make_livelink_csv(tmp_path / "a.csv")
    session = session_by_networks(source)
    session.export(tmp_path / "b.csv")
    assert (tmp_path / "b.csv").read_bytes() == source.read_bytes()


@pytest.mark.parametrize(
    "edit",
    [
        Edit(CONTROL_IDS, Op.SCALE, 0.0, 1.0, 0.0, 1.0),
        Edit((), Op.OFFSET, 0.0, 1.0, 0.0, 4e-6, channels=("jawOpen", "mouthClose")),
        Edit((), Op.OFFSET, 0.0, 1.0, 0.0, 2e-4, channels=("headYaw",)),
    ],
    ids=["scaled by 1", "weight", "degrees"],
)
def test_an_edit_that_changes_less_than_is_written_leaves_every_byte(
    edit: Edit, tmp_path: Path
) -> None:
    """The file has ten decimals; changed weights have five."""
    source = make_livelink_csv(tmp_path / "a.csv", seconds=1)
    session = session_by_rig(source)
    session.add(edit)
    session.export(tmp_path / "b.csv")
    assert (tmp_path / "b.csv").read_bytes() == source.read_bytes()
    assert session.changed_frames() == 0


def test_export_opened_again_is_what_was_on_screen(tmp_path: Path) -> None:
    source = make_livelink_csv(tmp_path / "a.csv", seconds=3, dropped=[40, 41, 42])
    session = session_by_networks(source)
    session.add(offset("mouth_opening", 1.5, 1.8, 6.0))
    assert not session.is_saved
    session.export(tmp_path / "b.csv")
    assert not session.is_saved
    again = session_by_networks(tmp_path / "b.csv")
    np.testing.assert_allclose(again.weights, session.weights, atol=1e-9)
    np.testing.assert_allclose(again.tracked, session.achieved, atol=1e-4)
    before, after = (p.read_bytes().splitlines() for p in (source, tmp_path / "b.csv"))
    assert len(before) == len(after)
    same = [a == b for a, b in zip(before, after, strict=True)]
    assert same.count(False) == session.changed_frames()
    assert b"-0" not in (tmp_path / "b.csv").read_bytes().replace(b",-0.0", b"")


def test_settings_that_answer_no_edit_are_nothing_to_save() -> None:
    session = session_by_rig(talking_clip(100))
    session.configure(Settings().with_exactness(0.7))
    assert session.is_saved
    session.add(Edit(("mouth_opening",), Op.OFFSET, 1.0, 2.0, 0.1, 2.0))
    assert not session.is_saved


def test_edits_saved_and_loaded_give_the_same_export(tmp_path: Path) -> None:
    take = open_take(make_livelink_csv(tmp_path / "a.csv"))
    session = session_by_networks(take)
    session.add(offset("mouth_opening", 0.2, 0.5, 6.0), offset(LIDS, 1.0, 1.3, -3.0))
    session.save_edits(tmp_path / "edits.json")
    other = session_by_networks(take)
    other.load_edits(tmp_path / "edits.json")
    np.testing.assert_array_equal(other.weights, session.weights)
    other.undo()
    assert other.edits == ()


@pytest.mark.parametrize("decimals", [2, 4, 10])
def test_as_many_frames_are_changed_as_rows_of_the_export_differ(
    tmp_path: Path, decimals: int
) -> None:
    """A change below the file's digits is in no row."""
    session = session_by_rig(make_livelink_csv(tmp_path / "take.csv", decimals=decimals))
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.8, 1.2, 0.3, 3.0))
    session.export(tmp_path / "out.csv")
    pairs = zip(
        (tmp_path / "take.csv").read_text().splitlines(),
        (tmp_path / "out.csv").read_text().splitlines(),
        strict=True,
    )
    assert session.changed_frames() == sum(1 for before, after in pairs if before != after) > 0
