"""Texts that may come from files, made fit for messages and terminals."""

from __future__ import annotations

import sys
from typing import TextIO

LONGEST = 300  # characters of a message, whatever a file or its name contains


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


def say(text: str, to: TextIO | None = None) -> None:
    """Print lines on the terminal; on standard output by default."""
    print("\n".join(map(printable, text.split("\n"))), file=to or sys.stdout)
