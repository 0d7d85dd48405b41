"""Colours and sizes of the curves panel.

Sky blue and orange (Okabe and Ito) can be distinguished with any kind of colour blindness, and
the three lines differ in width and pattern too, so nothing depends on colour alone.
"""

from __future__ import annotations

from functools import lru_cache

from PySide6.QtGui import QColor, QFont, QPen
from PySide6.QtWidgets import QWidget

from faceedit_app.ui.look import palette

BACKGROUND = palette.BACKGROUND
PLOT = "#23272c"
PLOT_ACTIVE = "#272c32"  # under the pointer, or focused
TICK = "#5c626b"
GRID = "#30353c"
TEXT = palette.TEXT
MUTED = palette.MUTED
LABEL = palette.LABEL  # names of the curves
TRACKED = "#9aa0aa"
ASKED = "#f4f5f7"
CHARACTER = "#009e73"  # what the user's character does
PLAYHEAD = "#ffffff"
FOCUS = palette.ACCENT
SELECTION = palette.ACCENT
EDITED = "#a9c4de"  # where an edit acts
GAP = "#d08a6a"  # gaps
TAG = "#14161a"  # behind numbers on the curves

FACE_WIDTH = 1.8  # pixels
DIMMED = 0.4  # opacity of a curve that cannot be changed
HEADER_WIDTH = 182  # left of everything on the time axis
AXIS_WIDTH = 38  # of it, for the numbers of the value axis
RULER_HEIGHT = 34
LEGEND_HEIGHT = 28
ROW_HEIGHT = 24  # at least
ROW_GAP = 2
RIGHT_MARGIN = 8
VALUE_SPACING = 19  # pixels between the numbers of the value axis
TIME_SPACING = 74  # pixels between the numbers of the time axis
TIMECODE_SPACING = 106

# Opacity of spans, 0..255: of an edit in its own plot, in the others, and while hovering; of the
# selection.
STRONG, WEAK, HOVER, SELECTED = 72, 34, 40, 34


@lru_cache(maxsize=256)
def color(name: str, alpha: int = 255) -> QColor:
    """A colour with some transparency; do not modify it."""
    out = QColor(name)
    out.setAlpha(alpha)
    return out


@lru_cache(maxsize=64)
def hairline(name: str, alpha: int = 255) -> QPen:
    """A pen one dot of the screen wide; do not modify it."""
    return QPen(color(name, alpha), 0)


def _pen(name: str, width: float, dashes: tuple[float, ...] = ()) -> QPen:
    pen = QPen(QColor(name), width)
    pen.setCosmetic(True)
    if dashes:
        pen.setDashPattern(list(dashes))
    return pen


def tracked_pen() -> QPen:
    """The curve as tracked: thin and grey."""
    return _pen(TRACKED, 1.0)


def asked_pen() -> QPen:
    """The curve as asked for: dashed."""
    return _pen(ASKED, 1.0, (4.0, 3.0))


def character_pen() -> QPen:
    """What the user's character does where it differs: thin, in the colour of its problems."""
    return _pen(CHARACTER, 1.0)


def face_pen(color: str) -> QPen:
    """The curve as the face shows it: solid, in the control's colour."""
    return _pen(color, FACE_WIDTH)


def in_dots(pen: QPen, ratio: float) -> QPen:
    """A pen as wide on a screen with `ratio` dots per pixel: Qt counts that of these in dots."""
    wide = QPen(pen)
    wide.setWidthF(pen.widthF() * ratio)
    return wide


def scaled_font(widget: QWidget, factor: float, bold: bool = False) -> QFont:
    """The widget's font in another size, whether it is set in points or in pixels."""
    font = QFont(widget.font())
    if font.pointSizeF() > 0:
        font.setPointSizeF(font.pointSizeF() * factor)
    else:
        font.setPixelSize(max(round(font.pixelSize() * factor), 1))
    font.setBold(bold)
    return font
