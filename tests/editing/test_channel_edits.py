"""Edits of channels: what they do to weights and rotations, and that they touch nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import talking_clip
from support.sessions import engine, session_by_networks, session_by_rig
from support.takes import make_livelink_csv

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.levels import softly_limited
from faceedit_app.editing.edits.channels import is_rotation
from faceedit_app.editing.edits.describe import describe, describe_what
from faceedit_app.editing.edits.edit import Edit, Op, from_json, to_json
from faceedit_app.editing.files.edits_file import read_edits, write_edits
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.neutral import without_rest
from faceedit_app.formats.opening import encoded_take, open_take

JAW, CLOSE = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]
SMILE = ARKIT_INDEX["mouthSmileLeft"]


def of_channels(
    op: Op, *channels: str, value: float = 0.0, span: tuple[float, float] = (1.0, 2.0)
) -> Edit:
    return Edit((), op, *span, 0.2, value, channels=channels)


EDITS = (
    of_channels(Op.OFFSET, "mouthSmileLeft", value=0.2),
    of_channels(Op.SCALE, "jawOpen", "mouthClose", value=0.5, span=(0.5, 9.0)),
    of_channels(Op.SMOOTH, "jawOpen", "mouthSmileLeft", value=0.1, span=(0.0, 30.0)),
    Edit((), Op.DRAW, 1.0, 2.0, 0.1, points=((1.0, 0.1), (2.0, 0.6)), channels=("cheekPuff",)),
    of_channels(Op.LIMIT, "jawOpen", value=0.2),
    Edit((), Op.NEUTRAL, 0.0, 9.0, 0.0, channels=("jawOpen",), amounts=((0.1, 0.6),)),
    Edit((), Op.LEVELS, 0.0, 9.0, 0.0, channels=("jawOpen",), amounts=((1.5, -0.1, 0.8),)),
)


# --- what changes ------------------------------------------------------------------------------


def test_offset_moves_the_named_channel_within_its_falloffs_and_nothing_else() -> None:
    session = session_by_networks(talking_clip())
    before = session.weights.copy()
    session.add(EDITS[0])
    moved = session.weights - before
    times = session.take.clip.times
    hold = (times >= 1.0) & (times <= 2.0)
    np.testing.assert_allclose(moved[hold, SMILE], 0.2, atol=2e-5)
    outside = (times < 0.8 - 1e-6) | (times > 2.2 + 1e-6)
    assert (session.weights[outside] == before[outside]).all()
    others = np.arange(52) != SMILE
    assert (session.weights[:, others] == before[:, others]).all()


def test_channels_are_edited_after_the_curves_have_been_answered() -> None:
    session = session_by_networks(talking_clip())
    session.add(Edit(("mouth_opening",), Op.OFFSET, 1.0, 2.0, 0.2, 6.0))
    answered = session.weights.copy()
    session.add(of_channels(Op.SCALE, "mouthSmileLeft", value=0.0))
    held = (session.take.clip.times >= 1.0) & (session.take.clip.times <= 2.0)
    median = np.median(session.take.clip.arkit_weights()[:, SMILE])
    np.testing.assert_allclose(session.weights[held, SMILE], median, atol=2e-5)
    assert (session.weights[:, JAW] == answered[:, JAW]).all()


def test_smooth_calms_a_channel_without_leaving_its_mean() -> None:
    clip = talking_clip(360)
    rough = clip.weights.copy()
    k = clip.channels.index("mouthSmileLeft")
    rough[:, k] = 0.4 + 0.1 * (np.arange(len(rough)) % 2)
    session = session_by_rig(replace(clip, weights=rough))
    session.add(of_channels(Op.SMOOTH, "mouthSmileLeft", value=0.1, span=(1.0, 4.0)))
    held = (clip.times > 1.0) & (clip.times < 4.0)
    np.testing.assert_allclose(session.weights[held, SMILE], 0.45, atol=0.002)


def test_weights_stay_believable_whatever_is_asked() -> None:
    channels = ("jawOpen", "mouthClose", "mouthSmileLeft")
    for value in (-5.0, 5.0):
        session = session_by_networks(talking_clip())
        session.add(of_channels(Op.OFFSET, *channels, value=value, span=(0.0, 9.0)))
        assert 0 <= session.weights.min() <= session.weights.max() <= 1
        assert (session.weights[:, CLOSE] <= session.weights[:, JAW] + 1e-6).all()


def test_curves_that_nobody_asked_for_are_not_shown_as_missed() -> None:
    session = session_by_rig(talking_clip())
    session.add(of_channels(Op.SCALE, "jawOpen", value=0.5, span=(0.0, 9.0)))
    assert (session.achieved != session.tracked).any()
    assert (session.asked == session.achieved).all()


def test_an_edit_of_channels_asks_for_nothing_at_other_times() -> None:
    """Curves that an edit of other curves has moved a little are not taken for asked for."""
    session = session_by_networks(talking_clip())
    session.add(Edit(("left_corner", "right_corner"), Op.OFFSET, 0.0, 9.0, 0.0, value=3.0))
    asked = session.asked.copy()
    assert not np.array_equal(asked, session.achieved)
    session.add(of_channels(Op.SCALE, "jawOpen", value=0.5))
    times = session.take.clip.times
    outside = (times < 0.8 - 1e-6) | (times > 2.2 + 1e-6)
    np.testing.assert_array_equal(session.asked[outside], asked[outside])
    assert not np.array_equal(session.asked[~outside], asked[~outside])


def test_lips_follow_a_jaw_that_is_lowered() -> None:
    session = session_by_rig(talking_clip())
    session.add(of_channels(Op.SCALE, "jawOpen", value=0.0, span=(0.0, 9.0)))
    session.preview_replace(0, replace(session.edits[0], about=0.0))
    assert session.weights[:, JAW].max() == 0
    assert session.weights[:, CLOSE].max() == 0


def test_soft_limit_keeps_what_is_low_and_the_order_and_never_passes_the_ceiling() -> None:
    values = np.linspace(0.0, 3.0, 400)[:, None]
    limited = softly_limited(values, np.array([0.5]))
    low = values[:, 0] < 0.7 * 0.5
    assert (limited[low] == values[low]).all()
    assert (np.diff(limited[:, 0]) >= 0).all()
    assert limited.max() <= 0.5
    assert np.abs(np.diff(limited[:, 0], n=2)).max() < 1e-3
    np.testing.assert_array_equal(softly_limited(-values, np.array([0.5])), -limited)


def test_neutral_takes_the_rest_away_and_a_blink_keeps_its_peak() -> None:
    values = np.array([[0.3], [0.2], [0.6], [0.9], [1.1]])
    moved = without_rest(values, np.array([0.3]), np.array([0.9]))
    np.testing.assert_allclose(moved[:, 0], [0.0, 0.0, 0.45, 0.9, 1.1])


def test_channel_that_the_take_lacks_is_left_alone() -> None:
    clip = talking_clip()
    keep = [k for k, name in enumerate(clip.channels) if name != "cheekPuff"]
    names = tuple(clip.channels[k] for k in keep)
    session = session_by_rig(replace(clip, channels=names, weights=clip.weights[:, keep]))
    session.add(of_channels(Op.OFFSET, "cheekPuff", "jawOpen", value=0.3))
    assert (session.weights[:, ARKIT_INDEX["cheekPuff"]] == 0).all()
    assert session.changed_frames() > 0


# --- no trace of the way there -----------------------------------------------------------------


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit.op.value)
def test_undo_returns_to_the_bits_of_the_take(edit: Edit) -> None:
    session = session_by_networks(talking_clip())
    before, measured = session.weights.copy(), session.achieved.copy()
    session.add(edit)
    assert session.changed_frames() > 0
    session.undo()
    assert (session.weights == before).all()
    assert (session.achieved == measured).all()


def test_chunks_come_out_alike_in_any_order_and_alone() -> None:
    """A take of several chunks, edited across their borders, the last chunk computed first."""
    clip = talking_clip(1800)
    curve = Edit(("mouth_opening",), Op.OFFSET, 7.0, 18.0, 0.5, 5.0)
    whole = session_by_networks(clip, engine())
    whole.add(curve, *EDITS[:3])
    parts = session_by_networks(clip, engine())
    parts.live.patience = 0.0
    parts.live.look(len(clip) - 1, len(clip) - 2, len(clip) - 1)
    parts.add(EDITS[2])
    parts.put((curve, EDITS[0], EDITS[2]))
    parts.put((curve, *EDITS[:3]))
    parts.live.work()
    assert (parts.weights == whole.weights).all()
    assert (parts.achieved == whole.achieved).all()


def test_smooth_has_no_seam_where_chunks_meet() -> None:
    clip = talking_clip(1800)
    session = session_by_networks(clip, engine())
    session.add(of_channels(Op.SMOOTH, "mouthSmileLeft", value=0.3, span=(0.0, 29.0)))
    whole = smoothed(clip.arkit_weights().astype(np.float64), 0.3 * clip.rate)
    held = clip.times <= 29.0
    np.testing.assert_allclose(session.weights[held, SMILE], whole[held, SMILE], atol=1.1e-5)


# --- files -------------------------------------------------------------------------------------


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit.op.value)
def test_edits_file_keeps_edits_of_channels(edit: Edit, tmp_path: Path) -> None:
    write_edits(tmp_path / "edits.json", [edit])
    assert read_edits(tmp_path / "edits.json") == (edit,)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"channel": "jawopen"}, "unknown channel"),
        ({"channels": ["jawOpen", "jawOpen"]}, "twice"),
        ({"channels": ["jawOpen", "headYaw"]}, "different units"),
        ({"channel": "jawOpen", "control": "mouth_opening"}, "it needs"),
        ({"channel": "jawOpen", "op": "reset"}, "channels have no reset"),
        ({"control": "mouth_opening", "op": "limit"}, 'needs "channels"'),
        ({"channel": "jawOpen", "op": "limit", "value": 0}, "above 0"),
        ({"channel": "jawOpen", "op": "levels"}, "3 amounts"),
        ({"channel": "jawOpen", "op": "levels", "amounts": [[1, 0, 2]]}, "at most 1"),
        ({"channel": "jawOpen", "op": "neutral", "amounts": [[0.5, 0.5]]}, "below its peak"),
        ({"channel": "headYaw", "op": "neutral", "amounts": [[0.1, 0.5]]}, "not rotations"),
        ({"channel": "jawOpen", "amounts": [[1]]}, "no amounts"),
        ({"channel": "jawOpen", "op": "levels", "amounts": [["a"]]}, "not a number"),
    ],
)
def test_wrong_edit_of_channels_is_refused_with_a_reason(
    fields: dict[str, object], message: str
) -> None:
    entry: dict[str, object] = {"op": "offset", "start": 0, "end": 1, "value": 0.1}
    with pytest.raises(ValueError, match=message):
        from_json(entry | fields)


def test_list_of_edits_names_channels_in_plain_words() -> None:
    turned = of_channels(Op.SCALE, "headYaw", "headPitch", "headRoll", value=0.0)
    assert describe(turned) == "Head held still"
    assert describe(EDITS[0]) == "mouthSmileLeft +0.20"
    assert describe(EDITS[4]) == "jawOpen at most 0.20"
    assert describe(EDITS[5]) == "Neutral rest (1 channel)"
    assert describe_what(EDITS[5]) == "1 channel", "it is in the name, so a list need not repeat it"
    assert describe(of_channels(Op.OFFSET, "headYaw", value=-3.0)) == "headYaw −3.0°"


def test_mirrored_edit_is_on_the_other_side() -> None:
    assert EDITS[0].mirrored().channels == ("mouthSmileRight",)
    assert of_channels(Op.OFFSET, "leftEyeYaw").mirrored().channels == ("rightEyeYaw",)
    assert from_json(to_json(EDITS[0].mirrored())) == EDITS[0].mirrored()


# --- rotations ---------------------------------------------------------------------------------


def turning(folder: Path, channel: str = "headYaw") -> EditSession:
    """A Live Link Face take whose head, or eye, turns by up to 20 degrees."""
    path = make_livelink_csv(folder / "take.csv", 3.0)
    lines = path.read_text().splitlines()
    column = lines[0].split(",").index(channel[0].upper() + channel[1:])
    for row, line in enumerate(lines[1:]):
        cells = line.split(",")
        cells[column] = f"{np.radians(20) * np.sin(row / 9):.6f}"
        lines[1 + row] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    return session_by_rig(open_take(path))


def test_head_can_be_held_still_and_only_its_cells_are_written(tmp_path: Path) -> None:
    session = turning(tmp_path)
    assert session.rotations is not None
    source = session.take.path.read_text().splitlines()
    still = Edit((), Op.SCALE, 1.0, 2.0, 0.0, 0.0, about=0.0, channels=("headYaw",))
    session.add(still)
    held = (session.take.clip.times >= 1.0) & (session.take.clip.times <= 2.0)
    assert (session.rotations[held, 0] == 0).all()
    assert session.changed_frames() == held.sum()
    session.export(tmp_path / "out.csv")
    written = (tmp_path / "out.csv").read_text().splitlines()
    yaw = source[0].split(",").index("HeadYaw")
    for row, (old, new) in enumerate(zip(source[1:], written[1:], strict=True)):
        if not held[row]:
            assert old == new
            continue
        cells, before = new.split(","), old.split(",")
        assert float(cells[yaw]) == 0
        assert cells[:yaw] + cells[yaw + 1 :] == before[:yaw] + before[yaw + 1 :]
    session.undo()
    session.export(tmp_path / "same.csv")
    assert (tmp_path / "same.csv").read_bytes() == session.take.path.read_bytes()


def test_rows_that_get_a_face_get_the_edited_rotations(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv", 2.0, untracked=(60, 61))
    take = open_take(path)
    assert take.lost_rows is not None
    assert take.clip.rotations is not None
    weights, straight = take.clip.weights, np.zeros_like(take.clip.rotations)
    content = encoded_take(path, take, weights, weights[[59, 60]], straight)
    (tmp_path / "out.csv").write_bytes(content)
    written = open_take(tmp_path / "out.csv").clip
    assert len(written) == len(take.clip) + 2
    assert written.rotations is not None
    assert (written.rotations == 0).all()


@pytest.mark.parametrize(
    ("channel", "farthest"),
    [("headYaw", 85), ("headPitch", 85), ("headRoll", 180), ("leftEyePitch", 50)],
)
def test_rotations_that_an_edit_makes_wild_are_read_as_they_are_shown(
    channel: str, farthest: float, tmp_path: Path
) -> None:
    """They stay what a head or an eye can be; those beyond it are read as degrees."""
    session = turning(tmp_path, channel)
    for _ in range(2):
        session.add(of_channels(Op.SCALE, channel, value=9.0, span=(0.0, 9.0)))
    assert session.rotations is not None
    most = np.degrees(np.abs(session.rotations).max())
    assert most == pytest.approx(farthest, abs=0.1)
    session.export(tmp_path / "out.csv")
    back = open_take(tmp_path / "out.csv").clip.rotations
    assert back is not None
    np.testing.assert_allclose(back, session.rotations, atol=1e-5)


def test_rotations_are_scaled_and_smoothed_in_degrees(tmp_path: Path) -> None:
    session = turning(tmp_path)
    assert session.rotations is not None
    tracked = session.rotations.copy()
    session.add(of_channels(Op.OFFSET, "headYaw", value=10.0, span=(0.0, 9.0)))
    moved = np.degrees(session.rotations[:, 0] - tracked[:, 0])
    np.testing.assert_allclose(moved, 10.0, atol=0.01)
    session.put((of_channels(Op.SMOOTH, "headYaw", value=1.0, span=(0.0, 9.0)),))
    assert np.ptp(session.rotations[:, 0]) < 0.5 * np.ptp(tracked[:, 0])
    assert (session.rotations[:, 1:] == tracked[:, 1:]).all()
    assert is_rotation("headYaw")
