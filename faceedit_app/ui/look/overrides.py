"""Keep the process alive if a method that Qt calls fails, on Python 3.11.

Up to Python 3.11, an error that C code raises (`[][0]`, `1 / 0`, `int("x")`) has a text in place of
an exception until some `try` looks at it. PySide, at least 6.8 to 6.11, adds to the exception of a
failed override which one it was, without looking first: the process ends with a segmentation fault.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Iterator
from inspect import CO_VARARGS
from types import FunctionType
from typing import Any

from PySide6.QtCore import QObject

_ROOT: Any = QObject.__mro__[-2]  # of all classes of Qt's, also of those that are no objects


def make_errors_whole() -> None:
    """See that errors are whole when they leave an override, in all classes made from now on."""
    if sys.version_info < (3, 12):
        _ROOT.__init_subclass__ = classmethod(_wrap_overrides)


def _wrap_overrides(cls: type, /, **keywords: Any) -> None:
    super(_ROOT, cls).__init_subclass__(**keywords)
    for name, function in list(_own(cls)):
        if any(_is_qts(base, name) for base in cls.__mro__):
            setattr(cls, name, _whole(function))


def _own(cls: type) -> Iterator[tuple[str, FunctionType]]:
    """The methods of a class and of its mixins that no other class of Qt's comes before."""
    seen: set[str] = set()
    for base in cls.__mro__:
        is_new = base is cls or not issubclass(base, _ROOT)
        for name, value in vars(base).items():
            if is_new and name not in seen and isinstance(value, FunctionType):
                yield name, value
        seen.update(vars(base))


def _is_qts(base: type, name: str) -> bool:
    """Whether a class of Qt's has a method of that name, which is not Python's."""
    if name.startswith("__") or not issubclass(base, _ROOT):
        return False
    return name in vars(base) and not isinstance(vars(base)[name], FunctionType)


def _whole(function: FunctionType) -> Callable[..., Any]:
    # A signal passes a function as many arguments as it takes, but one that takes any number, all.
    takes_all = function.__code__.co_flags & CO_VARARGS
    most = None if takes_all else function.__code__.co_argcount

    @functools.wraps(function)
    def called(*arguments: Any, **keywords: Any) -> Any:
        try:
            return function(*arguments[:most], **keywords)
        except BaseException:  # that looks at it
            raise

    return called
