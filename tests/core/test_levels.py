"""How strongly a character answers each channel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.levels import Levels

JAW, BLINK = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["eyeBlinkLeft"]


def frames(*jaws: float) -> Floats:
    weights = np.full((len(jaws), len(ARKIT_CHANNELS)), 0.3, np.float32)
    weights[:, JAW] = jaws
    return weights


def test_no_levels_keep_every_bit() -> None:
    weights = frames(0.1, 0.7, 1.2, -0.01)
    assert not Levels()
    assert Levels().applied(weights).tobytes() == weights.tobytes()


def test_multiplier_and_offset_change_only_their_channel() -> None:
    shown = Levels({"jawOpen": (1.5, 0.1, 1.0)}).applied(frames(0.0, 0.4, 0.9))
    assert shown[:, JAW] == pytest.approx([0.1, 0.7, 1.45])
    assert (np.delete(shown, JAW, axis=1) == np.float32(0.3)).all()


def test_an_offset_below_zero_takes_nothing_below_zero() -> None:
    shown = Levels({"jawOpen": (1.0, -0.2, 1.0)}).applied(frames(0.1, 0.5, -0.05))
    assert shown[:, JAW] == pytest.approx([0.0, 0.3, -0.05])


def test_a_soft_limit_is_never_passed_and_keeps_the_order() -> None:
    shown = Levels({"jawOpen": (1.0, 0.0, 0.6)}).applied(frames(*np.linspace(0, 1, 50)))
    assert shown[:, JAW].max() < 0.6
    assert (np.diff(shown[:, JAW]) > 0).all()
    assert shown[10, JAW] == pytest.approx(10 / 49)  # far below, it is unchanged


def test_a_rig_shows_its_channels_with_their_levels() -> None:
    rig = replace(shipped_rig(), levels=Levels({"eyeBlinkLeft": (2.0, 0.0, 1.0)}))
    weights = frames(0.2)[0]
    weights[BLINK] = 0.4
    shown = rig.from_arkit(weights)
    assert shown[rig.channel_index["eyeBlinkLeft"]] == pytest.approx(0.8)
    assert weights[BLINK] == np.float32(0.4)
