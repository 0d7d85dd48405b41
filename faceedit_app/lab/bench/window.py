"""What the user waits for: a drag, wide edits of takes of any length, playback."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from trimesh.remesh import subdivide

from faceedit_app.core.controls import CONTROLS, LIDS, LIP_OPENING
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving import solver as solve
from faceedit_app.editing.solving.answers import Answers
from faceedit_app.lab.bench.clocks import Stages, Timings, repeat
from faceedit_app.lab.bench.desk import Desk, Heartbeat, long_take
from faceedit_app.networks.engine import Engine
from faceedit_app.render.renderer import FaceRenderer
from faceedit_app.render.surface import NormalSolver
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.face.face_picture import FacePicture
from faceedit_app.ui.state.document import Document

FRAMES = 202  # the paper's
VERTICES = 15_000
STAGES = ("controls", "networks", "curves", "plots", "deform", "draw")


def _begin_drag(desk: Desk, rig: Rig | None = None) -> Callable[[], float]:
    """Press on the mouth, with both lids chosen and the whole take selected, and warm up.

    Returns:
        One step of the drag, which returns its milliseconds.
    """
    clip = desk.open(long_take(FRAMES), rig=rig).take.clip
    desk.choose(LIP_OPENING, *LIDS)
    desk.window.timeline.show_range(0.0, clip.duration)
    desk.window.timeline.select((0.0, clip.duration))
    desk.press(LIP_OPENING, clip.duration / 2)
    once = desk.dragged(LIP_OPENING)
    desk.warm_up(once, 20)
    return once


def drag(desk: Desk, times: int) -> dict[str, Any]:
    """Measure 1: the mouth and both lids are dragged over a whole take.

    So the networks of all three regions answer for all 202 frames, at each step.
    """
    once = _begin_drag(desk)
    steps = [(once(), desk.worked) for _ in range(times)]
    whole, worked = (Timings(column) for column in zip(*steps, strict=True))
    stages = Stages()
    accounts = (
        ("controls", EditSession, "preview"),
        ("curves", solve.Solver, "solve"),
        ("window", Document, "_pass_on_preview"),  # what views do is not the session's time
        ("controls", solve, "request"),
        ("networks", Answers, "wait"),  # other cores answer while regions are solved
        ("plots", CurvesPanel, "refresh"),
        ("draw", FacePicture, "draw"),
        ("draw", FaceRenderer, "begin"),
        ("draw", FaceRenderer, "finish"),
        ("deform", Rig, "vertices"),
        ("deform", NormalSolver, "__call__"),
    )
    with stages.watching(*accounts):
        watched = sum(once() for _ in range(times))
    # Qt calls what paints a plot past Python's classes, so it is measured by itself.
    plots = [plot.viewport() for plot in desk.editor.curves.plots]
    painted = repeat(lambda: [plot.repaint() for plot in plots], times, 2)
    desk.cancel()
    desk.choose()
    parts = {stage: 1e3 * stages.seconds.get(stage, 0.0) / times for stage in STAGES}
    parts["plots"] += painted.median
    return {
        "drag": whole.summary() | {"processors": worked.median, "repetitions": times},
        "stages": parts | {"window": max(watched / times - sum(parts.values()), 0.0)},
        "drag_one": _drag_of_one(desk, times).summary(),
    }


def drag_dense(desk: Desk, times: int) -> dict[str, Any]:
    """The drag of measure 1 on a character with `VERTICES` vertices, as users bring them."""
    rig = denser(desk.rig, VERTICES)
    once = _begin_drag(desk, rig)
    steps = Timings([once() for _ in range(times)])
    desk.cancel()
    desk.choose()
    return steps.summary() | {"vertices": len(rig.neutral)}


def denser(rig: Rig, vertices: int) -> Rig:
    """The character with at least so many vertices: its faces are cut in four, part by part."""
    neutral, moved, colors = rig.neutral, rig.deltas.transpose(1, 0, 2), rig.colors
    faces, materials, start = [], [], 0
    for material in rig.materials:
        part = rig.faces[material.start : material.stop]
        if len(neutral) < vertices:
            attributes = {"moved": moved.reshape(len(neutral), -1), "colors": colors}
            neutral, part, attributes = subdivide(neutral, part, vertex_attributes=attributes)
            moved = attributes["moved"].reshape(len(neutral), -1, 3)
            colors = attributes["colors"]
        faces.append(part)
        materials.append(replace(material, start=start, stop=start + len(part)))
        start += len(part)
    return replace(
        rig,
        neutral=neutral.astype(np.float32),
        faces=np.concatenate(faces).astype(np.int32),
        deltas=np.ascontiguousarray(moved.transpose(1, 0, 2), np.float32),
        colors=colors.astype(np.float32),
        materials=tuple(materials),
        shade=None,
    )


def _drag_of_one(desk: Desk, times: int) -> Timings:
    """A typical drag: one curve, in a selection of 0.4 s, where the lids are edited too."""
    session, line = desk.session, desk.window.timeline
    session.add(Edit(LIDS, Op.OFFSET, 0.0, session.take.clip.duration, 0.0, -1.0))
    line.select((line.time - 0.2, line.time + 0.2))
    desk.press(LIP_OPENING, line.time)
    once = desk.dragged(LIP_OPENING)
    desk.warm_up(once, 10)
    steps = Timings([once() for _ in range(times)])
    desk.cancel()
    return steps


def networks(engine: Engine, times: int) -> Timings:
    """The three regions' networks on 202 frames, as the paper measures them."""
    demo = long_take(FRAMES).clip
    curves = np.random.default_rng(0).normal(30.0, 3.0, (len(demo), len(CONTROLS)))
    regions = [region.id for region in REGIONS]
    return repeat(lambda: engine.answers(regions, curves, 1.0), times)


def lengths(desk: Desk, frames: tuple[int, ...], times: int) -> dict[str, Any]:
    """Measure 2: one local edit, and one of the whole take, at several lengths."""
    return {str(count): _length(desk, count, times) for count in frames}


def _length(desk: Desk, frames: int, times: int) -> dict[str, Any]:
    session = desk.open(long_take(frames))
    line, clip = desk.window.timeline, session.take.clip
    moment = line.time
    desk.press(LIP_OPENING, moment)
    once = desk.dragged(LIP_OPENING)
    desk.warm_up(once, 10)
    local = Timings([once() for _ in range(times)])
    desk.cancel()
    line.show_range(0.0, clip.duration)
    desk.settle()
    desk.press(LIP_OPENING, moment)
    overview = Timings([once() for _ in range(max(times // 4, 2))])
    desk.cancel()
    line.show_range(moment - 4.0, moment + 4.0)
    return {
        "local": local.summary(),
        "local_overview": overview.summary(),
        "whole": _whole(desk, moment),
    }


def _whole(desk: Desk, moment: float) -> dict[str, float]:
    line, clip = desk.window.timeline, desk.session.take.clip
    line.select((0.0, clip.duration))
    desk.settle()
    desk.press(LIP_OPENING, moment)
    beat, began = Heartbeat(desk.window), time.perf_counter()
    first = desk.dragged(LIP_OPENING)()
    desk.release(LIP_OPENING)
    complete = 1e3 * (time.perf_counter() - began)
    blocked = beat.stop()
    desk.window.document.undo()
    desk.press(LIP_OPENING, moment)
    desk.dragged(LIP_OPENING)()
    began = time.perf_counter()
    desk.editor.curves.cancel_drag()
    cancelled = 1e3 * (time.perf_counter() - began)
    desk.settle()
    line.select(None)
    return {
        "visible": first,
        "complete": complete,
        "longest_block": blocked,
        "cancel": cancelled,
    }


def playback(desk: Desk, size: int, seconds: float) -> dict[str, float]:
    """Measure 3: a take of 60 fps, with its curves and the playhead moving."""
    desk.open(long_take(round(60 * (seconds + 2)), 60.0), size)
    window, viewport = desk.window, desk.editor.face.viewport
    window.timeline.show_range(0.0, 8.0)
    window.timeline.go_to_frame(0)
    desk.settle()
    window.playback.play()
    _run(desk, 0.3)
    draws, frame, began = viewport.draws, window.timeline.frame, time.perf_counter()
    _run(desk, seconds)
    took = time.perf_counter() - began
    window.playback.pause()
    shown, passed = viewport.draws - draws, window.timeline.frame - frame
    return {"fps": shown / took, "frames": passed, "dropped": max(passed - shown, 0)}


def _run(desk: Desk, seconds: float) -> None:
    until = time.perf_counter() + seconds
    while time.perf_counter() < until:
        desk.app.processEvents()
        time.sleep(0.0002)  # as a waiting event loop would
