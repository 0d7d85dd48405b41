"""How a file writes its numbers, so that new ones look like its own."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.formats.weights import BYTES, PERCENT, PERMILLE

# Coarser than this, an edited curve would move in visible steps.
_LEAST_PADDED, _LEAST_TRIMMED = 4, 6
_MOST_TRIMMED = 9  # the digits that float32 needs
_FEWEST = 5  # digits that changed weights have at most
_ALL = 7  # digits that show any change of a weight
_NUMBER = re.compile(rb"[+-]?\d*(?:\.(\d*))?([eE][+-]?\d+)?")
_DIGITS = bytes.maketrans(b"123456789", b"000000000")


@dataclass(frozen=True)
class NumberFormat:
    """How to write a weight.

    Attributes:
        decimals: digits after the point.
        padded: whether trailing zeros are written.
        exponent: `e` or `E` in scientific notation, else empty.
        least: digits after the point in scientific notation, if they are enough.
    """

    decimals: int
    padded: bool
    exponent: str = ""
    least: int = 0

    def write(self, value: float) -> bytes:
        """The text of a finite number; never a negative zero."""
        if self.exponent:
            texts = (f"{value:.{n}{self.exponent}}" for n in range(self.least, self.decimals))
            most = f"{value:.{self.decimals}{self.exponent}}"
            text = next((text for text in texts if float(text) == float(most)), most)
        else:
            text = f"{value:.{self.decimals}f}"
            if not self.padded:
                text = text.rstrip("0").rstrip(".")
        if text[0] == "-" and not float(text):
            text = text[1:]
        return text.encode()


def shortest(weights: Floats) -> Doubles:
    """The decimal numbers with the fewest digits that single precision keeps as these weights."""
    found: Doubles = weights.astype(np.float64).round(_FEWEST)
    rest = found.astype(np.float32) != weights
    for decimals in range(_FEWEST + 1, _MOST_TRIMMED + 1):
        if not rest.any():
            break
        exact = weights[rest].astype(np.float64)
        short = np.round(exact, decimals)
        fits = short.astype(np.float32) == weights[rest]
        found[rest] = np.where(fits, short, exact)
        rest[rest] = ~fits
    return found


def as_written(weights: Floats, scale: float, form: NumberFormat) -> Doubles:
    """Numbers that differ where those that a file shows for weights do."""
    if form.exponent or form.decimals >= _ALL:
        return weights.astype(np.float64)
    numbers: Doubles = (shortest(weights) * scale).round(form.decimals)
    return numbers


def is_number(text: str) -> bool:
    """Whether a text is a number, with a point or a comma."""
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


def kept_text(old: bytes, new: bytes, decimal: bytes = b".") -> bytes:
    """The old text of a number if the new one is the same number, else the new text."""
    try:
        same = float(old.replace(decimal, b".")) == float(new.replace(decimal, b"."))
    except ValueError:
        return new
    return old if same else new


def detect_format(texts: Iterable[bytes], scale: float = 1.0) -> NumberFormat:
    """Detect the number format from a sample of a file's numbers.

    Args:
        texts: the sample.
        scale: the value of a full blendshape.
    """
    fewer = round(math.log10(scale))
    decimals: Counter[int] = Counter()
    exponents: Counter[str] = Counter()
    total = 0
    shapes = Counter(text.translate(_DIGITS) for text in texts)  # few, however many numbers
    for shape, count in shapes.items():
        match = _NUMBER.fullmatch(shape)
        if match is None:
            continue
        total += count
        decimals[len(match[1] or b"")] += count
        exponents[chr(match[2][0]) if match[2] else ""] += count
    most = max(decimals, default=0)
    if scale in (BYTES, PERMILLE) and not most:
        return NumberFormat(0, True)  # a program that reads these reads whole numbers only
    # Python and JavaScript write small numbers such as `1e-05` among plain ones.
    exponent = max(exponents, key=lambda key: exponents[key], default="")
    if exponent:
        return NumberFormat(max(most, _LEAST_TRIMMED), True, exponent, most)
    if scale == PERCENT and len(decimals) == 1:  # all percentages have as many decimals
        return NumberFormat(max(most, _LEAST_PADDED - fewer), True)
    # Some programs write exact zeros and ones shorter than the rest (`0`, `0.0`).
    padded = most > 1 and decimals[most] + decimals[0] + decimals[1] == total
    padded = padded and decimals[most] > 1 and 10 * decimals[most] > total
    if padded:
        return NumberFormat(max(most, _LEAST_PADDED - fewer), True)
    return NumberFormat(min(max(most, _LEAST_TRIMMED - fewer), _MOST_TRIMMED - fewer), False)
