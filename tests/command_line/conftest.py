"""What the tests of the commands share."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.faces import models
from support.takes import make_livelink_csv

from faceedit_app.cli import main

__all__ = ["models"]


@pytest.fixture
def take(tmp_path: Path) -> Path:
    """Two seconds, in which the face is lost in two frames."""
    return make_livelink_csv(tmp_path / "take.csv", dropped=[30, 31])


@pytest.fixture
def complaint(capfd: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs a command that must fail, and gives its one line."""

    def run(*arguments: object) -> str:
        capfd.readouterr()
        assert main([*map(str, arguments)]) == 2
        out, err = capfd.readouterr()
        assert out == ""
        assert err.endswith("\n")
        assert len(err.splitlines()) == 1, err
        assert err.startswith("faceedit: ")
        return err

    return run


@pytest.fixture
def printed(capfd: pytest.CaptureFixture[str]) -> Callable[..., dict[str, Any]]:
    """Runs a command with `--json`, and gives what it prints."""

    def run(*arguments: object, code: int = 0) -> dict[str, Any]:
        capfd.readouterr()
        assert main([*map(str, arguments), "--json"]) == code
        facts = json.loads(capfd.readouterr().out)
        assert isinstance(facts, dict)
        return facts

    return run
