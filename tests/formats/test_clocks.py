"""Files with several clocks, or with a clock in several columns."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faceedit_app.formats.opening import open_take, write_take

FRAMES, RATE, LOST = 90, 25, (50, 51)
KEPT = [n for n in range(FRAMES) if n not in LOST]
BEGIN = 1_709_648_551.7
WORKED = np.cumsum(0.09 + 0.02 * np.random.default_rng(7).random(FRAMES))


def table(folder: Path, header: str, write: Callable[[int], str]) -> Path:
    path = folder / "take.csv"
    rows = "".join(f"{write(n)},0.{n % 7}\n" for n in KEPT)
    path.write_text(f"{header},jawOpen\n{rows}")
    return path


def nanoseconds(n: int) -> int:
    return round((BEGIN + n / RATE) * 1e6) * 1000


BOTH: dict[str, tuple[str, Callable[[int], str]]] = {
    "ms of the video": (
        "system_time,video_ms",
        lambda n: f"{BEGIN + WORKED[n]:.6f},{1000 * n / RATE}",
    ),
    "seconds of the video": (
        "timestamp,video_time",
        lambda n: f"{BEGIN + WORKED[n]:.6f},{n / RATE:.4f}",
    ),
    "the only even one": ("t,elapsed", lambda n: f"{WORKED[n]:.6f},{n / RATE:.4f}"),
    "the only one whose unit is sure": ("pts,stamp", lambda n: f"{24 * n},{n / RATE:.4f}"),
    "the frame's": ("frame_time,utc_time", lambda n: f"{n / RATE:.4f},{WORKED[n]:.6f}"),
}


@pytest.mark.parametrize(("header", "write"), BOTH.values(), ids=BOTH)
def test_of_two_clocks_that_of_the_film_counts(
    tmp_path: Path, header: str, write: Callable[[int], str]
) -> None:
    take = open_take(table(tmp_path, header, write))
    assert take.clip.rate == RATE
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(49, 2)]
    (other,) = take.carried
    assert any(f'not of "{other}"' in note for note in take.notes)


def test_clocks_that_agree_are_not_remarked_on(tmp_path: Path) -> None:
    path = table(tmp_path, "timestamp,video_time", lambda n: f"{BEGIN + n / RATE},{n / RATE}")
    take = open_take(path)
    assert take.carried == ("video_time",)
    assert take.notes == ("1 gap, 2 frames missing",)


def test_a_clock_that_is_no_clock_does_not_matter(tmp_path: Path) -> None:
    path = table(tmp_path, "time_s,inference_time", lambda n: f"{n / RATE},{12 + n % 3}")
    assert open_take(path).notes == ("1 gap, 2 frames missing",)


PARTS: dict[str, tuple[str, Callable[[int], str]]] = {
    "ROS": (
        "header.stamp.secs,header.stamp.nsecs",
        lambda n: f"{nanoseconds(n) // 10**9},{nanoseconds(n) % 10**9}",
    ),
    "ROS 2": ("sec,nanosec", lambda n: f"{nanoseconds(n) // 10**9},{nanoseconds(n) % 10**9}"),
    "Unix": (
        "tv_sec,tv_usec",
        lambda n: f"{nanoseconds(n) // 10**9},{nanoseconds(n) // 1000 % 10**6}",
    ),
    "the fraction first": (
        "stamp_msec,stamp_sec",
        lambda n: f"{nanoseconds(n) // 10**6 % 1000},{nanoseconds(n) // 10**9}",
    ),
    "AVFoundation": ("time,timescale", lambda n: f"{n * 600 // RATE},600"),
    "AVFoundation, by words": ("pts_value,pts_time_scale", lambda n: f"{n * 90000 // RATE},90000"),
}


@pytest.mark.parametrize(("header", "write"), PARTS.values(), ids=PARTS)
def test_times_in_two_columns_are_read_together(
    tmp_path: Path, header: str, write: Callable[[int], str]
) -> None:
    path = table(tmp_path, header, write)
    take = open_take(path)
    assert take.clip.rate == RATE
    assert take.clip.times[-1] == pytest.approx((FRAMES - 1) / RATE, abs=1e-3)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(49, 2)]
    assert take.notes == ("1 gap, 2 frames missing",)
    write_take(tmp_path / "out.csv", take, take.clip.weights)
    assert (tmp_path / "out.csv").read_bytes() == path.read_bytes()


def test_two_columns_with_whole_times_are_not_added(tmp_path: Path) -> None:
    path = table(tmp_path, "time_s,time_ms", lambda n: f"{n // RATE},{1000 * n // RATE}")
    clip = open_take(path).clip
    assert clip.rate == RATE
    assert clip.times[-1] == pytest.approx((FRAMES - 1) / RATE, abs=0.05)


JSON: dict[str, Callable[[int], dict[str, Any]]] = {
    "two clocks": lambda n: {"systemTime": BEGIN + WORKED[n], "mediaTime": n / RATE},
    "ROS": lambda n: {
        "header": {"stamp": {"secs": nanoseconds(n) // 10**9, "nsecs": nanoseconds(n) % 10**9}}
    },
    "a time scale": lambda n: {"time": n * 600 // RATE, "timescale": 600},
}


@pytest.mark.parametrize("write", JSON.values(), ids=JSON)
def test_clocks_in_json_are_chosen_and_joined_alike(
    tmp_path: Path, write: Callable[[int], dict[str, Any]]
) -> None:
    path = tmp_path / "take.json"
    path.write_text(json.dumps([{**write(n), "weights": {"jawOpen": n % 7 / 10}} for n in KEPT]))
    take = open_take(path)
    assert take.clip.rate == RATE
    assert take.clip.times[-1] == pytest.approx((FRAMES - 1) / RATE, abs=1e-3)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(49, 2)]
    wanted = ['the times are those of "mediaTime"'] if "systemTime" in write(0) else []
    assert [note.split(",")[0] for note in take.notes if "gap" not in note] == wanted
