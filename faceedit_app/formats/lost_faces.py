"""How files say that the face was lost: flags, missing numbers, and other text in their place."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.formats.timing import counted

# What programs write in place of a missing number, in lower case.
MISSING = frozenset(
    (
        *("", "nan", "-nan", "+nan", "na", "n/a", "<na>", "-nan(ind)", "nan(ind)", "1.#qnan"),
        *("1.#ind", "-1.#ind", "#n/a", "#value!", "#div/0!", "#num!", "null", "(null)", "none"),
        *("nil", "undefined", "-", "--", "?", "\\n", "missing", "nodata"),
    )
)
CONFIDENCE = "confidence"
LEAST_SURE = 1e-3
"""The least confidence that is written; 0 would mean that the face was lost."""
_COUNTS = ("blendshapecount", "numproperties")
# Names of flags, letters only, in lower case: 0 or false if the face was not tracked.
_TRACKED = (
    *(CONFIDENCE, "success", "tracked", "istracked", "facetracked", "tracking", "istracking"),
    *("detected", "facedetected", "facefound", "hasface", "facevisible", "valid", "isvalid"),
    *("numfaces", "facecount", "faces", "nfaces"),
)
_STATES = ("trackingstate", "trackingstatus", "facestate", "facestatus", "state", "status")
_LOST = ("lost", "islost", "facelost", "trackinglost", "noface", "facemissing")
_NO = frozenset(("0", "0.0", "0.00", "0.000", "false", "no"))
_YES = frozenset(("1", "1.0", "true", "yes"))
# What a flag or state says without a number, letters only.
_LOST_WORDS = frozenset(
    (
        *("lost", "nottracking", "nottracked", "untracked", "notdetected", "undetected", "noface"),
        *("facelost", "trackinglost", "notavailable", "notfound", "facenotfound"),
    )
)
_NOT_TRACKED = -1.0  # or less, in every column of a row
_SENTINEL = 999.0  # no weight on any scale, in every column of a row
_FEWEST_NUMBERS = 3  # of a row that such numbers mark as lost
_FACE = 8  # channels of a row that are not all 0 by chance
_ABRUPT = 0.05  # full blendshapes by which a frame beside such a row differs
_REMEMBERED = 1_000  # names, without case and separators
_WORD = re.compile(r"[^\W\d_]{3}")
_TIME_UNIT = re.compile(r"[\[(]?(?:s|secs?|seconds?|ms|msecs?|milliseconds?|frames?)[\])]?", re.I)


@lru_cache(_REMEMBERED)  # all rows of a file are asked about the same flag
def letters(name: str) -> str:
    """A name without case and separators."""
    return re.sub(r"[\W_]", "", name).lower()


def flag_column(names: Sequence[str]) -> int | None:
    """The column that says whether a row has a face, the most reliable first, or None."""
    bare = [letters(name) for name in names]
    flags = (*_COUNTS, *_TRACKED, *_LOST, *_STATES)
    return next((bare.index(name) for name in flags if name in bare), None)


def confidence_of(numbers: Doubles) -> Floats | None:
    """(T,) how sure a tracker was; None if the numbers are no confidences, from 0 to 1."""
    fits = ((numbers >= 0.0) & (numbers <= 1.0)).all()
    return numbers.astype(np.float32) if fits else None


def confidence_cells(confidence: Floats) -> list[str]:
    """The texts of (T,) confidences; one of 0 would mean that the face was lost."""
    return [f"{max(v, LEAST_SURE):.3f}" if v > 0 else "" for v in confidence.tolist()]


def is_count(name: str) -> bool:
    """Whether a flag is the number of values in a row."""
    return letters(name) in _COUNTS


def is_flag(name: str) -> bool:
    """Whether a field says whether the face was tracked."""
    return letters(name) in (*_TRACKED, *_LOST, *_STATES)


def says_lost(name: str, value: str) -> bool:
    """Whether a flag of this name says that the face was lost.

    Args:
        value: its text; a number of a state says nothing.
    """
    word, text = letters(name), value.strip().lower()
    if letters(text) in _LOST_WORDS:
        return True
    if word in _LOST:
        return text in _YES
    return word not in _STATES and text in _NO


def is_missing(text: str) -> bool:
    """Whether a cell's text stands for a missing number."""
    return text.lower() in MISSING


def is_time_unit(text: str) -> bool:
    """Whether a cell's text is the unit of a time; then its row has units, and lost no face."""
    return _TIME_UNIT.fullmatch(text) is not None


def has_no_numbers(texts: Sequence[str]) -> bool:
    """Whether a row says in words that it has no numbers, such as `lost` in all or one of them."""
    said = {text.lower() for text in texts} - MISSING
    if len(said) != 1 or len(texts) < _FEWEST_NUMBERS:
        return False
    return not any(character.isdigit() for character in said.pop())


def lost_rows(numbers: Doubles, flagged: Bools) -> Bools:
    """(R,) which rows have no frame: without a number, or with one number in place of all.

    Args:
        numbers: (R, N), NaN if missing.
        flagged: (R,) whether the row says so itself.
    """
    if flagged.all() and np.nan_to_num(numbers).any():  # this tool never fills in the flag
        flagged = np.zeros_like(flagged)
    lost: Bools = np.all(~np.isfinite(numbers), axis=1) | flagged
    if numbers.shape[1] >= _FEWEST_NUMBERS:
        first = numbers[:, 0]
        same = np.all(numbers == first[:, None], axis=1)
        lost |= same & ((first <= _NOT_TRACKED) | (first >= _SENTINEL))
    return lost


def count_without_footer(texts: Sequence[Sequence[str]], lost: Bools) -> int:
    """How many of R rows are left without those at the end that are no rows, such as `END`.

    Args:
        texts: (R) the texts of a row in some columns; its time, if it were a row, has a digit, and
            no words that the times of other rows lack.
        lost: (R,) which rows have no frame.
    """
    count = len(lost)
    usual = texts[int(np.argmin(lost))] if count else ()
    while count and lost[count - 1] and any(texts[count - 1]):
        digits = any(letter.isdigit() for text in texts[count - 1] for letter in text)
        if digits and not any(map(_says_more, texts[count - 1], usual)):
            break
        count -= 1
    return count


def _says_more(text: str, usual: str) -> bool:
    """Whether a text has words, such as `Total frames: 75`, in place of one such as `2.96`."""
    if is_missing(text) or letters(text) in _LOST_WORDS or text.lower() in (*_NO, *_YES):
        return False
    return bool(_WORD.search(text)) and not _WORD.search(usual)


def blank_notes(weights: Floats) -> tuple[str, ...]:
    """The note about frames of (T, K) in which all weights drop to 0 at once.

    Some tools write them where the face was lost; a neutral face of a synthetic take is also 0.
    """
    if len(weights) < _FEWEST_NUMBERS or weights.shape[1] < _FACE:
        return ()
    blank: Bools = np.all(weights == 0, axis=1)
    if not blank.any() or blank.mean() > 0.5:
        return ()
    edges = np.flatnonzero(np.diff(blank.astype(np.int8)))
    steps = np.abs(weights[edges] - weights[edges + 1]).max(axis=1, initial=0.0)
    if not len(edges) or np.median(steps) < _ABRUPT:
        return ()
    places = int((blank & ~np.concatenate([[False], blank[:-1]])).sum())
    where = f"in {counted(int(blank.sum()), 'frame')} at {counted(places, 'place')}"
    return (f"all weights are 0 {where}: the face may have been lost there",)
