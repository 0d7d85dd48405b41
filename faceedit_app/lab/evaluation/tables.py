"""Numbers and tables in Markdown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def cell(value: float, digits: int = 4) -> str:
    """A number for a table; a dash if there is none."""
    return f"{round(value, digits) + 0.0:.{digits}f}" if np.isfinite(value) else "–"


def markdown_table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])
