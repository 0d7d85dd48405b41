"""Ctrl+C ends a command, whatever it is doing."""

from __future__ import annotations

import importlib
import signal
import threading
from pathlib import Path

import pytest

from faceedit_app.command_line import ctrl_c

# As trimesh imports what it can do without.
_SWALLOWS = """
import signal
try:
    signal.raise_signal(signal.SIGINT)
except BaseException:
    missing = True
"""


def test_a_library_that_swallows_ctrl_c_in_its_import_does_not_keep_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "swallows_ctrl_c.py").write_text(_SWALLOWS)
    monkeypatch.syspath_prepend(tmp_path)
    before = signal.getsignal(signal.SIGINT)

    def work() -> None:
        with ctrl_c.heard():
            assert importlib.import_module("swallows_ctrl_c").missing
            threading.Event().wait()  # would never end

    with pytest.raises(KeyboardInterrupt):
        work()
    assert signal.getsignal(signal.SIGINT) is before


def test_a_command_may_go_on_after_ctrl_c() -> None:
    """As training, which writes the best so far, and recording do."""
    began: list[object] = []
    with ctrl_c.heard(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(threading.Timer, "start", began.append)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert not began
