"""Minima and maxima in bins of any size, also after changes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from faceedit_app.core.extremes import STEP, Extremes

BASE = 16


def lowest_and_highest(
    values: NDArray[np.float32], size: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    bins = [values[i : i + size] for i in range(0, len(values), size)]
    return np.array([b.min(axis=0) for b in bins]), np.array([b.max(axis=0) for b in bins])


@given(st.integers(1, 3_000), st.integers(BASE, 900), st.integers(0, 5), st.data())
def test_bins_hold_what_they_cover_also_after_changes(
    rows: int, wanted: int, seed: int, data: st.DataObject
) -> None:
    values = np.random.default_rng(seed).normal(size=(rows, 2)).astype(np.float32)
    extremes = Extremes(lambda some: values[some], rows, 2, base=BASE)
    size = extremes.bin_size(wanted)
    assert wanted / 2 < size <= wanted
    first = data.draw(st.integers(0, rows - 1))
    last = data.draw(st.integers(first, rows))
    values[first:last] += 5.0
    extremes.update(first, last)
    bins = -(-rows // size)
    low, high = extremes.bins(0, bins, size)
    lowest, highest = lowest_and_highest(values, size)
    assert np.array_equal(low, lowest)
    assert np.array_equal(high, highest)
    part = extremes.bins(bins // 2, bins, size)
    assert np.array_equal(part[0], lowest[bins // 2 :])


@pytest.mark.parametrize("base", [100, 128])
def test_blocks_that_are_read_at_a_time_leave_no_seams(base: int) -> None:
    values = np.random.default_rng(1).integers(-9, 9, (70_000, 1)).astype(np.int16)
    extremes = Extremes(lambda some: values[some], len(values), 1, np.int16, base)
    low, high = extremes.bins(0, -(-len(values) // base), base)
    lowest, highest = lowest_and_highest(values.astype(np.float32), base)
    assert low.dtype == np.int16
    assert np.array_equal(low, lowest)
    assert np.array_equal(high, highest)


def test_a_change_reads_what_it_touches_only() -> None:
    read: list[slice] = []
    values = np.zeros((200_000, 1), np.float32)

    def source(rows: slice) -> NDArray[np.float32]:
        read.append(rows)
        return values[rows]

    extremes = Extremes(source, len(values), 1, base=BASE)
    read.clear()
    values[100_000] = 7.0
    extremes.update(100_000, 100_001)
    assert sum(rows.stop - rows.start for rows in read) == BASE
    size = extremes.bin_size(BASE * STEP**3)
    assert extremes.bins(0, -(-len(values) // size), size)[1].max() == 7.0
