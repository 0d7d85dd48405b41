"""The words and phonemes under the waveform, on the same time axis."""

from __future__ import annotations

from bisect import bisect_left
from typing import TYPE_CHECKING

import pyqtgraph as pg
from PySide6.QtCore import QPoint, QRectF, Qt, Signal
from PySide6.QtGui import QFontMetricsF, QKeyEvent, QPainter
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from faceedit_app.ui.curves import paint, style
from faceedit_app.ui.curves.gestures import FINE, Pointer, Span
from faceedit_app.ui.curves.scale import Scale
from faceedit_app.ui.curves.time_view import Mouse, TimeView
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.words.speech_sounds import Lips, lips_of, spelled

if TYPE_CHECKING:
    from faceedit_app.words.transcript import Transcript, Word

HEIGHT = 44  # pixels
_WORDS = 24  # of them, for the words
_NEAR = 4.0  # pixels from an edge within which it is dragged
_PADDING = 3.0  # pixels beside a text
_LEAST = 3.0  # pixels; narrower phonemes are not drawn one by one
_WORD, _CLOSING = 38, 78  # opacity behind words, and behind m, b and p; orange is for problems
_LIPS = 2.0  # pixels of the line under m, b and p, as of shut lips
_TIP = (
    "What is said. Drag an edge to move it in time; with Shift, ten times finer.\n"
    "Double-click a word to select its time; Ctrl+L repeats it.\n"
    "m, b and p are underlined: there the lips should meet. If they do not, that is a problem.\n"
    "To bring the face to a word, choose Retime (W) and drag a curve sideways."
)


class WordsStrip(pg.GraphicsView, Mouse):
    """The words in the visible time range.

    Signals:
        menu_asked(place): a right click, and its place on the screen; the word there is selected.
    """

    menu_asked = Signal(QPoint)

    def __init__(self, document: Document, timeline: Timeline) -> None:
        super().__init__(background=style.PLOT)
        self._document, self._timeline = document, timeline
        self._held: tuple[float, float, float] | None = None  # edge, last pixel, its time now
        self._before: Transcript | None = None  # at the start of the drag
        self._scrubs = False
        self.view = TimeView(timeline, self, has_values=False)
        self.setCentralItem(self.view)
        self._marks = _Marks(self)
        self._marks.setParentItem(self.view)
        self.view.menu_asked.connect(self._ask_menu)
        self.view.sigResized.connect(self._marks.renew)
        for changed in (
            timeline.view_changed,
            timeline.playhead_moved,
            timeline.selection_changed,
            timeline.falloff_changed,
        ):
            changed.connect(self._marks.renew)
        self.setFixedHeight(HEIGHT)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setAcceptDrops(False)
        self.setObjectName("words")
        self.setAccessibleName("Words")
        self.setAccessibleDescription(_TIP)
        self.setToolTip(_TIP)

    @property
    def words(self) -> Transcript | None:
        """What is shown."""
        session = self._document.session
        return session.words if session is not None else None

    @property
    def timeline(self) -> Timeline:
        """The time axis."""
        return self._timeline

    @property
    def current_scale(self) -> Scale:
        """How its pixels map to seconds."""
        return self.view.scale_now

    def renew(self) -> None:
        """Show the words again: they may be others."""
        self._marks.renew()

    def select(self, word: Word) -> None:
        """Select a word's time and go there."""
        self._timeline.go_to_time(word.start)
        line = self._timeline
        line.select((line.snap_edge(word.start), line.snap_edge(word.end)))

    def find(self, text: str) -> bool:
        """Select the next word after the playhead that begins with a text; False if none does.

        From the last one, the search goes on with the first.
        """
        words, wanted = self.words, text.strip().casefold()
        if words is None or not wanted:
            return False
        found = [word for word in words.words if word.text.casefold().startswith(wanted)]
        selection = self._timeline.selection
        now = selection[0] if selection is not None else self._timeline.time - 1e-3
        later = [word for word in found if self._timeline.snap_edge(word.start) > now + 1e-6]
        if found:
            self.select((later or found)[0])
        return bool(found)

    # --- mouse -----------------------------------------------------------------------------

    def pressed(self, pointer: Pointer) -> None:
        """Drag the edge under the pointer, or scrub."""
        edge = self._edge_at(pointer)
        if edge is not None:
            self._held, self._before = (edge, pointer.x, edge), self.words
        else:
            self._scrubs = True
            self._timeline.go_to_time(self.current_scale.time_at(pointer.x))

    def dragged(self, pointer: Pointer) -> None:
        """Continue the gesture."""
        session, scale = self._document.session, self.current_scale
        if self._held is not None and self._before is not None and session is not None:
            edge, last, now = self._held
            way = (pointer.x - last) * scale.seconds_per_pixel * (FINE if pointer.fine else 1.0)
            self._held = edge, pointer.x, now + way
            session.preview_words(self._before.with_edge(edge, now + way))
        elif self._scrubs:
            x = min(max(pointer.x, 0.0), scale.width)
            self._timeline.go_to_time(scale.time_at(x))

    def released(self, pointer: Pointer) -> None:
        """End the gesture."""
        self.dragged(pointer)
        self.mouse_lost()

    def double_clicked(self, pointer: Pointer) -> None:
        """Select the word under the pointer, or clear the selection."""
        word = self._word_at(pointer.x)
        if word is not None:
            self.select(word)
        else:
            self._timeline.select(None)

    def mouse_lost(self) -> None:
        """The button is up: keep the result."""
        was_held, self._held, self._scrubs = self._held is not None, None, False
        if was_held:
            self._document.commit("Move edge of a word")

    def cancel(self) -> None:
        """Esc, or the right button: leave the edge where it was."""
        if self._held is not None:
            self._held = None
            self._document.cancel()

    @property
    def is_held(self) -> bool:
        """Whether an edge is being dragged."""
        return self._held is not None

    def hovered(self, pointer: Pointer) -> None:
        """Show whether a press would drag an edge."""
        near = self._edge_at(pointer) is not None
        shape = Qt.CursorShape.SizeHorCursor if near else Qt.CursorShape.ArrowCursor
        self.view.setCursor(shape)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc cancels the drag; all other keys go to the window."""
        if event.key() == Qt.Key.Key_Escape:
            self.cancel()
        event.ignore()

    def _ask_menu(self, x: float, _y: float, place: QPoint) -> None:
        word = self._word_at(x)
        if word is not None:
            self.select(word)
        self.menu_asked.emit(place)

    def _word_at(self, x: float) -> Word | None:
        words, seconds = self.words, self.current_scale.time_at(x)
        inside = (w for w in (words.words if words else ()) if w.start <= seconds <= w.end)
        return next(inside, None)

    def _edge_at(self, pointer: Pointer) -> float | None:
        """The edge under the pointer: among the words, only those of words."""
        words, scale = self.words, self.current_scale
        if words is None:
            return None
        edges = words.edges
        if pointer.y < _WORDS:
            edges = tuple(sorted(t for word in words.words for t in (word.start, word.end)))
        seconds = scale.time_at(pointer.x)
        at = bisect_left(edges, seconds)
        near = [(abs(scale.x_of(t) - pointer.x), t) for t in edges[max(at - 1, 0) : at + 1]]
        distance, edge = min(near, default=(_NEAR + 1.0, 0.0))
        return edge if distance <= _NEAR else None


class _Marks(pg.GraphicsObject):
    """Paints a strip's words, in its pixels."""

    def __init__(self, strip: WordsStrip) -> None:
        super().__init__()
        self._strip = strip
        self._fonts = style.scaled_font(strip, 0.95), style.scaled_font(strip, 0.78)

    def renew(self) -> None:
        """Paint again."""
        self.prepareGeometryChange()
        self.update()

    def boundingRect(self) -> QRectF:
        """The whole strip."""
        rect: QRectF = self._strip.view.rect()
        return rect

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, _widget: QWidget | None = None
    ) -> None:
        """Selection, words, phonemes, playhead."""
        strip, timeline = self._strip, self._strip.timeline
        scale, words = strip.current_scale, strip.words
        if timeline.selection is not None:
            span = Span(*timeline.selection, timeline.falloff, timeline.falloff_out)
            paint.draw_selection(painter, scale, span)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        for word in words.words if words is not None else ():
            left, right = scale.x_of(word.start), scale.x_of(word.end)
            if right < 0 or left > scale.width:
                continue
            box = QRectF(left, 2, max(right - left, 1.0), _WORDS - 3)
            painter.fillRect(box, style.color(style.EDITED, _WORD))
            self._write(painter, box, word.text, 0, style.TEXT)
            self._draw_edges(painter, (left, right), 2, HEIGHT - 2)
            self._paint_phonemes(painter, word, scale)
        paint.draw_playhead(painter, scale, timeline.time)

    def _paint_phonemes(self, painter: QPainter, word: Word, scale: Scale) -> None:
        top, height = float(_WORDS), float(HEIGHT - _WORDS - 2)
        for phoneme in word.phonemes:
            left, right = scale.x_of(phoneme.start), scale.x_of(phoneme.end)
            closes = lips_of(phoneme.symbol) is Lips.CLOSE
            if right - left < _LEAST and not closes:
                continue
            box = QRectF(left, top, max(right - left, 1.0), height)
            if closes:
                painter.fillRect(box, style.color(style.EDITED, _CLOSING))
                lips = QRectF(left, top + height - _LIPS, box.width(), _LIPS)
                painter.fillRect(lips, style.color(style.EDITED))
            ink = style.TEXT if closes else style.MUTED
            self._write(painter, box, spelled(phoneme.symbol), 1, ink)
            self._draw_edges(painter, (right,), top, top + height)

    def _write(self, painter: QPainter, box: QRectF, text: str, size: int, ink: str) -> None:
        """Write a text in the middle of a box, if it fits or, for a word, as much as fits."""
        font = self._fonts[size]
        metrics, room = QFontMetricsF(font), box.width() - (_PADDING if size == 0 else 0.0)
        if metrics.horizontalAdvance(text) > room:
            text = metrics.elidedText(text, Qt.TextElideMode.ElideRight, room) if size == 0 else ""
        if text and text != "…":
            painter.setFont(font)
            painter.setPen(style.color(ink))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    @staticmethod
    def _draw_edges(painter: QPainter, edges: tuple[float, ...], top: float, bottom: float) -> None:
        painter.setPen(style.hairline(style.EDITED, 130))
        for x in edges:
            painter.drawLine(round(x), round(top), round(x), round(bottom))
