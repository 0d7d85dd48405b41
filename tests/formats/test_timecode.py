"""Timecodes say more than they seem to, and less: what is derived, and what is admitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.dialects import DIALECTS, clock, drop_frame, milliseconds, whole_frames
from support.takes import timecode

from faceedit_app.formats.gaps import find_gaps
from faceedit_app.formats.rates import sure_notes
from faceedit_app.formats.timecode import (
    BadTimecode,
    clock_times,
    derive_base,
    derive_timing,
    is_clock,
    parse_timecodes,
)
from faceedit_app.formats.timing import NoTimes, Timing, format_rate, format_time


def codes(frames: list[float], base: int = 60, start: float = 3_000_000) -> list[str]:
    return [timecode(start + frame, base) for frame in frames]


def every(step: float, rows: int) -> list[float]:
    return [i * step for i in range(rows)]


def timing_of(texts: list[str]) -> Timing:
    return clock_times(texts) if is_clock(texts[0]) else derive_timing(texts)


def gaps_of(timing: Timing) -> list[tuple[int, int]]:
    return [(gap.frame, gap.missing) for gap in find_gaps(timing.times, timing.rate)]


def test_thousandths_are_of_a_frame_and_not_of_a_second() -> None:
    stamps = parse_timecodes(["01:02:03:35.273"])
    assert stamps.clock[0] == 3723
    assert stamps.frames[0] == 35.273


@pytest.mark.parametrize("text", ["00:00:01:12", "00:00:01;12", "00;00;01;12", "00:00:01:12.0"])
def test_common_spellings_mean_the_same(text: str) -> None:
    stamps = parse_timecodes([text])
    assert (stamps.clock[0], stamps.frames[0]) == (1, 12.0)


@pytest.mark.parametrize(
    "text",
    ["", "abc", "1.5", "00:00:01", "100:00:00:00", "00:60:00:00", "00:00:60:00", "٠١:02:03:04"],
)
def test_a_text_that_is_no_timecode_is_refused_with_its_row(text: str) -> None:
    with pytest.raises(BadTimecode) as caught:
        derive_timing(["00:00:00:00", text])
    assert caught.value.row == 1


@pytest.mark.parametrize("base", [24, 25, 30, 48, 50, 60, 100, 120])
def test_the_base_shows_where_the_second_rolls_over(base: int) -> None:
    texts = codes(every(1, base * 3), base)
    timing = derive_timing(texts)
    assert derive_base(parse_timecodes(texts))[0] == base
    assert timing.rate == base
    assert timing.notes == ()


def test_thirty_fps_on_a_sixty_fps_timecode_is_seen_and_said() -> None:
    timing = derive_timing(codes(every(1.9997, 300)))
    assert timing.rate == 30
    (note,) = timing.notes
    assert note == (
        "30 fps: the timecode counts 60 frames a second, 2 from row to row, as from a camera "
        "slower than its timecode; if it has another frame rate, set that: Take > Frame rate, "
        "or the option fps"
    )
    assert sure_notes(timing.notes) == ()
    assert timing.times[-1] == pytest.approx(299 * 1.9997 / 60, abs=1e-4)


def test_a_camera_that_drifts_keeps_its_own_times() -> None:
    timing = derive_timing(codes(every(1.0016, 600)))
    assert timing.rate == 60
    assert timing.times[-1] == pytest.approx(599 * 1.0016 / 60, abs=1e-4)


def test_a_broadcast_rate_is_believed_only_on_evidence() -> None:
    assert derive_timing(codes(every(1.001, 600))).rate == pytest.approx(59.94006)
    assert derive_timing(codes(every(1, 600))).rate == 60
    assert derive_timing(codes(every(1, 600), 24)).rate == 24


def test_drop_frame_numbers_are_not_gaps() -> None:
    before = [f"00:00:59;{frame:02d}" for frame in range(30)]
    after = [f"00:01:00;{frame:02d}" for frame in range(2, 30)]
    timing = derive_timing(before + after)
    assert timing.rate == pytest.approx(29.97003)
    assert gaps_of(timing) == []


def test_lost_frames_are_gaps_with_their_length() -> None:
    rows = [frame for frame in every(1.9997, 300) if not 99 < frame < 109 and not 200 < frame < 203]
    timing = derive_timing(codes(rows))
    assert [missing for _, missing in gaps_of(timing)] == [5, 1]
    assert timing.rate == 30


@pytest.mark.parametrize(("base", "step"), [(60, 2), (60, 1), (30, 1), (24, 1)])
def test_frames_lost_as_the_only_second_ends_make_no_unusual_base(base: int, step: int) -> None:
    rows = [frame for i, frame in enumerate(every(step, 37)) if not 9 < i < 13]
    for start in range(base - 13 * step, base - 9 * step):
        timing = derive_timing(codes(rows, base, 1000 * base + start + 0.58))
        assert timing.rate == base / step
        assert gaps_of(timing) == [(9, 3)]


def test_a_base_that_lost_frames_leave_open_is_admitted() -> None:
    rows = [frame for i, frame in enumerate(every(1, 37)) if not 9 < i < 13]
    timing = derive_timing(codes(rows, 25, 25_013))  # as well 24 frames a second and two lost
    assert "25 fps is assumed" in timing.notes[0]
    assert gaps_of(timing) == [(9, 3)]


@pytest.mark.parametrize(("base", "lost"), [(25, (24,)), (25, (25,)), (50, (48, 49)), (50, (50,))])
def test_a_base_next_to_another_is_admitted_if_one_second_ends(
    base: int, lost: tuple[int, ...]
) -> None:
    """25 frames a second of which the last is lost look like 24."""
    rows = [float(frame) for frame in range(base - 9, base + 9) if frame not in lost]
    timing = derive_timing(codes(rows, base, 1000 * base))
    assert timing.rate == base or "is assumed" in timing.notes[0]
    unbroken = derive_timing(codes(every(1, 3 * base), base, 1000 * base))
    assert (unbroken.rate, unbroken.notes) == (base, ())


@pytest.mark.parametrize("lost", [(29, 30), (30, 31), (31, 32), (28, 31)])
def test_frames_lost_around_a_full_minute_are_drop_frame_only_if_those_numbers_are(
    lost: tuple[int, int],
) -> None:
    rows = [frame for frame in every(1, 90) if frame not in lost]
    timing = derive_timing(codes(rows, 30, 30 * (600 + 59)))
    dropped = lost == (30, 31)
    assert timing.rate == (pytest.approx(29.97003) if dropped else 30)
    assert any("drop-frame" in note for note in timing.notes) == dropped
    assert sum(missing for _, missing in gaps_of(timing)) == (0 if dropped else 2)


def test_numbers_lost_as_seconds_end_do_not_count_at_a_broadcast_rate() -> None:
    lost = {8 + 30 * k + j for k in range(4) for j in range(2)}
    rows = [frame for frame in every(1, 130) if frame not in lost]
    assert derive_timing(codes(rows, 30, 30 * 36_000 - 8)).rate == 30


def test_midnight_does_not_turn_time_back() -> None:
    timing = derive_timing(codes(every(1, 120), start=24 * 3600 * 60 - 60))
    assert timing.times[-1] == pytest.approx(119 / 60)
    assert gaps_of(timing) == []


def test_a_timecode_from_a_jittering_clock_is_replaced_by_even_rows() -> None:
    steps = np.random.default_rng(1).choice([0, 1, 2], size=609, p=[0.21, 0.6, 0.19])
    timing = derive_timing(codes([0, *np.cumsum(steps).tolist()]))
    assert timing.rate == 60
    assert np.allclose(np.diff(timing.times), 1 / 60)
    assert "evenly spaced at 60 fps" in timing.notes[-1]


def test_twenty_five_fps_on_whole_frames_of_sixty_becomes_even() -> None:
    timing = derive_timing(codes([float(int(i * 2.4)) for i in range(250)]))
    assert timing.rate == 25
    assert gaps_of(timing) == []


@pytest.mark.parametrize(
    ("texts", "says"),
    [
        (["10:00:00:00"] * 5, "the same timecode in every row"),
        ([f"{clock(i)}:00.000" for i in range(64)], "step by 1 s"),
        ([f"{clock(86_400 - (i + 1) % 2)}:{i:02d}" for i in range(60)], "do not run forward"),
    ],
    ids=["stands still", "a second a row", "flips over midnight"],
)
def test_a_timecode_that_cannot_be_the_time_is_not_believed(texts: list[str], says: str) -> None:
    with pytest.raises(NoTimes, match=says):
        derive_timing(texts)


def test_one_repeated_timecode_moves_no_other_row() -> None:
    frames = every(1, 300)
    frames[100] = frames[99]
    timing = derive_timing(codes(frames))
    assert timing.times[101] == pytest.approx(101 / 60)
    assert 99 / 60 < timing.times[100] < 101 / 60
    assert any("repeat" in note for note in timing.notes)


@pytest.mark.parametrize(
    ("start", "says"),
    [(2_990_000, "jumps back 1 time"), (1_000_000, "by more than an hour 1 time")],
)
def test_two_recordings_in_one_file_follow_one_another(start: int, says: str) -> None:
    timing = derive_timing(codes(every(1, 200)) + codes(every(1, 200), start=start))
    assert timing.times[-1] == pytest.approx(399 / 60)
    assert any(says in note for note in timing.notes)


def test_a_single_row_is_allowed() -> None:
    timing = derive_timing(["10:00:00:12.5"])
    assert timing.times.tolist() == [0.0]
    assert timing.rate == 60
    assert "single frame" in timing.notes[0]


def test_an_assumed_base_is_admitted() -> None:
    timing = derive_timing(codes(every(1, 10)))
    assert timing.rate == 60
    assert "60 fps is assumed" in timing.notes[0]


@pytest.mark.parametrize("lost", [range(20, 30), range(11, 40), (3, 25, 26, 49, 50, 51)])
def test_a_base_that_the_last_frame_of_a_second_shows_is_not_assumed(lost: Sequence[int]) -> None:
    """25 fps on a base of 60: after frame 57.6 a second ends, whatever is lost elsewhere."""
    rows = [frame for i, frame in enumerate(every(2.4, 75)) if i not in lost]
    timing = derive_timing(codes(rows))
    assert timing.rate == 25
    (note,) = timing.notes
    assert note.startswith("25 fps: the timecode counts 60 frames a second, 2.4 from row")


@settings(deadline=None, derandomize=True)
@given(st.lists(st.integers(0, 24 * 3600 * 60 - 1), min_size=1, max_size=60))
def test_times_always_increase_whatever_the_timecodes(frames: list[int]) -> None:
    try:
        timing = derive_timing([timecode(frame) for frame in frames])
    except NoTimes:
        return
    assert timing.times[0] == 0
    assert np.all(np.diff(timing.times) > 0)
    assert np.isfinite(timing.rate)
    assert timing.rate > 0


@settings(deadline=None, derandomize=True)
@given(
    base=st.sampled_from([24, 25, 30, 50, 60]),
    start=st.integers(0, 24 * 3600 * 24),
    lost=st.sets(st.integers(10, 180), max_size=12),
)
def test_any_drop_in_a_steady_recording_is_found(base: int, start: int, lost: set[int]) -> None:
    rows = [float(i) for i in range(200) if i not in lost]
    timing = derive_timing(codes(rows, base, start))
    assert timing.rate == base
    assert sum(missing for _, missing in gaps_of(timing)) == len(lost)


# --- dialects ------------------------------------------------------------------------------------

RATES = [24, 25, 30, 48, 50, 60]


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("dialect", DIALECTS)
def test_every_dialect_gives_the_film_its_rate(dialect: str, rate: int) -> None:
    timing = timing_of([DIALECTS[dialect](n, rate) for n in range(5 * rate)])
    assert timing.rate == rate
    assert timing.times[-1] == pytest.approx(5 - 1 / rate, abs=1e-6)
    assert np.allclose(np.diff(timing.times), 1 / rate, rtol=0, atol=2e-5)


@pytest.mark.parametrize("rate", [24000 / 1001, 30000 / 1001, 60000 / 1001])
@pytest.mark.parametrize("dialect", DIALECTS)
def test_every_dialect_tells_a_broadcast_rate_without_false_gaps(dialect: str, rate: float) -> None:
    timing = timing_of([DIALECTS[dialect](n, rate) for n in range(4000)])
    assert timing.rate == pytest.approx(rate, rel=1e-6)
    assert gaps_of(timing) == []


@settings(deadline=None, derandomize=True, max_examples=150)
@given(
    dialect=st.sampled_from([*DIALECTS]),
    rate=st.sampled_from(RATES),
    share=st.floats(0, 0.12),
    seed=st.integers(0, 99),
)
def test_lost_frames_are_gaps_in_every_dialect(
    dialect: str, rate: int, share: float, seed: int
) -> None:
    frames = 8 * rate
    lost = np.random.default_rng(seed).permutation(np.arange(1, frames - 1))[: int(share * frames)]
    kept = sorted({*range(frames)} - {*lost.tolist()})
    timing = timing_of([DIALECTS[dialect](n, rate) for n in kept])
    assert timing.rate == rate
    assert sum(missing for _, missing in gaps_of(timing)) == len(lost)
    assert timing.times[-1] == pytest.approx((frames - 1) / rate, abs=1e-3)


@pytest.mark.parametrize(
    ("dialect", "says"),
    [
        ("running number", "number the frames of the film"),
        ("milliseconds", "milliseconds in place of frames"),
        ("milliseconds of the second", "milliseconds of the second"),
    ],
)
def test_an_unusual_dialect_is_remarked_on(dialect: str, says: str) -> None:
    notes = timing_of([DIALECTS[dialect](n, 30) for n in range(90)]).notes
    assert len(notes) == 1
    assert says in notes[0]


def test_a_running_number_may_begin_anywhere_if_it_wraps() -> None:
    texts = [f"{timecode(1_234_567 + n, 30)[:11]}.{(n + 1) % 1000:03d}" for n in range(1500)]
    timing = derive_timing(texts)
    assert timing.rate == 30
    assert np.allclose(np.diff(timing.times), 1 / 30)


def test_thousandths_that_grow_by_one_a_row_are_no_running_number() -> None:
    timing = derive_timing(codes(every(1.001, 1500), start=0))
    assert timing.rate == pytest.approx(59.94006)
    assert gaps_of(timing) == []


def test_a_frame_that_was_rounded_up_to_the_base_is_the_next_second_s_first() -> None:
    texts = [f"{clock(n / 30)}:{n % 30 * 2:02d}.000" for n in range(64)]
    texts[30], texts[60] = "00:00:00:60.000", "00:00:01:60.000"
    timing = derive_timing(texts)
    assert timing.rate == 30
    assert gaps_of(timing) == []


def test_drop_frame_numbers_with_a_colon_are_not_gaps() -> None:
    timing = derive_timing([drop_frame(n, ":") for n in range(4000)])
    assert timing.rate == pytest.approx(29.97003)
    assert gaps_of(timing) == []
    assert any("it is read as drop-frame" in note for note in timing.notes)


def test_a_semicolon_alone_makes_no_drop_frame() -> None:
    timing = derive_timing([f"{clock(n // 30)};{n % 30:02d}" for n in range(4000)])
    assert timing.rate == 30
    assert gaps_of(timing) == []


@pytest.mark.parametrize("base", [24, 25])
def test_a_semicolon_in_timecode_of_a_base_without_drop_frame_means_nothing(base: int) -> None:
    texts = [code.rpartition(":") for code in codes(every(1, 200), base, start=base * 3600)]
    timing = derive_timing([f"{before};{frame[:2]}" for before, _, frame in texts])
    assert timing.rate == base
    assert timing.times[-1] == pytest.approx(199 / base)


def test_whole_seconds_tell_the_rate_by_counting() -> None:
    timing = clock_times([clock((n + 11) / 30) for n in range(200)])
    assert timing.rate == 30
    assert np.allclose(np.diff(timing.times), 1 / 30)
    assert any("rounded to 1 s" in note for note in timing.notes)


@pytest.mark.parametrize("spell", [whole_frames, milliseconds])
def test_a_take_across_midnight_goes_on(spell: Callable[[int, float], str]) -> None:
    texts = [spell(24 * 3600 * 30 - 60 + n, 30) for n in range(120)]
    timing = derive_timing(texts)
    assert timing.rate == 30
    assert gaps_of(timing) == []


def test_times_and_rates_read_as_people_write_them() -> None:
    assert format_time(4.5333) == "0:04.533"
    assert format_time(59.9999) == "1:00.000"
    assert format_time(3725.5) == "1:02:05.500"
    assert format_time(12.0005) == f"0:{12.0005:.3f}", "a half is rounded as elsewhere"
    assert format_rate(30000 / 1001) == "29.97 fps"
    assert format_rate(60.0) == "60 fps"
