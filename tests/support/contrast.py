"""How well texts can be read: their contrast with what is behind them, as WCAG 2.1 defines it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from PySide6.QtCore import QModelIndex, QPoint, QRect, QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QComboBox,
    QGroupBox,
    QHeaderView,
    QLabel,
    QLineEdit,
    QMenu,
    QMenuBar,
    QPlainTextEdit,
    QProgressBar,
    QTabBar,
    QTableView,
    QToolButton,
    QTreeView,
    QWidget,
)

LEAST = 4.5
SCALE = 4  # pixels of the picture per pixel of the screen: letters then have their full colour
_TEXTS = (
    *(QLabel, QAbstractButton, QAbstractSpinBox, QComboBox, QLineEdit, QPlainTextEdit),
    *(QGroupBox, QProgressBar),
)
_ROUNDING = 0.1
Place = tuple[str, QRect]  # a text, and where it is in the window


def luminance(color: QColor) -> float:
    """Relative luminance of sRGB."""
    parts = (color.redF(), color.greenF(), color.blueF())
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: QColor | str, other: QColor | str) -> float:
    """Between two colours, 1 to 21."""
    low, high = sorted(luminance(QColor(color)) for color in (one, other))
    return (high + 0.05) / (low + 0.05)


def unreadable_texts(window: QWidget) -> tuple[int, list[str]]:
    """How many texts a window or dialog shows, and those that have less contrast than `LEAST`."""
    picture = _picture_of(window)
    count, bad = 0, []
    for text, place in _places(window):
        count += 1
        found = _contrast_in(picture, place)
        if found < LEAST - _ROUNDING:
            bad.append(f"{text!r}: {found:.2f}")
    return count, bad


def unreadable_entries(menu: QMenu) -> list[str]:
    """The entries of a menu, whether they can be chosen or not, that have less contrast."""
    menu.ensurePolished()
    menu.resize(menu.sizeHint())
    picture = _picture_of(menu)
    bad = []
    for action in menu.actions():
        place = menu.actionGeometry(action)
        if action.isVisible() and not action.isSeparator():
            found = _contrast_in(picture, place)
            if found < LEAST - _ROUNDING:
                bad.append(f"{action.text()!r}: {found:.2f}")
    return bad


def _places(window: QWidget) -> Iterator[Place]:
    for widget in window.findChildren(QWidget):
        if not widget.isVisible() or widget.window() is not window:
            continue
        if widget.visibleRegion().isEmpty():
            continue
        if isinstance(widget, QTabBar):
            for tab in range(widget.count()):
                yield widget.tabText(tab), _inside(window, widget, widget.tabRect(tab))
        elif isinstance(widget, QMenuBar):
            for action in widget.actions():
                yield action.text(), _inside(window, widget, widget.actionGeometry(action))
        elif isinstance(widget, _TEXTS) and (text := _text_of(widget)):
            yield text, _inside(window, widget, widget.rect())
        elif isinstance(widget, QHeaderView):
            yield from _heads(window, widget)
        elif isinstance(widget, QAbstractItemView) and widget.model() is not None:
            yield from _cells(window, widget)


def _inside(window: QWidget, widget: QWidget, rect: QRect) -> QRect:
    """A part of a widget, as it can be seen in the window."""
    seen = widget.visibleRegion().boundingRect() & rect
    return QRect(widget.mapTo(window, seen.topLeft()), seen.size()) & window.rect()


def _heads(window: QWidget, header: QHeaderView) -> Iterator[Place]:
    model = header.model()
    for section in range(header.count() if model is not None else 0):
        text = model.headerData(section, header.orientation(), Qt.ItemDataRole.DisplayRole)
        at, size = header.sectionViewportPosition(section), header.sectionSize(section)
        if text and size > 0:
            place = _inside(window, header.viewport(), QRect(at, 0, size, header.height()))
            if not place.isEmpty():
                yield str(text), place


def _cells(window: QWidget, view: QAbstractItemView) -> Iterator[Place]:
    model, port = view.model(), view.viewport()
    columns = model.columnCount(QModelIndex()) if isinstance(view, QTreeView | QTableView) else 1
    for row in range(model.rowCount(QModelIndex())):
        for column in range(columns):
            index = model.index(row, column)
            rect = view.visualRect(index)
            if not port.rect().contains(rect) or rect.width() < 8:
                continue
            if text := index.data(Qt.ItemDataRole.DisplayRole):
                yield str(text), _inside(window, port, rect)


def _text_of(widget: QWidget) -> str:
    if isinstance(widget, QComboBox):
        return widget.currentText()
    if isinstance(widget, QGroupBox):
        return widget.title()
    if isinstance(widget, QPlainTextEdit):
        return widget.toPlainText() or widget.placeholderText()
    if isinstance(widget, QLineEdit):  # the one in a spin box or combo box is that box's
        inner = isinstance(widget.parent(), QAbstractSpinBox | QComboBox)
        return "" if inner else widget.text() or widget.placeholderText()
    if isinstance(widget, QToolButton):
        is_icon = widget.toolButtonStyle() is Qt.ToolButtonStyle.ToolButtonIconOnly
        return "" if is_icon else widget.text()
    if isinstance(widget, QLabel) and not widget.pixmap().isNull():
        return ""
    if isinstance(widget, QProgressBar):
        return widget.text() if widget.isTextVisible() else ""
    assert isinstance(widget, QLabel | QAbstractButton | QAbstractSpinBox)
    return widget.text()


def _picture_of(window: QWidget) -> QImage:
    picture = QImage(window.size() * SCALE, QImage.Format.Format_RGB32)
    picture.setDevicePixelRatio(SCALE)
    with QPainter(picture) as painter:
        window.render(painter, QPoint())
    return picture


def _contrast_in(picture: QImage, place: QRect) -> float:
    """Between the commonest colour of a place and the one that differs most from it."""
    part = picture.copy(QRect(place.topLeft() * SCALE, QSize(place.size() * SCALE)))
    lines = np.frombuffer(part.constBits(), np.uint32).reshape(part.height(), -1)
    colors, counts = np.unique(lines[::2, : part.width()], return_counts=True)
    behind = QColor.fromRgb(int(colors[counts.argmax()]))
    return max(contrast(QColor.fromRgb(int(color)), behind) for color in colors[counts > 4])
