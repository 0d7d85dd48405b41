"""Texts that may come from files, made fit for messages and terminals."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import TextIO

LONGEST = 300  # characters of a message, whatever a file or its name contains
_LONGEST_NAME = 80  # characters of a name that may be misspelled
# How alike names are, 0 to 1, that differ in one letter, or in a few.
ONE_LETTER, FEW_LETTERS = 0.85, 0.7


def printable(text: str) -> str:
    """A text in which `?` stands for all characters that do not print.

    These are terminal escapes, line ends, marks that reverse the direction of writing, and the
    bytes of names that are not UTF-8.
    """
    return text if text.isprintable() else "".join(c if c.isprintable() else "?" for c in text)


def plain_line(text: str, longest: int = LONGEST) -> str:
    """A text as one printable line of a message, which ends in an ellipsis if it was longer."""
    line = printable(" ".join(text[: 4 * longest].split()))
    return line if len(line) <= longest else f"{line[: longest - 1]}…"


def listed(words: Iterable[str]) -> str:
    """Words as a list in a sentence, such as `brows, jaw and tongue`; each word once."""
    *first, last = dict.fromkeys(words)
    return f"{', '.join(first)} and {last}" if first else last


def say(text: str, to: TextIO | None = None) -> None:
    """Print lines on the terminal; on standard output by default."""
    print("\n".join(map(printable, text.split("\n"))), file=to or sys.stdout)


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """The names that were probably meant by an unknown one, as a phrase that follows it.

    Args:
        name: the unknown name.
        names: those that there are; case, spaces and underscores make no difference.

    Returns:
        Such as ` (did you mean mouth_opening?)`; "" if none is near.
    """
    by_key = {_letters(one): one for one in names}
    near = near_names(_letters(name[:_LONGEST_NAME]), by_key, FEW_LETTERS)
    return f" (did you mean {' or '.join(near)}?)" if near else ""


def near_names(key: str, by_key: Mapping[str, str], likeness: float) -> list[str]:
    """At most three of some names that were probably meant by an unknown one, the nearest first.

    Args:
        key: what is compared of the unknown name, such as its letters.
        by_key: the names that there are, by the same of each.
        likeness: the least, 0 to 1.
    """
    return [by_key[near] for near in get_close_matches(key, by_key, 3, likeness)]


def _letters(name: str) -> str:
    return "".join(c for c in name.lower() if c.isalnum())
