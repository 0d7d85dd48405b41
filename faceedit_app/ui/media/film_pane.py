"""The film beside, above or below the face, at the playhead."""

from __future__ import annotations

import contextlib
import math
from enum import StrEnum

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QContextMenuEvent, QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QHBoxLayout, QMenu, QSizePolicy, QVBoxLayout, QWidget

from faceedit_app.core.arrays import Pixels
from faceedit_app.core.errors import FaceEditError
from faceedit_app.formats.timing import format_time
from faceedit_app.media.film import Film, Projector
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import MUTED, PANEL
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.look.theme import MARGIN
from faceedit_app.ui.media.landmark_paint import paint_landmarks
from faceedit_app.ui.media.parts import Name, OffsetBox, placing_actions, remove_button
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.state.timeline import Timeline


class FilmPlace(StrEnum):
    """Where the film is shown."""

    BESIDE = "beside"
    ABOVE = "above"
    BELOW = "below"


def best_place(film: QSize, faces: QSize, beside: QSize, above: QSize) -> FilmPlace:
    """Where a film has to be for it and the face to be large: beside the face, or above it.

    Args:
        film, faces: their shapes, in any unit.
        beside, above: the room that both share in either case.
    """

    def shown(part: QSize) -> int:
        keep = Qt.AspectRatioMode.KeepAspectRatio
        both = film.scaled(part, keep), faces.scaled(part, keep)
        return math.prod(size.width() * size.height() for size in both)

    halves = QSize(beside.width() // 2, beside.height()), QSize(above.width(), above.height() // 2)
    at_side, on_top = map(shown, halves)
    return FilmPlace.ABOVE if on_top > at_side else FilmPlace.BESIDE


class Screen(QWidget):
    """Shows the picture at the playhead, or the last one until it is decoded.

    Signals:
        shaped(): the first picture of a film is there, or the film is gone; see `shape`.
        arrived(int): a requested picture is ready; sent from the decoding thread.
        broken(object): the FaceEditError that ended decoding; sent from that thread.
    """

    shaped = Signal()
    arrived = Signal(int)
    broken = Signal(object)

    def __init__(self, media: TakeMedia, timeline: Timeline, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._media, self._timeline = media, timeline
        self._projector: Projector | None = None
        self._film: Film | None = None
        self._picture: Pixels | None = None
        self.shape: QSize | None = None  # of the film's pictures, once one is there
        self.index = -1  # of the picture on screen
        self.wanted = -1
        self._note = ""
        self.setMinimumSize(QSize(140, 100))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setAccessibleName("Film")
        media.film_changed.connect(self._load)
        media.placed.connect(self.follow)
        media.turned.connect(self.update)
        media.overlay.changed.connect(self.update)
        timeline.playhead_moved.connect(self.follow)
        self.arrived.connect(self._show, Qt.ConnectionType.QueuedConnection)
        self.broken.connect(self._stop, Qt.ConnectionType.QueuedConnection)

    def _load(self) -> None:
        """Show another film, or none."""
        self.close_film()
        self.shape = None
        if self._media.film is None:
            self.shaped.emit()
        else:
            self._film = self._media.film.item
            self._projector = Projector(self._film, self._ready, self._failed)
            self.follow()
        self.update()

    @property
    def is_waiting(self) -> bool:
        """Whether there is a film of which no picture is there yet."""
        return self._film is not None and self.shape is None

    def _ready(self, index: int) -> None:
        with contextlib.suppress(RuntimeError):  # the window was just closed
            self.arrived.emit(index)

    def _failed(self, error: FaceEditError) -> None:
        with contextlib.suppress(RuntimeError):
            self.broken.emit(error)

    def follow(self) -> None:
        """Show the picture at the playhead; outside the film, none."""
        placed, film = self._media.film, self._film
        if placed is None or film is None or self._projector is None:
            return
        seconds = self._timeline.time - placed.offset
        # Allow half a picture beyond the ends: rates differ, and clocks are rounded.
        slack = 0.5 / film.rate
        if seconds < -slack:
            self._show_note(f"The film begins at {format_time(placed.offset)}")
        elif seconds > film.duration + slack:
            self._show_note(f"The film ended at {format_time(placed.offset + film.duration)}")
        else:
            self._note = ""
            self.wanted = film.index_at(seconds)
            self._show(self.wanted)
            self._projector.want(self.wanted)

    def _show_note(self, note: str) -> None:
        self._note, self._picture, self.index, self.wanted = note, None, -1, -1
        self.update()

    def _show(self, index: int) -> None:
        picture = self._film.cached(index) if self._film is not None else None
        # A picture that arrives late during playback is still newer than the one on screen.
        done = self.index in (index, self.wanted)
        if picture is not None and self.wanted >= 0 and not done:
            self._picture, self.index = picture, index
            self.update()
            if self.shape is None:
                self.shape = QSize(picture.shape[1], picture.shape[0])
                self.shaped.emit()

    def _stop(self, error: FaceEditError) -> None:
        self.close_film()
        self._show_note(str(error))

    def close_film(self) -> None:
        """Stop decoding."""
        projector, self._projector = self._projector, None
        self._film = self._picture = None
        self.index = self.wanted = -1
        if projector is not None:
            projector.close()

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the picture as large as fits, or why there is none."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(PANEL))
        if self._picture is None:
            painter.setPen(QColor(MUTED))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            room = self.rect().adjusted(16, 16, -16, -16)
            painter.drawText(room, flags, self._note or "Preparing the film…")
            return
        height, width = self._picture.shape[:2]
        scale = min(self.width() / width, self.height() / height)
        wide, high = width * scale, height * scale
        left, top = 0.5 * (self.width() - wide), 0.5 * (self.height() - high)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        if self._media.mirrored:
            painter.translate(self.width(), 0)
            painter.scale(-1, 1)
        pixels = self._picture
        image = QImage(pixels.data, width, height, pixels.strides[0], QImage.Format.Format_RGB32)
        shown = QRectF(left, top, wide, high)
        painter.drawImage(shown, image)
        film = self._film
        places = None if film is None else self._media.overlay.at(film.path, self.index)
        if places is not None:
            paint_landmarks(painter, places, shown)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Show the film's menu."""
        media, timeline = self._media, self._timeline
        menu = QMenu(self)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        placing_actions(menu, media, media.move_film, timeline)
        menu.addSeparator()
        menu.addAction("Remove film").triggered.connect(media.remove_film)
        menu.popup(event.globalPos())

    def sizeHint(self) -> QSize:
        """Nearly as wide as the face, for portrait and landscape films."""
        return QSize(480, 560)


class FilmPane(QWidget):
    """The film, with its name and offset below. Hidden without a film."""

    def __init__(self, media: TakeMedia, timeline: Timeline) -> None:
        super().__init__()
        self._media = media
        self.screen_ = Screen(media, timeline)
        self.name = Name()
        self.offset = OffsetBox("film")
        self.offset.setFixedWidth(86)
        self.offset.valueChanged.connect(media.move_film)
        self.offset.editingFinished.connect(media.acted)
        remove = remove_button("film")
        remove.clicked.connect(media.remove_film)
        foot = QWidget()
        foot.setObjectName("film_foot")
        foot.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        row = QHBoxLayout(foot)
        row.setContentsMargins(MARGIN, 3, 6, 3)
        row.setSpacing(4)
        row.addWidget(self.name, 1)
        row.addWidget(self.offset)
        row.addWidget(remove)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.screen_, 1)
        column.addWidget(foot)
        for changed in (media.film_changed, media.sound_changed, media.placed):
            changed.connect(self._sync)
        self._sync()

    def _sync(self) -> None:
        placed = self._media.film
        self.setVisible(placed is not None)
        if placed is not None:
            self.name.show_name(placed.path.name, str(placed.path))
            self.screen_.setToolTip(plain_tip(str(placed.path)))
            self.offset.show_offset(placed.offset)
            sound = self._media.sound  # of the same file: it has this field, and moves the film
            self.offset.setVisible(sound is None or sound.path != placed.path)
