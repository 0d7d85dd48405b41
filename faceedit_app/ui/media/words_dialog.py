"""The dialog for the words of a take: type what is said, and find when."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QCloseEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.core.errors import FaceEditError
from faceedit_app.ui.look.texts import Message, plain_label
from faceedit_app.ui.state.background import Background
from faceedit_app.words import aligning, files, imported
from faceedit_app.words.denoising import Stopped
from faceedit_app.words.dictionary import LANGUAGE, is_foreign, spoken, suggestion, unknown_words
from faceedit_app.words.transcript import Transcript

if TYPE_CHECKING:  # it imports PyAV
    from faceedit_app.media.sound import Sound

_STEPS = 1000  # of the progress bar
_MOST_ASKED = 12  # unknown words at once; the others are asked for after these


@dataclass(frozen=True)
class SearchScope:
    """Where words are looked for.

    Attributes:
        sound: the take's sound, if it has any.
        offset: when its file begins, in seconds of the take.
        take: first and last second of the take.
        selection: the selected range, if any.
        shown: the selected range as it is shown.
        is_read: the take's sound is not still being read, so that its offset is known.
    """

    sound: Sound | None
    offset: float
    take: tuple[float, float]
    selection: tuple[float, float] | None
    shown: str = ""
    is_read: bool = True


@dataclass(frozen=True)
class Draft:
    """Words that were typed and not yet timed.

    Attributes:
        text: what is said.
        spellings: what unknown words sound like, as far as that was given.
    """

    text: str
    spellings: dict[str, str]


class WordsDialog(QDialog):
    """Asks for the words, and for what unknown ones sound like; then finds their times.

    What is typed and not timed is there again when the words of the same file are next asked for.

    Args:
        place: says where to look; asked again with each search, since the sound may come later.
        present: the take's words, if it has any.
        choose: asks for a file with words.
        save: asks where to write words, and writes them; None = they cannot be written.
        make: called with the words that were found.
        drafts: where it keeps what is typed and not timed.
        said_in: the take or sound that the words are of.
    """

    def __init__(
        self,
        parent: QWidget,
        background: Background,
        place: Callable[[], SearchScope],
        present: Transcript | None,
        choose: Callable[[], Path | None],
        save: Callable[[], None] | None,
        make: Callable[[Transcript], None],
        drafts: dict[Path, Draft],
        said_in: Path,
    ) -> None:
        super().__init__(parent)
        self._background, self._find_place, self._present = background, place, present
        self._choose, self._make = choose, make
        self._drafts, self._said_in = drafts, said_in
        self._place = place()
        self._imported: imported.Imported | None = None  # the file whose text is in the field
        self._spellings = dict(present.sounds_like) if present is not None else {}
        self._asked: dict[str, QLineEdit] = {}
        self._job: _Job | None = None
        self.setWindowTitle("Words")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._lay_out(save)
        if present is not None:
            self.text.setPlainText(present.text)
        self._restore(drafts.get(said_in))
        self.text.textChanged.connect(self._edited)
        self._show_state()

    def _restore(self, draft: Draft | None) -> None:
        if draft is not None:
            self.text.setPlainText(draft.text)
            self._spellings |= draft.spellings
            self.message.setText("You typed this before; no times have been found for it yet.")

    def _lay_out(self, save: Callable[[], None] | None) -> None:
        self.heading = QLabel(self._heading())
        self.text = QPlainTextEdit()
        self.text.setPlaceholderText("Type or paste what is said")
        self.text.setAccessibleName("What is said")
        self.text.setMinimumSize(460, 130)
        self.text.setTabChangesFocus(True)
        self.in_selection = QCheckBox()
        if self._place.selection is not None:
            self.in_selection.setText(f"&Only in the selection, {self._place.shown}")
        self.in_selection.setVisible(self._place.selection is not None)
        self.spellings = QFormLayout()
        self.progress = QProgressBar()
        self.progress.setRange(0, _STEPS)
        self.progress.setTextVisible(False)
        self.message = Message()
        self.search = QPushButton("&Find times")
        self.search.setDefault(True)
        self.search.clicked.connect(self.start)
        self.search.setToolTip("Ctrl+Enter starts it from the text")
        for keys in ("Ctrl+Return", "Ctrl+Enter"):  # Enter alone begins a line
            QShortcut(QKeySequence(keys), self).activated.connect(self.search.click)
        buttons = QDialogButtonBox()
        role = QDialogButtonBox.ButtonRole
        self.open_file = buttons.addButton("O&pen…", role.ActionRole)
        self.open_file.setToolTip("Open TextGrid, SRT, VTT, JSON or TXT")
        self.open_file.clicked.connect(self._open)
        self.export = buttons.addButton("&Export…", role.ActionRole)
        self.export.setToolTip("Write the take's words as TextGrid, SRT or JSON")
        self.export.setEnabled(self._present is not None)
        self.export.setVisible(save is not None)
        if save is not None:
            self.export.clicked.connect(save)
        buttons.addButton(self.search, role.AcceptRole)
        self.stop = buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        self.stop.clicked.connect(self._stop)
        column = QVBoxLayout(self)
        column.setSpacing(10)
        column.addWidget(self.heading)
        column.addWidget(self.text, 1)
        column.addWidget(self.in_selection)
        column.addLayout(self.spellings)
        column.addWidget(self.progress)
        column.addWidget(self.message)
        column.addWidget(buttons)

    def _heading(self) -> str:
        if self._place.sound is None and self._place.is_read:
            return "Open a file with times, or add the take's sound and type what is said."
        return f"What is said, in {LANGUAGE}. For other languages, open a file with times."

    # --- finding ---------------------------------------------------------------------------

    def start(self) -> None:
        """Ask for unknown words, else find the times in the background."""
        if self._job is not None:
            return
        self._place = self._find_place()
        self.heading.setText(self._heading())
        if not self._place.is_read:
            self.message.setText("The take's sound is still being read; try again in a moment.")
            return
        try:
            self._take_spellings()
        except FaceEditError as error:
            self.message.setText(f"{error}.")
            return
        if self._imported is not None and self._imported.transcript is not None:
            self._finish(self._imported.transcript.shifted(self._place.offset))
            return
        unknown = unknown_words(self.text.toPlainText(), self._spellings)
        if self._place.sound is not None and unknown:
            self._ask(unknown)
            return
        self._job = _Job(self)
        self._job.moved.connect(self._moved)
        self._show_state()
        self._background.run(self._work(self._job), self._found, self._failed)

    def _take_spellings(self) -> None:
        """Read what unknown words sound like.

        Raises:
            FaceEditError: a spelling is not in the dictionary either.
        """
        for word, field in self._asked.items():
            spelling = field.text().strip()
            if spelling:
                field.setFocus()
                spoken(spelling)
                self._spellings[word] = spelling

    def _work(self, job: _Job) -> Callable[[], Transcript]:
        place, spellings = self._place, dict(self._spellings)
        lines = self._imported.lines if self._imported is not None else None
        text = self.text.toPlainText()
        wanted = place.selection if self.in_selection.isChecked() else None

        def work() -> Transcript:
            said = lines or (aligning.TextLine(text),)
            if place.sound is None:
                if any(line.end is None for line in said):
                    raise FaceEditError("The take has no sound; add it, or open a file with times")
                return imported.spread(said, place.take[1])
            sound = place.sound
            first, last = (t - place.offset for t in (wanted or place.take))
            part = max(first, sound.start), min(last, sound.end)
            found = aligning.align_part(
                sound.samples, sound.rate, sound.start, part, said, spellings, job.report
            )
            return found.shifted(place.offset)

        return work

    def _ask(self, unknown: list[str]) -> None:
        """Ask what unknown words sound like."""
        while self.spellings.rowCount():
            self.spellings.removeRow(0)
        self._asked = {}
        for word in unknown[:_MOST_ASKED]:
            field = QLineEdit()
            field.setPlaceholderText("sounds like, in English words")
            field.setAccessibleName(f"{word[:40]} sounds like")
            field.setText(suggestion(word))
            self._asked[word] = field
            self.spellings.addRow(plain_label(f"“{word[:40]}”"), field)
        left = len(unknown) - len(self._asked)
        more = f" {left} more follow." if left else ""
        if is_foreign(self.text.toPlainText(), unknown):
            more = f" For a language other than {LANGUAGE}, open a file with times."
        self.message.setText(
            "Not in the dictionary. Correct the spelling above, or type what it sounds like:"
            f" “two” for 2.{more}"
        )
        next((f for f in self._asked.values() if not f.text()), self.search).setFocus()

    def _found(self, words: Transcript) -> None:
        self._job = None
        self._finish(words)

    def _finish(self, words: Transcript) -> None:
        if self.in_selection.isChecked() and self._present is not None:
            words = self._present.joined(words)
        self._make(words)
        self.accept()

    def _failed(self, error: Exception) -> None:
        self._job = None
        self._show_state()
        self.text.setFocus()  # the button that had the focus lost it while it was off
        if isinstance(error, Stopped):
            self.message.setText("Cancelled.")
        elif isinstance(error, FaceEditError):
            self.message.setText(f"{error}.")
        else:
            raise error

    def _moved(self, share: float) -> None:
        self.progress.setValue(round(_STEPS * share))

    # --- its own state ---------------------------------------------------------------------

    def _open(self) -> None:
        """Fill the field from a file."""
        path = self._choose()
        if path is None:
            return
        try:
            found = files.read_words(path)
        except FaceEditError as error:
            self.message.setText(f"{error}.")
            return
        self.text.setPlainText("\n".join(line.text for line in found.lines))
        self._imported = found
        self.message.setText("")
        self._show_state()

    def _edited(self) -> None:
        """The text is no longer that of the file."""
        self._imported = None
        self._show_state()

    def _show_state(self) -> None:
        busy = self._job is not None
        has_times = self._imported is not None and self._imported.transcript is not None
        self.search.setText("&Use these times" if has_times else "&Find times")
        self.search.setEnabled(not busy and bool(self.text.toPlainText().strip()))
        self.text.setReadOnly(busy)
        self.open_file.setEnabled(not busy)
        self.progress.setVisible(busy)
        self.progress.setValue(0)
        if busy:
            self.message.setText("Finding when each word is said…")

    def _stop(self) -> None:
        """Stop the search, or close."""
        if self._job is not None:
            self._job.is_stopped = True
            self.message.setText("Cancelling…")
        else:
            self.reject()

    def reject(self) -> None:
        """Esc: stop the search first."""
        if self._job is not None:
            self._stop()
        else:
            super().reject()

    def done(self, result: int) -> None:
        """Keep what was typed, unless its times were found or a file holds it."""
        text = self.text.toPlainText()
        is_known = not text.strip() or self._imported is not None
        is_known |= self._present is not None and text == self._present.text
        self._drafts.pop(self._said_in, None)
        if result == QDialog.DialogCode.Rejected and not is_known:
            self._drafts[self._said_in] = Draft(text, dict(self._spellings))
        super().done(result)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Stop the search; its result is then ignored."""
        if self._job is not None:
            self._job.is_stopped = True
            event.ignore()
        else:
            super().closeEvent(event)


class _Job(QObject):
    """One search.

    Signals:
        moved(float): progress, 0..1.
    """

    moved = Signal(float)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.is_stopped = False

    def report(self, share: float) -> bool:
        """Called in the thread: whether to go on."""
        if not self.is_stopped:
            self.moved.emit(share)
        return not self.is_stopped
