"""Tries the fixes for problems in the background, before they are ticked for Fix all."""

from __future__ import annotations

from threading import Event

from PySide6.QtCore import QObject, Signal

from faceedit_app.editing.help.trying import Brought, trial_of
from faceedit_app.ui.page.problems_bar import ProblemsBar
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.document import Document


class FixTrials(QObject):
    """What the fixes for the problems in the bar would make.

    Nothing is tried before somebody wants to know: that costs as much as Fix all itself.

    Signals:
        tried(object): the problems that fixes would make, by what they mend (`Brought`).

    Attributes:
        is_trying: whether that is being found out.
    """

    tried = Signal(object)

    def __init__(self, document: Document, bar: ProblemsBar) -> None:
        super().__init__(bar)
        self._document, self._bar = document, bar
        self._background = Background(self)
        self._tried: tuple[object, ...] = ()  # what the present or the last trial was of
        self._stop = Event()  # of the present trial
        self.is_trying = False
        document.opened.connect(self.stop)
        document.changed.connect(self._changed)

    def _subject(self) -> tuple[object, ...]:
        """What the answer depends on."""
        session = self._document.session
        if session is None:
            return ()
        return session.state, session.engine, session.shown_rig

    def begin(self) -> None:
        """Try the fixes of all problems that were found, unless that was done or is going on."""
        session, problems = self._document.session, self._bar.problems
        if session is None or not any(problem.fix for problem in problems):
            return
        subject = (*self._subject(), problems)
        if _are_same(self._tried, subject):
            return
        self.stop()
        self._tried, self.is_trying = subject, True
        stop = self._stop = Event()

        def done(brought: Brought) -> None:
            if not stop.is_set():
                self.is_trying = False
                self.tried.emit(brought)

        def failed(_: Exception) -> None:
            """The fixes stay ticked; what they make is said when they have been made."""
            done({})

        self._background.run(trial_of(session, problems, lambda: not stop.is_set()), done, failed)

    def _changed(self) -> None:
        """An edit, another engine or character; the bar will search again."""
        if not _are_same(self._tried[:-1], self._subject()):
            self.stop()

    def stop(self) -> None:
        """End the trial in progress: the window is needed, or what is tried has changed."""
        self._stop.set()
        if self.is_trying or self._tried:
            self._tried, self.is_trying = (), False

    def close(self) -> None:
        """End for good."""
        self.stop()
        self._background.close()


def _are_same(some: tuple[object, ...], others: tuple[object, ...]) -> bool:
    """Whether two tuples hold the same objects; equal ones may take long to compare."""
    return len(some) == len(others) and all(a is b for a, b in zip(some, others, strict=True))
