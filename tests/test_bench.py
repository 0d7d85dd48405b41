"""`faceedit bench` in its quick mode: all is measured that should be; nothing is judged."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faceedit_app.bench import references
from faceedit_app.bench.clocks import Stages, Times, repeat
from faceedit_app.bench.desk import long_take
from faceedit_app.bench.report import machine, text
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resources import shipped
from faceedit_app.networks.engine import Engine


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    """One quick run of the command, as a user starts it."""
    run = subprocess.run(
        [sys.executable, "-m", "faceedit_app", "bench", "--json", "--quick"],
        capture_output=True,
        encoding="utf-8",
        env=os.environ | {"QT_QPA_PLATFORM": "offscreen"},
        timeout=110,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    result: dict[str, Any] = json.loads(run.stdout)
    return result


def numbers(tree: Any) -> Iterator[float]:
    if isinstance(tree, dict):
        for value in tree.values():
            yield from numbers(value)
    elif isinstance(tree, float):
        yield tree


@pytest.mark.timeout(120)
def test_the_report_has_all_that_was_asked_for(found: dict[str, Any]) -> None:
    assert {"median", "p95"} <= set(found["drag"])
    assert "median" in found["networks_202"]
    assert {"controls", "networks", "curves", "plots", "deform", "draw"} <= set(found["stages"])
    assert set(found["start_s"]) == {"window", "face", "edit"}
    assert set(found["ratio"]) == {"naive", "holden", "gl_limit", "cpu_limit", "blender"}
    assert "640" in found["playback_fps"]
    assert "202" in found["peak_mb"]
    assert found["local_edit_ratio_200k"] > 0
    assert {"processor", "cores", "python", "packages"} <= set(found["machine"])


@pytest.mark.timeout(120)
def test_its_numbers_make_sense(found: dict[str, Any]) -> None:
    assert all(np.isfinite(number) and number >= 0 for number in numbers(found))
    drag = found["drag"]
    assert 0 < drag["best"] <= drag["median"] <= drag["p95"]
    assert all(found["stages"][stage] > 0 for stage in ("controls", "networks", "curves", "plots"))
    start = found["start_s"]
    assert 0 < start["window"] < start["face"] <= start["edit"]
    assert found["peak_mb"]["202"] > 50
    for row in found["lengths"].values():
        assert row["whole"]["complete"] >= row["whole"]["visible"] > 0


@pytest.mark.timeout(120)
def test_people_can_read_it(found: dict[str, Any]) -> None:
    words = text(found)
    for part in ("drag, 202 frames", "networks", "playback", "start", "peak memory", "blender"):
        assert part in words


def test_stages_count_what_they_call_in_others_there_alone() -> None:
    class Part:
        def inner(self) -> None:
            sum(range(20_000))

        def outer(self) -> None:
            self.inner()

    stages = Stages()
    with stages.watching(("a", Part, "outer"), ("b", Part, "inner")):
        repeat(Part().outer, 20, 0)
    assert set(stages.seconds) == {"a", "b"}
    assert stages.seconds["b"] > stages.seconds["a"]
    assert "measured" not in Part.outer.__qualname__


def test_times_are_summed_up() -> None:
    times = Times([1.0, 2.0, 3.0, 4.0, 100.0])
    assert (times.median, times.best) == (3.0, 1.0)
    assert 4.0 < times.p95 <= 100.0


def test_long_takes_repeat_the_demo() -> None:
    clip = long_take(1500).clip
    assert len(clip) == 1500
    assert (np.diff(clip.times) > 0).all()
    np.testing.assert_array_equal(clip.weights[0], clip.weights[600])


def test_references_that_are_absent_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(references.importlib.util, "find_spec", lambda _name: None)
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    assert references.holden(1) is None
    assert references.blender(1) is None


def test_a_blender_that_cannot_draw_is_none(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    broken = tmp_path / "blender"
    broken.write_text("#!/bin/sh\nexit 3\n", encoding="utf-8")
    broken.chmod(0o755)
    monkeypatch.setattr(shutil, "which", lambda _name: str(broken))
    assert references.blender(1) is None


def test_the_limit_of_the_processor_is_counted_from_the_networks() -> None:
    engine = Engine.load(shipped("models"))
    products = sum(engine.models[region.id].products for region in REGIONS)
    assert 100_000 < products < 10_000_000
    assert references.cpu_limit(engine, 2).best > 0


def test_the_machine_is_named() -> None:
    assert {"numpy", "PySide6_Essentials"} <= set(machine()["packages"])
