"""Long silences are taken out of a sound, and its times can be found again."""

from __future__ import annotations

import numpy as np
import pytest

from faceedit_app.words.denoising import RATE, STEP, without_silence


def test_the_inner_part_of_long_silences_is_left_out() -> None:
    rng = np.random.default_rng(0)
    loud = rng.normal(0, 3000, 2 * RATE)
    still = rng.normal(0, 5, 5 * RATE)
    sound = np.concatenate([still, loud, still, loud, still[: RATE // 2]]).astype(np.int16)
    spoken = without_silence(sound)
    assert len(spoken.samples) / RATE == pytest.approx(0.3 + 2 + 0.6 + 2 + 0.5, abs=0.5)
    for frame in range(0, len(spoken.frames) - 1, 7):
        whole = STEP * int(spoken.frames[frame])
        assert spoken.begin(STEP * frame) == pytest.approx(whole, abs=1e-9)
        assert spoken.end(STEP * (frame + 1)) == pytest.approx(whole + STEP, abs=1e-9)
        assert spoken.inside(whole) == pytest.approx(STEP * frame, abs=1e-9)
        first = round(whole * RATE)
        part = spoken.samples[frame * 160 : frame * 160 + 160]
        assert np.array_equal(part, sound[first : first + 160])
    assert spoken.inside(9.0) == pytest.approx(spoken.inside(11.5))


@pytest.mark.parametrize("sound", [np.zeros(0), np.zeros(RATE * 3), np.full(RATE * 3, 500.0)])
def test_a_sound_of_one_loudness_stays_whole(sound: np.ndarray) -> None:
    samples = sound.astype(np.int16)
    assert np.array_equal(without_silence(samples).samples, samples)
