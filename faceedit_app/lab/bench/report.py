"""Runs all measurements and reports them."""

from __future__ import annotations

import importlib.metadata
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_info

from faceedit_app import __version__
from faceedit_app.core.rig import Rig
from faceedit_app.editing.opening import load_engine, shipped_rig
from faceedit_app.lab.bench import busy, kernels, references, starting, window
from faceedit_app.lab.bench.clocks import Timings
from faceedit_app.lab.bench.desk import Desk
from faceedit_app.networks.engine import Engine
from faceedit_app.render import contexts
from faceedit_app.ui.start.application import application, collecting

PACKAGES = (
    "numpy",
    "onnxruntime",
    "scipy",
    "PySide6_Essentials",
    "pyqtgraph",
    "pyrender2",
    "PyOpenGL",
    "torch",
)

# References that do the same work as well as this machine can.
LIMITS = ("cpu_limit", "gl_limit")
# The parts of the report that are milliseconds.
TIMES = ("drag", "stages", "drag_one", "drag_dense", "networks_202", "lengths", "busy")


@dataclass(frozen=True)
class BenchPlan:
    """How much is measured."""

    repetitions: int = 200
    lengths: tuple[int, ...] = (202, 2_000, 20_000, 200_000)
    peaks: tuple[int, ...] = lengths  # takes on which the window is started for its memory
    sizes: tuple[int, ...] = (640, 1024)
    listed: tuple[int, int] = (busy.FRAMES, busy.EDITS)  # frames, edits
    seconds: float = 5.0  # of playback
    starts: int = 5
    compared: bool = True
    rest: float = 1.0  # see `Desk`


QUICK = BenchPlan(3, (202, 400), (202,), (640,), (400, 10), 0.2, 1, False, 0.02)


def run(plan: BenchPlan, say: Callable[[str], None] = lambda _: None) -> dict[str, Any]:
    """Measure everything; about two minutes on two cores.

    Args:
        plan: how much.
        say: called with what is being measured.
    """
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    rig = shipped_rig()
    engine = load_engine(rig)
    found: dict[str, Any] = {"machine": machine()}
    say("starting")
    found["start_s"], found["peak_mb"] = _starts(plan)
    app = application()
    with tempfile.TemporaryDirectory() as folder, collecting(app):
        desk = Desk(app, Path(folder), rig, engine, plan.rest)
        say("dragging")
        found |= window.drag(desk, plan.repetitions)
        dense = window.drag_dense(desk, max(plan.repetitions // 2, 2))
        found["drag_dense"] = dense
        found["dense_ratio"] = dense["median"] / found["drag"]["median"]
        answered = window.networks(engine, plan.repetitions)
        found["networks_202"] = answered.summary()
        say("editing takes of any length")
        times = max(plan.repetitions // 4, 2)
        found["lengths"] = window.lengths(desk, plan.lengths, times)
        say("a take with many edits")
        found["busy"] = busy.busy(desk, max(plan.repetitions // 25, 2), *plan.listed)
        say("playing")
        played = {str(size): window.playback(desk, size, plan.seconds) for size in plan.sizes}
        found["playback"] = played
        found["playback_fps"] = {size: run["fps"] for size, run in played.items()}
        desk.window.document.session = None
        desk.window.close()
    local = [found["lengths"][str(n)]["local"]["median"] for n in plan.lengths]
    found["local_edit_ratio_200k"] = local[-1] / local[0]
    say("comparing")
    found["machine"]["drawn_by"] = contexts.drawn_by()
    found["references"], found["ratio"] = _compared(plan, rig, engine, found, answered, say)
    found["in_limits"] = {name: in_limit(found, name) for name in LIMITS}
    found["avx2"] = _with_narrower_kernels(plan, say)
    return found


def in_limit(found: dict[str, Any], limit: str) -> dict[str, Any] | None:
    """All times as multiples of a reference of the same run, to compare machines by.

    Args:
        found: the report.
        limit: one of `LIMITS`.

    Returns:
        The parts `TIMES` of the report; None if the reference is missing.
    """
    reference = found["references"].get(limit)
    if reference is None:
        return None

    def divided(tree: Any) -> Any:
        if isinstance(tree, dict):
            kept = {name: divided(value) for name, value in tree.items()}
            return {name: value for name, value in kept.items() if value is not None}
        return tree / reference["median"] if isinstance(tree, float) else None

    parts = {name: found[name] for name in TIMES if name in found}
    parts["start"] = {name: 1e3 * seconds for name, seconds in found["start_s"].items()}
    result: dict[str, Any] = divided(parts)
    return result


def _with_narrower_kernels(plan: BenchPlan, say: Callable[[str], None]) -> dict[str, Any] | None:
    """The whole measurement with AVX2, in another process; None if the processor has no more."""
    variables = kernels.narrower()
    if variables is None or not plan.compared:
        return None
    say("again, with AVX2")
    command = [sys.executable, "-m", "faceedit_app", "bench", "--json"]
    run = subprocess.run(
        command,
        stdout=subprocess.PIPE,
        encoding="utf-8",
        env=os.environ | variables,
        check=True,
    )
    found: dict[str, Any] = json.loads(run.stdout)
    return found | {"note": kernels.UNCHANGED}


def _starts(plan: BenchPlan) -> tuple[dict[str, float], dict[str, float]]:
    runs = [starting.start() for _ in range(plan.starts)]
    start = {
        key: float(np.median([run[key] for run in runs])) for key in ("window", "face", "edit")
    }
    peaks = {"demo": runs[-1]["peak_mb"]}
    for frames in plan.peaks:
        peaks[str(frames)] = starting.start(frames)["peak_mb"]
    return start, peaks


def _compared(
    plan: BenchPlan,
    rig: Rig,
    engine: Engine,
    found: dict[str, Any],
    answered: Timings,
    say: Callable[[str], None],
) -> tuple[dict[str, Any], dict[str, float | None]]:
    """Each reference's time as a multiple of FaceEdit's."""
    ratio: dict[str, float | None] = dict.fromkeys(
        ("naive", "torch", "holden", "gl_limit", "cpu_limit", "blender")
    )
    if not plan.compared:
        return {}, ratio
    others = references.of_all(engine, rig, plan.repetitions)
    blender = references.blender(rig, max(plan.repetitions // 4, 3), say)
    whole, draw = found["drag"]["median"], found["stages"]["draw"]
    ours = {"naive": whole, "gl_limit": draw}
    for name, times in others.items():
        if times is not None:
            ratio[name] = times.median / ours.get(name, answered.median)
    if blender is not None:
        ratio["blender"] = blender["median"] / whole
    summaries = {name: None if t is None else t.summary() for name, t in others.items()}
    return summaries | {"blender": blender}, ratio


def machine() -> dict[str, Any]:
    """The machine."""
    versions = {}
    for package in PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            continue
    return {
        "processor": _processor(),
        "instructions": kernels.instructions(),
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "system": platform.platform(),
        "python": platform.python_version(),
        "faceedit": __version__,
        "blas": [f"{lib['internal_api']} {lib['version']}" for lib in threadpool_info()],
        "packages": versions,
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(t.partition(":")[2].strip() for t in lines if t.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def text(found: dict[str, Any]) -> str:
    """The report as text."""
    drag, stages, start = found["drag"], found["stages"], found["start_s"]
    one = found["drag_one"]
    lines = [
        f"{found['machine']['processor']} with {found['machine']['instructions']}, "
        f"{found['machine']['cores']} cores, "
        f"load {found['machine']['load'] or 0:.1f}, drawn by {found['machine']['drawn_by']}",
        "",
        f"drag, 202 frames     {drag['median']:7.1f} ms   95 %: {drag['p95']:.1f}"
        f"   best: {drag['best']:.1f}   of the processors: {drag['processors']:.1f}",
        *(f"  {name:<18} {value:7.1f} ms" for name, value in stages.items()),
        f"drag of one curve    {one['median']:7.1f} ms   95 %: {one['p95']:.1f}",
        f"{found['drag_dense']['vertices']} vertices      {found['drag_dense']['median']:7.1f} ms"
        f"   {found['dense_ratio']:.2f} times as long as with ours",
        f"networks, 202 frames {found['networks_202']['median']:7.1f} ms",
        "",
        "take       local  in overview   whole: visible  complete  longest block  cancel   (ms)",
    ]
    for frames, row in found["lengths"].items():
        whole = row["whole"]
        lines.append(
            f"{frames:>7} {row['local']['median']:8.1f} {row['local_overview']['median']:12.1f}"
            f" {whole['visible']:16.1f} {whole['complete']:9.0f} {whole['longest_block']:14.0f}"
            f" {whole['cancel']:7.0f}"
        )
    lines.append(f"local edit, longest to shortest: {found['local_edit_ratio_200k']:.2f}")
    lines += [*busy.text(found["busy"]), ""]
    for size, run in found["playback"].items():
        lines.append(f"playback {size:>5}: {run['fps']:.1f} fps, {run['dropped']} dropped")
    lines.append(
        f"start: window {start['window']:.2f} s, face {start['face']:.2f} s, "
        f"edit {start['edit']:.2f} s"
    )
    lines += [f"peak memory, {name}: {value:.0f} MB" for name, value in found["peak_mb"].items()]
    for name, value in found["ratio"].items():
        lines.append(f"{name:<10} " + ("-" if value is None else f"{value:.2f} times as long"))
    if found["avx2"]:
        lines += ["", f"With AVX2 ({kernels.UNCHANGED}):", "", text(found["avx2"])]
    return "\n".join(lines)
