"""An error in a method that Qt calls is an error like any other, and does not end the process."""

from __future__ import annotations

import importlib
import pkgutil
import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from PySide6.QtCore import QEvent, QSize
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QDialog, QPushButton, QWidget
from support.windows import Bench

import faceedit_app.ui


def _takes_none() -> None:
    pass


# What C code raises: up to Python 3.11 without an exception, until somebody looks.
ERRORS: dict[type[Exception], Callable[[], Any]] = {
    ZeroDivisionError: lambda: 1 // 0,
    IndexError: lambda: [][0],
    ValueError: lambda: int("x"),
    TypeError: lambda: _takes_none(*[1]),
}


class Sized:
    """A mixin that knows nothing of Qt."""

    def sizeHint(self) -> QSize:
        """Fail."""
        return QSize([][0], 1)


class Failing(Sized, QWidget):
    """Fails in events, when it is asked for its size, and in what another override calls."""

    error: type[Exception] = ValueError

    def event(self, event: QEvent) -> bool:
        """Pass on all events."""
        return super().event(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Fail."""
        ERRORS[self.error]()


class Stubborn(QDialog):
    """Counts how often it was rejected."""

    rejected_times = 0

    def reject(self) -> None:
        """Stay."""
        self.rejected_times += 1


@pytest.mark.parametrize("error", ERRORS)
def test_an_error_in_an_event_reaches_who_caused_it(bench: Bench, error: type[Exception]) -> None:
    widget = Failing()
    bench.qtbot.addWidget(widget)
    widget.error = error
    with pytest.raises(error):
        widget.close()


def test_an_error_in_a_mixin_does_too(bench: Bench) -> None:
    widget = Failing()
    bench.qtbot.addWidget(widget)
    with pytest.raises(IndexError):
        widget.adjustSize()


def test_a_signal_passes_no_more_arguments_than_an_override_takes(bench: Bench) -> None:
    dialog, button = Stubborn(), QPushButton()
    bench.qtbot.addWidget(dialog)
    bench.qtbot.addWidget(button)
    button.clicked.connect(dialog.reject)  # it says whether the button is checked
    button.click()
    assert dialog.rejected_times == 1


def test_a_class_that_overrides_nothing_is_left_alone(bench: Bench) -> None:
    class Later(Failing):
        """Adds nothing."""

    assert vars(Later).keys().isdisjoint({"closeEvent", "event", "sizeHint"})


@pytest.mark.skipif(sys.version_info >= (3, 12), reason="errors are whole without help")
def test_no_class_of_the_window_was_made_too_early() -> None:
    for module in pkgutil.walk_packages(faceedit_app.ui.__path__, "faceedit_app.ui."):
        importlib.import_module(module.name)
    found = [
        (cls, name, value)
        for cls in _subclasses(QWidget)
        if cls.__module__.startswith("faceedit_app.")
        for name, value in vars(cls).items()
        if name.endswith("Event")
    ]
    assert len(found) > 50
    assert [entry for entry in found if not hasattr(entry[2], "__wrapped__")] == []


def _subclasses(base: type[QWidget]) -> Iterator[type[QWidget]]:
    for cls in base.__subclasses__():
        yield cls
        yield from _subclasses(cls)
