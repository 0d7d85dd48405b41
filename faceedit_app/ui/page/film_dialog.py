"""The dialog of File > Export film: what is shown, how large, and in which format."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.editing.filming import FilmView, Shot
from faceedit_app.formats.rates import COMMON_RATES
from faceedit_app.formats.timing import format_rate
from faceedit_app.media.film_writer import FILM_FORMATS, FilmFormat
from faceedit_app.ui.look.widgets import Choice

_VIEWS = {
    FilmView.FACE: "The face",
    FilmView.BOTH: "Both faces: tracked and edited",
    FilmView.FILM: "The take's film beside the face",
    FilmView.FILM_ABOVE: "The take's film above the face",
    FilmView.FILM_BELOW: "The take's film below the face",
}
_HEIGHTS = (720, 1080, 480, 1440)
_ASPECTS = {FilmView.FACE: 1.0, FilmView.BOTH: 2.0, FilmView.FILM: 16 / 9}
_STACKED = 8 / 9  # two landscape pictures, one above the other
_FASTEST = 60.0  # pictures per second that are offered
_NOTES = {"mp4": "plays everywhere", "webm": "for the web", "png": "numbered, in a folder"}


class FilmDialog(QDialog):
    """Asks how to film a take.

    Args:
        rate: of the take.
        has_sound, has_film: whether the take has them.
    """

    def __init__(
        self, parent: QWidget | None, rate: float, has_sound: bool, has_film: bool
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export film")
        self.setMinimumWidth(420)
        column = QVBoxLayout(self)
        column.setSpacing(12)
        form = QFormLayout()
        form.setLabelAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.view = Choice()
        for view, text in _VIEWS.items():
            if has_film or not view.has_film:
                self.view.addItem(text, view)
        form.addRow("&Show", self.view)
        self.picture_size = Choice()
        form.addRow("Si&ze", self.picture_size)
        self.rate = Choice()
        self.rate.addItem(f"Same as the take: {format_rate(rate)}", None)
        for other in COMMON_RATES:
            if other <= _FASTEST and abs(other / rate - 1) > 1e-4:
                self.rate.addItem(format_rate(other), other)
        form.addRow("Frame &rate", self.rate)
        self.format = Choice()
        for kind in FILM_FORMATS:
            self.format.addItem(f"{kind.name}: {_NOTES[kind.key]}", kind)
        form.addRow("&Format", self.format)
        self.sound = QCheckBox("With the take's s&ound")
        self.sound.setChecked(has_sound)
        self.sound.setEnabled(has_sound)
        form.addRow("", self.sound)
        column.addLayout(form)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        buttons.addButton("&Export…", QDialogButtonBox.ButtonRole.AcceptRole).setDefault(True)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column.addWidget(buttons)
        self.view.currentIndexChanged.connect(self._offer_sizes)
        self._offer_sizes()

    @property
    def chosen(self) -> FilmFormat:
        """The chosen format."""
        chosen: FilmFormat = self.format.currentData()
        return chosen

    @property
    def shot(self) -> Shot:
        """What was chosen; the camera is left to the caller."""
        return Shot(
            view=FilmView(self.view.currentData()),
            size=tuple(self.picture_size.currentData()),
            rate=self.rate.currentData(),
            form=self.chosen.key,
            has_sound=self.sound.isChecked(),
        )

    def _offer_sizes(self) -> None:
        before = max(self.picture_size.currentIndex(), 0)
        aspect = _ASPECTS.get(FilmView(self.view.currentData()), _STACKED)
        self.picture_size.clear()
        for height in _HEIGHTS:
            width = 2 * round(height * aspect / 2)
            self.picture_size.addItem(f"{width} × {height}", (width, height))
        self.picture_size.setCurrentIndex(before)
