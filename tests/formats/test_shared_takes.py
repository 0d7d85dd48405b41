"""Real recordings, where they are at hand; none of them is part of the project."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.places import SHARED

from faceedit_app.formats.opening import open_take, write_take

LIVELINK = sorted((SHARED / "data" / "livelink").glob("*.csv"))
CLIPS = sorted((SHARED / "data" / "clips").glob("*.csv"))

pytestmark = pytest.mark.skipif(
    not LIVELINK, reason="no real takes here; FACEEDIT_SHARED may name their folder"
)

# frames, gaps, missing frames, rows without a face; counted apart from our own code
KNOWN = {
    "S07-001.csv": (2028, 2, 2, 0),
    "S88-001.csv": (1662, 5, 280, 277),
    "alex_rom_3.csv": (4030, 3, 3, 0),
    "alex_rom_4.csv": (3809, 2, 2, 0),
    "apfel.csv": (1891, 9, 37, 35),
    "facial.csv": (1913, 1, 1, 0),
}


@pytest.mark.parametrize("path", LIVELINK + CLIPS, ids=lambda path: path.name)
def test_a_real_take_is_exported_byte_for_byte(path: Path, tmp_path: Path) -> None:
    take = open_take(path)
    write_take(tmp_path / "out.csv", take, take.clip.weights)
    assert (tmp_path / "out.csv").read_bytes() == path.read_bytes()
    assert len(take.clip.channels) == 52
    assert take.clip.rate == (25 if path.name.startswith("grid") else 30)
    assert np.all(np.diff(take.clip.times) > 0)


@pytest.mark.parametrize("path", LIVELINK, ids=lambda path: path.name)
def test_a_real_take_s_drops_are_found(path: Path) -> None:
    if path.name not in KNOWN:
        pytest.skip("nothing is known of this take")
    frames, gaps, missing, lost = KNOWN[path.name]
    take = open_take(path)
    assert len(take.clip) == frames
    assert len(take.clip.gaps) == gaps
    assert sum(gap.missing for gap in take.clip.gaps) == missing
    assert any("30 fps: the timecode counts 60" in note for note in take.notes)
    said = [note for note in take.notes if "the face was lost" in note]
    assert [f"{lost} rows" in note for note in said] == ([True] if lost else [])


@pytest.mark.parametrize("path", LIVELINK, ids=lambda path: path.name)
def test_an_edit_of_a_real_take_touches_its_rows_only(path: Path, tmp_path: Path) -> None:
    take = open_take(path)
    weights = take.clip.weights.copy()
    weights[300:312, :20] += np.float32(0.0625)
    write_take(tmp_path / "out.csv", take, weights)
    before, after = path.read_bytes().splitlines(), (tmp_path / "out.csv").read_bytes().splitlines()
    assert len(before) == len(after)
    assert sum(a != b for a, b in zip(before, after, strict=True)) == 12
    assert np.allclose(open_take(tmp_path / "out.csv").clip.weights, weights, rtol=0, atol=6e-8)
