"""Starts FaceEdit in its own process, and measures times and memory.

`python -m faceedit_app.lab.bench.starting SECONDS_SINCE_1970 FRAMES` prints one line of JSON.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # nothing of FaceEdit is imported before the start that is measured
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.session import EditSession

_LONGEST = 240  # seconds


def start(frames: int = 0) -> dict[str, float]:
    """Start the window in another process, on the demo take or one with a number of frames.

    Returns:
        Seconds from the start of the process to the `window`, the `face` and the first `edit`;
        `peak_mb` of memory, with an edit of the whole take made.
    """
    with tempfile.TemporaryDirectory() as home:
        env = {"QT_QPA_PLATFORM": "offscreen", "HOME": home}
        env |= {f"XDG_{name}_HOME": home for name in ("CONFIG", "STATE", "DATA", "CACHE")}
        env["PYTHONDONTWRITEBYTECODE"] = ""  # an installed program's modules are compiled
        command = [sys.executable, "-m", "faceedit_app.lab.bench.starting", str(time.time())]
        run = subprocess.run(
            [*command, str(frames)],
            capture_output=True,
            encoding="utf-8",
            env=os.environ | env,
            timeout=_LONGEST,
            check=True,
        )
    found: dict[str, float] = json.loads(run.stdout.splitlines()[-1])
    return found


def _child(began: float, frames: int) -> None:
    """Do what `faceedit --demo` does, and record times."""
    from PySide6.QtCore import QTimer

    from faceedit_app.ui.start import app
    from faceedit_app.ui.start.window import MainWindow
    from faceedit_app.ui.state import loading

    seen: dict[str, float] = {}
    if frames:
        _instead_of_the_demo(loading, frames)

    def begin(window: MainWindow, *how: Any) -> None:
        seen["window"] = time.time() - began
        really_start(window, *how)
        watch = QTimer(window, interval=2)
        watch.timeout.connect(lambda: look(window))
        watch.start()

    def look(window: MainWindow) -> None:
        session = window.document.session
        if session is None or window.editor is None:
            return
        if "face" not in seen and window.editor.face.viewport.draws:
            seen["face"] = time.time() - began
        if "edit" not in seen and session.has_engine and "face" in seen:
            seen["edit"] = time.time() - began
            _edit(window)
        elif "edit" in seen and not window.editor.solving.is_busy:
            window.document.session = None  # so that closing asks no question
            window.close()

    really_start = MainWindow.start
    MainWindow.start = begin  # type: ignore[method-assign, assignment]
    app.run(None, demo=True)
    print(json.dumps(seen | {"peak_mb": peak_megabytes()}))


def _instead_of_the_demo(loading: Any, frames: int) -> None:
    from faceedit_app.editing import opening
    from faceedit_app.lab.bench.desk import long_take

    def open_session(_path: Path, rig: Rig, _fps: float | None = None) -> EditSession:
        return opening.open_session(long_take(frames), rig)

    loading.open_session = open_session


def _edit(window: Any) -> None:
    from faceedit_app.core.controls import LIP_OPENING
    from faceedit_app.editing.edits.edit import Edit, Op

    window.document.act(
        lambda session: session.add(Edit((LIP_OPENING,), Op.OFFSET, 0.0, 1e6, 0.0, 2.0))
    )


def peak_megabytes() -> float:
    """This process's peak memory; 0 if the system does not report it."""
    try:
        import resource
    except ImportError:  # Windows
        return 0.0
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


if __name__ == "__main__":
    _child(float(sys.argv[1]), int(sys.argv[2]))
