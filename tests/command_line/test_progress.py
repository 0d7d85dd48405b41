"""What long commands say while they work."""

from __future__ import annotations

import pytest

from faceedit_app.command_line.progress import bar_or_lines


def test_a_long_command_without_a_terminal_says_now_and_then_where_it_is(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for every in (0.0, 3600.0):
        with bar_or_lines("Killing", 1000, "windows", every) as advance:
            advance(12)
    assert capsys.readouterr().err == "Killing: 12 of 1,000 windows\n"
