"""A CSV that gets other frames keeps its separator, decimal sign, names, scale and digits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

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
        assert after.splitlines()[1].split(";")[1:] == before.splitlines()[1].split(";")[1:]
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
