"""How many random cases the tests try, and of what."""

from __future__ import annotations

import os

from hypothesis import strategies as st

TIMES = int(os.environ.get("FACEEDIT_TIMES", "1"))
# All that UTF-8 can write, as in `st.text()`; that tries each of a million, in each process.
CHARACTERS = st.characters(exclude_categories=["Cs"])


def seeds(count: int) -> range:
    """Seeds of so many random cases; `FACEEDIT_TIMES=10` tries ten times as many."""
    return range(count * TIMES)
