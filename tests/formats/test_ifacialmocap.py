"""What iFacialMocap sends, saved as text: a frame on each line, in whole percent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.timing import RateNeeded

FACE = np.round(recordings.face(), 2)
TAIL = "=head#-21.4,-6.1,-1.5,0.05,-0.13,-0.47|rightEye#6.0,3.1,0.2|leftEye#6.0,2.9,-0.3|"


def stream(sign: str = "-", begin: str = "", scale: float = 100.0) -> str:
    names = [name.replace("Left", "_L").replace("Right", "_R") for name in ARKIT_CHANNELS]
    names = [
        name if name[:-2] not in ("jaw", "mouth") else old
        for name, old in zip(names, ARKIT_CHANNELS, strict=True)
    ]
    return "".join(
        begin.format(t=n / 30)
        + "|".join(f"{name}{sign}{v * scale:.0f}" for name, v in zip(names, row, strict=True))
        + f"|{TAIL}\n"
        for n, row in enumerate(FACE)
    )


@pytest.mark.parametrize("sign", ["-", "&"])
def test_a_stream_asks_for_its_rate_and_keeps_all_but_the_edited_number(
    tmp_path: Path, sign: str
) -> None:
    path, out = tmp_path / "stream.txt", tmp_path / "out.txt"
    path.write_text(stream(sign))
    with pytest.raises(RateNeeded) as asked:
        open_take(path)
    assert asked.value.rate == 60
    take = open_take(path, fps=60)
    assert np.allclose(take.clip.arkit_weights(), FACE, atol=1e-6)
    assert take.carried == ("head", "rightEye", "leftEye")
    edited = take.clip.weights.copy()
    edited[7, take.clip.channels.index("jawOpen")] = 0.4321
    write_take(out, take, edited)
    before, after = path.read_text().split("|"), out.read_text().split("|")
    assert [b for a, b in zip(before, after, strict=True) if a != b] == [f"jawOpen{sign}43"]


def test_times_at_the_beginning_of_the_lines_are_read(tmp_path: Path) -> None:
    path = tmp_path / "stream.txt"
    for begin in ("{t:.4f}|", "{t:.4f},", "00:00:{t:06.3f}, ", "[12:00:{t:06.3f}] ", '{t:.4f},"'):
        path.write_text(stream(begin=begin))
        clip = open_take(path).clip
        assert clip.rate == pytest.approx(30)
        assert np.allclose(clip.arkit_weights(), FACE, atol=1e-6)


def test_lines_before_the_stream_are_no_frames_and_may_state_the_rate(tmp_path: Path) -> None:
    path = tmp_path / "stream.txt"
    path.write_text("# recorded by hand\n# fps: 50\n" + stream())
    take = open_take(path)
    assert (len(take.clip), take.clip.rate) == (len(FACE), 50)
    assert not any("lost" in note for note in take.notes)


def test_a_quiet_stream_is_percent_too(tmp_path: Path) -> None:
    path = tmp_path / "stream.txt"
    path.write_text(stream(scale=2))
    assert open_take(path, fps=60).clip.weights.max() == pytest.approx(0.02)


def test_frames_without_weights_are_gaps_and_damage_is_named(tmp_path: Path) -> None:
    path = tmp_path / "stream.txt"
    frames = stream().splitlines()
    path.write_text("\n".join([*frames[:10], TAIL, *frames[11:]]))
    assert [gap.missing for gap in open_take(path, fps=60).clip.gaps] == [1]
    path.write_text("\n".join([*frames[:10], frames[10].replace("jawOpen", "jaw"), *frames[11:]]))
    with pytest.raises(FileError, match="line 11: has no jawOpen"):
        open_take(path, fps=60)
    path.write_text("".join(frames))
    with pytest.raises(FileError, match="line 1: has eyeBlink_L twice"):
        open_take(path, fps=60)
