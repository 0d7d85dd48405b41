"""Small synthetic takes in the layouts that real files have."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Floats

ROTATIONS = tuple(
    part + axis for part in ("Head", "LeftEye", "RightEye") for axis in ("Yaw", "Pitch", "Roll")
)


class NoFile:
    """The source of a take that was never in a file: its export is the bare numbers."""

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        return edited.tobytes()


def livelink_names() -> list[str]:
    """The application's own spelling and order: upper case, right before left in two places."""
    names = [name[0].upper() + name[1:] for name in ARKIT_CHANNELS]
    for left, right in (("JawLeft", "JawRight"), ("MouthLeft", "MouthRight")):
        i, k = names.index(left), names.index(right)
        names[i], names[k] = right, left
    return names


def timecode(frame: float, base: int = 60) -> str:
    """`HH:MM:SS:FF.sss` of a frame that is counted from midnight."""
    seconds, thousandths = divmod(round(frame * 1000), base * 1000)
    minutes, second = divmod(seconds, 60)
    hours, minute = divmod(minutes, 60)
    frames, part = divmod(thousandths, 1000)
    return f"{hours % 24:02d}:{minute:02d}:{second:02d}:{frames:02d}.{part:03d}"


def speech_like(frames: int, rate: float, channels: Iterable[str]) -> NDArray[np.float64]:
    """(frames, K) weights with a talking jaw, a moving mouth and two blinks a second apart."""
    t = np.arange(frames) / rate
    jaw = 0.25 + 0.2 * np.sin(2 * np.pi * 2.0 * t) * np.sin(2 * np.pi * 0.3 * t)
    blink = 0.05 + 0.8 * np.exp(-(((t % 1.0 - 0.5) / 0.06) ** 2))
    moving: dict[str, NDArray[np.float64]] = {
        "jawOpen": jaw,
        "mouthClose": 0.3 * jaw,
        "mouthFunnel": 0.1 + 0.1 * np.sin(2 * np.pi * 1.3 * t),
        "mouthSmileLeft": 0.2 + 0.1 * np.sin(2 * np.pi * 0.5 * t),
        "mouthSmileRight": 0.2 + 0.1 * np.sin(2 * np.pi * 0.5 * t),
        "eyeBlinkLeft": blink,
        "eyeBlinkRight": blink,
    }
    zero = np.zeros(frames)
    by_lower = {name.lower(): values for name, values in moving.items()}
    return np.stack([by_lower.get(name.lower(), zero) for name in channels], axis=1)


def make_livelink_csv(
    path: Path,
    seconds: float = 2.0,
    rate: int = 60,
    *,
    base: int = 60,
    start: float = 12 * 3600 * 60 + 0.169,
    decimals: int = 10,
    dropped: Iterable[int] = (),
    untracked: Iterable[int] = (),
    names: list[str] | None = None,
    count_name: str = "BlendShapeCount",
    extra: Mapping[str, str] | None = None,
    newline: str = "\n",
    spell: Callable[[str], str] = str,
    weights: NDArray[np.float64] | None = None,
) -> Path:
    """Write a Live Link Face CSV of `seconds` at `rate` on a timecode of `base`.

    Args:
        start: frame of the base since midnight at which the recording begins.
        decimals: digits after the point of every number.
        dropped: frames that are absent.
        untracked: frames at which the face was lost: timecode and a count of 0 only.
        names: the blendshape columns; by default the application's own.
        extra: columns after all others, with the text of their cells.
        spell: changes each timecode before it is written.
        weights: (frames, len(names)); by default `speech_like`.
    """
    rows = (seconds, rate, base, start, decimals, frozenset(dropped), frozenset(untracked))
    if names is None and not extra and weights is None and spell is str:
        lines = _usual_lines(count_name, *rows)
    else:
        lines = _lines(count_name, *rows, names, extra, spell, weights)
    path.write_bytes((newline.join(lines) + newline).encode())
    return path


def _lines(
    count_name: str,
    seconds: float,
    rate: int,
    base: int,
    start: float,
    decimals: int,
    dropped: frozenset[int],
    untracked: frozenset[int],
    names: list[str] | None = None,
    extra: Mapping[str, str] | None = None,
    spell: Callable[[str], str] = str,
    weights: NDArray[np.float64] | None = None,
) -> tuple[str, ...]:
    names = livelink_names() if names is None else names
    extra = dict(extra or {})
    frames = round(seconds * rate) if weights is None else len(weights)
    weights = speech_like(frames, rate, names) if weights is None else weights
    count = len(names) + len(ROTATIONS) + len(extra)
    lines = [",".join(["Timecode", count_name, *names, *ROTATIONS, *extra])]
    turns = [f"{0.01 * k - 0.04:.{decimals}f}" for k in range(len(ROTATIONS))]
    for frame in range(frames):
        code = spell(timecode(start + frame * base / rate, base))
        if frame in untracked:
            lines.append(f"{code},0")
        elif frame not in dropped:
            cells = [f"{value:.{decimals}f}" for value in weights[frame].tolist()]
            lines.append(",".join([code, str(count), *cells, *turns, *extra.values()]))
    return tuple(lines)


_usual_lines = lru_cache(maxsize=32)(_lines)  # most tests want the same few takes


def make_plain_csv(
    path: Path,
    seconds: float = 2.0,
    rate: float = 30.0,
    channels: tuple[str, ...] = ARKIT_CHANNELS,
) -> Path:
    """Write a CSV with `time_s` and ARKit names, 4 and 5 decimals."""
    frames = round(seconds * rate)
    weights = speech_like(frames, rate, channels)
    lines = [",".join(["time_s", *channels])]
    for frame in range(frames):
        cells = [f"{value:.5f}" for value in weights[frame]]
        lines.append(",".join([f"{frame / rate:.4f}", *cells]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="")
    return path
