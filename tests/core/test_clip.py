"""Times and the frames that they mean."""

from __future__ import annotations

import numpy as np
import pytest

from faceedit_app.core.clip import nearest, nearest_rows


@pytest.mark.parametrize("count", [1, 2, 50])
def test_one_time_and_many_mean_the_same_frames(count: int) -> None:
    times = np.cumsum(np.random.default_rng(3).choice([0.25, 0.5, 1.5], count))
    between = (times[1:] + times[:-1]) / 2  # as near to both: the earlier
    wanted = np.concatenate([np.linspace(times[0] - 1, times[-1] + 1, 97), times, between])
    rows = nearest_rows(times, wanted)
    assert rows.tolist() == [nearest(times, one) for one in wanted.tolist()]
    away = np.abs(times[:, None] - wanted)
    np.testing.assert_array_equal(rows, np.argmin(away, axis=0))  # the first of several
