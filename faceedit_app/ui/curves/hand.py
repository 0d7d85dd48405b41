"""A hand on the face: its drags make the same edits as those on the plots."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.ui.curves.interaction import Interaction
from faceedit_app.ui.curves.plot import CurvePlot


class FaceHand:
    """See `face.handles.Hand`.

    Args:
        plots: in curve order.
        mouse: what drags on them go through.
        reveal: shows the curve of a control, which may be hidden.
    """

    def __init__(
        self,
        plots: Sequence[CurvePlot],
        mouse: Interaction,
        reveal: Callable[[str], None],
    ) -> None:
        self._plots, self._mouse, self._reveal = plots, mouse, reveal
        self._held = ""  # the control whose curve is to be shown once it is pulled

    @property
    def is_held(self) -> bool:
        """Whether a gesture is in progress."""
        return self._mouse.is_held

    def grab(self, control: str, one_side: bool) -> bool:
        """Take a control at the frame on screen; False if it cannot be edited."""
        self._held = control
        return self._mouse.grab(self._plots[CONTROL_INDEX[control]], one_side)

    def probe(self, millimetres: float) -> None:
        """Preview a move, to see which way the face goes."""
        self._mouse.probe(millimetres)

    def end_probe(self) -> None:
        """End that preview."""
        if self._mouse.session is not None:
            self._mouse.session.cancel()

    def pull(self, millimetres: float, snap: bool) -> None:
        """Move by this much since the grab, and show the curve that is edited."""
        if self._held:  # not before: a chin that is pulled down edits the mouth instead
            self._reveal(self._held)
            self._held = ""
        self._mouse.pull(millimetres, snap)

    def let_go(self) -> None:
        """Keep the edit."""
        self._mouse.let_go()

    def cancel(self) -> None:
        """Let go without an edit."""
        self._mouse.cancel()
