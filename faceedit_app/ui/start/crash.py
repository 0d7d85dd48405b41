"""Unexpected errors: keep the edits, log what happened, and report it plainly."""

from __future__ import annotations

import logging
import logging.handlers
import sys
from pathlib import Path
from types import TracebackType

import platformdirs

from faceedit_app.ui.commands import dialogs

_log = logging.getLogger("faceedit")


def log_path() -> Path:
    """The file that unexpected errors are written to."""
    return Path(platformdirs.user_log_dir("FaceEdit", appauthor=False)) / "faceedit.log"


def install() -> None:
    """Catch unexpected errors, so that the window and the edits stay open."""
    try:
        log_path().parent.mkdir(parents=True, exist_ok=True)
        handler: logging.Handler = logging.handlers.RotatingFileHandler(
            log_path(), maxBytes=500_000, backupCount=1, encoding="utf-8", delay=True
        )
    except OSError:  # a read-only home: standard error is better than nothing
        handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    _log.addHandler(handler)
    sys.excepthook = _Hook()


class _Hook:
    """An excepthook that does not call itself when reporting the error fails too."""

    def __init__(self) -> None:
        self._is_reporting = False

    def __call__(
        self, kind: type[BaseException], error: BaseException, trace: TracebackType | None
    ) -> None:
        if issubclass(kind, KeyboardInterrupt):
            sys.__excepthook__(kind, error, trace)
            return
        _log.error("unexpected", exc_info=(kind, error, trace))
        sys.__excepthook__(kind, error, trace)
        if self._is_reporting:  # a dialog is open; a repaint may fail many times a second
            return
        self._is_reporting = True
        try:
            dialogs.show_error(
                None,
                "FaceEdit ran into an unexpected error. Your edits are still here; save or export"
                f" them now. The details are in {log_path()}",
            )
        finally:
            self._is_reporting = False
