"""`faceedit bench` in its quick mode: all is measured that should be; nothing is judged."""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from support.faces import shipped_rig

from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.lab.bench import kernels, references
from faceedit_app.lab.bench.clocks import Stages, Timings, repeat
from faceedit_app.lab.bench.desk import long_take
from faceedit_app.lab.bench.report import in_limit, machine, text
from faceedit_app.lab.bench.table import table
from faceedit_app.lab.bench.window import denser

Install = Callable[[str, str], None]


@pytest.fixture(scope="module")
def rig() -> Rig:
    return shipped_rig()


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
    assert set(found["ratio"]) == {
        "naive",
        "torch",
        "holden",
        "gl_limit",
        "cpu_limit",
        "blender",
    }
    assert "640" in found["playback_fps"]
    assert (found["busy"]["frames"], found["busy"]["edits"]) == (400, 10)
    assert {"toggle", "delete", "undo", "strength", "smile"} <= set(found["busy"]["answers"])
    assert "202" in found["peak_mb"]
    assert found["local_edit_ratio_200k"] > 0
    assert {"processor", "instructions", "cores", "python", "packages"} <= set(found["machine"])
    assert found["machine"]["drawn_by"]
    assert found["drag_dense"]["vertices"] >= 15_000
    assert found["dense_ratio"] > 0
    assert set(found["in_limits"]) == {"cpu_limit", "gl_limit"}
    assert found["avx2"] is None  # a trial run does not repeat itself


@pytest.mark.timeout(120)
def test_its_numbers_make_sense(found: dict[str, Any]) -> None:
    assert all(np.isfinite(number) and number >= 0 for number in numbers(found))
    drag = found["drag"]
    assert 0 < drag["best"] <= drag["median"] <= drag["p95"]
    assert all(found["stages"][stage] > 0 for stage in ("controls", "networks", "curves", "plots"))
    start = found["start_s"]
    assert 0 < start["window"] < start["face"] <= start["edit"]
    assert found["peak_mb"]["202"] > 50
    for row in found["busy"]["answers"].values():
        assert 0 < row["answer"] <= row["longest_answer"]
        assert row["complete"] > 0
    for row in found["lengths"].values():
        assert row["whole"]["complete"] >= row["whole"]["visible"] > 0


@pytest.mark.timeout(120)
def test_people_can_read_it(found: dict[str, Any]) -> None:
    words = text(found)
    for part in (
        found["machine"]["instructions"],
        "vertices",
        "drag, 202 frames",
        "networks",
        "playback",
        "start",
        "peak memory",
        "blender",
        "10 edits",
    ):
        assert part in words


@pytest.mark.timeout(120)
def test_the_table_has_a_column_for_each_instruction_set(found: dict[str, Any]) -> None:
    limits = {"references": {"cpu_limit": {"median": 2.0}}}
    machine = found["machine"] | {"instructions": "AVX2"}
    narrower = found | limits | {"machine": machine, "drag": found["drag"] | {"median": 15.0}}
    head, _, first, *rows = table(found | {"avx2": narrower}).splitlines()
    assert head.count("|") == 7
    assert "AVX2" in head
    assert first.endswith("| 15.0 ms | 7.5 | at most 14 ms: no |")
    assert all(row.count("|") == 7 for row in rows)
    assert table(found).splitlines()[0].count("|") == 5


def test_times_are_given_as_multiples_of_a_limit_of_the_same_run() -> None:
    found = {
        "drag": {"median": 12.0, "repetitions": 200},
        "lengths": {"202": {"whole": {"cancel": 4.0}}},
        "start_s": {"face": 1.5},
        "references": {"cpu_limit": {"median": 2.0}, "gl_limit": None},
    }
    assert in_limit(found, "cpu_limit") == {
        "drag": {"median": 6.0},
        "lengths": {"202": {"whole": {"cancel": 2.0}}},
        "start": {"face": 750.0},
    }
    assert in_limit(found, "gl_limit") is None


def test_a_process_can_be_made_to_use_avx2() -> None:
    variables = kernels.narrower()
    if variables is None:
        pytest.skip("the processor has no wider instructions")
    command = (
        "from faceedit_app.lab.bench import kernels as k; print(k.instructions(), k.narrower())"
    )
    run = subprocess.run(
        [sys.executable, "-c", command],
        capture_output=True,
        encoding="utf-8",
        env=os.environ | variables,
        check=True,
    )
    assert run.stdout.split() == ["AVX2", "None"]


def test_a_denser_character_has_the_same_shape_and_curves(rig: Rig) -> None:
    dense = denser(rig, 15_000)
    assert len(dense.neutral) >= 15_000
    assert dense.deltas.shape == (len(rig.channels), len(dense.neutral), 3)
    np.testing.assert_array_equal(dense.neutral[: len(rig.neutral)], rig.neutral)
    np.testing.assert_array_equal(dense.deltas[:, : len(rig.neutral)], rig.deltas)
    assert dense.materials[-1].stop == len(dense.faces)
    before, after = (trimesh.Trimesh(r.neutral, r.faces, process=False).area for r in (rig, dense))
    assert after == pytest.approx(before, rel=1e-4)


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
    times = Timings([1.0, 2.0, 3.0, 4.0, 100.0])
    assert (times.median, times.best) == (3.0, 1.0)
    assert 4.0 < times.p95 <= 100.0


def test_long_takes_repeat_the_demo() -> None:
    clip = long_take(1500).clip
    assert len(clip) == 1500
    assert (np.diff(clip.times) > 0).all()
    np.testing.assert_array_equal(clip.weights[0], clip.weights[600])


def test_references_that_are_absent_are_none(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _name: None)
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    assert references.in_torch("unet", 1) is None
    assert references.cpu_limit(shipped("models"), 1) is None
    assert references.gl_limit(rig, 1) is None
    assert references.blender(rig, 1) is None


@pytest.fixture
def programs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Install:
    """Puts programs, as shell scripts, in the place of all that are installed."""
    if os.name != "posix":
        pytest.skip("the stand-ins for Blender are shell scripts")
    installed: dict[str, str] = {}
    monkeypatch.setattr(shutil, "which", installed.get)
    monkeypatch.setenv("DISPLAY", ":0")

    def install(name: str, script: str) -> None:
        path = tmp_path / name
        path.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
        path.chmod(0o755)
        installed[name] = str(path)

    return install


def test_blender_gets_our_take_and_its_last_answer_counts(
    programs: Install, rig: Rig, tmp_path: Path
) -> None:
    programs(
        "blender",
        f"""for job; do :; done  # the last argument
cp "$job" '{tmp_path}/job.json'
echo 'FACEEDIT {{"median": 80.0, "eevee": null}}'
echo 'glTF import finished'
echo 'FACEEDIT {{"median": 80.0, "eevee": {{"median": 250.0}}}}'""",
    )
    assert references.blender(rig, 7) == {"median": 80.0, "eevee": {"median": 250.0}}
    job = json.loads((tmp_path / "job.json").read_text(encoding="utf-8"))
    assert (job["size"], job["times"]) == (references.SIZE, 7)
    assert set(job["weights"]) == set(rig.channels)
    assert job["changed"] in job["weights"]
    assert {len(weights) for weights in job["weights"].values()} == {references.FRAMES}
    assert any(weights[job["frame"]] for weights in job["weights"].values())


def test_an_eevee_that_dies_leaves_workbench_its_answer(programs: Install, rig: Rig) -> None:
    programs("blender", """echo 'FACEEDIT {"median": 80.0, "eevee": null}'; kill -SEGV $$""")
    assert references.blender(rig, 1) == {"median": 80.0, "eevee": None}


def test_a_blender_that_cannot_draw_is_none_and_says_why(programs: Install, rig: Rig) -> None:
    programs("blender", "echo 'no OpenGL' >&2; exit 3")
    told: list[str] = []
    assert references.blender(rig, 1, told.append) is None
    assert told == ["blender: no OpenGL"]


def test_a_blender_that_hangs_is_stopped_with_its_display(
    programs: Install, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(references, "_BLENDER_SECONDS", 0.5)
    programs("blender", "sleep 600")  # longer than a test may take
    programs("xvfb-run", 'shift 3; "$@"; true')  # waits for Blender, as the real one does
    told: list[str] = []
    assert references.blender(rig, 1, told.append) is None
    assert told == ["blender: not done after 0.5 seconds"]


@pytest.mark.skipif(sys.platform != "linux", reason="others always have a display")
def test_blender_needs_a_display(
    programs: Install, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    programs("blender", "echo 'FACEEDIT {}'")
    told: list[str] = []
    assert references.blender(rig, 1, told.append) is None
    assert told == ["blender: needs a display, or xvfb-run"]


def test_the_limit_of_the_processor_is_counted_from_the_networks() -> None:
    path = shipped("models") / "lower.onnx"
    needed = references.multiplications(path, 208)
    assert needed == 2 * references.multiplications(path, 104)
    assert 100_000 < needed / 208 < 10_000_000
    limit = references.cpu_limit(shipped("models"), 2)
    assert limit is not None
    assert limit.best > 0


@pytest.mark.parametrize("architecture", ["unet", "holden"])
def test_torch_is_measured_on_networks_of_a_kind(architecture: str) -> None:
    found = references.in_torch(architecture, 2)
    assert found is not None
    assert found.best > 0


def test_the_machine_is_named() -> None:
    assert {"numpy", "PySide6_Essentials"} <= set(machine()["packages"])
