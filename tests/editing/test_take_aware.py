"""Answers respect the take: its channels, its range, its closures, both sides of its face."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.faces import shipped_rig
from support.places import SHARED
from support.sessions import demo_take, session_by_networks, shipped_engine, take_of

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX, mirrored_channel
from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIDS, MOUTH_CORNERS
from faceedit_app.core.regions import LOWER
from faceedit_app.editing.edits.edit import Company, Edit, Op
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.files.edits_file import read_edits
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take

MIRROR = [ARKIT_INDEX[mirrored_channel(c)] for c in ARKIT_CHANNELS]
MOUTH = CONTROL_INDEX["mouth_opening"]
RATE = 25.0


def demo() -> Clip:
    """The demo take in ARKit's order."""
    clip = demo_take().clip
    return replace(clip, weights=clip.arkit_weights(), channels=ARKIT_CHANNELS)


def with_weights(clip: Clip, weights: Floats) -> Clip:
    return replace(clip, weights=weights.astype(np.float32))


def without(clip: Clip, *stems: str) -> Clip:
    """The clip as a tracker writes it that never moves some channels."""
    weights = clip.weights.copy()
    weights[:, [i for c, i in ARKIT_INDEX.items() if c.startswith(stems)]] = 0.0
    return with_weights(clip, weights)


def session_on(clip: Clip) -> EditSession:
    return session_by_networks(take_of(clip), shipped_engine())


def held(session: EditSession, start: float, end: float) -> np.ndarray:
    times = session.take.clip.times
    return (times >= start) & (times <= end)


def offset(*controls: str, value: float) -> Edit:
    return Edit(controls, Op.OFFSET, 2.0, 4.0, 0.3, value)


def moved(session: EditSession, stem: str) -> float:
    """Mean change of a channel, or of both sides of it, in the hold of `offset`."""
    rows = held(session, 2.0, 4.0)
    columns = [i for c, i in ARKIT_INDEX.items() if c.startswith(stem)]
    change = (session.weights - session.take.clip.arkit_weights())[rows][:, columns]
    return float(change.mean())


@pytest.mark.parametrize(
    ("controls", "value"),
    [(("mouth_opening",), 6.0), (MOUTH_CORNERS, 3.0), (("mouth_width",), -4.0), (LIDS, -4.0)],
)
def test_channels_that_the_take_never_uses_stay_still(
    controls: tuple[str, ...], value: float
) -> None:
    idle = ("mouthFrown", "mouthStretch", "noseSneer", "browOuterUp")
    session = session_on(without(demo(), *idle))
    session.add(offset(*controls, value=value))
    rows = held(session, 2.0, 4.0)
    columns = [CONTROL_INDEX[c] for c in controls]
    reached = (session.achieved - session.tracked)[rows][:, columns].mean()
    assert reached == pytest.approx(value, abs=0.15 * abs(value))
    for stem in idle:
        assert abs(moved(session, stem)) < 0.005, stem


def test_a_channel_that_a_curve_cannot_do_without_moves_all_the_same() -> None:
    session = session_on(without(demo(), "jawOpen", "mouthClose"))
    session.add(offset("mouth_opening", value=6.0))
    assert moved(session, "jawOpen") > 0.05
    change = (session.achieved - session.tracked)[held(session, 2.0, 4.0), MOUTH]
    assert change.mean() > 5.0


@pytest.mark.parametrize(
    ("controls", "value"), [(("mouth_opening",), 4.0), (MOUTH_CORNERS, 3.0), (LIDS, -4.0)]
)
def test_a_symmetric_request_on_a_symmetric_take_is_answered_symmetrically(
    controls: tuple[str, ...], value: float
) -> None:
    weights = demo().weights
    session = session_on(with_weights(demo(), 0.5 * (weights + weights[:, MIRROR])))
    session.add(offset(*controls, value=value))
    assert session.changed_frames() > 40
    np.testing.assert_allclose(session.weights, session.weights[:, MIRROR], atol=1e-5)


@pytest.mark.parametrize("lid", LIDS)
@pytest.mark.parametrize("falloff", [0.0, 0.15])
def test_a_wink_moves_nothing_of_the_other_eye(lid: str, falloff: float) -> None:
    session = session_on(demo())
    session.add(Edit((lid,), Op.SET, 2.0, 2.3, falloff, 0.0))
    (other,) = {*LIDS} - {lid}
    column = CONTROL_INDEX[other]
    np.testing.assert_array_equal(session.achieved[:, column], session.tracked[:, column])
    rows = held(session, 2.0, 2.3)
    assert session.achieved[rows, CONTROL_INDEX[lid]].min() < 0.5


def test_eyes_that_are_held_shut_are_shut_and_still() -> None:
    weights = demo().weights.copy()
    blinks = [ARKIT_INDEX["eyeBlinkLeft"], ARKIT_INDEX["eyeBlinkRight"]]
    weights[:, blinks] *= 0.8  # blinks of this take leave the eyes a little open
    session = session_on(with_weights(demo(), weights))
    session.add(Edit(LIDS, Op.SET, 2.0, 4.0, 0.3, 0.0))
    rows = held(session, 2.0, 4.0)
    assert session.achieved[rows][:, [CONTROL_INDEX[lid] for lid in LIDS]].max() < 0.1
    columns = [i for c, i in ARKIT_INDEX.items() if c.startswith(("eyeBlink", "eyeSquint"))]
    twitches = np.abs(np.diff(session.weights[rows][:, columns], 2, axis=0))
    assert twitches.max() < 0.05  # single frames opened one eye and squinted by 0.2


@pytest.mark.parametrize("falloff", [0.09, 0.3])
def test_a_blink_moves_the_brows_as_blinks_do_and_not_as_grimaces(falloff: float) -> None:
    clip, weights = demo(), demo().weights.copy()
    for at in (1.0, 8.5):  # eyes shut tight below lowered brows
        tight = np.clip(1.5 - np.abs(clip.times - at) / 0.4, 0.0, 1.0)[:, None]
        for stem, most in (("eyeBlink", 0.9), ("browDown", 0.8), ("eyeSquint", 0.6)):
            sides = [ARKIT_INDEX[f"{stem}{side}"] for side in ("Left", "Right")]
            weights[:, sides] += tight * (most - weights[:, sides])
    session = session_on(with_weights(clip, weights))
    brows = [CONTROL_INDEX[c] for c in ("left_brow", "right_brow")]
    down = session.tracked[:, brows] - np.median(session.tracked[:, brows], axis=0)
    assert down.min() < -4.0
    session.add(Edit(LIDS, Op.SET, 4.0, 4.03, falloff, 0.0, falloff_out=0.21))
    moved_by = (session.achieved - session.tracked)[:, brows]
    assert np.abs(moved_by).max() < 1.0  # nine of ten blinks of people move them by less


@pytest.mark.parametrize(
    ("controls", "value", "unused"),
    [
        (("mouth_width",), -6.0, ("mouthPucker", "mouthFunnel")),
        (MOUTH_CORNERS, 3.0, ("mouthSmile", "mouthStretch")),
    ],
)
def test_a_mouth_does_not_open_for_a_shape_that_the_take_never_makes(
    controls: tuple[str, ...], value: float, unused: tuple[str, ...]
) -> None:
    session = session_on(without(demo(), *unused))
    session.add(offset(*controls, value=value))
    change = session.achieved - session.tracked
    columns = [CONTROL_INDEX[c] for c in controls]
    reached = change[held(session, 2.0, 4.0)][:, columns].mean()
    assert reached == pytest.approx(value, abs=0.5)
    assert np.abs(change[:, MOUTH]).max() < 2.0  # it was 5 and 15


def test_one_corner_of_the_mouth_rises_without_the_other() -> None:
    session = session_on(demo())
    session.add(offset(MOUTH_CORNERS[0], value=3.0))
    change = (session.achieved - session.tracked)[held(session, 2.0, 4.0)]
    mine, other = (change[:, CONTROL_INDEX[c]].mean() for c in MOUTH_CORNERS)
    assert mine == pytest.approx(3.0, abs=0.2)
    assert abs(other) < 1.0


@pytest.mark.parametrize("at", [2.6, 3.4, 5.0, 6.4])
def test_closed_lips_are_the_takes_own_and_do_not_frown(at: float) -> None:
    session = session_on(demo())
    opening = session.tracked[:, MOUTH]
    own = float(np.percentile(opening, 2))
    session.add(Edit(("mouth_opening",), Op.SET, at - 0.06, at + 0.06, 0.1, 0.0))
    rows = held(session, at - 0.06, at + 0.06)
    assert session.achieved[rows, MOUTH].min() == pytest.approx(own, abs=0.5)
    frowns = [ARKIT_INDEX["mouthFrownLeft"], ARKIT_INDEX["mouthFrownRight"]]
    risen = (session.weights - demo().weights)[:, frowns]
    assert risen.max() < 0.01


def test_a_take_that_never_closes_its_lips_closes_them_as_others_do() -> None:
    weights = demo().weights.copy()
    weights[:, ARKIT_INDEX["jawOpen"]] += 0.2
    session = session_on(with_weights(demo(), weights))
    assert session.tracked[:, MOUTH].min() > 4
    session.add(Edit(("mouth_opening",), Op.SET, 3.0, 3.2, 0.1, 0.0))
    assert session.achieved[held(session, 3.0, 3.2), MOUTH].min() == pytest.approx(1.15, abs=0.5)


def test_a_mouth_that_opens_beyond_the_take_opens_as_others_do() -> None:
    rest = np.median(demo().weights, axis=0)
    session = session_on(with_weights(demo(), rest + 0.4 * (demo().weights - rest)))
    session.add(offset("mouth_opening", value=25.0))
    assert (session.achieved - session.tracked)[held(session, 2.0, 4.0), MOUTH].mean() > 24.0
    # Where jaws of people are as open as that, 10 % of the weights are above .45.
    assert moved(session, "mouthFunnel") < 0.4
    corners = session.achieved[:, [CONTROL_INDEX[c] for c in MOUTH_CORNERS]]
    assert np.ptp(corners, axis=0).min() > 3.0  # they go down with the jaw


def test_a_smile_is_one_of_cheeks_dimples_and_eyes() -> None:
    session = session_on(demo())
    session.add(offset(*MOUTH_CORNERS, value=3.0))
    assert moved(session, "mouthSmile") > 0.2
    assert moved(session, "cheekSquint") > 0.08
    assert moved(session, "mouthDimple") > 0.03
    assert moved(session, "eyeSquint") > 0.02
    assert moved(session, "mouthStretch") < 0.25 * moved(session, "mouthSmile")


def test_eyes_that_are_asked_for_do_not_narrow_with_a_smile() -> None:
    session = session_on(demo())
    session.add(offset(*LIDS, value=0.0), offset(*MOUTH_CORNERS, value=3.0))
    assert abs(moved(session, "eyeSquint")) < 0.01


def test_a_pucker_puckers() -> None:
    session = session_on(demo())
    session.add(offset("mouth_width", value=-5.0))
    assert moved(session, "mouthPucker") > 0.25
    assert moved(session, "mouthFrown") < 0.02


def shaken(clip: Clip, *stems: str) -> Clip:
    """The clip as a shaky tracker writes some of its channels."""
    weights = clip.weights.copy()
    random = np.random.default_rng(5)
    for channel, i in ARKIT_INDEX.items():
        if channel.startswith(stems):
            weights[:, i] = np.clip(weights[:, i] + random.normal(0, 0.01, len(weights)), 0, 1)
    return with_weights(clip, weights)


def roughness(weights: Floats) -> np.ndarray:
    rough: np.ndarray = np.sqrt((np.diff(weights.astype(np.float64), 2, axis=0) ** 2).mean(axis=0))
    return rough


def test_a_smooth_lets_no_channel_shake_that_did_not() -> None:
    clip = shaken(without(demo(), "mouthFunnel", "mouthStretch"), "jawOpen", "mouthSmile")
    session = session_on(clip)
    session.add(*(Edit((c,), Op.SMOOTH, 0.0, clip.duration, 0.0, 0.04) for c in LOWER.own))
    before, after = roughness(clip.weights), roughness(session.weights)
    rises = after - before
    assert rises.max() < 0.002, ARKIT_CHANNELS[int(rises.argmax())]
    jaw = ARKIT_INDEX["jawOpen"]
    assert after[jaw] < 0.8 * before[jaw]
    assert roughness(session.achieved)[MOUTH] < 0.8 * roughness(session.tracked)[MOUTH]


@pytest.mark.skipif(not (SHARED / "cases").exists(), reason="shared is absent")
def test_a_take_that_flickered_when_smoothed_is_calm() -> None:
    take = open_take(SHARED / "cases" / "smooth_makes_flicker.csv")
    session = EditSession(take, shipped_rig(), shipped_engine())
    session.add(*read_edits(SHARED / "cases" / "edit_smooth_all_40ms.json"))
    before = roughness(take.clip.arkit_weights())
    assert (roughness(session.weights) - before).max() < 0.002


def damaged(clip: Clip, first: int, other: int, count: int) -> Clip:
    """The clip with a stretch of it replaced by another stretch."""
    weights = clip.weights.copy()
    edge = np.minimum(np.arange(1, count + 1), np.arange(count, 0, -1)) / 4
    share = np.minimum(edge, 1.0)[:, None]
    here, there = clip.weights[first : first + count], clip.weights[other : other + count]
    weights[first : first + count] = share * there + (1 - share) * here
    return with_weights(clip, weights)


def test_a_damaged_stretch_is_restored_by_what_the_rest_of_the_take_does() -> None:
    clip = demo()
    true = session_on(clip).tracked
    columns = [ARKIT_INDEX[c] for c in LOWER.channels]
    errors = []
    for first, other in ((40, 160), (90, 200), (150, 20)):
        broken = damaged(clip, first, other, 40)
        rows = slice(first, first + 40)
        times = clip.times[rows]
        session = session_on(broken)
        session.add(
            *(
                Edit((c,), Op.DRAW, times[0], times[-1], 0.0, points=tuple(
                    zip(times.tolist(), true[rows, CONTROL_INDEX[c]].tolist(), strict=True)
                ))
                for c in LOWER.own
            )
        )  # fmt: skip
        truth = clip.weights[rows][:, columns]
        left = ((session.weights[rows][:, columns] - truth) ** 2).mean()
        errors.append(left / ((broken.weights[rows][:, columns] - truth) ** 2).mean())
    assert np.mean(errors) < 0.2


def test_a_short_take_is_answered_nearly_as_the_networks_do() -> None:
    """Half a second says nothing about a face, so the networks' answer stays."""
    clip = demo()
    brief = Clip(clip.weights[50:63], clip.channels, clip.times[:13], clip.rate)
    session = session_on(brief)
    session.configure(Settings(reach=0.0))
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.0, 1.0, 0.0, 3.0))
    assert (session.achieved - session.tracked)[:, MOUTH].mean() > 1.0


def test_naturalness_moves_the_answer_without_a_jump() -> None:
    session = session_on(demo())
    session.add(offset("mouth_opening", value=4.0))
    found = []
    for naturalness in (0.0, 0.5, 0.501, 1.0):
        session.configure(Settings(naturalness=naturalness, reach=0.0))
        found.append(session.weights.astype(np.float64))
    assert np.abs(found[2] - found[1]).max() < 0.01
    assert np.abs(found[1] - 0.5 * (found[0] + found[3])).max() < 0.05


def test_curves_of_the_take_are_within_what_may_be_asked_for() -> None:
    session = session_on(demo())
    for control in CONTROL_IDS:
        low, high = session.limits[CONTROL_INDEX[control]]
        assert low <= session.tracked[:, CONTROL_INDEX[control]].min()
        assert high >= session.tracked[:, CONTROL_INDEX[control]].max()
    session.add(Edit(("left_eyelid",), Op.OFFSET, 2.0, 3.0, 0.1, -33.9))
    session.add(Edit(("mouth_opening",), Op.OFFSET, 2.0, 3.0, 0.1, 500.0))
    for control in ("left_eyelid", "mouth_opening"):
        low, high = session.limits[CONTROL_INDEX[control]]
        asked = session.asked[:, CONTROL_INDEX[control]]
        assert low - 1e-4 <= asked.min() <= asked.max() <= high + 1e-4


def test_a_pucker_that_begins_inside_a_smile_leaves_the_jaw_alone() -> None:
    take = demo_take()
    session = session_by_networks(take, shipped_engine())
    whole = 0.0, take.clip.duration
    session.add(Edit(MOUTH_CORNERS, Op.OFFSET, *whole, 0.2, 3.0, companions=Company.ALONG))
    smiling = session.achieved[:, MOUTH].copy()
    for start in (2.0, 8.5):
        end = start + 0.4
        session.add(
            Edit(("mouth_width",), Op.OFFSET, start, end, 0.2, -5.0, companions=Company.ALONG)
        )
    # Its curve was met to the hair while it faded in, at the cost of the jaw: by up to 3.6 mm.
    assert np.abs(session.achieved[:, MOUTH] - smiling).max() < 1.0


@pytest.mark.parametrize("lip", ["upper_lip", "lower_lip"])
@pytest.mark.parametrize("value", [-2.5, 2.5])
def test_one_lip_moves_no_other_curve_farther_than_itself(lip: str, value: float) -> None:
    session = session_on(demo())
    session.add(offset(lip, value=value))
    change = session.achieved - session.tracked
    reached = change[held(session, 2.0, 4.0)][:, CONTROL_INDEX[lip]].mean()
    assert reached == pytest.approx(value, abs=0.4)
    # The mouth opened by 4 mm, and its width changed by 6, as in a smile or a pucker.
    assert np.abs(change[:, MOUTH]).max() < 3.0
    corners = [CONTROL_INDEX[c] for c in MOUTH_CORNERS]
    assert np.abs(change[:, corners]).max() < 1.5
    assert np.abs(change[:, CONTROL_INDEX["mouth_width"]]).max() < 3.0


@pytest.mark.parametrize(
    ("first", "second", "most"),
    [
        (("mouth_opening", 6.0), ("mouth_width", 4.0), 0.08),
        (("upper_lip", -2.0), ("mouth_width", -4.0), 0.08),
        (("mouth_opening", -8.0), ("lower_lip", -2.0), 0.12),  # lips cannot shut and be lowered
    ],
)
def test_no_channel_jumps_where_one_edit_begins_inside_another(
    first: tuple[str, float], second: tuple[str, float], most: float
) -> None:
    session = session_on(demo())
    for at in (2.0, 6.0):
        for begins, (control, value) in ((0.0, first), (0.4, second)):
            start = at + begins
            session.add(Edit((control,), Op.OFFSET, start, at + 0.8, 0.2, value))
    change = (session.weights - session.take.clip.arkit_weights()).astype(float)
    assert np.abs(np.diff(change, 2, axis=0)).max() < most  # it was up to 0.45


@pytest.mark.parametrize("lip", ["upper_lip", "lower_lip"])
def test_lips_that_are_pressed_hardly_pass_each_other(lip: str) -> None:
    session = session_on(demo())
    session.add(offset("mouth_opening", value=-40.0))
    session.add(offset(lip, value=6.0))
    vectors = shipped_rig().arkit_distances.vectors(session.weights.astype(float))
    upwards = np.sign(np.median(vectors[:, MOUTH, 1]))
    assert (vectors[:, MOUTH, 1] * upwards).min() > -0.51  # it was -0.9
