"""Writes the table of formats into README.md and docs/formats.md.

python docs/make_tables.py
"""

from __future__ import annotations

import re
from pathlib import Path

from faceedit_app.formats.registry import markdown_table

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("README.md", "docs/formats.md")
_PLACE = re.compile(r"(<!-- formats:[^\n]*-->\n).*?(<!-- end of formats -->)", re.DOTALL)


def with_tables(text: str) -> str:
    """A page with the table of formats where it belongs."""
    return _PLACE.sub(lambda match: f"{match[1]}{markdown_table()}{match[2]}", text)


if __name__ == "__main__":
    for name in PAGES:
        page = ROOT / name
        page.write_text(with_tables(page.read_text(encoding="utf-8")), encoding="utf-8")
