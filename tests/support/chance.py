"""How many random cases the tests try."""

from __future__ import annotations

import os

TIMES = int(os.environ.get("FACEEDIT_TIMES", "1"))


def seeds(count: int) -> range:
    """Seeds of so many random cases; `FACEEDIT_TIMES=10` tries ten times as many."""
    return range(count * TIMES)
