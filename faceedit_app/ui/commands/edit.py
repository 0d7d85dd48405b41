"""The Edit, View and Playback menus: each command is one short method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.playback import Playback
from faceedit_app.ui.state.timeline import Timeline

if TYPE_CHECKING:
    from faceedit_app.ui.curves import CurvesPanel

ZOOM = 0.7
NUDGE, FINE_NUDGE = 0.5, 0.05  # mm


class EditCommands:
    """Acts on the document and the timeline.

    Args:
        panel: the curves, once they are there (they are built after the first paint).
        settle: brings gestures elsewhere in the window to their end.
        discard: drops what is proposed; False if nothing is.
    """

    def __init__(
        self,
        document: Document,
        timeline: Timeline,
        playback: Playback,
        panel: Callable[[], CurvesPanel | None],
        settle: Callable[[], None],
        discard: Callable[[], bool],
    ) -> None:
        self._document, self._timeline, self._playback = document, timeline, playback
        self._panel, self._settle, self._discard = panel, settle, discard

    def finish(self) -> None:
        """Drop a drag in progress and bring other gestures to their end."""
        self._cancel_drag()
        self._settle()

    def handlers(self) -> dict[str, Callable[[], None]]:
        """What to do for each of these `Command.id`s."""
        line = self._timeline
        return {
            "undo": self.undo,
            "redo": self.redo,
            "reset_range": self.reset_range,
            "reset_curve": self.reset_curve,
            "select_all": lambda: line.select((0.0, line.snap(line.duration))),
            "deselect": self.deselect,
            "preserve": lambda: self.set_mode("preserve"),
            "resynthesize": lambda: self.set_mode("resynthesize"),
            "fit": self.fit,
            "zoom_in": lambda: line.zoom(ZOOM, line.time),
            "zoom_out": lambda: line.zoom(1 / ZOOM, line.time),
            "play": self._playback.toggle,
            "play_around": self._playback.play_around,
            "rewind": lambda: self._playback.shuttle(-1),
            "stop": self._playback.pause,
            "fast_forward": lambda: self._playback.shuttle(1),
            "loop": lambda: self._playback.set_loop(not self._playback.loop),
            "back": lambda: line.go_to_frame(line.frame - 1),
            "forward": lambda: line.go_to_frame(line.frame + 1),
            "second_back": lambda: line.go_to_time(line.time - 1),
            "second_forward": lambda: line.go_to_time(line.time + 1),
            "start": lambda: line.go_to_frame(0),
            "end": lambda: line.go_to_frame(line.frames - 1),
            "mark_start": self.mark_start,
            "mark_end": self.mark_end,
            "raise": lambda: self._nudge(NUDGE),
            "lower": lambda: self._nudge(-NUDGE),
            "raise_fine": lambda: self._nudge(FINE_NUDGE),
            "lower_fine": lambda: self._nudge(-FINE_NUDGE),
            **{f"curve_{i + 1}": partial(self._focus, i) for i in range(len(CONTROL_IDS))},
        }

    def _nudge(self, millimetres: float) -> None:
        panel = self._panel()
        if panel is not None:
            self._settle()
            panel.nudge(millimetres)

    def _focus(self, index: int) -> None:
        panel = self._panel()
        if panel is not None:
            panel.focus_curve(index)

    # --- edits -------------------------------------------------------------------------------

    def undo(self) -> None:
        """Take the last step back; a drag in progress is the last step."""
        if not self._cancel_drag():
            self._settle()
            self._document.undo()

    def redo(self) -> None:
        """Take the step again."""
        if not self._cancel_drag():
            self._settle()
            self._document.redo()

    def reset_range(self) -> None:
        """All curves back to the take in the selection, else around the playhead."""
        self._reset(CONTROL_IDS)

    def reset_curve(self) -> None:
        """The curve that has the focus back to the take."""
        panel = self._panel()
        control = panel.focused_control if panel is not None else None
        self._reset((control,) if control else ())

    def _reset(self, controls: tuple[str, ...]) -> None:
        self._cancel_drag()
        self._settle()
        session = self._document.session
        if session is not None and session.edits and controls:
            session.reset(*self.range_at_hand(), controls, self._timeline.falloff)

    def range_at_hand(self) -> tuple[float, float]:
        """The selection, else the playhead with the falloff to either side."""
        line = self._timeline
        if line.selection is not None:
            return line.selection
        return max(line.time - line.falloff, 0.0), min(line.time + line.falloff, line.duration)

    def set_mode(self, mode: str) -> None:
        """Choose how the networks' answer is combined with the take."""
        from faceedit_app.editing.edits.settings import Mode

        self._cancel_drag()
        self._settle()
        session = self._document.session
        if session is not None:
            session.configure(replace(session.settings, mode=Mode(mode)))

    def deselect(self) -> None:
        """Cancel a drag in progress, else drop the selection."""
        if not self._cancel_drag():
            self._timeline.select(None)
            panel = self._panel()
            if panel is not None:
                panel.setFocus()

    def _cancel_drag(self) -> bool:
        panel = self._panel()
        if panel is not None and panel.is_dragging:
            panel.cancel_drag()
            return True
        return self._discard()

    # --- time --------------------------------------------------------------------------------

    def fit(self) -> None:
        """Show the selection if there is one that is not yet all there is to see."""
        line = self._timeline
        chosen = line.selection
        if chosen is not None and chosen[1] > chosen[0]:
            margin = 0.1 * (chosen[1] - chosen[0])
            before = line.view
            line.show_range(chosen[0] - margin, chosen[1] + margin)
            if line.view != before:
                return
        line.show_range(0.0, line.duration)

    def mark_start(self) -> None:
        """Start the selection at the playhead."""
        line = self._timeline
        end = line.selection[1] if line.selection else line.duration
        line.select((line.time, end if end > line.time else line.snap(line.duration)))

    def mark_end(self) -> None:
        """End the selection at the playhead."""
        line = self._timeline
        start = line.selection[0] if line.selection else 0.0
        line.select((start if start < line.time else 0.0, line.time))
