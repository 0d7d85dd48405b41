"""Face Cap recordings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take

WEIGHTS = recordings.face()


@pytest.mark.parametrize("begin", ["", "\ufeff"])
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_a_recording_opens_and_keeps_its_bytes(tmp_path: Path, begin: str, newline: str) -> None:
    path = tmp_path / "FC_2021-2-1.txt"
    text = begin + recordings.facecap(WEIGHTS, newline=newline)
    path.write_bytes(text.encode())
    take = open_take(path)
    assert take.format == "Face Cap TXT"
    assert (len(take.clip), take.clip.rate, len(take.clip.channels)) == (40, 30, 52)
    assert np.allclose(take.clip.weights, WEIGHTS, atol=1e-7)
    assert take.carried[1:3] == ("headX", "headY")
    weights = take.clip.weights.copy()
    weights[7, take.clip.channels.index("jawLeft")] = 0.125
    out = tmp_path / "out.txt"
    write_take(out, take, weights)
    before, after = text.encode().split(b","), out.read_bytes().split(b",")
    assert [b for a, b in zip(before, after, strict=True) if a != b] == [b"0.1250"]


def test_frames_that_were_lost_are_gaps(tmp_path: Path) -> None:
    lines = recordings.facecap(WEIGHTS).splitlines(keepends=True)
    path = tmp_path / "take.txt"
    path.write_text("".join(lines[:12] + lines[15:]))
    assert [(gap.frame, gap.missing) for gap in open_take(path).clip.gaps] == [(9, 3)]


def test_a_recording_without_frames_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "take.txt"
    path.write_text("".join(recordings.facecap(WEIGHTS).splitlines(keepends=True)[:2]))
    with pytest.raises(FileError, match="holds no frames"):
        open_take(path)


def test_the_angles_of_a_calm_head_are_degrees_and_stay_so(tmp_path: Path) -> None:
    path, out = tmp_path / "take.txt", tmp_path / "out.txt"
    path.write_text(recordings.facecap(WEIGHTS))
    take = open_take(path)
    rotations = take.clip.rotations
    assert rotations is not None
    np.testing.assert_allclose(rotations[:, :3], np.radians([[-2.0, 1.5, 0.3]] * 40), atol=1e-6)
    assert not any("degrees" in note for note in take.notes)
    turned = rotations.copy()
    turned[3, 0] = np.radians(4)
    write_take(out, take, take.clip.weights, turned)
    before, after = path.read_bytes().split(b","), out.read_bytes().split(b",")
    assert [float(b) for a, b in zip(before, after, strict=True) if a != b] == [4]
