"""What has a time axis on the page: curves, sound and words, one above the other."""

from __future__ import annotations

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.media.strip_row import StripRow


class TimeRows(QWidget):
    """Shows as many rows as leave a whole curve to be dragged: in a low window, some give way.

    Args:
        curves: above all rows.
        rows: below them, from top to bottom; the lowest stays longest.
    """

    def __init__(self, curves: CurvesPanel, *rows: StripRow) -> None:
        super().__init__()
        self._curves, self._rows = curves, rows
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(curves, 1)
        for row in rows:
            column.addWidget(row)

    def event(self, event: QEvent) -> bool:
        """Share the height again when it changes, or what is to be shown."""
        done = super().event(event)
        if event.type() in (QEvent.Type.Show, QEvent.Type.Resize, QEvent.Type.LayoutRequest):
            self._share()
        return done

    def _share(self) -> None:
        if not self.isVisible():  # its height is not known yet
            return
        room = self.height() - self._curves.minimumSizeHint().height()
        for row in reversed(self._rows):
            fits = room >= row.minimumHeight()
            if fits and row.is_wanted:
                room -= row.minimumHeight()
            row.give_way(not fits)
