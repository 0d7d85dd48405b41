"""Ten minutes at 60 frames a second with 500 edits: how fast the window answers.

Measured in the real window with the shipped networks. An answer is what the user waits for: the
command or the step of a slider, and all painting that follows. The rest is computed in the
background; the longest time during which the window does not respond is reported as well.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from faceedit_app.core.controls import MAIN_CONTROLS, MOUTH_WIDTH
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.lab.bench.clocks import Timings
from faceedit_app.lab.bench.desk import Desk, Heartbeat, long_take

FRAMES, RATE = 36_000, 60.0
EDITS = 500
REST = 0.8  # seconds until the problems of the take have been searched again
_OPS = (Op.OFFSET, Op.SCALE, Op.SMOOTH, Op.DRAW)
_VALUES = {Op.OFFSET: 2.0, Op.SCALE: 1.2, Op.SMOOTH: 0.05}


def spread_edits(count: int, seconds: float) -> tuple[Edit, ...]:
    """Edits of several kinds, all over a take, in random order."""
    starts = np.random.default_rng(0).uniform(0.0, max(seconds - 1.0, 0.1), count)
    made = []
    for i, start in enumerate(starts.tolist()):
        op = _OPS[i % len(_OPS)]
        points = ((start, 30.0), (start + 0.3, 32.0)) if op is Op.DRAW else ()
        control = MOUTH_WIDTH if op is Op.DRAW else MAIN_CONTROLS[i % len(MAIN_CONTROLS)]
        value = _VALUES.get(op, 0.0)
        made.append(Edit((control,), op, start, start + 0.3, 0.2, value, points=points))
    return tuple(made)


def busy(desk: Desk, times: int, frames: int = FRAMES, count: int = EDITS) -> dict[str, Any]:
    """Measure 4: changes to the list of edits, and edits of the whole take."""
    session = desk.open(long_take(frames, RATE))
    session.add(*spread_edits(count, session.take.clip.duration))
    desk.settle()
    editor, act = desk.editor, desk.window.actions_
    row = _nearest(session.edits, desk.window.timeline.time)
    editor.edits.select(row)
    desk.settle()
    slider = editor.edits.strength
    strengths = iter(np.tile([60, 80, 100, 120], 10_000).tolist())

    def drag_slider() -> None:
        slider.setSliderDown(True)
        slider.setSliderPosition(next(strengths))

    def found(work: Callable[[], object]) -> dict[str, float]:
        return _answers(desk, work, times)

    def slid() -> dict[str, float]:
        result = found(drag_slider)
        slider.setSliderDown(False)
        desk.settle()
        return result

    result = {
        "toggle": _switched(desk, row, times),
        "undo": found(act["undo"].trigger),
        "redo": found(act["redo"].trigger),
        "strength": slid(),
        "delete": _delete(desk, row, times),
    }
    result["smile"] = _smile(desk, times)
    editor.edits.select_new()
    result["smile_strength"] = slid()
    result["smile_toggle"] = _switched(desk, len(session.edits) - 1, times)
    result["smile_undo"] = _answers(desk, act["undo"].trigger, 1)
    return {"frames": frames, "edits": count, "answers": result}


def text(found: dict[str, Any]) -> list[str]:
    """Lines of the printed report."""
    lines = [
        "",
        f"{found['frames']} frames, {found['edits']} edits"
        "   answer  longest  block after  complete   (ms)",
    ]
    for name, row in found["answers"].items():
        lines.append(
            f"{name:<24} {row['answer']:9.1f} {row['longest_answer']:8.1f}"
            f" {row['longest_block']:12.1f} {row['complete']:9.0f}"
        )
    return lines


def _nearest(edits: tuple[Edit, ...], seconds: float) -> int:
    """The edit nearest to the playhead, whose effect is on screen."""
    return min(range(len(edits)), key=lambda i: abs(edits[i].start - seconds))


def _switched(desk: Desk, row: int, times: int) -> dict[str, float]:
    """Switch an edit off and on; it ends up on."""
    result = _answers(desk, desk.window.actions_["toggle_edit"].trigger, times)
    if not desk.session.edits[row].enabled:
        desk.window.actions_["toggle_edit"].trigger()
        desk.settle()
    return result


def _delete(desk: Desk, row: int, times: int) -> dict[str, float]:
    def prepare() -> None:
        desk.window.document.undo()
        desk.editor.edits.select(row)
        desk.settle()

    act = desk.window.actions_["delete_edit"].trigger
    runs = [_answer(desk, act, prepare) for _ in range(times)]
    desk.window.document.undo()
    desk.settle()
    return _summary(runs)


def _smile(desk: Desk, times: int) -> dict[str, float]:
    """One click for the whole take; the last one is kept."""

    def prepare() -> None:
        desk.window.timeline.select(None)
        desk.window.document.undo()
        desk.settle()

    act = desk.window.actions_["fix_smile"].trigger
    desk.window.timeline.select(None)
    runs = [_answer(desk, act, prepare) for _ in range(times)]
    desk.window.document.redo()
    desk.settle()
    return _summary(runs)


def _answers(desk: Desk, work: Callable[[], object], times: int) -> dict[str, float]:
    return _summary([_answer(desk, work) for _ in range(times)])


def _answer(
    desk: Desk, work: Callable[[], object], prepare: Callable[[], None] = lambda: None
) -> tuple[float, float, float]:
    """Milliseconds until the window has answered, of the longest block after, and until all is
    computed."""
    began = time.perf_counter()
    work()
    desk.app.processEvents()
    answered = time.perf_counter() - began
    beat = Heartbeat(desk.window)
    while desk.editor.solving.is_busy:
        desk.app.processEvents()
    complete = time.perf_counter() - began
    desk.settle(REST)
    blocked = beat.stop()
    prepare()
    return 1e3 * answered, blocked, 1e3 * complete


def _summary(runs: list[tuple[float, float, float]]) -> dict[str, float]:
    answered, blocked, complete = zip(*runs, strict=True)
    return {
        "answer": Timings(answered).median,
        "longest_answer": max(answered),
        "longest_block": max(blocked),
        "complete": Timings(complete).median,
    }
