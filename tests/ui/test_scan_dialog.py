"""Make a character from a scan in the window: the steps shown, a point moved, the result saved."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from support.faces import shipped_rig
from support.windows import Bench, trigger

from faceedit_app.characters import registration
from faceedit_app.characters.making import Template
from faceedit_app.characters.registration import Landmarks
from faceedit_app.core.arrays import Pixels
from faceedit_app.scans import steps
from faceedit_app.ui.character.scan_dialog import ScanDialog
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start.window import MainWindow


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    """Our own skin, 4 % longer, as a mesh without shapes."""
    template = Template.of(shipped_rig())
    path = tmp_path / "scan.ply"
    longer = template.vertices * (1.0, 1.04, 1.0)
    trimesh.Trimesh(longer, template.faces, process=False).export(path)
    return path


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Landmarks and pictures without networks and OpenGL."""

    def landmarks(template: Template, *_: object) -> Landmarks:
        points = {n: template.vertices[v] * (1.0, 1.04, 1.0) for n, v in template.points.items()}
        return template.landmarks(points)

    def picture(_rig: object, weights: np.ndarray, width: int, height: int, _at: object) -> Pixels:
        return np.full((height, width, 3), round(100 * float(weights.sum())) % 256, np.uint8)

    monkeypatch.setattr(steps, "find_landmarks", landmarks)
    monkeypatch.setattr(steps, "snapshot", picture)
    monkeypatch.setattr(registration, "_STEPS", ((0.02, 10.0, 0.5, 1),))  # near is near enough


def dialog_of(window: MainWindow) -> ScanDialog:
    found = window.findChild(ScanDialog)
    assert isinstance(found, ScanDialog)
    return found


def test_a_scan_becomes_the_character_that_is_shown(
    bench: Bench, scan: Path, drawn: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    window = bench.editing()
    monkeypatch.setattr(dialogs, "ask_scan", lambda *_: scan)
    trigger(window, "make_character")
    dialog = dialog_of(window)
    assert not dialog.save.isEnabled()
    bench.qtbot.waitUntil(dialog.save.isEnabled, timeout=60_000)
    assert "mm from the scan" in dialog.status.text()
    dialog.expression.setCurrentText("Smile")
    assert not dialog.character.is_empty

    start = dialog.points.place("chin").toPoint()
    stop = start - QPoint(0, 12)
    QTest.mousePress(dialog.points, Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(dialog.points, stop)
    QTest.mouseRelease(dialog.points, Qt.MouseButton.LeftButton, pos=stop)
    assert dialog.again.isEnabled()
    assert not dialog.save.isEnabled(), "the point would be lost"
    dialog.parts["brows"].click()
    assert not dialog.again.isEnabled()
    bench.qtbot.waitUntil(dialog.again.isEnabled, timeout=60_000)
    assert not dialog.save.isEnabled()
    assert "Press Fit again" in dialog.status.text()
    dialog.parts["brows"].click()
    bench.qtbot.waitUntil(dialog.again.isEnabled, timeout=60_000)
    QTest.mouseClick(dialog.again, Qt.MouseButton.LeftButton)
    assert not dialog.save.isEnabled()
    bench.qtbot.waitUntil(dialog.save.isEnabled, timeout=60_000)
    moved = dialog.points.place("chin").y()
    assert stop.y() - 12 < moved < start.y() - 3, "it follows the hand as far as a face allows"

    says = dialog.status.text()
    hair = dialog.parts["hair"]
    hair.setFocus()
    QTest.keyClick(hair, Qt.Key.Key_Space)
    assert not dialog.save.isEnabled()
    assert dialog.focusWidget() is dialog, "a second Space must not press Close"
    bench.qtbot.waitUntil(dialog.save.isEnabled, timeout=60_000)
    assert dialog.status.text() == says
    assert dialog.focusWidget() is hair

    path = tmp_path / "made.glb"
    monkeypatch.setattr(dialogs, "ask_save_character", lambda *_: path)
    QTest.mouseClick(dialog.save, Qt.MouseButton.LeftButton)
    bench.qtbot.waitUntil(lambda: window.document.character is not None)
    assert window.document.character is not None
    assert window.document.character.character.path == path
    assert len(window.document.character.match.matched) == 52
    surfaces = [part.surface.name for part in window.document.character.character.parts]
    assert "brows" in surfaces
    assert "hair" not in surfaces


def test_what_is_not_a_head_is_one_line_in_the_dialog(
    bench: Bench, drawn: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    window = bench.editing()
    bad = tmp_path / "bad.ply"
    bad.write_bytes(b"ply\nnothing")
    monkeypatch.setattr(dialogs, "ask_scan", lambda *_: bad)
    trigger(window, "make_character")
    dialog = dialog_of(window)
    bench.qtbot.waitUntil(lambda: "bad.ply" in dialog.status.text())
    assert not dialog.save.isEnabled()
    dialog.reject()
