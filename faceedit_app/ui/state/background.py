"""What takes long, away from the window: reading takes, the character, the networks.

The imports stand inside the functions because they are what takes long: the solver, the networks
and pyrender are first imported here, in a thread, while the window is already up.
"""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from PySide6.QtCore import QObject, Qt, Signal

if TYPE_CHECKING:
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.session import EditSession
    from faceedit_app.networks.engine import Engine

Result = TypeVar("Result")


def load_character() -> Rig:
    """The shipped character.

    Raises:
        FileError: it is missing or damaged.
    """
    from faceedit_app.editing.opening import shipped_rig

    return shipped_rig()


def open_session(path: Path, rig: Rig) -> EditSession:
    """Read a take, to be edited without networks until they are loaded.

    Raises:
        FileError: it is no take, or a damaged one.
    """
    from faceedit_app.editing import opening

    return opening.open_session(path, rig)


def prepare_renderer() -> None:
    """Import what drawing needs, so that the first picture does not stop the window for long."""
    from faceedit_app.render import contexts

    try:
        backend = contexts.choose_backend()  # before OpenGL is imported
        importlib.import_module("faceedit_app.render.studio")
        contexts.platform_class(backend)
    except Exception:  # drivers and PyOpenGL raise all kinds
        return  # opening the renderer meets it again, and says so where it can be shown


def load_engine(rig: Rig) -> Engine:
    """The shipped networks.

    Raises:
        FileError: they are missing or damaged, or for another character.
    """
    from faceedit_app.editing.opening import load_engine

    return load_engine(rig)


class Background(QObject):
    """Runs functions in threads and hands their results to the GUI thread."""

    _finished = Signal(object, object, object)  # done, failed, future

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._pool = ThreadPoolExecutor(max_workers=2, thread_name_prefix="faceedit")
        self._closed = False
        self._finished.connect(self._deliver, Qt.ConnectionType.QueuedConnection)

    def run(
        self,
        work: Callable[[], Result],
        done: Callable[[Result], None],
        failed: Callable[[Exception], None],
    ) -> None:
        """Call `work` in a thread, then `done` or `failed` in the GUI thread."""

        def report(future: Future[Result]) -> None:
            with contextlib.suppress(RuntimeError):  # the window went away this very moment
                if not self._closed:
                    self._finished.emit(done, failed, future)

        self._pool.submit(work).add_done_callback(report)

    def _deliver(self, done: Any, failed: Any, future: Future[Any]) -> None:
        if self._closed:
            return
        error = future.exception()
        if error is None:
            done(future.result())
        elif isinstance(error, Exception):
            failed(error)

    def close(self) -> None:
        """Forget what is still running; nothing is delivered any more."""
        self._closed = True
        self._pool.shutdown(wait=False, cancel_futures=True)
