"""The checklist of the user's character: what was found in it, and how to correct that."""

from __future__ import annotations

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QHideEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QLabel,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.characters.fitted import FittedCharacter
from faceedit_app.characters.map_file import map_path
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.ui.character.shape_table import ShapeModel, ShapeTable
from faceedit_app.ui.look.texts import sentence
from faceedit_app.ui.look.widgets import resize_on_screen

_SIZE = (760, 640)
_NOTES_HEIGHT = 130  # pixels at most; more notes are scrolled
_POINTS = "The control points are shown on the face: drag one to correct it."
_NO_FACE = "Open a take to see the character and its control points."
_TABLE = (
    "Double-click a shape to choose another, or a number to change how strongly the character "
    "shows a channel; the take keeps its weights."
)


class CharacterChecklist(QDialog):
    """Shows a character's shapes, points and faults while the window stays usable.

    Signals:
        shape_chosen(str, str): a channel, and the shape for it; "" for none.
        levelled(str, object): a channel, and how strongly the character answers it.
        save_asked(): the map is to be saved beside the character.
        closed(): it was closed.
    """

    shape_chosen = Signal(str, str)
    levelled = Signal(str, object)
    save_asked = Signal()
    closed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        resize_on_screen(self, *_SIZE)
        self._character: FittedCharacter | None = None
        self._summary, self._notes = _text(), _text()
        self._model = ShapeModel(self)
        self._model.chosen.connect(self.shape_chosen)
        self._model.levelled.connect(self.levelled)
        self.table = ShapeTable(self._model)
        self.only_noted = QCheckBox("Only channels with a note")
        self.only_noted.toggled.connect(self._refresh)
        self._notes_area = notes = _Notes(self._notes)
        self._hint = _text()
        self._hint.setObjectName("caption")
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        self.save = QPushButton("Save map")
        buttons.addButton(self.save, QDialogButtonBox.ButtonRole.ActionRole)
        self.save.clicked.connect(self.save_asked)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setSpacing(10)
        for part in (self._summary, self.only_noted, self.table, notes, self._hint, buttons):
            column.addWidget(part)

    def show_character(self, character: FittedCharacter, is_changed: bool, is_drawn: bool) -> None:
        """Show a character.

        Args:
            is_changed: whether its map differs from what is saved.
            is_drawn: whether its face is on the screen, which it is with a take.
        """
        self._character = character
        path = character.character.path
        self.setWindowTitle(f"Character: {path.name}")
        self.save.setEnabled(is_changed)
        self.save.setToolTip(f"Save your choices as {map_path(path).name}, beside the character")
        self._hint.setText(f"{_POINTS if is_drawn else _NO_FACE} {_TABLE}")
        self._refresh()

    @property
    def hint(self) -> str:
        """What can be done with the table and the points."""
        return self._hint.text()

    @property
    def notes(self) -> str:
        """The text below the table."""
        return self._notes.text()

    @property
    def summary(self) -> str:
        """The text above the table."""
        return self._summary.text()

    def _refresh(self) -> None:
        if self._character is None:
            return
        check = self._character.checklist
        self._model.show_character(self._character, self.only_noted.isChecked())
        facts = [f"{len(check.matched)} of {len(ARKIT_CHANNELS)} channels have a shape"]
        if check.dead:
            moves = "moves" if len(check.dead) == 1 else "move"
            facts.append(f"{len(check.dead)} {moves} nothing that can be seen")
        facts.append(f"{self._character.character.vertex_count:,} vertices")
        self._summary.setText(f"{self._character.character.format}: {'; '.join(facts)}.")
        lines = [sentence(text) for text in check.doubts]
        lines += [f"{text}." for text in check.lost]  # they begin with the name of a shape
        lines += [sentence(text) for text in check.remarks]
        if check.unknown:
            lines.append(f"Not used: {', '.join(check.unknown)}.")
        self._notes.setText("\n".join(lines))
        self._notes_area.setVisible(bool(lines))

    def stand_left_of(self, face: QWidget) -> None:
        """Move off the face, whose points are to be dragged, as far as the screen allows."""
        room, corner = self.screen().availableGeometry(), face.mapToGlobal(QPoint(0, 0))
        left = max(corner.x() - self.frameGeometry().width(), room.left())
        self.move(
            left, max(min(corner.y(), room.bottom() - self.frameGeometry().height()), room.top())
        )

    def hideEvent(self, event: QHideEvent) -> None:
        """Say that it was closed."""
        super().hideEvent(event)
        self.closed.emit()


class _Notes(QScrollArea):
    """Notes that take as much of the height as they need, which leaves the rest to the table."""

    def __init__(self, notes: QLabel) -> None:
        super().__init__()
        self._notes = notes
        self.setWidget(notes)
        self.setWidgetResizable(True)
        self.setMinimumHeight(0)
        policy = QSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)

    def heightForWidth(self, width: int) -> int:
        """Pixels that the notes need, up to a limit."""
        frame = 2 * self.frameWidth()
        return min(self._notes.heightForWidth(width - frame) + frame, _NOTES_HEIGHT)


def _text() -> QLabel:
    label = QLabel()
    label.setTextFormat(Qt.TextFormat.PlainText)  # names come from the file
    label.setWordWrap(True)
    label.setAlignment(Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft)
    return label
