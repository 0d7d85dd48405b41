"""Where a file has each channel several times, the remarks say which is read, or it is refused."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take

NAMES = ARKIT_CHANNELS[:6]
ONE = recordings.face(30, channels=6)
OTHER = 0.8 * ONE


def table(path: Path, affixes: Sequence[str], by_channel: bool) -> Path:
    """A take whose first column for each channel has the weights `ONE`, and all others `OTHER`."""
    columns = [
        (affix.format(name), (OTHER if n else ONE)[:, k])
        for n, affix in enumerate(affixes)
        for k, name in enumerate(NAMES)
    ]
    if by_channel:
        columns = [columns[n * len(NAMES) + k] for k in range(6) for n in range(len(affixes))]
    lines = [",".join(["time_s", *(name for name, _ in columns)])]
    for row in range(len(ONE)):
        lines.append(",".join([f"{row / 30:.4f}", *(f"{w[row]:.5f}" for _, w in columns)]))
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("by_channel", [False, True])
@pytest.mark.parametrize(
    ("affixes", "read"),
    [
        (("{}_filtered", "{}_raw"), 0),
        (("{}_raw", "{}_filtered"), 1),
        (("smooth_{}", "raw_{}"), 0),
        (("raw_{}", "smooth_{}"), 1),
        (("{}", "{}_raw"), 0),
        (("{}_smoothed", "{}"), 1),
        (("{}_raw", "{}_velocity"), 0),
        (("{}", "{}.1"), 0),
    ],
)
def test_plain_numbers_come_first_then_smoothed_ones_and_the_remarks_say_so(
    tmp_path: Path, affixes: tuple[str, str], read: int, by_channel: bool
) -> None:
    path, out = table(tmp_path / "take.csv", affixes, by_channel), tmp_path / "out.csv"
    take = open_take(path)
    np.testing.assert_allclose(take.clip.weights, OTHER if read else ONE, atol=1e-5)
    own, other = affixes[read].format(NAMES[0]), affixes[1 - read].format(NAMES[0])
    note = f'"{other}" and 5 more are carried: "{own}" and the like are read'
    assert note in take.notes
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("layout", ["json", "a line for each channel"])
def test_other_layouts_prefer_smoothed_numbers_too(tmp_path: Path, layout: str) -> None:
    path = tmp_path / "take.csv"
    series = {
        f"{name}_{kind}": face[:, k].round(5).tolist()
        for k, name in enumerate(NAMES)
        for kind, face in (("raw", ONE), ("smoothed", OTHER))
    }
    if layout == "json":
        frames = [{name: values[n] for name, values in series.items()} for n in range(len(ONE))]
        path.write_text(json.dumps({"fps": 30, "frames": frames}))
    else:
        path.write_text("".join(f"{n},{','.join(map(str, v))}\n" for n, v in series.items()))
    take = open_take(path, 30)
    np.testing.assert_allclose(take.clip.weights, OTHER, atol=1e-5)
    note = f'"{NAMES[0]}_raw" and 5 more are carried: "{NAMES[0]}_smoothed" and the like are read'
    assert note in take.notes


@pytest.mark.parametrize("affixes", [("Anna_{}", "Bob_{}"), ("{}_min", "{}_max", "{}_sd")])
def test_columns_of_several_people_or_kinds_are_refused_by_their_names(
    tmp_path: Path, affixes: tuple[str, ...]
) -> None:
    path = table(tmp_path / "take.csv", affixes, by_channel=True)
    with pytest.raises(FileError) as refused:
        open_take(path)
    one, other = (affix.format(NAMES[0]) for affix in affixes[:2])
    assert f'but {len(affixes)} columns for each: "{one}" and "{other}"' in str(refused.value)
    assert refused.value.remedy == "keep the columns of one person, or of one kind"


def test_longer_names_of_channels_that_are_missing_are_in_the_remarks(tmp_path: Path) -> None:
    path = table(tmp_path / "take.csv", ["{}_L"], by_channel=False)
    lines = path.read_text().splitlines()
    lines = [f"{lines[0]},jawOpen", *(f"{line},0.1" for line in lines[1:])]
    path.write_text("\n".join(lines) + "\n")
    (note,) = (note for note in open_take(path).notes if note.startswith("carried, although"))
    assert f'"{NAMES[0]}_L" ({NAMES[0]})' in note
    assert note.endswith("and 3 more")
