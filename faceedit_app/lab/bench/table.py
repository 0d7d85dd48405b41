"""The figures as the rows of a Markdown table, for docs/performance.md."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Row:
    """A figure that has a goal.

    Attributes:
        name: what is measured.
        path: its place in the report.
        goal: in the same unit.
        unit: of both.
        digits: decimals.
        least: whether the goal is the least, not the most.
        limit: the reference that does the same kind of work.
    """

    name: str
    path: str
    goal: float | None
    unit: str = "ms"
    digits: int = 1
    least: bool = False
    limit: str | None = "cpu_limit"


ROWS = (
    Row("drag of all regions, 202 frames", "drag.median", 14.0),
    Row("95 % of its steps", "drag.p95", 17.0),
    Row("drag of one curve", "drag_one.median", 10.0),
    Row("networks, three regions, 202 frames", "networks_202.median", 2.5),
    Row("its stages: controls", "stages.controls", None),
    Row("curves (reach and measuring)", "stages.curves", 2.0),
    Row("plots", "stages.plots", 3.5),
    Row("draw", "stages.draw", None, limit="gl_limit"),
    Row("deform", "stages.deform", None),
    Row("window", "stages.window", None),
    Row("60 fps at 640", "playback_fps.640", 59.5, "fps", least=True, limit=None),
    Row("60 fps at 1024", "playback_fps.1024", 59.5, "fps", least=True, limit=None),
    Row("window after start", "start_s.window", None, "s", 2, limit=None),
    Row("face after start", "start_s.face", 1.5, "s", 2, limit=None),
    Row("first edit after start", "start_s.edit", 1.5, "s", 2, limit=None),
    Row(
        "drag with a character of 15,000 vertices: times ours",
        "dense_ratio",
        1.5,
        "x",
        2,
        False,
        None,
    ),
    Row("local edit, 200,000 frames to 202", "local_edit_ratio_200k", 1.2, "x", 2, False, None),
    Row("Blender's step: times ours", "ratio.blender", 5.0, "x", 2, True, None),
    Row("the naive way: times ours", "ratio.naive", 5.0, "x", 2, True, None),
    Row("peak memory, demo", "peak_mb.demo", None, "MB", 0, limit=None),
)


def table(found: dict[str, Any]) -> str:
    """One row for each figure, with a column for each instruction set that was measured."""
    runs = [run for run in (found, found.get("avx2")) if run]
    names = [run["machine"]["instructions"] for run in runs]
    head = ["what", *(cell for name in names for cell in (name, "times the limit")), "goal"]
    lines = [head, ["---"] * len(head), *_cells(runs)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _cells(runs: list[dict[str, Any]]) -> Iterator[list[str]]:
    for row in ROWS:
        values = [_value(run, row.path) for run in runs]
        if all(value is None for value in values):
            continue
        line = [row.name]
        for run, value in zip(runs, values, strict=True):
            line += [_shown(row, value), _in_limit(run, row, value)]
        yield [*line, _goal(row, values)]


def _value(run: dict[str, Any], path: str) -> float | None:
    value: Any = run
    for name in path.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    return float(value) if value is not None else None


def _shown(row: Row, value: float | None) -> str:
    return "-" if value is None else f"{value:.{row.digits}f} {row.unit}"


def _in_limit(run: dict[str, Any], row: Row, value: float | None) -> str:
    limit = _value(run, f"references.{row.limit}.median")
    return "" if value is None or not limit else f"{value / limit:.1f}"


def _goal(row: Row, values: list[float | None]) -> str:
    if row.goal is None:
        return ""
    known = [value for value in values if value is not None]
    reached = all(v >= row.goal if row.least else v <= row.goal for v in known)
    sign = "at least" if row.least else "at most"
    return f"{sign} {row.goal:g} {row.unit}: {'yes' if reached else 'no'}"
