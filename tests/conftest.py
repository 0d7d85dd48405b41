"""What all tests share."""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Torch's builds for graphics cards bring triton, which has an LLVM of its own and crashes if it is
# loaded after the one that software OpenGL brings. Nothing but a test run has both in a process.
with contextlib.suppress(ImportError):
    import triton  # noqa: F401

# Before Qt is imported by anything: tests need no display, and disturb none.
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from support.chance import TIMES
from support.media import devices
from support.panels import panel, panels
from support.windows import bench, shelf

from faceedit_app.ui.start.application import Garbage

__all__ = ["bench", "devices", "panel", "panels", "shelf"]

# Garbage is collected between tests, in the main thread, as the application's `Collector` does: a
# thread of a window's that happens to collect would delete the plots of earlier windows, and crash.
_garbage = Garbage()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """One more than there are processors: a fifth of the time, tests wait for the window."""
    return (os.cpu_count() or 1) + 1


def pytest_configure() -> None:
    gc.disable()
    # The same examples each time, and no failure because a computer is busy.
    settings.register_profile(
        "tests",
        deadline=None,
        derandomize=True,
        max_examples=50 * TIMES,
        suppress_health_check=[HealthCheck.too_slow],
    )
    settings.load_profile("tests")


@pytest.hookimpl(tryfirst=True)
def pytest_collection(session: pytest.Session) -> None:
    """Each process begins with modules of its own: what one has rewritten, the others only read.

    In a fresh clone, pytest rewrites the asserts of all modules, which takes five seconds.
    """
    config = session.config
    if config.args_source is pytest.Config.ArgsSource.TESTPATHS and hasattr(config, "workerinput"):
        number = int(config.workerinput["workerid"].removeprefix("gw"))
        modules = sorted(Path(__file__).parent.rglob("test_*.py"))
        for module in modules[number :: config.workerinput["workercount"]]:
            if str(module.parent) not in sys.path:
                sys.path.insert(0, str(module.parent))  # as pytest does
            with contextlib.suppress(Exception, pytest.skip.Exception):  # collection will say it
                importlib.import_module(module.stem)


def pytest_collection_finish() -> None:
    # Modules stay until the end: later collections need not look through them again.
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown() -> Iterator[None]:
    yield
    full = gc.get_stats()[2]["collections"]
    _garbage.collect()
    if gc.get_stats()[2]["collections"] > full:
        gc.freeze()  # what has outlived its test is kept by a module, and need not be seen again
