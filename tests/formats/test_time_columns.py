"""Times in other languages, with units in their cells, as steps, or in a column of any name."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import pytest

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import RateNeeded

RATE, FRAMES, LOST = 30, 90, (50, 51)
MOMENT = 638_503_344_000_000_000  # 2024, in ticks of 100 ns since the year 1
Write = Callable[[int], str]


def opened(folder: Path, name: str, write: Write, separator: str = ",") -> Take:
    point = "," if "," in write(1) else "."
    kept = (n for n in range(FRAMES) if n not in LOST)
    rows = (separator.join([write(n), f"0{point}{n:02d}1"]) for n in kept)
    path = folder / "take.csv"
    path.write_text("\n".join([separator.join([name, "jawOpen"]), *rows]) + "\n")
    return open_take(path)


def clock(n: int) -> str:
    return f"00:00:{n // RATE:02d}.{n % RATE * 1_000_000 // RATE:06d}"


TIMES: dict[str, tuple[str, Write, str]] = {
    "German": ("Zeit [s]", lambda n: f"{n / RATE:.4f}".replace(".", ","), ";"),
    "French, ms": ("Temps (ms)", lambda n: f"{1000 * n / RATE:.1f}", ";"),
    "Chinese": ("时间", lambda n: f"{n / RATE:.4f}", ","),
    "a unit in the cells": ("time", lambda n: f"{1000 * n / RATE:.0f}ms", ","),
    "seconds in the cells": ("t", lambda n: f"{n / RATE:.3f} s", ","),
    "a time of pandas": ("time", lambda n: f"0 days {clock(n)}", ","),
    "ticks of .NET": ("Ticks", lambda n: str(MOMENT + n * 10_000_000 // RATE), ","),
    "ticks that are not called so": (
        "timestamp",
        lambda n: str(MOMENT + n * 10_000_000 // RATE),
        ",",
    ),
    "file times of Windows": (
        "timestamp",
        lambda n: str(133_591_944_000_000_000 + n * 10_000_000 // RATE),
        ",",
    ),
    "no known name": ("Chronos", lambda n: f"{n / RATE:.4f}", ","),
}


@pytest.mark.parametrize(("name", "write", "separator"), TIMES.values(), ids=TIMES)
def test_times_are_found_and_show_what_was_lost(
    tmp_path: Path, name: str, write: Write, separator: str
) -> None:
    clip = opened(tmp_path, name, write, separator).clip
    assert clip.rate == RATE
    assert clip.times[-1] == pytest.approx((FRAMES - 1) / RATE, abs=2e-3)
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(49, 2)]


STEPS: dict[str, tuple[str, Write]] = {
    "seconds": ("deltaTime", lambda n: f"{(3 if n == 52 else 1) / RATE:.5f}"),
    "milliseconds": ("dt_ms", lambda n: f"{(3 if n == 52 else 1) * 1000 / RATE:.2f}"),
}


@pytest.mark.parametrize(("name", "write"), STEPS.values(), ids=STEPS)
def test_steps_from_row_to_row_add_up_to_times(tmp_path: Path, name: str, write: Write) -> None:
    clip = opened(tmp_path, name, write).clip
    assert clip.rate == RATE
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(49, 2)]


def test_a_date_without_a_clock_leaves_the_time_to_another_column(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    rows = "".join(f"2024-05-03,{clock(n)},0.1\n" for n in range(FRAMES))
    path.write_text("date,clock,jawOpen\n" + rows)
    assert open_take(path).clip.rate == RATE


def test_a_column_that_is_taken_for_times_is_named(tmp_path: Path) -> None:
    notes = opened(tmp_path, "Chronos", lambda n: f"{n / RATE:.4f}").notes
    assert 'the first column, "Chronos", is read as times' in notes


def test_a_first_column_that_does_not_run_forward_is_no_time(tmp_path: Path) -> None:
    with pytest.raises(RateNeeded, match="has no column with times"):
        opened(tmp_path, "energy", lambda n: f"{abs(45 - n) / 30:.3f}")


@pytest.mark.parametrize(
    ("name", "write"),
    [("frame", lambda n: f"f{n:04d}"), ("image", lambda n: f"shot2_{n:04d}.png")],
)
def test_numbers_in_the_names_of_pictures_are_frame_numbers(
    tmp_path: Path, name: str, write: Write
) -> None:
    with pytest.raises(RateNeeded) as asked:
        opened(tmp_path, name, write)
    assert asked.value.rate == 30
    clip = open_take(asked.value.path, fps=RATE).clip
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(49, 2)]


def digits(form: str, cut: int | None = None) -> Write:
    begin = datetime(2024, 3, 5, 9, 59, 58, 500_000)  # goes on to the next hour
    return lambda n: (begin + timedelta(seconds=n / RATE)).strftime(form)[:cut]


DIGITS: dict[str, Write] = {
    "microseconds": digits("%Y%m%d%H%M%S%f"),
    "milliseconds": digits("%Y%m%d%H%M%S%f", -3),
    "parts": digits("%Y%m%d_%H%M%S_%f"),
    "a clock time": digits("%H%M%S.%f"),
    "a clock time in milliseconds": digits("%H%M%S%f", -3),
}


@pytest.mark.parametrize("write", DIGITS.values(), ids=DIGITS)
def test_digits_that_are_a_date_or_clock_time_go_on_at_a_full_minute(
    tmp_path: Path, write: Write
) -> None:
    clip = opened(tmp_path, "timestamp", write).clip
    assert clip.rate == RATE
    assert clip.duration == pytest.approx(FRAMES / RATE, abs=2e-3)
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(49, 2)]


def test_digits_of_a_date_in_json_are_a_date(tmp_path: Path) -> None:
    path, write = tmp_path / "take.json", digits("%Y%m%d%H%M%S%f")
    frames = [f'{{"timestamp": {write(n)}, "jawOpen": 0.{n:02d}}}' for n in range(FRAMES)]
    path.write_text(f"[{', '.join(frames)}]")
    clip = open_take(path).clip
    assert clip.rate == RATE
    assert not clip.gaps


def test_seconds_that_go_on_beyond_59_are_no_clock_time(tmp_path: Path) -> None:
    clip = opened(tmp_path, "time", lambda n: f"{95958.5 + n / RATE:.3f}").clip
    assert clip.duration == pytest.approx(FRAMES / RATE, abs=2e-3)


UNPADDED: dict[str, Write] = {
    "a clock": lambda n: f"14:22:{n // RATE}.{n % RATE * 1000 // RATE}",
    "a date": lambda n: f"2024-03-05 14:22:3{n // RATE}.{n % RATE * 1000 // RATE}",
    "a local date": lambda n: f"05/03/2024 14:22:3{n // RATE}.{n % RATE * 1000 // RATE}",
    "seconds": lambda n: f"{n // RATE}.{n % RATE * 1000 // RATE}",
    "microseconds": lambda n: f"14:22:3{n // RATE}.{n % RATE * 1_000_000 // RATE}",
}


@pytest.mark.parametrize("write", UNPADDED.values(), ids=UNPADDED)
def test_milliseconds_without_zeros_before_them_are_read_and_said(
    tmp_path: Path, write: Write
) -> None:
    take = opened(tmp_path, "time", write)
    assert take.clip.rate == RATE
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(49, 2)]
    assert any("without zeros before them" in note for note in take.notes)


def test_times_that_zeros_do_not_put_in_order_are_refused_as_they_are(tmp_path: Path) -> None:
    rows = "".join(f"14:22:31.{n},0.1\n" for n in (100, 140, 90, 220, 260, 300))
    (tmp_path / "take.csv").write_text(f"time,jawOpen\n{rows}")
    with pytest.raises(FileError, match=r"14:22:31\.90 does not|sort"):
        open_take(tmp_path / "take.csv")
