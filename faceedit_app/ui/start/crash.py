"""When FaceEdit itself is wrong: keep the edits, write down what happened, say so plainly."""

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
    """Catch what no code expected; the window stays open, and with it the edits."""
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
    """An excepthook that does not call itself when telling the user fails too."""

    def __init__(self) -> None:
        self._telling = False

    def __call__(
        self, kind: type[BaseException], error: BaseException, trace: TracebackType | None
    ) -> None:
        if issubclass(kind, KeyboardInterrupt):
            sys.__excepthook__(kind, error, trace)
            return
        _log.error("unexpected", exc_info=(kind, error, trace))
        sys.__excepthook__(kind, error, trace)
        if self._telling:  # a dialog is up already; a repaint may fail many times a second
            return
        self._telling = True
        try:
            dialogs.show_error(
                None,
                "Something went wrong inside FaceEdit. Your edits are still there; export or save"
                f" them now. What happened was written to {log_path()}",
            )
        finally:
            self._telling = False
