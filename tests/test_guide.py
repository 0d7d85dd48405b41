"""The guide and the list of shortcuts tell what the window does."""

from __future__ import annotations

import importlib.util
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"


def test_the_list_of_shortcuts_is_that_of_the_table() -> None:
    spec = importlib.util.spec_from_file_location("shots", DOCS / "make_screenshots.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    written = (DOCS / "shortcuts.md").read_text(encoding="utf-8")
    assert written == module.shortcuts(), "run python docs/make_screenshots.py"


def test_contributors_find_every_room_in_the_table() -> None:
    package, table = DOCS.parent / "faceedit_app", DOCS.parent / "CONTRIBUTING.md"
    text = table.read_text(encoding="utf-8")
    rooms = {path.parent for path in package.glob("*/*.py")} - {package / "ui", package / "lab"}
    rooms |= {path.parent for path in package.glob("ui/*/*.py")}
    names = [room.relative_to(DOCS.parent).as_posix() for room in rooms]
    assert [name for name in names if f"| `{name}/`" not in text] == []
