"""Something that cannot be painted neither ends the window nor is reported for ever."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget
from support.windows import Bench

import faceedit_app.ui
from faceedit_app.ui.look import guard


class Broken(QWidget):
    """Fails while a painter is open."""

    paints = 0

    @guard.guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Open a painter, then fail."""
        painter = QPainter(self)
        self.paints += 1
        with guard.saved(painter):
            raise ValueError("not a number")


def test_a_failing_paint_event_is_reported_once_and_the_rest_is_painted(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, qtlog: Any
) -> None:
    reports: list[BaseException] = []
    monkeypatch.setattr(sys, "excepthook", lambda kind, error, trace: reports.append(error))
    monkeypatch.setattr(guard, "_reported", set[str]())
    widget = Broken()
    bench.qtbot.addWidget(widget)
    widget.show()
    bench.qtbot.waitUntil(lambda: bool(reports))
    for _ in range(3):
        before = widget.paints
        widget.repaint()
        assert widget.paints > before
    assert [str(error) for error in reports] == ["Broken.paintEvent: ValueError: not a number"]
    assert not [line for line in qtlog.records if "saved states" in line.message]


def test_every_paint_method_of_the_window_is_guarded() -> None:
    found = 0
    for path in Path(*faceedit_app.ui.__path__).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.name in ("paint", "paintEvent"):
                found += 1
                names = [ast.unparse(decorator) for decorator in node.decorator_list]
                assert "guarded" in names, f"{path}: {node.name}"
    assert found > 10
