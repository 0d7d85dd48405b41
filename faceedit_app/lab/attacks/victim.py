"""A window that works at random until it is killed, and says what it has finished.

It prints a line of JSON before and after everything that must not be lost; `kill_series.py` reads
them.
"""

from __future__ import annotations

import hashlib
import json
import os
import random
import sys
from dataclasses import asdict
from pathlib import Path

from PySide6.QtCore import QCoreApplication

from faceedit_app.core.fields import to_text
from faceedit_app.editing.edits.edit import to_json
from faceedit_app.editing.edits.media import Placement
from faceedit_app.editing.files import journal
from faceedit_app.editing.files.pending import pending_journals
from faceedit_app.editing.files.project import ViewState
from faceedit_app.editing.steps import EditState
from faceedit_app.lab.attacks.hands import dialogs_cancelled
from faceedit_app.lab.attacks.monkey import Monkey
from faceedit_app.lab.attacks.opened import open_window, session_of
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.dialogs import Recover
from faceedit_app.ui.start.application import application, collecting
from faceedit_app.ui.state.document import Document

PROJECT, EXPORTED = "work.faceedit", "exported.csv"


def state_of(state: EditState) -> str:
    """A short text that differs for different edits and settings."""
    content = [to_text(to_json(edit)) for edit in state.edits] + [str(asdict(state.settings))]
    return hashlib.sha256("\n".join(content).encode()).hexdigest()[:16]


def _say(**what: object) -> None:
    try:
        print(json.dumps(what), flush=True)
    except OSError:  # nobody is left to kill it
        os._exit(1)


def _announce_saving(document: Document) -> None:
    """Say when a project is being saved, by the victim or by the window's own commands."""
    save = document.save_project

    def announced(path: Path, view: ViewState, media: Placement) -> None:
        state = state_of(document.session.state) if document.session is not None else ""
        _say(begins="save", state=state)
        save(path, view, media)
        _say(did="save", state=state)

    document.save_project = announced  # type: ignore[method-assign]


def main(folder: Path, seed: str) -> None:
    """Work on `folder/take.csv` until killed; the same seed makes the same gestures."""
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    application()
    journal.journal_folder = lambda: folder / "journals"
    with dialogs_cancelled(), collecting():
        dialogs.ask_recover = lambda *_: Recover.RECOVER
        recovers = bool(pending_journals(folder / "journals"))
        _say(starts=True)
        window = open_window(folder / "take.csv", folder)
        session, chance = session_of(window), random.Random(seed)
        monkey = Monkey(window, chance)
        _announce_saving(window.document)
        _say(did="recover" if recovers else "open", state=state_of(session.state))
        session.stepped.connect(lambda state: _say(did="step", state=state_of(state)))
        while True:
            monkey.act()
            QCoreApplication.processEvents()
            window.workspace.end_gestures()
            _say(did="gesture")
            if chance.random() < 0.05:
                window.document.save_project(folder / PROJECT, ViewState(), window.media.placement)
            if chance.random() < 0.05:
                _say(begins="export", state=state_of(session.state))
                window.document.export(folder / EXPORTED)
                _say(did="export", state=state_of(session.state))
            if len(session.edits) > 60:
                while session.can_undo:
                    session.undo()


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
