"""Synthesised performances as files: folders of takes in the Live Link Face format."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FaceEditError, FileError, reason_of
from faceedit_app.lab.training.speech import draw_speaker, synthesize

SPEAKERS = 16
SHORTEST, LONGEST = 10.0, 60.0  # seconds of a take

TIMECODE_BASE = 60  # the application counts sixtieths whatever the rate

_SWAPPED = {"jawLeft": "jawRight", "jawRight": "jawLeft", "mouthLeft": "mouthRight",
            "mouthRight": "mouthLeft"}  # fmt: skip
_COLUMNS = tuple(_SWAPPED.get(name, name) for name in ARKIT_CHANNELS)
_ROTATIONS = ("HeadYaw", "HeadPitch", "HeadRoll", "LeftEyeYaw", "LeftEyePitch", "LeftEyeRoll",
              "RightEyeYaw", "RightEyePitch", "RightEyeRoll")  # fmt: skip
LIVELINK_HEADER: tuple[str, ...] = (
    "Timecode",
    "BlendShapeCount",
    *(name[0].upper() + name[1:] for name in _COLUMNS),
    *_ROTATIONS,
)
"""The columns in the order of Live Link Face: the sideways channels have right before left."""


def write_performances(
    directory: Path | str,
    minutes: float,
    seed: int,
    progress: Callable[[int, int], None] | None = None,
) -> list[Path]:
    """Write a folder of takes, `speaker_NN_take_NN.csv`, and return their paths.

    Args:
        directory: made if it is missing; takes of the same names are replaced.
        minutes: of all takes together; they are shared out over `SPEAKERS` speakers in takes
            of at most a minute.
        seed: the same seed gives the same takes; 0 or more.
        progress: called with the number of takes written and the number of all.

    Raises:
        FaceEditError: `minutes` is not above 0.
        FileError: the folder cannot be made or written.
        Unavailable: espeak-ng is not installed.
    """
    if not minutes > 0:
        raise FaceEditError(f"synthesize: minutes is {minutes:g}; give a number above 0")
    directory = Path(directory)
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = reason_of(error)
        raise FileError(directory, f"cannot be made ({reason})", "choose another folder") from error
    total = 60.0 * minutes
    length = min(max(total / SPEAKERS, SHORTEST), LONGEST)
    count = max(1, math.ceil(total / length - 1e-9))
    paths = []
    for take in range(count):
        speaker, number = take % SPEAKERS, take // SPEAKERS
        seconds = min(length, total - take * length)
        _, weights = synthesize(
            seconds,
            seed=_derived(seed, take, 1),
            speaker=draw_speaker(np.random.default_rng(_derived(seed, speaker, 2))),
        )
        path = directory / f"speaker_{speaker + 1:02d}_take_{number + 1:02d}.csv"
        write_livelink(path, weights, start=f"10:{take // 60 % 60:02d}:{take % 60:02d}:00.000")
        paths.append(path)
        if progress is not None:
            progress(take + 1, count)
    return paths


def write_livelink(
    path: Path | str, weights: Floats, rate: float = 60.0, start: str = "10:00:00:00.000"
) -> None:
    """Write a take as the Live Link Face app would, with the head at rest.

    Args:
        path: a `.csv` file.
        weights: (T, 52) float32 in ARKit order.
        rate: frames a second.
        start: timecode of the first frame, `HH:MM:SS:FF.sss`.

    Raises:
        FileError: the file cannot be written.
    """
    write_atomically(path, livelink_bytes(weights, rate, start))


def livelink_bytes(weights: Floats, rate: float, start: str) -> bytes:
    """The content of the file that `write_livelink` writes."""
    ordered = weights[:, [ARKIT_INDEX[name] for name in _COLUMNS]].astype(np.float64)
    values = np.concatenate([ordered, rotations(weights)], axis=1)
    first, step = _frames(start), TIMECODE_BASE / rate
    row = ",".join(["%.10f"] * values.shape[1])
    lines = [",".join(LIVELINK_HEADER)]
    lines += [
        f"{_timecode(first + i * step)},{values.shape[1]}," + row % tuple(frame)
        for i, frame in enumerate(values)
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def rotations(weights: Floats) -> Doubles:
    """(T, 9) radians: the head rests, the eyes turn as the eyeLook channels say.

    The factors are those between the application's own columns: 0.6 rad sideways and 0.5 rad
    up or down at weight 1, straight ahead at a little convergence.
    """

    def channel(name: str) -> Doubles:
        return weights[:, ARKIT_INDEX[name]].astype(np.float64)

    out = np.zeros((len(weights), len(_ROTATIONS)))
    for column, side, sign in ((3, "Left", -1.0), (6, "Right", 1.0)):
        outward = channel("eyeLookOut" + side) - channel("eyeLookIn" + side)
        down = channel("eyeLookDown" + side) - channel("eyeLookUp" + side)
        out[:, column] = sign * (0.6 * outward + 0.063)
        out[:, column + 1] = 0.5 * down + 0.015
    return out


def _frames(timecode: str) -> float:
    found = re.fullmatch(r"(\d\d):(\d\d):(\d\d):(\d\d(?:\.\d+)?)", timecode)
    if found is None:
        raise ValueError(f"not a timecode HH:MM:SS:FF.sss: {timecode!r}")
    hours, minutes, seconds = (int(part) for part in found.groups()[:3])
    return ((hours * 60 + minutes) * 60 + seconds) * TIMECODE_BASE + float(found[4])


def _timecode(frames: float) -> str:
    whole, thousandths = divmod(round(frames * 1000), 1000)
    seconds, frame = divmod(whole, TIMECODE_BASE)
    minutes, second = divmod(seconds, 60)
    hour, minute = divmod(minutes, 60)
    return f"{hour % 24:02d}:{minute:02d}:{second:02d}:{frame:02d}.{thousandths:03d}"


def _derived(seed: int, index: int, purpose: int) -> int:
    """A seed of its own for each take and each speaker."""
    return int(np.random.SeedSequence([seed, index, purpose]).generate_state(1)[0])
