"""Find the scale of a file's weights, and weights that are impossible."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

PERCENT = 100.0
PERCENT_NOTE = "the weights run from 0 to 100: read as percent, and written as percent"
BYTES = 255.0
_BYTES_NOTE = "the weights run from 0 to 255: read as such, and written as such"
# Trackers exceed 1 by a few hundredths, exaggerated takes by a factor; beyond that it is damage.
LARGEST = 10.0
_TWICE = 2.0
_FAR, _BELOW = 1.5, -0.02  # full blendshapes that a tracker does not go beyond
PERMILLE = 1000.0
_PERMILLE_NOTE = "the weights run from 0 to 1000: read as such, and written as such"
_BEYOND_PERCENT = 150.0  # whole numbers that go this far are bytes
_BEYOND_BYTES = 300.0  # numbers of which some share goes this far are thousandths
_SHARE = 0.01
_WEIGHTS = r"(?:weights?|values?|blend ?shapes?|coefficients?|scores?)"
_TO = r"\s*(?:-|–|\.\.|to)\s*"
_HUNDRED = rf"(?:percent|\bpct\b|(?<![\d.])%|\b0(?:\.0)?{_TO}100\b)"
_IN_PERCENT = re.compile(
    rf"\b{_WEIGHTS}\b(?:(?!frame)[^,;]){{0,30}}?{_HUNDRED}|{_HUNDRED}[^,;]{{0,10}}?\b{_WEIGHTS}\b",
    re.IGNORECASE,
)
_NOT_PERCENT = re.compile(rf"\bnot\b|\b0(?:\.0)?{_TO}1(?:\.0)?\b", re.IGNORECASE)
_LONG_ENOUGH = 10  # frames that show how far a channel goes
_MOVING = 0.1  # the largest number of a channel that moves, if it runs from 0 to 1
_MOST = 0.5  # share of its numbers that are not whole
_MANY = 0.15  # share of the weights that are not 0


def scale_of(values: NDArray[Any]) -> float:
    """The value of a full blendshape in a file: 1, 100 for percent, 255 for bytes, or 1000.

    Args:
        values: all weights, on the file's scale; NaN if missing.
    """
    sizes = np.abs(values[np.isfinite(values) & (values != 0)])
    sizes = sizes[sizes <= LARGEST * PERCENT]
    if not len(sizes) or ((sizes > _TWICE).mean() <= _MANY and not _stay_large(values)):
        return 1.0
    whole = np.all(sizes == np.round(sizes))
    if (sizes > _BEYOND_BYTES).mean() > _SHARE:
        return PERMILLE
    return BYTES if whole and _BEYOND_PERCENT < sizes.max() <= BYTES else PERCENT


def _stay_large(values: NDArray[Any]) -> bool:
    """Whether a channel of (T, K) is impossible from 0 to 1 for many frames, not for a moment."""
    if values.ndim < 2 or not len(values):
        return False
    large = np.abs(values) > LARGEST
    return bool((large.sum(axis=0) >= _LONG_ENOUGH).sum() >= 2)


def says_percent(text: str) -> bool:
    """Whether a line of text says that weights are percent: `# weights in percent (0-100)`."""
    return _IN_PERCENT.search(text) is not None and _NOT_PERCENT.search(text) is None


def scale_notes(scale: float) -> tuple[str, ...]:
    """The note about a scale other than 0 to 1."""
    notes = {PERCENT: PERCENT_NOTE, BYTES: _BYTES_NOTE, PERMILLE: _PERMILLE_NOTE}
    return (notes[scale],) if scale in notes else ()


def mixed_notes(values: NDArray[Any], scale: float, channels: Sequence[str]) -> tuple[str, ...]:
    """The note about channels of a take in percent that seem to run from 0 to 1.

    Args:
        values: (T, K) on the file's scale, finite.
        channels: their K names.
    """
    if scale != PERCENT or len(values) < _LONG_ENOUGH:
        return ()
    sizes = np.abs(values)
    moving = (sizes.max(axis=0) > _MOVING) & (np.mean(sizes % 1 != 0, axis=0) > _MOST)
    small = [channels[k] for k in np.flatnonzero(moving & (sizes.max(axis=0) <= 1)).tolist()]
    if not small:
        return ()
    if len(small) == 1:
        return (f"{small[0]} never passes 1 %: correct the file if it runs from 0 to 1",)
    several = f"{small[0]} and {len(small) - 1} more"
    return (f"{several} never pass 1 %: correct the file if they run from 0 to 1",)


def odd_notes(
    values: NDArray[Any], scale: float, channels: Sequence[str], place: Callable[[int, int], str]
) -> tuple[str, ...]:
    """The notes about weights far above a full blendshape, and about those below 0.

    Args:
        values: (T, K) on the file's scale, finite.
        channels: their K names.
        place: where the file has a weight, by frame and channel.
    """
    high, low = values > _FAR * scale, values < _BELOW * scale
    notes = []
    if high.any():
        several = f"{high.sum()} weights are far above {scale:g}: " if high.sum() > 1 else ""
        most = _farthest(values, high, channels, place)
        notes.append(f"{several}{most}, where {scale:g} is a full blendshape")
    if low.any():
        several = f"{low.sum()} weights are below 0: " if low.sum() > 1 else ""
        notes.append(f"{several}{_farthest(values, low, channels, place)}, and stays so")
    return tuple(notes)


def _farthest(
    values: NDArray[Any],
    odd: NDArray[np.bool_],
    channels: Sequence[str],
    place: Callable[[int, int], str],
) -> str:
    """What and where the largest of some weights is."""
    frame, k = divmod(int(np.argmax(np.where(odd, np.abs(values), -1.0))), values.shape[1])
    return f"{channels[k]} is {values[frame, k]:g} {place(frame, k)}"


def first_impossible(values: NDArray[Any], scale: float) -> tuple[int, int] | None:
    """Row and column of the first of the weights (T, K) that is impossible, or None."""
    wrong = np.argwhere(np.abs(values) > LARGEST * scale)
    return (int(wrong[0, 0]), int(wrong[0, 1])) if len(wrong) else None


def impossible(value: float | str, scale: float) -> str:
    """What is wrong with a weight, as a phrase to follow its name."""
    text = f"{value:g}" if isinstance(value, float) else value
    return f"is {text}, where {scale:g} is a full blendshape"
