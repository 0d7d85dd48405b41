"""Another frame rate for the open take: a step of its history, for which it is read again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication, QEventLoop

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.retiming import retimed
from faceedit_app.formats.timing import format_rate
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace

if TYPE_CHECKING:  # the window is there before the solver
    from faceedit_app.editing.session import EditSession
    from faceedit_app.editing.steps import EditState

_NO_INPUT = (
    QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents
    | QEventLoop.ProcessEventsFlag.WaitForMoreEvents
)


class FrameRate:
    """Opens the take at another frame rate, when the user gives one, and when that is undone."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        workspace.document.rate_wanted.connect(self._travel)

    def change(self) -> None:
        """Ask for a frame rate, and make it a step; edits stay on their frames."""
        self._workspace.end_gestures()
        session = self._workspace.session
        if session is None or not self._may_read(session):
            return
        clip, name = session.take.clip, session.take.path.name
        frames = clip.duration * clip.rate  # with those of gaps; times that are uneven stay so
        question = f"What is the frame rate of {name}?{_what_changes(session.edits)}"
        rate = dialogs.ask_rate(self._workspace.window, question, frames, clip.rate)
        if rate is None or rate == clip.rate:
            return
        factor, step = clip.rate / rate, f"Frame rate {format_rate(rate)}"

        def on_same_frames(state: EditState) -> EditState:
            return replace(state, edits=tuple(retimed(edit, factor) for edit in state.edits))

        self._read(session, rate, lambda again: again.continue_from(session, step, on_same_frames))

    def _travel(self, rate: float | None, steps: int) -> None:
        """Undo or redo steps that lead to another frame rate."""
        session = self._workspace.session
        if session is not None and self._may_read(session):
            self._read(session, rate, lambda again: again.arrive_from(session, steps))

    def _may_read(self, session: EditSession) -> bool:
        """Whether the take's file is still what was opened; else say so."""
        path = session.take.path
        if not self._workspace.document.was_changed(path) and session.exported_over is None:
            return True
        self._workspace.warning.emit(
            f"{path.name} has been replaced since it was opened, so its frame rate cannot be "
            "changed now: save the project and open the take as it was"
        )
        return False

    def _read(
        self, session: EditSession, rate: float | None, prepare: Callable[[EditSession], None]
    ) -> None:
        """Open the take at another rate, with the same frames on screen.

        Input waits, as for other steps, so that none is made meanwhile.
        """
        workspace, timeline = self._workspace, self._workspace.timeline
        frame, before, view = timeline.frame, session.take.clip.rate, timeline.view

        def shown() -> None:
            assert workspace.session is not None
            factor = before / (now := workspace.session.take.clip.rate)
            timeline.show_range(view[0] * factor, view[1] * factor)
            timeline.go_to_frame(frame)
            workspace.message.emit(f"The take has {format_rate(now)} now; Undo takes that back")

        path, project = session.take.path, workspace.document.project_file
        workspace.opener.open(path, prepare, shown, project, rate)
        while workspace.opener.is_reading:
            QCoreApplication.processEvents(_NO_INPUT)


def _what_changes(edits: Sequence[Edit]) -> str:
    """What another frame rate does to edits, a sentence to be added to the question.

    They are answered in seconds: the same frames are slower or quicker motion then. A fill looks
    for donors that move as the frames around it, and finds others.
    """
    kinds = {edit.op for edit in edits if edit.effect is not None} - {Op.RESET}
    if not kinds:
        return ""
    different = "may look slightly different"
    if kinds == {Op.FILL}:
        what = "fills get other motion"
    elif Op.FILL in kinds:
        what = f"fills get other motion, and other edits {different}"
    else:
        what = different
    return f" Edits stay on their frames, but {what}."
