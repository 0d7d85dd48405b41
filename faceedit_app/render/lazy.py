"""Import parts of packages without running the rest of them until something uses it."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec, module_from_spec
from types import ModuleType
from typing import Any

_running = threading.RLock()
_PATIENCE = 10.0  # seconds; importing the largest package takes one


class LazyPackage(ModuleType):
    """A package whose own code runs when something asks it for what it does not have yet.

    `importlib.util.LazyLoader` does the same, but runs a package whenever one of its modules is
    imported.
    """

    _runs: bool  # while its code runs

    def __getattr__(self, name: str) -> Any:
        if _is_use(name):
            _run(self)
        if name in self.__dict__:
            return self.__dict__[name]
        raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")


def _is_use(name: str) -> bool:
    """Whether asking for an attribute uses a package; `inspect` asks all modules for some."""
    return not name.startswith("__") or name in ("__all__", "__path__", "__version__")


def _run(package: ModuleType) -> None:
    """Run a package unless it has run, or is running in this thread."""
    # The thread that runs it may wait for a module that this thread is importing.
    if not _running.acquire(timeout=_PATIENCE):
        return
    try:
        if isinstance(package, LazyPackage) and "_runs" not in package.__dict__:
            package._runs = True
            try:
                _open(package)
                package.__spec__.loader.exec_module(package)  # type: ignore[union-attr]
                package.__class__ = ModuleType  # type: ignore[assignment]  # no longer lazy
            finally:
                del package._runs
    finally:
        _running.release()


@contextmanager
def lazily(*packages: str) -> Iterator[None]:
    """Within this context, modules of these packages are imported without the packages' own code.

    Afterwards a package runs as soon as one of its attributes is used or another of its modules
    is imported. Packages that run already are left alone, and one that is not installed is
    reported as usual.

    Args:
        packages: their names.
    """
    with _running:
        waiting = [package for name in packages if (package := _lazy(name)) is not None]
        for package in waiting:
            _open(package)
        try:
            yield
        finally:
            for package in waiting:
                if isinstance(package, LazyPackage):  # it has not run meanwhile
                    del package.__path__  # so that the import of a module runs the package first


def _lazy(name: str) -> ModuleType | None:
    """A package that has not run; None if it has, or is not installed."""
    if name not in sys.modules and (spec := find_spec(name)) is not None:
        package = module_from_spec(spec)
        package.__class__ = LazyPackage
        sys.modules[name] = package
        parent, _, child = name.rpartition(".")
        if parent:
            setattr(sys.modules[parent], child, package)
    found = sys.modules.get(name)
    return found if isinstance(found, LazyPackage) else None


def _open(package: ModuleType) -> None:
    """Let modules of the package be found."""
    assert package.__spec__ is not None
    package.__path__ = package.__spec__.submodule_search_locations or []
