"""Layouts that few tools write: read as they are meant, and exported byte for byte; or refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take

NAMES = ("jawOpen", "eyeBlinkLeft", "mouthSmileLeft", "mouthSmileRight")
FRAMES = 60


def weights() -> list[list[float]]:
    values = 0.3 + 0.25 * np.sin(np.arange(FRAMES)[:, None] / 7 + np.arange(4))
    return [[round(float(value), 4) for value in row] for row in values]


def table(
    stamp: Callable[[int], str] = lambda n: f"{n / 30:.4f}",
    head: str = "time_s",
    cell: str = "{:.4f}",
) -> list[str]:
    """The lines of a CSV."""
    rows = (",".join([stamp(n), *map(cell.format, row)]) for n, row in enumerate(weights()))
    return [",".join([head, *NAMES]), *rows]


def lines_of(lines: list[str]) -> str:
    return "\n".join(lines) + "\n"


def at(n: int, rate: int = 30) -> str:
    """Seconds and milliseconds of a frame."""
    return f"{n // rate:02d}.{n % rate * 1000 // rate:03d}"


def code(n: int) -> str:
    """A timecode at 30 fps."""
    return f"10:00:{n // 30:02d}:{n % 30:02d}"


columns = [list(column) for column in zip(*weights(), strict=True)]

OPENED: dict[str, tuple[str, float]] = {
    "a header on each page": (lines_of([*table()[:31], table()[0], *table()[31:]]), 30),
    "a timecode that was set back": (
        lines_of(table(lambda n: code(n if n < 40 else n - 35), "Timecode")),
        30,
    ),
    "rows of a table in JSON": (
        json.dumps([["time", *NAMES], *([n / 25, *row] for n, row in enumerate(weights()))]),
        25,
    ),
    "hours beyond a day": (
        lines_of(table(lambda n: f"25:00:{n // 30:02d}:{n % 30:02d}", "Timecode")),
        30,
    ),
    "clock beyond a day": (lines_of(table(lambda n: f"26:00:{at(n)}", "time")), 30),
    "days of a spreadsheet": (
        lines_of(table(lambda n: f"{45352.5 + n / 30 / 86400:.10f}", "time")),
        30,
    ),
    "a broadcast rate beside a timecode of whole frames": (
        lines_of(table(lambda n: f"01:00:{n // 24:02d}:{n % 24:02d},23.976", "Timecode,fps")),
        24000 / 1001,
    ),
    "times before 0": (lines_of(table(lambda n: f"{n / 30 - 1:.4f}", "time")), 30),
    "nanoseconds since 1970": (
        lines_of(table(lambda n: f"{1_700_000_000_000_000_000 + n * 10**9 // 30}", "timestamp")),
        30,
    ),
    "a word at the end": (lines_of([*table(), "END"]), 30),
    "the end of a file of DOS": (lines_of(table()) + "\x1a", 30),
    "a frame rate in each entry of JSON": (
        json.dumps(
            [
                {"frame": n, "fps": 25, **dict(zip(NAMES, row, strict=True))}
                for n, row in enumerate(weights())
            ]
        ),
        25,
    ),
    "a frame rate in a list of JSON": (
        json.dumps({"clips": [{"fps": 25, "values": dict(zip(NAMES, columns, strict=True))}]}),
        25,
    ),
    "scientific notation": (lines_of(table(cell="{:.3E}")), 30),
}


@pytest.mark.parametrize(("content", "rate"), OPENED.values(), ids=OPENED)
def test_it_opens_at_its_rate_and_an_edit_changes_one_number(
    tmp_path: Path, content: str, rate: float
) -> None:
    path, out = tmp_path / "take", tmp_path / "out"
    path.write_text(content)
    take = open_take(path)
    clip = take.clip
    assert (len(clip), clip.channels, clip.gaps) == (FRAMES, NAMES, ())
    assert clip.rate == pytest.approx(rate, abs=1e-9)
    np.testing.assert_allclose(clip.times, np.arange(FRAMES) / rate, atol=6e-4)
    np.testing.assert_allclose(clip.weights, weights(), atol=1e-3)
    write_take(out, take, clip.weights)
    assert out.read_text() == content
    edited = clip.weights.copy()
    edited[20, 0] = 0.03265
    write_take(out, take, edited)
    before, after = content.replace(",", "\n"), out.read_text().replace(",", "\n")
    pairs = zip(before.split("\n"), after.split("\n"), strict=True)
    assert sum(1 for one, other in pairs if one != other) == 1
    np.testing.assert_allclose(open_take(out).clip.weights, edited, atol=6e-5)


REFUSED: dict[str, tuple[str, str]] = {
    "a rate that was measured at each frame": (
        json.dumps(
            [
                {"fps": 29.5 + n / 50, **dict(zip(NAMES, row, strict=True))}
                for n, row in enumerate(weights())
            ]
        ),
        "give its frame rate",
    ),
    "two takes": (
        lines_of([*table(), *table()[1:]]),
        "line 62: the times begin again at 0.0000: a second take follows; move its rows",
    ),
    "two takes with their headers": (lines_of(table() * 2), "line 63: the times begin again"),
    "two takes with timecodes": (
        lines_of([*table(code, "Timecode"), *table(code, "Timecode")[1:]]),
        "line 62: the times begin again at 10:00:00:00: a second take follows",
    ),
    "an earlier take after its header": (
        lines_of(table(code, "Timecode") + table(lambda n: f"09{code(n)[2:]}", "Timecode")),
        "line 63: the header is repeated, and the times do not go on from 10:00:01:29 to "
        "09:00:00:00: a second take follows; move its rows to a file of their own",
    ),
    "a later take after its header": (
        lines_of(table() + table(lambda n: f"{n / 30 + 60:.4f}")),
        "line 63: the header is repeated, and the times do not go on from 1.9667 to 60.0000",
    ),
    "two takes with frame numbers": (
        lines_of([*table(str, "frame"), *table(str, "frame")[1:]]),
        "line 62: the times begin again at 0: a second take follows",
    ),
    "times in words": (
        lines_of(table(lambda n: f"PT{n / 30:.3f}S", "time")),
        'times in "time" of a form that is not known, such as "PT0.000S"; give its frame rate',
    ),
    "a unit that nothing confirms": (
        lines_of(table(lambda n: f"{16 * n}", "MidiTick")),
        "no column with times; give its frame rate",
    ),
    "YAML": (
        "fps: 30\nframes:\n" + "".join(f"- {{jawOpen: {r[0]}, jawLeft: 0}}\n" for r in weights()),
        "names ARKit's channels, but in a layout that is not known; save it as CSV",
    ),
    "JavaScript": (
        "const take = " + json.dumps([dict(zip(NAMES, row, strict=True)) for row in weights()]),
        "names ARKit's channels, but in a layout that is not known; save it as CSV",
    ),
    "XML": (
        '<take fps="30">' + "".join(f'<f jawOpen="{row[0]}"/>' for row in weights()) + "</take>",
        "is XML or HTML; save its table as CSV",
    ),
}


@pytest.mark.parametrize(("content", "says"), REFUSED.values(), ids=REFUSED)
def test_what_it_is_and_what_to_do_is_said_in_one_line(
    tmp_path: Path, content: str, says: str
) -> None:
    path = tmp_path / "take"
    path.write_text(content)
    with pytest.raises(FileError) as error:
        open_take(path)
    assert says in str(error.value)
    assert len(str(error.value)) < 300 + len(str(path))
    assert "\n" not in str(error.value)
