"""What can be told of a window or a panel: the same for the same state.

A window or a panel that an earlier test has left is used again only if nothing here tells it from
a new one.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterator
from enum import Enum
from pathlib import Path
from typing import Any, cast

import numpy as np
from PySide6.QtCore import (
    QObject,
    QPoint,
    QPointF,
    QRect,
    QRectF,
    QSize,
    QTimer,
    SignalInstance,
)
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSlider,
    QComboBox,
    QDoubleSpinBox,
    QGraphicsScene,
    QLabel,
    QLineEdit,
    QStackedWidget,
    QStatusBar,
    QTabBar,
    QWidget,
)

from faceedit_app.ui.curves.header import Header
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.time_view import TimeView
from faceedit_app.ui.start.window import MainWindow

Facts = dict[str, Hashable]
Files = tuple[tuple[str, bytes], ...]

_PLAIN = (bool, int, float, str, bytes, type(None), Enum)
# A set tells sooner what nearly all values are: plain, or nothing that can be looked into.
_PLAIN_TYPES = frozenset(_PLAIN)
_OPAQUE: set[type] = set()  # those found so far
_FOLDED = (CurvePlot, Header)
_SEEN = (QWidget, QAction, QTimer, QGraphicsScene)
_BOXES = (QPoint, QPointF, QRect, QRectF, QSize)
_DEEPEST = 4  # levels of lists in lists
_OURS = "faceedit_app.ui."
# Attributes of caches, of what is made when it is first needed, of what counts how often something
# happened, and of what the next press or picture sets before it is read.
_PASSING = {
    "__METAOBJECT__", "_job", "draws", "_newest", "_anchor", "_last_preview", "_spans",
    "_extremes", "_numbers", "_painted", "lastMousePos", "_stale", "_smooth", "_picture", "_began",
    "_shown_at", "_measured", "range", "_box", "_backdrop", "_took", "_loudest", "_share",
}  # fmt: skip


def facts_of(window: MainWindow) -> Facts:
    """All that its widgets show, and all that its objects hold: the same for the same state."""
    if window.editor is not None and window.editor.problems.is_searched:
        window.editor.problems.restart()  # a slow computer has searched the take by now
    facts: Facts = {"title": window.windowTitle(), "state": window.windowState().value}
    return facts | facts_below(window)


def facts_below(top: QObject) -> Facts:
    """What can be told of an object and of all below it."""
    facts: Facts = {}
    for name, thing in _parts("", top):
        is_ours = type(thing).__module__.startswith(_OURS)
        if not is_ours and not isinstance(thing, _SEEN):
            continue  # what Qt keeps for itself
        if isinstance(thing, QGraphicsScene):
            facts[name] = _seen_in(thing)
        else:
            if (shown := _shown(thing)) is not None:
                facts[name] = shown
            if is_ours:
                _add_held(facts, name, thing)
    return facts


def _parts(above: str, thing: QObject) -> Iterator[tuple[str, QObject]]:
    """It and all below it, by names that do not depend on what lies upon what."""
    if isinstance(thing, _FOLDED) and thing.control.optional and thing.isHidden():
        return  # folded away, it is brought up to date when it is unfolded
    yield above, thing
    counts: dict[str, int] = {}
    for child in thing.children():
        kind = f"{type(child).__name__} {child.objectName()}"
        counts[kind] = counts.get(kind, 0) + 1
        yield from _parts(f"{above}/{kind} {counts[kind]}", child)


def _shown(thing: QObject) -> Hashable:
    """What the user sees of it."""
    if isinstance(thing, QAction):
        return thing.text(), thing.isEnabled(), thing.isChecked(), thing.isVisible()
    if isinstance(thing, QTimer):
        return thing.interval()
    if not isinstance(thing, QWidget) or thing.objectName().startswith("qt_scrollarea_"):
        return None  # what Qt makes when it is first needed
    if not thing.isVisible() and not _is_on_a_page(thing):
        return None  # it is set when it is shown
    place: Hashable = None
    if thing.isVisible():
        place = repr(thing.size()) if thing.isWindow() else repr(thing.geometry())
    common = (
        thing.isHidden(),
        place,
        thing.isEnabled(),
        thing.hasFocus(),
        _anywhere(thing.toolTip()),
    )
    return common, thing.accessibleDescription(), _content(thing)


def _is_on_a_page(widget: QWidget) -> bool:
    """Whether another page hides it, but nothing on its own page."""
    place: QWidget | None = widget
    while place is not None and not isinstance(place.parentWidget(), QStackedWidget):
        if place.isHidden():
            return False
        place = place.parentWidget()
    return place is not None


def _seen_in(scene: QGraphicsScene) -> Hashable:
    """What is seen in a plot or on a strip, from front to back, and at which scale."""
    views = [item for item in scene.items() if isinstance(item, TimeView)]
    ranges = repr([(view.viewRange(), view._is_held) for view in views])
    return ranges, tuple(type(item).__name__ for item in scene.items() if item.isVisible())


def _anywhere(text: str) -> str:
    """A text without the folders in it: each test has one of its own."""
    return re.sub(r"\S*/", "", text)


def _content(widget: QWidget) -> Hashable:
    match widget:
        case QAbstractButton():
            return widget.text(), widget.isChecked()
        case QLabel() | QLineEdit():
            return widget.text()
        case QAbstractSlider():
            return widget.value(), widget.minimum(), widget.maximum(), widget.isSliderDown()
        case QDoubleSpinBox():
            return widget.value(), widget.minimum(), widget.maximum(), widget.text()
        case QComboBox():
            return widget.currentIndex(), widget.count()
        case QTabBar():
            return widget.currentIndex()
        case QStatusBar():
            return widget.currentMessage()
    return None


def _add_held(facts: Facts, name: str, thing: object, depth: int = 0) -> None:
    """Add what the attributes of an object hold, and those of ours that are in them."""
    for attribute, value in getattr(thing, "__dict__", {}).items():
        if attribute in _PASSING or isinstance(value, SignalInstance):
            continue
        facts[f"{name}.{attribute}"] = _plain(value)
        if depth < _DEEPEST and _is_ours(value):
            _add_held(facts, f"{name}.{attribute}", value, depth + 1)


def _is_ours(value: object) -> bool:
    """Whether it is a part of the window that is not among its children."""
    return type(value).__module__.startswith(_OURS) and not isinstance(value, QObject | Enum)


def _plain(value: Any, depth: int = 0) -> Hashable:
    """What can be compared of a value: itself, its parts, or else its type."""
    kind = type(value)
    if kind in _OPAQUE:
        return kind.__qualname__
    if kind in _PLAIN_TYPES or isinstance(value, _PLAIN):
        return cast(Hashable, value)
    if isinstance(value, Path):
        return value.name  # each test has a folder of its own
    if isinstance(value, _BOXES):
        return repr(value)
    if isinstance(value, np.ndarray):
        return value.shape, hash(value.tobytes())
    if depth < _DEEPEST:
        if isinstance(value, tuple | list):
            return tuple(_plain(part, depth + 1) for part in value)
        if isinstance(value, set | frozenset):
            return frozenset(_plain(part, depth + 1) for part in value)
        if isinstance(value, dict):
            pairs = [
                (_plain(key, depth + 1), _plain(part, depth + 1)) for key, part in value.items()
            ]
            return tuple(pairs)
        _OPAQUE.add(kind)
    return kind.__qualname__


def differences(one: Facts, other: Facts) -> list[str]:
    """What tells two windows apart, a line each."""
    return [
        f"{name}: {one.get(name, 'absent')} / {other.get(name, 'absent')}"
        for name in sorted({*one, *other})
        if one.get(name, "absent") != other.get(name, "absent")
    ]


def files_of(take: Path) -> Files:
    """The files from which a take is opened: itself, and sound and film beside it."""
    return tuple((p.name, p.read_bytes()) for p in sorted(take.parent.glob(f"{take.stem}.*")))
