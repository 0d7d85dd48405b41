"""What the dialogs have in common that preview edits while the window stays usable."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt
from PySide6.QtWidgets import QDialog, QWidget

from faceedit_app.ui.look.number import may_accept
from faceedit_app.ui.state.document import Document


class PreviewDialog(QDialog):
    """Previews edits of the open take, beside a window in which time and camera can be moved.

    There is one at a time. It closes when another take is opened, which its edits are not meant
    for. Other edits end its preview, which returns when the user returns to the dialog.
    """

    def __init__(self, parent: QWidget, document: Document) -> None:
        for other in parent.findChildren(PreviewDialog):
            other.close()
        super().__init__(parent)
        self._document = document
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        document.opened.connect(self.reject)

    def preview(self) -> None:
        """Show the take with the edits that the dialog asks for."""
        raise NotImplementedError

    def accept(self) -> None:
        """Close, if all numbers can be taken."""
        if may_accept(self):
            super().accept()

    def event(self, event: QEvent) -> bool:
        """Preview again when the user returns from the window."""
        if event.type() == QEvent.Type.WindowActivate and self.isVisible():
            self.preview()
        return super().event(event)
