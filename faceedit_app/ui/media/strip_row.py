"""A row under the plots: a strip on their time axis, and its head."""

from __future__ import annotations

from PySide6.QtWidgets import QHBoxLayout, QWidget

from faceedit_app.ui.curves import style


class StripRow(QWidget):
    """Aligns a strip with the plots.

    Args:
        strip: what is on the time axis.
        height: of the strip, in pixels.

    Attributes:
        head: left of the strip, under the names of the curves; subclasses lay it out.
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
