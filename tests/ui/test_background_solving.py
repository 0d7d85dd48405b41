"""A wide edit of a long take is computed while the window goes on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyqtgraph as pg
import pytest
from PySide6.QtWidgets import QPushButton
from support.takes import make_livelink_csv
from support.waiting import run_events
from support.windows import Bench, editor_of, session_of, trigger

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state import background_solving as solving

WIDE = Edit(("mouth_opening",), Op.OFFSET, 0.0, 1000.0, 0.0, 4.0)


@pytest.fixture
def window(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> MainWindow:
    """A window with a take of many chunks, on a machine that is slow enough to be watched."""
    monkeypatch.setattr(solving, "PATIENCE", 0.0)
    monkeypatch.setattr(solving, "SLICE", 0.0)
    monkeypatch.setattr(solving, "REDRAW", 0.0)
    monkeypatch.setattr(solving, "QUIET", 0.0)
    return bench.window(make_livelink_csv(bench.folder / "long.csv", seconds=60.0))


def parts(window: MainWindow) -> solving.BackgroundSolving:
    assert window.editor is not None
    return window.editor.solving


def begin(window: MainWindow) -> np.ndarray:
    tracked = session_of(window).weights.copy()
    window.document.act(lambda session: session.add(WIDE))
    assert parts(window).is_busy
    assert not session_of(window).live.is_complete
    return tracked


def test_what_is_on_screen_is_there_at_once_and_the_rest_follows(
    bench: Bench, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    trigger(window, "all_channels")
    panel = editor_of(window).channels
    assert panel is not None
    bench.qtbot.waitUntil(panel.isVisible)
    run_events()
    window.timeline.go_to_time(40.0)
    window.timeline.show_range(39.0, 41.0)
    tracked = begin(window)
    frame = window.timeline.frame
    session = session_of(window)
    assert (session.weights[frame] != tracked[frame]).any()
    np.testing.assert_array_equal(session.weights[0], tracked[0])
    drawn: list[None] = []
    monkeypatch.setattr(editor_of(window).face.viewport, "redraw", lambda: drawn.append(None))
    bench.qtbot.waitUntil(lambda: not parts(window).is_busy)
    assert (session.weights != tracked).any(axis=1).all()
    (plot,) = panel.plots
    _, edited = (item for item in plot.view.addedItems if isinstance(item, pg.PlotDataItem))
    jaw = session.weights[:, ARKIT_INDEX["jawOpen"]]
    np.testing.assert_array_equal(edited.getOriginalDataset()[1], jaw, "all channels follow")
    assert not window.status.work.isVisible()
    assert drawn == [], "a picture that is drawn again is rough at first"


def test_progress_is_shown_and_can_be_cancelled(bench: Bench, window: MainWindow) -> None:
    tracked = begin(window)
    bench.qtbot.waitUntil(window.status.work.isVisible)
    (cancel,) = window.status.work.findChildren(QPushButton)
    assert cancel.width() <= cancel.sizeHint().width()
    assert 0 <= window.status.bar.value() < window.status.bar.maximum()
    window.status.cancelled.emit()
    assert not parts(window).is_busy
    assert not window.status.work.isVisible()
    assert session_of(window).edits == ()
    np.testing.assert_array_equal(session_of(window).weights, tracked)


def test_a_gesture_that_is_still_computed_is_dropped_by_cancel(
    bench: Bench, window: MainWindow
) -> None:
    window.document.preview(WIDE)
    assert parts(window).is_busy
    parts(window).cancel()
    assert not session_of(window).is_previewing
    assert session_of(window).changed_frames() == 0


def test_an_export_holds_all_of_it(bench: Bench, window: MainWindow, tmp_path: Path) -> None:
    begin(window)
    window.document.export(tmp_path / "out.csv")
    assert session_of(window).live.is_complete
    assert session_of(window).changed_frames() == len(session_of(window).take.clip)
    assert (tmp_path / "out.csv").exists()
