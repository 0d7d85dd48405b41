"""The moments of the picture beside a film side by side."""

from __future__ import annotations

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import Clip
from faceedit_app.tracking.moments import Column, moments, sheet

COUNT, RATE = 100, 25.0
TIMES = np.arange(COUNT) / RATE
LIDS = [ARKIT_INDEX["eyeBlinkLeft"], ARKIT_INDEX["eyeBlinkRight"]]
JAW = ARKIT_INDEX["jawOpen"]


def column(weights: Floats, lost: slice = slice(0, 0)) -> Column:
    kept = np.delete(np.arange(COUNT), lost)
    return Column.of(Clip(weights[kept], ARKIT_CHANNELS, TIMES[kept], RATE), TIMES)


def talking() -> Floats:
    weights = np.zeros((COUNT, len(ARKIT_CHANNELS)), np.float32)
    weights[:, JAW] = 0.3 + 0.3 * np.sin(TIMES * 5.0)
    return weights


def blink(depth: float, width: float) -> Floats:
    shape = depth * np.exp(-(((TIMES - 2.0) / width) ** 2))
    return np.repeat(shape[:, None], 2, axis=1).astype(np.float32)


def test_a_mended_blink_is_shown_where_it_is_shut() -> None:
    before, after = talking(), talking()
    before[:, LIDS], after[:, LIDS] = blink(0.7, 0.04), blink(1.0, 0.12)  # wider as well
    found = moments(column(before), column(after), TIMES, shipped_rig())
    assert len(set(found)) == 4
    assert found == sorted(found)
    assert 50 in found


def test_edits_are_shown_where_the_film_shows_a_face() -> None:
    """Gaps are filled with what is far from the frame before; that is no edit to compare."""
    before, after = talking(), talking()
    after[20:40, JAW] = 1.0
    after[70:, JAW] += 0.2
    found = moments(column(before, slice(20, 40)), column(after), TIMES, shipped_rig())
    assert sum(picture >= 70 for picture in found) >= 3
    assert not [picture for picture in found if 20 <= picture < 40]
    after[70:] = before[70:]
    only = moments(column(before, slice(20, 40)), column(after), TIMES, shipped_rig())
    assert [picture for picture in only if 20 <= picture < 40]


@pytest.mark.parametrize("count", [100, 3])
def test_without_edits_lips_and_lids_are_shown_at_their_ends(count: int) -> None:
    weights = talking()
    weights[:, LIDS] = blink(1.0, 0.05)
    faces = Column(weights, np.arange(count), np.ones(count, np.bool_))
    found = moments(faces, faces, TIMES[:count], shipped_rig())
    assert len(found) == min(4, count)
    jaw = weights[:count, JAW]
    assert {int(jaw.argmin()), int(jaw.argmax())} <= set(found)
    assert count < 51 or 50 in found


def test_each_row_has_its_time_and_each_column_its_title() -> None:
    rows = [np.full((60, 180, 3), 99, np.uint8) for _ in range(2)]
    shown, other = sheet(rows, [0.5, 1.25]), sheet(rows, [0.5, 1.26])
    assert np.array_equal(shown[32:92], rows[0])
    assert np.array_equal(shown[124:184], rows[1])
    assert all(np.ptp(shown[:32, k * 60 : (k + 1) * 60]) > 100 for k in range(3))
    assert np.array_equal(shown[92:124], other[92:124])
    assert not np.array_equal(shown[184:], other[184:])
