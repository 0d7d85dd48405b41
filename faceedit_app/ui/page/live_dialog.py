"""The dialogs of File > Live preview and File > Record from phone."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLineEdit,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.live.protocols import LOOPBACK, PROTOCOLS, Protocol, own_address
from faceedit_app.ui.look.number import NumberBox, may_accept
from faceedit_app.ui.look.texts import Message
from faceedit_app.ui.look.widgets import Choice


class _AddressDialog(QDialog):
    """Protocol, address and port.

    Args:
        title: of the window.
        protocols: the ones to choose from.
        place: the label of the address, and what it is at first.
        button: the text that goes on.
    """

    def __init__(
        self,
        parent: QWidget | None,
        title: str,
        protocols: list[Protocol],
        place: tuple[str, str],
        button: str,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setMinimumWidth(420)
        self._protocols = protocols
        self._column = column = QVBoxLayout(self)
        column.setSpacing(12)
        self.form = QFormLayout()
        self.form.setLabelAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.protocol_choice = Choice()
        for protocol in protocols:
            self.protocol_choice.addItem(protocol.name)
        self.form.addRow("&Protocol", self.protocol_choice)
        label, address = place
        self.address = QLineEdit(address)
        self.form.addRow(label, self.address)
        self.port_box = NumberBox()
        self.port_box.setDecimals(0)
        self.port_box.setRange(1, 65535)
        self.form.addRow("P&ort", self.port_box)
        column.addLayout(self.form)
        self.hint = Message()
        column.addWidget(self.hint)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        buttons.addButton(button, QDialogButtonBox.ButtonRole.AcceptRole).setDefault(True)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column.addWidget(buttons)
        self.protocol_choice.currentIndexChanged.connect(self._show_protocol)

    @property
    def protocol(self) -> Protocol:
        """The chosen protocol."""
        return self._protocols[self.protocol_choice.currentIndex()]

    @property
    def chosen(self) -> tuple[Protocol, str, int]:
        """Protocol, address and port."""
        return self.protocol, self.address.text().strip(), int(self.port_box.value())

    def accept(self) -> None:
        """Close, if the port can be taken."""
        if may_accept(self):
            super().accept()

    def _show_protocol(self) -> None:
        self.port_box.setValue(self.protocol.port)

    def event(self, event: QEvent) -> bool:
        """Keep room for all lines of the hint, whatever its text and the dialog's width."""
        done = super().event(event)
        if event.type() in (QEvent.Type.Resize, QEvent.Type.LayoutRequest):
            self.setMinimumHeight(self._column.totalHeightForWidth(self.width()))
        return done


class LiveDialog(_AddressDialog):
    """Asks where to send the face."""

    def __init__(self, parent: QWidget | None) -> None:
        sendable = [protocol for protocol in PROTOCOLS if protocol.encode is not None]
        super().__init__(parent, "Live preview", sendable, ("&Send to", LOOPBACK), "&Start")
        self.address.setToolTip("The computer of the other program; 127.0.0.1 is this one")
        self._show_protocol()

    def _show_protocol(self) -> None:
        super()._show_protocol()
        self.hint.setText(f"{self.protocol.hints[0]}.")


class RecordDialog(_AddressDialog):
    """Asks what to record."""

    def __init__(self, parent: QWidget | None) -> None:
        place = ("Phone's &address", "")
        super().__init__(parent, "Record from phone", [*PROTOCOLS], place, "&Record…")
        self._show_protocol()

    def _show_protocol(self) -> None:
        super()._show_protocol()
        self.form.setRowVisible(self.address, bool(self.protocol.greeting))
        self.hint.setText(
            f"This computer's address is {own_address()}. {self.protocol.hints[1]}.\n\n"
            "Every frame is written to the file at once. Recording stops when you press Stop."
        )
