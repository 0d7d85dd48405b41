"""CSV with other times than timecodes: which column tells the time, and its unit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.takes import make_plain_csv

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import RateNeeded, time_rows

EPOCH = 1_750_000_000.123  # seconds


def table(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "take.csv"
    path.write_text(text, encoding="utf-8", newline="")
    return path


def with_times(folder: Path, name: str, times: Iterable[str], fps: float | None = None) -> Take:
    """A take with one column of times."""
    rows = "".join(f"{time},{0.01 * (k % 50):.3f}\n" for k, time in enumerate(times))
    return open_take(table(folder, f"{name},jawOpen\n{rows}"), fps)


def seconds(rate: float, count: int = 120, lost: Sequence[int] = ()) -> list[float]:
    return [n / rate for n in range(count) if n not in lost]


@pytest.mark.parametrize("rate", [24, 25, 30, 48, 50, 60, 120])
def test_the_rate_comes_from_rounded_times(tmp_path: Path, rate: int) -> None:
    clip = open_take(make_plain_csv(tmp_path / "take.csv", rate=rate)).clip
    assert clip.rate == rate
    assert clip.gaps == ()
    assert clip.timecodes is None
    assert len(clip.channels) == 52
    assert np.allclose(np.diff(clip.times), 1 / rate, rtol=0, atol=1e-9)


def test_a_broadcast_rate_is_distinguished_from_its_neighbour(tmp_path: Path) -> None:
    path = make_plain_csv(tmp_path / "take.csv", seconds=20, rate=30000 / 1001)
    assert open_take(path).clip.rate == pytest.approx(29.97003)


def utc(t: float) -> str:
    moment = datetime.fromtimestamp(EPOCH + t, UTC).replace(tzinfo=None)
    return moment.isoformat(timespec="milliseconds")


# Name of the column, and how it is written.
COLUMNS: dict[str, tuple[str, Callable[[float], str]]] = {
    "s": ("time_s", lambda t: f"{t:.4f}"),
    "s that are called so": ("seconds", lambda t: f"{t:.6f}"),
    "s, unnamed": ("Time", lambda t: f"{t:.4f}"),
    "s since 1970": ("timestamp", lambda t: f"{EPOCH + t:.4f}"),
    "ms": ("timestamp_ms", lambda t: f"{1000 * t:.0f}"),
    "ms, unnamed": ("time", lambda t: f"{1000 * t:.0f}"),
    "ms with decimals": ("time", lambda t: f"{1000 * t:.3f}"),
    "ms since 1970": ("timestamp", lambda t: f"{1000 * (EPOCH + t):.0f}"),
    "us": ("t_us", lambda t: f"{1e6 * t:.0f}"),
    "us since 1970": ("timestamp", lambda t: f"{1e6 * (EPOCH + t):.0f}"),
    "ns": ("timestamp_ns", lambda t: f"{1e9 * t:.0f}"),
    "ns since 1970": ("captureTime", lambda t: f"{int(1e9 * t) + 1_750_000_000_123_456_789}"),
    "time of day": ("time", lambda t: (datetime(2025, 1, 1) + timedelta(seconds=t)).isoformat()),
    "UTC": ("timestamp", lambda t: f'"{utc(t)}Z"'),
    "Audio2Face": ("timeCode", lambda t: f"{t:.6f}"),
    "elapsed": ("Time Elapsed", lambda t: f"{t:.4f}"),
}


@pytest.mark.parametrize("rate", [24, 30, 60])
@pytest.mark.parametrize("column", COLUMNS)
def test_times_are_read_in_whatever_unit_they_are(tmp_path: Path, column: str, rate: int) -> None:
    name, write = COLUMNS[column]
    take = with_times(tmp_path, name, map(write, seconds(rate, lost=[50, 51])))
    assert take.clip.rate == rate
    assert take.clip.duration == pytest.approx(120 / rate, abs=2e-3)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(49, 2)]


@pytest.mark.parametrize(
    ("column", "remark"),
    [
        ("ms", None),
        ("ms, unnamed", "time is in milliseconds"),
        ("us since 1970", "timestamp is in microseconds"),
        ("ns since 1970", "captureTime is in nanoseconds"),
        ("s since 1970", None),
    ],
)
def test_a_unit_that_no_name_tells_is_remarked_on(
    tmp_path: Path, column: str, remark: str | None
) -> None:
    name, write = COLUMNS[column]
    notes = with_times(tmp_path, name, map(write, seconds(60))).notes
    assert notes == ((remark,) if remark else ())


def test_a_name_with_the_wrong_unit_is_corrected_and_said(tmp_path: Path) -> None:
    take = with_times(tmp_path, "time_s", [f"{1000 * t:.0f}" for t in seconds(30)])
    assert take.clip.rate == 30
    assert take.notes == ("time_s is in milliseconds",)


@pytest.mark.parametrize("name", ["timestamp_ms", "time"])
def test_real_time_is_preferred_to_numbers_of_frames(tmp_path: Path, name: str) -> None:
    rows = "".join(f"{n},{1000 * n / 30:.0f},0.1\n" for n in range(60))
    take = open_take(table(tmp_path, f"frame,{name},jawOpen\n{rows}"))
    assert take.clip.rate == 30
    assert take.carried == ("frame",)


def test_a_timecode_of_no_use_gives_way_to_another_column(tmp_path: Path) -> None:
    rows = "".join(f"00:00:00:00,{n / 25:.3f},0.1\n" for n in range(60))
    take = open_take(table(tmp_path, f"Timecode,Time Elapsed,jawOpen\n{rows}"))
    assert take.clip.rate == 25
    assert take.clip.timecodes is None


@settings(deadline=None, derandomize=True, max_examples=200)
@given(
    rate=st.sampled_from([24, 25, 30, 50, 60]),
    decimals=st.integers(2, 5),
    share=st.floats(0, 0.1),
    truncated=st.booleans(),
    begin=st.floats(0, 1000),
    seed=st.integers(0, 99),
)
def test_rounded_times_with_losses_are_as_even_as_the_film(
    rate: int, decimals: int, share: float, truncated: bool, begin: float, seed: int
) -> None:
    frames = 10 * rate
    lost = np.random.default_rng(seed).permutation(np.arange(1, frames - 1))[: int(share * frames)]
    kept = np.array(sorted({*range(frames)} - {*lost.tolist()}))
    exact = (begin + kept / rate) * 10**decimals
    given_times = (np.floor(exact) if truncated else np.round(exact)) / 10**decimals
    timing = time_rows(given_times)
    assert timing.rate == rate
    assert np.allclose(timing.times, kept / rate, rtol=0, atol=1.01 * 10.0**-decimals)


def test_two_decimals_at_sixty_frames_become_even(tmp_path: Path) -> None:
    take = with_times(tmp_path, "time_s", [f"{t:.2f}" for t in seconds(60, 500)])
    assert take.clip.rate == 60
    assert np.allclose(np.diff(take.clip.times), 1 / 60)
    assert take.notes == ("times are rounded to 0.01 s: rows are evenly spaced at 60 fps",)


def test_a_clock_that_is_slower_than_the_rows_is_counted_out(tmp_path: Path) -> None:
    take = with_times(tmp_path, "time_s", [f"{int(t + 0.4)}" for t in seconds(30, 200)])
    assert take.clip.rate == 30
    assert np.allclose(np.diff(take.clip.times), 1 / 30)


def test_the_times_of_a_clock_that_wavers_are_kept(tmp_path: Path) -> None:
    steps = np.random.default_rng(3).uniform(0.014, 0.0201, 300)
    times = np.cumsum(steps)
    take = with_times(tmp_path, "timestamp", [f"{t:.4f}" for t in times])
    assert np.allclose(take.clip.times, np.round(times, 4) - np.round(times[0], 4), atol=1e-6)


def test_recordings_that_are_hours_apart_follow_one_another(tmp_path: Path) -> None:
    times = [0.0, *(EPOCH + t for t in seconds(60, 100))]
    take = with_times(tmp_path, "time_s", [f"{t:.4f}" for t in times])
    assert take.clip.rate == 60
    assert take.clip.duration == pytest.approx(101 / 60, abs=1e-3)
    assert any("by more than an hour 1 time" in note for note in take.notes)


def test_times_that_would_fill_a_day_are_refused(tmp_path: Path) -> None:
    times = np.cumsum([0.02 if k % 2 else 3000 for k in range(200)])
    with pytest.raises(FileError, match="lasts 82:30:"):
        with_times(tmp_path, "time_s", [f"{t:.2f}" for t in times])


# --- times that are not there --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "likely"), [("Timecode", 60), ("frame", 30), ("time", 60), ("", 60), ("index", 30)]
)
def test_numbers_of_frames_ask_for_the_rate(tmp_path: Path, name: str, likely: float) -> None:
    rows = "".join(f"{i}.0,68.0,-0.017023563385009766\n" for i in range(100) if i != 50)
    path = table(tmp_path, f"{name},BlendshapeCount,JawOpen\n" + rows)
    with pytest.raises(RateNeeded, match=r"numbers its frames.*; give its frame rate$") as asked:
        open_take(path)
    assert asked.value.for_command.endswith(f"such as --fps {likely}")
    assert (asked.value.rate, asked.value.frames) == (likely, 100)
    take = open_take(path, fps=24)
    assert take.format == "CSV with frame numbers"
    assert (take.clip.rate, take.fps) == (24, 24)
    assert take.clip.duration == pytest.approx(100 / 24)
    assert take.notes == (
        "BlendshapeCount says 68, the header has 1 values",
        "1 gap, 1 frame missing",
    )
    assert take.source.encode(take.clip.weights, take.clip.weights) == path.read_bytes()


@pytest.mark.parametrize(
    "times",
    [["0"] * 20, [f"{7 * n}" for n in range(20)][::-1], [f"{3600 * n}" for n in range(20)]],
    ids=["standing still", "backwards", "an hour a row"],
)
def test_times_that_cannot_be_ask_for_the_rate(tmp_path: Path, times: list[str]) -> None:
    with pytest.raises(RateNeeded):
        with_times(tmp_path, "time_s", times)
    take = with_times(tmp_path, "time_s", times, fps=50)
    assert np.allclose(take.clip.times, np.arange(20) / 50)


def test_a_take_without_times_asks_and_counts_its_lost_rows(tmp_path: Path) -> None:
    rows = "".join(",\n" if n in (4, 5) else "0.1,0.2\n" for n in range(12))
    path = table(tmp_path, "jawOpen,mouthClose,x\n" + rows.replace("\n", ",1\n"))
    with pytest.raises(RateNeeded, match="no column with times") as asked:
        open_take(path)
    assert (asked.value.rate, asked.value.frames) == (60, 12)
    take = open_take(path, fps=30)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(3, 2)]
    assert (
        "the face was lost in 2 rows at 1 place: no frames there, the rows are kept" in take.notes
    )


def test_a_rate_that_is_given_wins_over_the_file_s_own(tmp_path: Path) -> None:
    path = make_plain_csv(tmp_path / "take.csv", rate=30, seconds=2)
    take = open_take(path, fps=60)
    assert take.clip.rate == 60
    assert take.clip.duration == pytest.approx(1)
    assert "the frame rate was set to 60 fps; by its times it is 30 fps" in take.notes
    assert open_take(path, fps=30).notes == ()


def test_a_rounded_broadcast_rate_is_meant_exactly(tmp_path: Path) -> None:
    path = table(tmp_path, "jawOpen\n" + "0.1\n" * 50)
    for fps, exact in ((23.98, 24000 / 1001), (29.97, 30000 / 1001), (59.94, 60000 / 1001)):
        assert open_take(path, fps).clip.rate == exact
    assert open_take(path, 24.0).clip.rate == 24


@pytest.mark.parametrize("fps", [0.0, -5.0, 1e9, float("nan")])
def test_a_rate_that_cannot_be_is_refused(tmp_path: Path, fps: float) -> None:
    with pytest.raises(FileError, match="frames per second"):
        open_take(make_plain_csv(tmp_path / "take.csv"), fps=fps)


# --- the rest ------------------------------------------------------------------------------------


def test_an_edit_changes_its_cell_in_the_source_s_format(tmp_path: Path) -> None:
    path = make_plain_csv(tmp_path / "take.csv")
    take = open_take(path)
    weights = take.clip.weights.copy()
    weights[10, take.clip.channels.index("jawOpen")] = 0.4321987
    out = tmp_path / "out.csv"
    write_take(out, take, weights)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    assert [i for i in range(len(before)) if before[i] != after[i]] == [11]
    changed = set(after[11].split(",")) - set(before[11].split(","))
    assert changed == {"0.43220"}


def test_audio2face_opens_with_its_index_column_and_prefix(tmp_path: Path) -> None:
    rows = "".join(f"{i},{i / 30:.6f},{0.01 * i},0.5\n" for i in range(40))
    path = table(tmp_path, ",timeCode,blendShapes.JawOpen,blendShapes.EyeBlinkLeft\n" + rows)
    take = open_take(path)
    assert take.format == "CSV with times in seconds"
    assert take.clip.channels == ("jawOpen", "eyeBlinkLeft")
    assert take.clip.rate == 30
    assert take.carried == ("(unnamed)",)
    assert take.source.encode(take.clip.weights, take.clip.weights) == path.read_bytes()


def test_times_begin_at_the_first_frame_and_keep_gaps(tmp_path: Path) -> None:
    rows = "".join(f"{5 + i / 25:.2f},0.1\n" for i in range(50) if i not in (20, 21))
    take = open_take(table(tmp_path, "time_s,jawOpen\n" + rows))
    assert take.clip.times[0] == 0
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(19, 2)]
    assert take.notes == ("1 gap, 2 frames missing",)


def test_an_unusual_rate_is_kept_and_noted(tmp_path: Path) -> None:
    rows = "".join(f"{i / 27.3:.6f},0.1\n" for i in range(50))
    take = open_take(table(tmp_path, "time,jawOpen\n" + rows))
    assert take.clip.rate == pytest.approx(27.3, abs=1e-3)
    (note,) = take.notes
    assert note.startswith("27.3 fps by its times, which is not a usual frame rate; if it has")


def test_a_single_frame_opens(tmp_path: Path) -> None:
    take = open_take(table(tmp_path, "time_s,jawOpen\n2.5,0.1\n"))
    assert np.array_equal(take.clip.times, [0.0])
    assert take.clip.rate == 60


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("time_s,jawOpen\n0,0\n0.1,0\n0.1,0\n", 4, "0.1 does not come after 0.1"),
        ("time_s,jawOpen\n0,0\n0.1,0\n0.05,0\n", 4, "0.05 does not come after 0.1"),
        ("time_s,jawOpen\n0,0\nlater,0\n", 3, 'column "time_s" holds "later"'),
        ("time_s,jawOpen\nnan,0\n1,0\n", 2, "not a finite number"),
        ("time,jawOpen\n2025-01-01T00:00:00,0\n2025-01-01T00:00:99,0\n", 3, "not a time like"),
        ("time_s;jawOpen\n0;1,234,5\n", 2, "write decimals with a point"),
        ("time_s,jawOpen\n", 1, "no frames"),
        ("time_s,jawOpen\n0,\n1,\n", None, "no row with a tracked face"),
    ],
)
def test_a_bad_file_is_reported_in_one_line(
    tmp_path: Path, text: str, line: int | None, says: str
) -> None:
    with pytest.raises(FileError) as caught:
        open_take(table(tmp_path, text))
    assert caught.value.line == line
    assert says in str(caught.value)


@pytest.mark.parametrize("rate", [24, 25, 29.97, 30, 50, 60])
@pytest.mark.parametrize("lost", [(), (1,), (2,), (1, 2), (2, 4)])
def test_a_take_of_a_few_rows_that_lost_some_keeps_its_rate(
    tmp_path: Path, rate: float, lost: tuple[int, ...]
) -> None:
    for decimals in (3, 6):
        times = [f"{t:.{decimals}f}" for t in seconds(rate, 6, lost)]
        clip = with_times(tmp_path, "time", times).clip
        assert clip.rate == pytest.approx(rate, abs=0.04)
        assert sum(gap.missing for gap in clip.gaps) == len(lost)


def test_a_rate_that_a_few_rounded_times_leave_open_is_admitted(tmp_path: Path) -> None:
    notes = with_times(tmp_path, "time", ["0.00", "0.03", "0.07", "0.13"]).notes
    assert any("leave the frame rate open" in note for note in notes)


def test_ninety_frames_a_second_in_hundredths_are_not_a_hundred_with_gaps(tmp_path: Path) -> None:
    clip = with_times(tmp_path, "time", [f"{t:.2f}" for t in seconds(90)]).clip
    assert (clip.rate, clip.gaps) == (90, ())


def test_minutes_and_seconds_begin_again_after_an_hour(tmp_path: Path) -> None:
    moments = [3599 + t for t in seconds(30, 60)]
    times = [f"{int(t) // 60 % 60:02d}:{t % 60:06.3f}" for t in moments]
    clip = with_times(tmp_path, "time", times).clip
    assert (clip.rate, clip.gaps) == (30, ())


@pytest.mark.parametrize("form", ["%Y-%m-%dT%H:%M:%S.%f", "%H:%M:%S.%f"])
def test_a_local_clock_that_is_set_back_does_not_stop_the_take(tmp_path: Path, form: str) -> None:
    begin = datetime(2026, 10, 25, 2, 59, 59)
    moments = [begin + timedelta(seconds=t - (3600 if t >= 1 else 0)) for t in seconds(30, 60)]
    take = with_times(tmp_path, "time", [moment.strftime(form) for moment in moments])
    assert take.clip.rate == 30
    assert take.clip.duration == pytest.approx(2, abs=0.04)
    assert any("goes back by an hour" in note for note in take.notes)


@pytest.mark.parametrize("spread", [0.004, 0.008, 0.015])
@pytest.mark.parametrize(("rate", "lost"), [(25, 0), (30, 0), (60, 0), (30, 0.05), (60, 0.05)])
def test_times_of_arrival_give_the_rate_at_which_frames_were_sent(
    tmp_path: Path, rate: int, lost: float, spread: float
) -> None:
    """As a script notes them that receives a phone's frames over the network."""
    drawn = np.random.default_rng(rate)
    kept = np.flatnonzero(np.append(drawn.random(598) >= lost, [True, True]))
    arrived = EPOCH + kept / rate + drawn.exponential(spread, len(kept))
    arrived = np.maximum.accumulate(arrived)  # some arrive together
    take = with_times(tmp_path, "timestamp", [f"{t:.3f}" for t in arrived])
    clip = take.clip
    assert clip.rate == pytest.approx(rate, rel=0.005)
    missing = sum(gap.missing for gap in clip.gaps)
    assert missing == pytest.approx(600 - len(kept), abs=8)
    assert clip.times[-1] == pytest.approx((kept[-1] - kept[0]) / rate, abs=0.25)


def test_a_clock_that_hardly_moves_asks_for_the_rate(tmp_path: Path) -> None:
    seconds_alone = [f"{int(t)}" for t in seconds(30, 50)]
    with pytest.raises(RateNeeded, match="too coarse"):
        with_times(tmp_path, "time", seconds_alone)
