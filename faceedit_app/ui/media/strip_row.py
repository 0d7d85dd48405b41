"""A row under the plots: a strip on their time axis, and its head."""

from __future__ import annotations

from PySide6.QtWidgets import QHBoxLayout, QWidget

from faceedit_app.ui.curves import style


class StripRow(QWidget):
    """Aligns a strip with the plots. Hidden until it has something to show.

    Args:
        strip: what is on the time axis.
        height: of the strip, in pixels.

    Attributes:
        head: left of the strip, under the names of the curves; subclasses lay it out.
        is_wanted: whether it has something to show.
    """

    def __init__(self, strip: QWidget, height: int) -> None:
        super().__init__()
        self.head = QWidget()
        self.head.setFixedWidth(style.HEADER_WIDTH)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, style.ROW_GAP, style.RIGHT_MARGIN, style.ROW_GAP)
        row.setSpacing(0)
        row.addWidget(self.head)
        row.addWidget(strip, 1)
        self.setFixedHeight(height + 2 * style.ROW_GAP)
        self.is_wanted = self._gives_way = False
        self.hide()

    def want(self, wanted: bool) -> None:
        """Show the row, unless it gives way, or hide it."""
        self.is_wanted = wanted
        self.setVisible(wanted and not self._gives_way)

    def give_way(self, gives_way: bool) -> None:
        """Hide the row for lack of room, or show it again if it is wanted."""
        if gives_way != self._gives_way:
            self._gives_way = gives_way
            self.setVisible(self.is_wanted and not gives_way)
