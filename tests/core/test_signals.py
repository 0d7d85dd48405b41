"""Signals that must not reach the processes that a command starts."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from faceedit_app.core.signals import signals_wait

_MASK = "import signal; print(signal.SIGTERM in signal.pthread_sigmask(signal.SIG_BLOCK, []))"


@pytest.mark.skipif(sys.platform == "win32", reason="no masks of signals")
def test_ctrl_c_waits_and_does_not_reach_processes_that_begin_meanwhile() -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda which, _frame: heard.append(which))
    try:
        with signals_wait(signal.SIGTERM):
            signal.raise_signal(signal.SIGTERM)
            assert not heard
            child = subprocess.run([sys.executable, "-S", "-c", _MASK], capture_output=True)
        assert heard == [signal.SIGTERM]
    finally:
        signal.signal(signal.SIGTERM, before)
    assert child.stdout.strip() == b"True"
