"""The guide and the list of shortcuts tell what the window does."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"


def test_the_list_of_shortcuts_is_that_of_the_table() -> None:
    spec = importlib.util.spec_from_file_location("shots", DOCS / "make_screenshots.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    written = (DOCS / "shortcuts.md").read_text(encoding="utf-8")
    assert written == module.shortcuts(), "run python docs/make_screenshots.py"


@pytest.mark.parametrize("page", ["docs/guide.md", "README.md"])
def test_every_picture_and_page_is_there(page: str) -> None:
    path = DOCS.parent / page
    for target in re.findall(r"\]\(([^)]+)\)", path.read_text(encoding="utf-8")):
        assert (path.parent / target.partition("#")[0]).exists(), target
