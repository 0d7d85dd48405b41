"""What the remarks say of values, names and rates that look wrong but may be meant."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.take import Take

NAMES = ("jawOpen", "eyeBlinkLeft", "mouthSmileLeft", "mouthSmileRight")
FRAMES = 60


def face(scale: float = 1.0) -> Doubles:
    """(FRAMES, 4) weights from 0.05 to 0.55 times `scale`."""
    rows = np.arange(FRAMES)[:, None]
    return scale * (0.3 + 0.25 * np.sin(rows / 7 + np.arange(len(NAMES))))


def opened(
    folder: Path,
    values: Doubles | None = None,
    names: tuple[str, ...] = NAMES,
    times: Doubles | None = None,
) -> Take:
    """Opens a table with these values, and checks that it is exported byte for byte."""
    values = face() if values is None else values
    times = np.arange(len(values)) / 30 if times is None else times
    rows = [
        ",".join([f"{time:.4f}", *(f"{value:.4f}" for value in row)])
        for time, row in zip(times, values, strict=True)
    ]
    path = folder / "take.csv"
    path.write_text("\n".join([",".join(["time_s", *names]), *rows]) + "\n")
    take = open_take(path)
    write_take(folder / "out.csv", take, take.clip.weights)
    assert (folder / "out.csv").read_bytes() == path.read_bytes()
    return take


def with_cell(value: float) -> Doubles:
    values = face()
    values[30, 0] = value
    return values


@pytest.mark.parametrize(
    ("values", "note"),
    [
        (with_cell(7.5), "jawOpen is 7.5 in line 32, where 1 is a full blendshape"),
        (face(3.2), "weights are far above 1: "),
        (with_cell(-0.4), "jawOpen is -0.4 in line 32, and stays so"),
        (-face(), "240 weights are below 0: "),
    ],
)
def test_unusual_weights_are_kept_and_named_with_their_place(
    tmp_path: Path, values: Doubles, note: str
) -> None:
    take = opened(tmp_path, values)
    assert len(take.notes) == 1
    assert note in take.notes[0]
    np.testing.assert_allclose(take.clip.weights, values, atol=1e-4)


@pytest.mark.parametrize("values", [face(), with_cell(1.2), with_cell(-0.01)])
def test_weights_that_trackers_write_need_no_remark(tmp_path: Path, values: Doubles) -> None:
    assert opened(tmp_path, values).notes == ()


@pytest.mark.parametrize("name", ["jawOpn", "JawOpne", "jaw_opem", "jawOpenn"])
def test_a_channel_that_may_be_misspelled_is_carried_and_named(tmp_path: Path, name: str) -> None:
    take = opened(tmp_path, names=(name, *NAMES[1:]))
    assert take.carried == (name,)
    assert take.notes == (f'carried, although a channel may be meant: "{name}" (jawOpen)',)
    with pytest.raises(FileError, match=f'"{name}"; if jawOpen is meant, correct the name'):
        opened(tmp_path, face()[:, :1], names=(name,))


@pytest.mark.parametrize("name", ["Angry", "HeadYaw", "_neutral", "jawOpenRaw2", "confidence"])
def test_columns_that_are_no_channels_are_carried_without_a_remark(
    tmp_path: Path, name: str
) -> None:
    assert opened(tmp_path, 0.9 + 0 * face(), names=(*NAMES[:3], name)).notes == ()


@pytest.mark.parametrize("before", ["", "face.", "data.blendshapes."])
def test_words_that_points_join_are_one_name(tmp_path: Path, before: str) -> None:
    names = ("jaw.open", "eye.blink.left", "mouth.smile.left", "mouth.smile.right")
    take = opened(tmp_path, names=tuple(before + name for name in names))
    assert take.clip.channels == NAMES


@pytest.mark.parametrize("names", [("", "", "", "", ""), tuple(f"Unnamed: {k}" for k in range(5))])
def test_a_table_whose_columns_have_no_names_asks_for_them(
    tmp_path: Path, names: tuple[str, ...]
) -> None:
    with pytest.raises(FileError, match="write the ARKit names of the columns in a line at the"):
        opened(tmp_path, np.ones((FRAMES, 5)), names)


def test_columns_without_a_name_are_carried_and_counted(tmp_path: Path) -> None:
    take = opened(tmp_path, names=(NAMES[0], "", "", ""))
    assert take.clip.channels == NAMES[:1]
    assert take.notes == ("3 columns of numbers have no name: carried",)


def test_frames_of_which_the_tracker_was_not_sure_are_counted(tmp_path: Path) -> None:
    values = face()
    values[:, 3] = np.where(np.arange(FRAMES) < 12, 0.7, 0.9)
    take = opened(tmp_path, values, (*NAMES[:3], "confidence"))
    assert take.notes == ("the tracker was less than 80 % sure of 12 frames",)


def at_rates(*parts: tuple[int, float]) -> Doubles:
    """The times of rows: so many at each rate."""
    steps = np.concatenate([np.full(count, 1 / rate) for count, rate in parts])
    return np.concatenate([[0.0], np.cumsum(steps)[:-1]])


CHANGES: dict[str, tuple[tuple[tuple[int, float], ...], float, str]] = {
    "25 to 50": (((60, 25), (119, 50)), 50, "25 fps until 0:02.400, then 50 fps"),
    "50 to 25": (((100, 50), (59, 25)), 50, "50 fps until 0:02.000, then 25 fps"),
    "25 to 30": (((100, 25), (100, 30)), 30, "25 fps until 0:04.000, then 30 fps"),
    "30 to 24": (((100, 30), (100, 24)), 30, "30 fps until 0:03.333, then 24 fps"),
    "slower for a while": (
        ((60, 60), (30, 30), (60, 60)),
        60,
        "60 fps until 0:01.000, 30 fps until 0:02.000, then 60 fps",
    ),
}


@pytest.mark.parametrize(("parts", "rate", "said"), CHANGES.values(), ids=CHANGES)
@pytest.mark.parametrize("decimals", [4, 3])
def test_a_frame_rate_that_changes_is_said_and_makes_no_gaps(
    tmp_path: Path,
    parts: tuple[tuple[int, float], ...],
    rate: float,
    said: str,
    decimals: int,
) -> None:
    times = at_rates(*parts).round(decimals)
    values = np.resize(face(), (len(times), len(NAMES)))
    take = opened(tmp_path, values, times=times)
    assert (take.clip.rate, take.clip.gaps) == (rate, ())
    np.testing.assert_allclose(take.clip.times, times, atol=6e-4)
    assert take.notes == (f"the frame rate changes: {said}",)


def test_24_and_25_fps_are_told_apart_if_the_times_are_fine_enough(tmp_path: Path) -> None:
    times = at_rates((100, 24), (100, 25)).round(4)
    take = opened(tmp_path, np.resize(face(), (len(times), len(NAMES))), times=times)
    assert take.clip.rate == 25
    assert take.notes == ("the frame rate changes: 24 fps until 0:04.167, then 25 fps",)


@pytest.mark.parametrize("lost", [[20], [20, 21, 22, 23], range(20, 80, 7)])
def test_lost_frames_are_gaps_and_no_change_of_rate(tmp_path: Path, lost: list[int]) -> None:
    times = np.delete(np.arange(120) / 60, list(lost))
    take = opened(tmp_path, np.resize(face(), (len(times), len(NAMES))), times=times)
    assert sum(gap.missing for gap in take.clip.gaps) == len(lost)
    assert not any("changes" in note for note in take.notes)


WRITTEN: dict[str, tuple[Callable[[float], str], str]] = {
    "17 digits of Python": (lambda value: repr(float(value) * 1.0000001), "0.03265"),
    "10 decimals": (lambda value: f"{value:.10f}", "0.0326500000"),
    "percent, one decimal": (lambda value: f"{100 * value:.1f}", "3.26"),
    "percent, none": (lambda value: f"{100 * value:.0f}", "3.26"),
    "percent, as short as can be": (lambda value: f"{100 * value:.6g}", "3.265"),
}


@pytest.mark.parametrize(("write", "wanted"), WRITTEN.values(), ids=WRITTEN)
def test_a_changed_number_has_no_more_digits_than_it_needs(
    tmp_path: Path, write: Callable[[float], str], wanted: str
) -> None:
    rows = [",".join([f"{n / 30:.4f}", *map(write, row)]) for n, row in enumerate(face())]
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    path.write_text("\n".join([",".join(["time_s", *NAMES]), *rows]) + "\n")
    take = open_take(path)
    weights = take.clip.weights.copy()
    weights[20, 0] = 0.03265
    write_take(out, take, weights)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    assert [k for k in range(len(before)) if before[k] != after[k]] == [21]
    assert after[21].split(",")[1] == wanted
