"""Times in two columns: seconds and a fraction, or a number and how many of them make a second."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal, InvalidOperation

from faceedit_app.formats.time_names import NAMED_TIMES, UNIT_ALONE, is_scale, rank, stem, unit_of

_PARTS = {"milliseconds": 1_000, "microseconds": 1_000_000, "nanoseconds": 1_000_000_000}
_MOST = 10**18  # what no part of a time reaches


def joined_parts(
    names: Sequence[str], texts: Sequence[Sequence[str]]
) -> dict[int, tuple[int, list[str]]]:
    """The times of which one column has only a part.

    Args:
        names: (C) of columns that may have times.
        texts: (C) per column its T texts.

    Returns:
        By the index of a column, that of the other part, and (T) texts in seconds.
    """
    units = [unit_of(name) for name in names]
    for whole, name in enumerate(names):
        for part, other in enumerate(names):
            if units[whole] == "seconds" and units[part] in _PARTS and stem(name) == stem(other):
                joined = _with_fraction(texts[whole], texts[part], _PARTS[units[part] or ""])
                if joined:
                    return {whole: (part, joined)}
    scale = next((k for k, name in enumerate(names) if is_scale(name)), None)
    if scale is not None:
        for value, name in enumerate(names):
            if rank(name) in (NAMED_TIMES, UNIT_ALONE) and units[value] is None:
                joined = _scaled(texts[value], texts[scale])
                if joined:
                    return {value: (scale, joined)}
    return {}


def _with_fraction(whole: Sequence[str], part: Sequence[str], second: int) -> list[str]:
    """Seconds with their fraction, of which `second` make one; empty if they are whole times."""
    seconds, fractions = _whole(whole), _whole(part)
    if not seconds or not fractions or not all(0 <= one < second for one in fractions):
        return []
    digits = len(str(second)) - 1
    return [f"{s}.{f:0{digits}d}" for s, f in zip(seconds, fractions, strict=True)]


def _scaled(values: Sequence[str], scales: Sequence[str]) -> list[str]:
    """Seconds, of each of which a scale says how many units it has; empty if they are no such."""
    numbers, units = _whole(values), _whole(scales)
    if not numbers or not units or min(units) < 1:
        return []
    pairs = zip(numbers, units, strict=True)
    return [f"{Decimal(number) / unit:.12f}" for number, unit in pairs]


def _whole(texts: Sequence[str]) -> list[int]:
    """The whole numbers, from 0, that texts are; empty if not all of them are."""
    try:
        found = [Decimal(text) for text in texts]
    except InvalidOperation:
        return []
    if "_" in "".join(texts) or not all(one.is_finite() and 0 <= one < _MOST for one in found):
        return []
    return [int(one) for one in found] if all(one == int(one) for one in found) else []
