"""A CSV that gets other frames keeps its separator, decimal sign, names, scale and digits."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support.dialects import drop_frame
from support.takes import livelink_names

from faceedit_app.cli import main
from faceedit_app.formats.opening import open_take

NAMES = ("jawOpen", "eyeBlink_L", "eyeBlink_R")
FRAMES = 60


def table(cell: str = "{:.2f}", separator: str = ";", comma: bool = True, end: str = "\n") -> str:
    """A take in percent at 30 fps."""
    rows = [
        [f"{n / 30:.4f}", *(cell.format(40 + 20 * np.sin(n / 5 + k)) for k in range(len(NAMES)))]
        for n in range(FRAMES)
    ]
    text = end.join(separator.join(row) for row in rows)
    text = text.replace(".", ",") if comma else text
    return separator.join(["Time", *NAMES]) + end + text + end


STYLES: dict[str, bytes] = {
    "semicolons and decimal commas": table().encode(),
    "quotes and spaces": table('"{:.7f}" ', comma=False).encode(),
    "percent signs": table("{:.1f} %", ",", comma=False).encode(),
    "tabs in UTF-16": ("\ufeff" + table(separator="\t", end="\r\n")).encode("utf-16-le"),
    "a byte order mark": ("\ufeff" + table(end="\r\n")).encode(),
}


@pytest.mark.parametrize("content", STYLES.values(), ids=STYLES)
@pytest.mark.parametrize("command", ["convert", "retime"])
def test_other_frames_are_written_in_the_style_of_the_take(
    tmp_path: Path, content: bytes, command: str
) -> None:
    take, out = tmp_path / "take.csv", tmp_path / "out.csv"
    take.write_bytes(content)
    if command == "convert":
        arguments = ["convert", str(take), str(out), "--fps", "15"]
    else:
        arguments = ["retime", str(take), "--cut", "0.5-1", "-o", str(out)]
    assert main(arguments) == 0
    encoding = "utf-16" if content[:2] == b"\xff\xfe" else "utf-8"
    before, after = content.decode(encoding), out.read_bytes().decode(encoding)
    assert after[: after.index("\n")] == before[: before.index("\n")]
    cells = after.splitlines()[3].split(";" if ";" in before else "\t" if "\t" in before else ",")
    assert len(cells) == 1 + len(NAMES)
    assert ("%" in before, "," in before.splitlines()[1]) == (
        all("%" in cell for cell in cells[1:]),
        "," in after.splitlines()[1],
    )
    old, new = open_take(take).clip, open_take(out).clip
    assert new.channels == old.channels
    assert new.rate == (15 if command == "convert" else 30)
    np.testing.assert_allclose(new.weights[0], old.weights[0], atol=0.05)
    if command == "retime":
        for row in (1, -1):  # in quotes, with spaces and all
            assert after.splitlines()[row].split(";")[1:] == before.splitlines()[row].split(";")[1:]
        np.testing.assert_allclose(new.weights[-1], old.weights[-1], atol=1e-4)


def test_times_that_were_no_seconds_become_seconds(tmp_path: Path) -> None:
    take, out = tmp_path / "take.csv", tmp_path / "out.csv"
    rows = "".join(f"{n},0.{n:02d}\n" for n in range(FRAMES))
    take.write_text("# fps: 30\nframe,Jaw_Open\n" + rows)
    assert main(["convert", str(take), str(out), "--fps", "15"]) == 0
    assert out.read_text().splitlines()[0] == "time_s,Jaw_Open"
    assert open_take(out).clip.rate == 15


def test_convert_keeps_the_layout_at_another_rate_unless_told_otherwise(tmp_path: Path) -> None:
    take, out = tmp_path / "take.csv", tmp_path / "out.csv"
    take.write_text(table())
    assert main(["convert", str(take), str(out), "--fps", "15"]) == 0
    assert out.read_text().splitlines()[0] == table().splitlines()[0]
    assert main(["convert", str(take), str(out), "--fps", "15", "--format", "livelink"]) == 0
    assert out.read_text().startswith("Timecode,BlendshapeCount,")


def livelink(folder: Path, stamp: Callable[[int], str], separator: str = ";") -> Path:
    """A Live Link take at 30 fps, of more digits than single precision keeps, with timecodes."""
    rows = [
        [stamp(n), "52", *(f"{0.3 + 0.2 * np.sin(n / 7 + k):.10f}" for k in range(52))]
        for n in range(3 * FRAMES)
    ]
    head = ["Timecode", "BlendshapeCount", *livelink_names()]
    text = "\n".join(separator.join(row) for row in [head, *rows]) + "\n"
    path = folder / "take.csv"
    path.write_text(text if separator == "," else text.replace(".", ","))
    return path


def drop(n: int) -> str:
    return drop_frame(n + 1700)  # over a full minute, where numbers are left out


STAMPS: dict[str, Callable[[int], str]] = {
    "base 30": lambda n: f"10:00:{n // 30 + 5:02d}:{n % 30:02d}",
    "base 30, thousandths": lambda n: f"10:00:{n // 30 + 5:02d}:{n % 30:02d}.250",
    "base 60": lambda n: f"10:00:{n // 30 + 5:02d}:{2 * (n % 30):02d}.169",
    "drop-frame": drop,
}


@pytest.mark.parametrize("stamp", STAMPS.values(), ids=STAMPS)
@pytest.mark.parametrize("separator", [",", "\t"])
def test_a_cut_keeps_the_timecode_and_the_layout_of_the_take(
    tmp_path: Path,
    stamp: Callable[[int], str],
    separator: str,
    capfd: pytest.CaptureFixture[str],
) -> None:
    take, out = livelink(tmp_path, stamp, separator), tmp_path / "out.csv"
    assert main(["retime", str(take), "--cut", "1-2", "-o", str(out)]) == 0
    said, before, after = capfd.readouterr().out, open_take(take).clip, open_take(out).clip
    assert "its timecode" not in said
    old, new = take.read_text().splitlines(), out.read_text().splitlines()
    assert new[0] == old[0]
    assert [line.split(separator)[0] for line in new] == [
        line.split(separator)[0] for line in old[: len(new)]
    ]
    assert new[5:20] == old[5:20]
    cells = [[line.split(separator, 1)[1] for line in lines[-50:]] for lines in (old, new)]
    assert cells[1] == cells[0]
    assert (after.rate, after.gaps) == (before.rate, ())
    assert after.duration == pytest.approx(before.duration - 1, abs=1 / 30)


@pytest.mark.parametrize(
    ("stamp", "says"),
    [
        (
            lambda n: f"10:00:{n // 30 + 5:02d}:{n % 30:02d}.{n % 30 * 1000 // 30:03d}",
            "its timecode now is HH:MM:SS:FF.sss with 60 frames a second",
        ),
        (STAMPS["base 30"], "its timecode now has thousandths of a frame"),
    ],
)
def test_what_cannot_be_kept_of_a_timecode_is_said(
    tmp_path: Path,
    stamp: Callable[[int], str],
    says: str,
    capfd: pytest.CaptureFixture[str],
) -> None:
    take, out = livelink(tmp_path, stamp), tmp_path / "out.csv"
    assert main(["convert", str(take), str(out), "--fps", "50"]) == 0
    assert says in capfd.readouterr().out
    assert open_take(out).clip.rate == 50
    assert out.read_text().startswith("Timecode;BlendshapeCount;")


@pytest.mark.parametrize(
    ("name", "stamp"),
    [
        ("time_ms", lambda n: f"{n * 40}"),
        ("timestamp", lambda n: f"{1_700_000_000_000 + n * 40}.25"),
        ("timestamp_us", lambda n: f"{500 + n * 40_000}"),
    ],
)
def test_a_cut_keeps_the_unit_of_the_times(
    tmp_path: Path,
    name: str,
    stamp: Callable[[int], str],
    capfd: pytest.CaptureFixture[str],
) -> None:
    take, out = tmp_path / "take.csv", tmp_path / "out.csv"
    rows = [f"{stamp(n)},0.{n:04d}" for n in range(FRAMES)]
    take.write_text("\n".join([f"{name},jawOpen", *rows]) + "\n")
    assert main(["retime", str(take), "--cut", "0.8-1.6", "-o", str(out)]) == 0
    assert "its times" not in capfd.readouterr().out
    written = out.read_text().splitlines()
    assert written[:15] == take.read_text().splitlines()[:15]
    assert [line.split(",")[0] for line in written[1:]] == [stamp(n) for n in range(FRAMES - 20)]
    assert open_take(out).clip.rate == 25


@pytest.mark.parametrize(
    ("name", "stamp"),
    [
        ("time", lambda n: f"2024-03-01T12:00:{n // 25:02d}.{n % 25 * 40:03d}"),
        ("delta", lambda n: "0.04"),
    ],
)
def test_times_that_become_seconds_are_said(
    name: str,
    stamp: Callable[[int], str],
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
) -> None:
    take, out = tmp_path / "take.csv", tmp_path / "out.csv"
    rows = "".join(f"{stamp(n)},0.{n:02d}\n" for n in range(FRAMES))
    take.write_text(f"{name},jawOpen\n{rows}")
    assert main(["retime", str(take), "--cut", "1-2", "-o", str(out)]) == 0
    assert "its times are now seconds, as time_s" in capfd.readouterr().out
    assert open_take(out).clip.duration == pytest.approx(FRAMES / 25 - 1.0)


@pytest.mark.parametrize("ending", [".ndjson", ".anim"])
def test_a_new_take_that_cannot_end_like_that_is_refused_in_one_line(
    tmp_path: Path, ending: str, capfd: pytest.CaptureFixture[str]
) -> None:
    take = tmp_path / "take.csv"
    take.write_text(table())
    out = str(tmp_path / f"out{ending}")
    assert main(["retime", str(take), "--cut", "0.5-1", "-o", out]) == 2
    error = capfd.readouterr().err
    assert "use one of .csv, .tsv, .json, .glb" in error or "use one of .csv, .json" in error
    assert error.count(".csv") == 1
    assert "--format" not in error
