"""What a further preset file does (run by tests/test_where_to_add.py)."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from PySide6.QtWidgets import QMenu, QToolButton
from support.places import ROOT
from support.windows import Bench, bench, trigger

from faceedit_app.core.controls import LIDS

__all__ = ["bench"]


def test_it_is_in_menu_tool_bar_and_help(bench: Bench) -> None:
    window = bench.editing()
    action = window.actions_["fix_wink"]
    menus = [menu for menu in window.menuBar().findChildren(QMenu) if action in menu.actions()]
    assert [menu.title() for menu in menus] == ["Fi&x"]
    texts = [entry.text() for entry in menus[0].actions()]
    assert texts.index("&Open eyes") + 1 == texts.index("Win&k") < texts.index("&Smile")
    assert action.shortcut().toString() == "Ctrl+Alt+W"
    assert not action.icon().isNull()
    assert "The left eye winks" in action.toolTip()
    assert any(b.defaultAction() is action for b in window.findChildren(QToolButton))


def test_it_makes_its_edit(bench: Bench) -> None:
    window = bench.editing()
    session = window.document.session
    assert session is not None
    trigger(window, "fix_wink")
    (edit,) = session.edits
    assert (edit.name, edit.controls) == ("Wink", LIDS[:1])
    assert session.changed_frames() > 0


def test_it_is_in_the_list_of_shortcuts() -> None:
    path = ROOT / "docs" / "make_screenshots.py"
    assert Path.cwd() == ROOT, "this must be the copy"
    spec = importlib.util.spec_from_file_location("make_screenshots", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert "| Ctrl+Alt+W | The left eye winks |" in module.shortcuts()
