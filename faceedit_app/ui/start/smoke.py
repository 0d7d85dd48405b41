"""A window that runs by itself, to test an installed FaceEdit from outside.

With the environment variable FACEEDIT_SMOKE=FOLDER, `faceedit TAKE.csv` loads everything,
makes one edit, writes the edited take, the edits, a picture of the window and a report with times
to the folder, and closes. `packaging/smoke_test.py` does this with a bundle, a package or a wheel.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from types import TracebackType

from PySide6.QtCore import QEvent, QObject, QTimer
from PySide6.QtWidgets import QApplication

from faceedit_app import __version__
from faceedit_app.ui.start.sample_edit import sample_edit
from faceedit_app.ui.start.window import MainWindow

VARIABLE = "FACEEDIT_SMOKE"
EDITED, EDITS, PICTURE, REPORT = "edited.csv", "edits.json", "window.png", "report.json"
_SMOOTH_MS = 800  # until the face has been drawn smoothly


def play(window: MainWindow, folder: Path) -> QObject:
    """Drive a window that is about to be shown, then close it.

    Returns:
        An object to keep alive until then.
    """
    return _Session(window, folder)


class _Session(QObject):
    """One edit, from the first paint to the last, and the report on it."""

    def __init__(self, window: MainWindow, folder: Path) -> None:
        super().__init__(window)
        self._window, self._folder = window, folder
        self._seen: dict[str, object] = {
            "version": __version__,
            "frozen": bool(getattr(sys, "frozen", False)),
            "ready": time.time(),
        }
        sys.excepthook = self._unexpected
        window.installEventFilter(self)
        window.settled.connect(self._settled)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Record when the window is first painted."""
        if event.type() == QEvent.Type.Paint:
            self._window.removeEventFilter(self)
            QTimer.singleShot(0, lambda: self._note("painted"))
        return False

    def _note(self, moment: str) -> None:
        self._seen[moment] = time.time()

    def _settled(self) -> None:
        self._note("settled")
        QTimer.singleShot(_SMOOTH_MS, self._edit)

    def _edit(self) -> None:
        document = self._window.document
        if document.session is None:
            raise RuntimeError("no take was opened")
        edit = sample_edit(document.session)
        self._window.timeline.go_to_time((edit.start + edit.end) / 2)
        document.session.add(edit)
        QTimer.singleShot(_SMOOTH_MS, self._finish)

    def _finish(self) -> None:
        window, document = self._window, self._window.document
        assert document.session is not None
        assert window.editor is not None
        document.save_edits(self._folder / EDITS)
        document.export(self._folder / EDITED)
        if not window.grab().save(str(self._folder / PICTURE)):
            raise RuntimeError("the picture was not written")
        self._seen |= {
            "title": window.windowTitle(),
            "networks": document.session.has_engine,
            "changed_frames": document.session.changed_frames(),
            "face_message": window.editor.face.viewport.message,
            "face_drawn": window.editor.face.viewport.draws,
            "platform": QApplication.platformName(),
            "torch": "torch" in sys.modules,
        }
        self._report()
        document.session.mark_saved()  # no user is there to answer for the edits
        window.close()

    def _unexpected(
        self, kind: type[BaseException], error: BaseException, trace: TracebackType | None
    ) -> None:
        """End the process on an error, because no user is there to answer a dialog."""
        sys.__excepthook__(kind, error, trace)
        self._seen["error"] = f"{kind.__name__}: {error}"
        self._report()
        QApplication.exit(1)

    def _report(self) -> None:
        text = json.dumps(self._seen, indent=2) + "\n"
        (self._folder / REPORT).write_text(text, encoding="utf-8")
