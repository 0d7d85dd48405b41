"""The list of edits as a view that chooses nothing by itself."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QFocusEvent
from PySide6.QtWidgets import QAbstractItemView, QListView


class EditRows(QListView):
    """Rows that are chosen by a click or with the arrow keys, never because the list got focus."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("edits_list")
        self.setAccessibleName("Edits")
        self.setMouseTracking(True)
        self.setUniformItemSizes(True)
        # By rows, Qt counts hidden ones, and cannot scroll to all of the last one.
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setDragDropMode(QAbstractItemView.DragDropMode.InternalMove)
        self.setDefaultDropAction(Qt.DropAction.MoveAction)
        self.setEditTriggers(QAbstractItemView.EditTrigger.DoubleClicked)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    @property
    def is_typed(self) -> bool:
        """Whether a field is open; one with what cannot be taken stays so without the focus."""
        return self.state() is QAbstractItemView.State.EditingState

    def reveal(self, first: int, last: int) -> None:
        """Scroll to rows, to the first of them if not all have room."""
        self.executeDelayedItemsLayout()  # else it ends where the list without new rows did
        for row in (last, first):
            self.scrollTo(self.model().index(row, 0))

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Choose nothing; a field that is still open, as its text cannot be taken, gets the keys.

        Qt makes the first row the current one, which would choose an edit and move the view.
        """
        has_current = self.currentIndex().isValid()
        with QSignalBlocker(self.selectionModel()):
            super().focusInEvent(event)
            if not has_current:
                self.selectionModel().clearCurrentIndex()
        field = self.indexWidget(self.currentIndex())
        if field is not None and self.is_typed:
            field.setFocus()
