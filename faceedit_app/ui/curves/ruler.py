"""The time ruler: times and frames, gaps, selection, playhead; scrubs and selects."""

from __future__ import annotations

from collections.abc import Sequence

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPoint, Qt, Signal
from PySide6.QtGui import QHelpEvent
from PySide6.QtWidgets import QToolTip

from faceedit_app.core.clip import Clip
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.axes import FrameAxis, TimeAxis
from faceedit_app.ui.curves.gestures import Pointer, RulerDrag, clamped
from faceedit_app.ui.curves.marks import Gaps, Playhead, Spans, grip
from faceedit_app.ui.curves.plot import Marks
from faceedit_app.ui.curves.scale import Interval, Scale
from faceedit_app.ui.curves.time_view import Mouse, TimeView
from faceedit_app.ui.state.time_display import Unit, shown_time
from faceedit_app.ui.state.timeline import Timeline

_NEAR_GAP = 4.0  # pixels from a gap within which its tooltip is shown
_GAP_ALPHA = 150


class Ruler(pg.GraphicsView, Mouse):
    """Time axis over the plots, as wide as they are.

    Signals:
        menu_asked(place): a right click, and its place on the screen.
    """

    menu_asked = Signal(QPoint)

    def __init__(self, timeline: Timeline) -> None:
        super().__init__(background=style.BACKGROUND)
        self._timeline = timeline
        self._clip: Clip | None = None
        self._gaps: Sequence[Interval] = ()
        self._drag: RulerDrag | None = None
        self.view = TimeView(timeline, self, has_values=False)
        self.setCentralItem(self.view)
        self._spans = Spans(self.view)
        self._gap_marks, self._playhead = Gaps(_GAP_ALPHA), Playhead()
        self._grip = grip()
        self.times, self.frames = TimeAxis(timeline.display), FrameAxis()
        self.view.addItem(self._gap_marks, ignoreBounds=True)
        for axis, size in ((self.times, 0.88), (self.frames, 0.74)):
            axis.setStyle(tickFont=style.scaled_font(self, size))
            axis.setHeight(style.RULER_HEIGHT)
            axis.setParentItem(self.view)
            axis.linkToView(self.view)
        for front in (self._playhead, self._grip):
            front.setZValue(1.0)  # over the numbers
            self.view.addItem(front, ignoreBounds=True)
        self.view.sigResized.connect(self._arrange)
        self.view.sigXRangeChanged.connect(self._show_frames)
        self.view.menu_asked.connect(self._ask_menu)
        timeline.display.changed.connect(self._renew)
        self.setFixedHeight(style.RULER_HEIGHT)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setAcceptDrops(False)
        self.setObjectName("ruler")
        self.setAccessibleName("Time ruler")
        self.setAccessibleDescription("Drag to scrub; Shift and drag to select a time range.")
        self.setToolTip(
            "Drag to scrub. Shift+drag selects a range, double click clears the selection."
        )

    @property
    def current_scale(self) -> Scale:
        """How its pixels map to seconds."""
        return self.view.scale_now

    def _ask_menu(self, x: float, _y: float, place: QPoint) -> None:
        """Make the menu act where it was asked for: “here” is the playhead."""
        self._timeline.go_to_time(self.current_scale.time_at(x))
        self.menu_asked.emit(place)

    @property
    def is_selecting(self) -> bool:
        """Whether a selection is being dragged out."""
        return self._drag is not None and self._drag.selecting

    def show_clip(self, clip: Clip | None, gaps: Sequence[Interval]) -> None:
        """Show the frames and gaps of a clip."""
        self._clip, self._gaps, self._drag = clip, gaps, None
        self._gap_marks.show_gaps(gaps)
        for axis in (self.times, self.frames):
            axis.show_rows(self._timeline.rows if clip is not None else None)
        self._show_frames()

    def show_marks(self, marks: Marks, playhead: float) -> None:
        """Show selection, the span of an edit, and the playhead (seconds)."""
        self._spans.show(marks.selection, marks.edit, marks.alpha)
        self._playhead.setValue(playhead)
        self._grip.setPos(playhead, 0.0)

    def _arrange(self) -> None:
        for axis in (self.times, self.frames):
            axis.setGeometry(self.view.rect())
        self._show_frames()

    def _show_frames(self) -> None:
        """If frames are marked, hide the ticks of the times."""
        scale = self.current_scale
        counted = self._timeline.display.unit is Unit.FRAMES
        shown = not counted and self.frames.has_room(scale.view, scale.width)
        self.frames.setVisible(shown)
        self.times.show_ticks(not shown)

    def _renew(self) -> None:
        self.times.renew()
        self._show_frames()

    # --- mouse -----------------------------------------------------------------------------

    def pressed(self, pointer: Pointer) -> None:
        """Scrub, or select."""
        seconds = self.current_scale.time_at(pointer.x)
        self._drag = RulerDrag(self._timeline.snap_edge(seconds), selecting=pointer.fine)
        if not pointer.fine:
            self._timeline.point_at(seconds)

    def dragged(self, pointer: Pointer) -> None:
        """Continue the gesture."""
        if self._drag is None:
            return
        # Clamped to the view, so that scrubbing does not turn pages.
        scale = self.current_scale
        seconds = scale.time_at(clamped(pointer.x, (0.0, scale.width)))
        if self._drag.selecting:
            self._timeline.select(self._drag.selection(self._timeline.snap_edge(seconds)))
        else:
            self._timeline.point_at(seconds)

    def released(self, pointer: Pointer) -> None:
        """End the gesture."""
        self.dragged(pointer)
        self.mouse_lost()

    def double_clicked(self, _pointer: Pointer) -> None:
        """Clear the selection."""
        self._timeline.select(None)

    def mouse_lost(self) -> None:
        """End the gesture and keep its result."""
        drag, self._drag = self._drag, None
        if drag is not None and drag.selecting:
            selection = self._timeline.selection
            if selection is not None and selection[0] == selection[1]:
                self._timeline.select(None)  # without a selection, an edit acts on one frame anyway

    def viewportEvent(self, event: QEvent) -> bool:
        """Over a gap, show in the tooltip what is missing."""
        if isinstance(event, QHelpEvent) and self._clip is not None:
            rows = self._timeline.rows
            assert rows is not None
            x, scale = event.pos().x(), self.current_scale
            for gap, (first, last) in zip(self._clip.gaps, self._gaps, strict=True):
                if scale.x_of(first) - _NEAR_GAP <= x <= scale.x_of(last) + _NEAR_GAP:
                    plural = "s" if gap.missing > 1 else ""
                    after = shown_time(rows, first, self._timeline.display.unit)
                    text = f"{gap.missing} frame{plural} missing after {after}"
                    QToolTip.showText(event.globalPos(), text, self)
                    return True
        return bool(super().viewportEvent(event))
