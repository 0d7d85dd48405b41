"""How often lips and lids stay open on another character."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.characters.closure import Openings, closure, together
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX


def frames(**channels: list[float]) -> np.ndarray:
    count = max(len(values) for values in channels.values())
    weights = np.zeros((count, 52), np.float32)
    for channel, values in channels.items():
        weights[: len(values), ARKIT_INDEX[channel]] = values
    return weights


def test_gaps_are_what_is_left_between_lips_and_lids() -> None:
    gaps = Openings.of(shipped_rig()).measure(frames(jawOpen=[0, 0.5], eyeBlinkLeft=[0, 1.0]))
    assert gaps[0, 0] == pytest.approx(0, abs=0.01)
    assert gaps[1, 0] > 15
    assert gaps[0, 1] > 6
    assert gaps[1, 1] < 1


def test_lips_that_pass_each_other_are_shut() -> None:
    pressed = frames(jawOpen=[0.3], mouthClose=[0.5])
    assert Openings.of(shipped_rig()).measure(pressed)[0, 0] == 0


def test_lips_that_slide_sideways_are_not_open() -> None:
    rig = shipped_rig()
    upper, lower = rig.control_pairs[CONTROL_INDEX["mouth_opening"]]
    deltas = rig.deltas.copy()
    aside = deltas[rig.channels.index("mouthLeft")]
    aside[[upper, lower]] = [[0.0, 0.0, 0.0], [0.003, 0.0, 0.0]]
    gaps = Openings.of(replace(rig, deltas=deltas)).measure(frames(mouthLeft=[1.0]))
    assert gaps[0, 0] == pytest.approx(0, abs=0.01)


def test_lids_that_a_full_blink_leaves_a_little_apart_are_shut() -> None:
    rig = shipped_rig()
    upper, lower = rig.control_pairs[CONTROL_INDEX["left_eyelid"]]
    blink = rig.channels.index("eyeBlinkLeft")
    for short, left in ((0.0004, 0.0), (0.002, 1.5)):  # metres; mm
        deltas = rig.deltas.copy()
        meeting = rig.neutral[lower] - rig.neutral[upper] + deltas[blink, lower]
        deltas[blink, upper] = meeting + np.array([0.0, short, 0.0])
        gap = Openings.of(replace(rig, deltas=deltas)).measure(frames(eyeBlinkLeft=[1.0]))[0, 1]
        assert gap == pytest.approx(left, abs=0.45)


def test_a_character_compared_with_itself_closes_everywhere() -> None:
    gaps = Openings.of(shipped_rig()).measure(frames(jawOpen=[0, 0, 0.3], eyeBlinkLeft=[1, 0, 0]))
    same = closure(gaps, gaps)
    assert (same.lips_frames, same.lips_open_share) == (2, 0)
    assert (same.lids_frames, same.lids_open_share) == (1, 0)


def test_shares_are_of_what_is_shut_on_ours() -> None:
    ours = np.array([[0, 0, 9], [1, 9, 9], [30, 9, 9]], float)
    theirs = np.array([[3, 0.2, 0], [0.4, 0, 0], [0, 0, 0]], float)
    found = closure(ours, theirs)
    assert (found.lips_frames, found.lips_open_share, found.lips_within_share) == (2, 0.5, 0.5)
    assert (found.lids_frames, found.lids_open_share, found.lids_within_share) == (1, 0, 1)


def test_nothing_shut_is_nothing_open() -> None:
    nothing = closure(together([]), together([]))
    assert (nothing.lips_frames, nothing.lips_open_share, nothing.lids_within_share) == (0, 0, 1)


def test_what_a_character_lacks_is_said() -> None:
    rig = shipped_rig()
    pairs = rig.control_pairs.copy()
    pairs[0] = -1
    assert Openings.of(replace(rig, control_pairs=pairs)).has.tolist() == [False, True, True]
