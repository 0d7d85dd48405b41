"""File > Character > Make from a scan: the steps as pictures, and points to correct them by."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QHBoxLayout,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.characters.leaving_out import PARTS
from faceedit_app.core.arrays import Doubles, Pixels
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.rig import Rig
from faceedit_app.scans.steps import EXPRESSIONS, Attempt, ScanSteps
from faceedit_app.ui.character.points_overlay import PointsOverlay
from faceedit_app.ui.character.scan_view import Picture, ScanView
from faceedit_app.ui.look.texts import Message
from faceedit_app.ui.look.widgets import Choice, caption
from faceedit_app.ui.state.background import Background

_Pictures = dict[str | None, Pixels]
_Drawn = tuple[Attempt, _Pictures]


class ScanDialog(QDialog):
    """Makes a character from a scan while the window stays usable.

    Signals:
        save_asked(object): an `Attempt` is to be saved as a character.
        failed(str): one line about what went wrong.
    """

    save_asked = Signal(object)
    failed = Signal(str)

    def __init__(self, parent: QWidget | None, path: Path, rig: Rig) -> None:
        super().__init__(parent)
        self.setWindowTitle(f"Character from a scan: {path.name}")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._path, self._rig = path, rig
        self._background = Background(self)
        self._steps: ScanSteps | None = None
        self._whole: Attempt | None = None  # with all parts
        self._attempt: Attempt | None = None
        self._pictures: _Pictures = {}
        self._says = ""
        self._moved: dict[str, Doubles] = {}
        self._is_fitted = True  # to the points as they are shown
        self._held: QWidget | None = None  # had the keyboard before it was disabled
        self._build()

    def _build(self) -> None:
        self.scan, self.character = ScanView(), Picture("The character")
        self.points = PointsOverlay(self.scan)
        self.points.moved.connect(self._move)
        self.expression = Choice()
        self.expression.addItems(list(EXPRESSIONS))
        self.expression.setAccessibleName("Expression")
        self.expression.currentTextChanged.connect(self._show_expression)
        # Not added to a scan that has its own, as geometry or in its picture.
        self.parts = {part: QCheckBox(f"FaceEdit's {part}") for part in PARTS}
        for box in self.parts.values():
            box.setChecked(True)
            box.toggled.connect(self._redraw)
        self.status = Message()
        self.busy = QProgressBar()
        self.busy.setRange(0, 0)
        self.busy.setTextVisible(False)
        self.busy.setFixedHeight(4)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        self.again, self.save = QPushButton("Fit again"), QPushButton("Save character…")
        buttons.addButton(self.again, QDialogButtonBox.ButtonRole.ActionRole)
        buttons.addButton(self.save, QDialogButtonBox.ButtonRole.AcceptRole)
        self.again.clicked.connect(self.begin)
        self.save.clicked.connect(lambda: self.save_asked.emit(self._attempt))
        buttons.rejected.connect(self.reject)
        grid = QGridLayout()
        grid.setSpacing(10)
        grid.addWidget(caption("The scan: drag a point that is wrong"), 0, 0)
        grid.addWidget(self.expression, 0, 1)
        grid.addWidget(self.scan, 1, 0)
        grid.addWidget(self.character, 1, 1)
        column = QVBoxLayout(self)
        column.setSpacing(10)
        column.addLayout(grid)
        column.addWidget(self.busy)
        column.addWidget(self.status)
        row = QHBoxLayout()  # one row for both, so that all fits a low screen
        for box in self.parts.values():
            row.addWidget(box)
        row.addWidget(buttons, 1)
        column.addLayout(row)

    def begin(self) -> None:
        """Make the character in the background, with the points as they are now."""
        self._work("Finding the face and fitting it: this takes about ten seconds…")
        moved, draw = dict(self._moved), self._drawing()

        def make() -> tuple[ScanSteps, Attempt, _Drawn]:
            steps = self._steps or ScanSteps(self._path, self._rig)
            attempt = steps.attempt(moved)
            return steps, attempt, draw(attempt)

        self._background.run(make, self._made, self._failed)

    def _drawing(self) -> Callable[[Attempt], _Drawn]:
        """Leaves out the parts that are not wanted now, and draws the rest."""
        left_out = [part for part, box in self.parts.items() if not box.isChecked()]
        side = self.scan.pixels

        def draw(whole: Attempt) -> _Drawn:
            attempt = whole.without(left_out)
            return attempt, {name: attempt.picture(side, name) for name in (None, *EXPRESSIONS)}

        return draw

    def _redraw(self) -> None:
        """Show the character with the parts that are wanted now."""
        whole, draw = self._whole, self._drawing()
        if whole is None:
            return
        self._work("Drawing…")
        self._background.run(lambda: draw(whole), self._redrawn, self._failed)

    def _redrawn(self, drawn: _Drawn) -> None:
        self._attempt, self._pictures = drawn
        self._show_expression(self.expression.currentText())
        self._rest(self._says)

    def _made(self, result: tuple[ScanSteps, Attempt, _Drawn]) -> None:
        self._steps, self._whole, (self._attempt, self._pictures) = result
        self._is_fitted = True
        attempt = self._attempt
        self.scan.look(attempt.scan.neutral, attempt.camera)
        self.scan.show_picture(self._pictures[None])
        self.points.show_points(attempt.points)
        self._show_expression(self.expression.currentText())
        middle, most = attempt.distance
        self._says = (
            f"{attempt.landmarks} landmarks. The skin of the face is {middle:.2f} mm from the scan "
            f"(95 % within {most:.1f} mm)."
            + "".join(f" {text[:1].upper()}{text[1:]}." for text in self._steps.scan.remarks)
        )
        self._rest(self._says)

    def _failed(self, error: Exception) -> None:
        if not isinstance(error, FaceEditError):
            self._rest("")
            raise error
        self._rest(str(error))
        self.failed.emit(str(error))

    def _work(self, text: str) -> None:
        self.status.setText(text)
        self.busy.show()
        waiting = (self.again, self.save, self.points, *self.parts.values())
        self._held = next((part for part in waiting if part.hasFocus()), None)
        if self._held is not None:
            self.setFocus()  # Qt would choose Close, where Space loses all that was made
        for part in waiting:
            part.setEnabled(False)

    def _rest(self, text: str) -> None:
        self.status.setText(text)
        self.busy.hide()
        for part in (self.points, *self.parts.values()):
            part.setEnabled(True)
        self.again.setEnabled(bool(self._moved) or self._attempt is None)
        self.save.setEnabled(self._attempt is not None and self._is_fitted)
        if self._held is not None and self.hasFocus():
            (self._held if self._held.isEnabled() else self.expression).setFocus()

    def _show_expression(self, name: str) -> None:
        if name in self._pictures:
            self.character.show_picture(self._pictures[name])

    def _move(self, name: str, vertex: int) -> None:
        """A point was dragged to another vertex of the scan."""
        if self._steps is not None:
            self._moved[name] = self._steps.scan.vertices[vertex]
            self._is_fitted = False  # saving now would leave the point where it was
            self._says = (
                "Press Fit again when all points are right; then the character can be saved."
            )
            self._rest(self._says)

    def done(self, result: int) -> None:
        """Forget what is still running."""
        self._background.close()
        super().done(result)
