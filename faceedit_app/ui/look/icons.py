"""The icons: the SVG files in `icons/`, drawn in the window's colours and sharp on every screen.

Each is drawn on a grid of 16 by 16 units in `currentColor`, which is replaced by the colour
asked for. `faceedit.svg`, the application's icon, and `list_arrow.svg`, `menu_tick.svg` and
`menu_tick_disabled.svg`, which the style sheet uses, are in their own colours.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from PySide6.QtCore import QByteArray, Qt
from PySide6.QtGui import QGuiApplication, QIcon, QPainter, QPixmap, QPixmapCache
from PySide6.QtSvg import QSvgRenderer

from faceedit_app.ui.look.palette import FAINT, TEXT

SIZE = 16  # of an icon on a button, in units of the window
APP_ICON = "faceedit"
_FOLDER = Path(__file__).parent / "icons"
_APP_SIZES = (16, 24, 32, 48, 64, 128, 256)


def icon(name: str, color: str = TEXT) -> QIcon:
    """An icon by name, with a paler version for disabled controls."""
    out = QIcon()
    for mode, ink in ((QIcon.Mode.Normal, color), (QIcon.Mode.Disabled, FAINT)):
        for ratio in _ratios():
            out.addPixmap(picture(name, ink, SIZE, ratio), mode)
    return out


def picture(name: str, color: str, size: int, ratio: float) -> QPixmap:
    """An icon by name, as a picture.

    Args:
        name: of its file, without the suffix.
        color: replaces `currentColor`.
        size: width and height in units of the window.
        ratio: screen pixels per unit.
    """
    pixmap, key = QPixmap(), f"FaceEdit {name} {color} {size} {ratio}"
    if QPixmapCache.find(key, pixmap):
        return pixmap
    pixmap = QPixmap(round(size * ratio), round(size * ratio))
    pixmap.fill(Qt.GlobalColor.transparent)
    with QPainter(pixmap) as painter:
        QSvgRenderer(QByteArray(_source(name).replace("currentColor", color).encode())).render(
            painter
        )
    pixmap.setDevicePixelRatio(ratio)
    QPixmapCache.insert(key, pixmap)
    return pixmap


def app_icon() -> QIcon:
    """FaceEdit's icon."""
    out = QIcon()
    for size in _APP_SIZES:
        out.addPixmap(picture(APP_ICON, "", size, 1.0))
    return out


def icon_file(name: str) -> Path:
    """The file of an icon."""
    return _FOLDER / f"{name}.svg"


@cache
def _source(name: str) -> str:
    return icon_file(name).read_text(encoding="utf-8")


def _ratios() -> list[float]:
    """Screen pixels per unit of all screens, so that no screen shows a scaled icon."""
    return sorted({1.0, 2.0, *(screen.devicePixelRatio() for screen in QGuiApplication.screens())})
