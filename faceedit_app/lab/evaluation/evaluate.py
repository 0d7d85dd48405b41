"""All figures about takes of people: what users get, each region's answers, closures, edits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING, Control, control_named
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.regions import LOWER, REGIONS, Region
from faceedit_app.core.rig import Rig
from faceedit_app.editing.opening import shipped_rig
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.evaluation.benchmark import GOALS, TrialResult, run_benchmark
from faceedit_app.lab.evaluation.metrics import (
    Closures,
    closures,
    energy_kept,
    high_energy,
    jerk,
    squared_errors,
    vertex_errors,
)
from faceedit_app.lab.evaluation.people.figures import PeopleFigures, measure_people
from faceedit_app.lab.evaluation.people.sources import of_people
from faceedit_app.lab.evaluation.systems import SYSTEMS, Systems
from faceedit_app.lab.training.card import trained_sources
from faceedit_app.lab.training.data import Performance

MOUTH_MM = tuple(0.5 * i for i in range(1, 13))
LIDS_MM = tuple(0.5 * i for i in range(1, 15))
MOUTH = "mouth"
CLOSING: dict[str, tuple[Control, tuple[float, ...]]] = {
    MOUTH: (control_named(LIP_OPENING), MOUTH_MM),
    **{lid: (control_named(lid), LIDS_MM) for lid in LIDS},
}
"""What can close: its control, and the thresholds of detection in mm."""
REGION_IDS = tuple(region.id for region in REGIONS)
WILD_MM = 40.0
WILD_FRAMES = 6


@dataclass(frozen=True)
class Score:
    """One system's figures in one region.

    Attributes:
        mse: mean squared weight error over the captured channels.
        vertex_mm: mean distance of the lip, lid or brow vertices from the truth.
        control_mm: mean absolute error of the region's controls.
        hf_kept: share of the truth's energy above 4 Hz that the answer has as well.
        jerk_ratio: jerk by that of the truth.
        natural: 99.9th percentile of the distance from natural motion, by the limit.
        wild: the same of the frames of a wild edit (40 mm for six frames), at worst.
    """

    mse: float
    vertex_mm: float
    control_mm: float
    hf_kept: float
    jerk_ratio: float
    natural: float
    wild: float


@dataclass
class Figures:
    """Everything that `evaluate` finds.

    Attributes:
        takes: (name, source, seconds).
        regions: by region and system.
        closures: by what closes, and system.
        outcomes: of the benchmark of edits.
        curves: mouth opening (mm) of the first takes, by take and system, for the plots.
        people: what users get, against references.
    """

    takes: list[tuple[str, str, float]]
    regions: dict[str, dict[str, Score]]
    closures: dict[str, dict[str, Closures]]
    outcomes: list[TrialResult] = field(default_factory=list)
    curves: dict[str, dict[str, Doubles]] = field(default_factory=dict)
    people: PeopleFigures = field(default_factory=PeopleFigures)

    def as_json(self) -> dict[str, Any]:
        """The figures as plain JSON values; what cannot be measured is null."""
        names = ("mse", "vertex_mm", "hf_kept", "jerk_ratio")
        nothing = dict.fromkeys(names)
        regions = {
            region: {
                system: {n: _number(getattr(scores[system], n)) for n in names}
                if system in scores
                else dict(nothing)
                for system in SYSTEMS
            }
            for region, scores in self.regions.items()
        }
        closing: dict[str, Any] = {}
        for what, found in self.closures.items():
            thresholds = CLOSING[what][1]
            closing[what] = {"threshold_mm": list(thresholds)}
            for system in SYSTEMS:
                empty = [None] * len(thresholds)
                rates = found.get(system)
                closing[what][system] = {
                    "tpr": [_number(v) for v in rates.tpr] if rates else empty,
                    "fpr": [_number(v) for v in rates.fpr] if rates else empty,
                }
        people = self.people.as_json()
        return people | {
            "regions": regions,
            "closures": closing | people.get("closures", {}),
            "edits": {
                mode: {k: _number(v) for k, v in edit_figures(self.outcomes, mode).items()}
                for mode in ("preserve", "resynthesize")
            },
            "takes": [{"name": name, "seconds": seconds} for name, _, seconds in self.takes],
        }


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def edit_figures(
    outcomes: Sequence[TrialResult], mode: str, naturalness: float = 1.0
) -> dict[str, float]:
    """The benchmark in four numbers.

    `reached_mm_p95` is over lip closures and blinks, which any face can do; the others are over
    all edits: the largest change outside, the 95th percentile of the jumps, the mean share at the
    limits.
    """
    mine = [o for o in outcomes if o.mode == mode and o.naturalness == naturalness]
    goals = [o.reached_mm for o in mine if o.kind in GOALS]
    nan = float("nan")
    return {
        "reached_mm_p95": float(np.percentile(goals, 95)) if goals else nan,
        "changed_outside": max((o.changed_outside for o in mine), default=nan),
        "boundary_jump": float(np.percentile([o.boundary_jump for o in mine], 95)) if mine else nan,
        "clipped_share": float(np.mean([o.clipped for o in mine])) if mine else nan,
    }


def evaluate_takes(
    performances: Sequence[Performance],
    models: Path,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Figures:
    """Measure a folder of models on takes of people; synthesised ones are left out.

    Args:
        performances: the takes, with the paths of their files.
        models: the folder.
        progress: called with the number of steps done and of all.

    Raises:
        FileError: a model is missing or damaged.
        FaceEditError: the takes are too short, or all are synthesised.
    """
    people = of_people(performances)
    if not people:
        raise FaceEditError("all takes are synthesised; name takes of people to measure on")
    figures = evaluate_networks(people, models, lambda done, of: progress(done, 2 * of))
    rig = shipped_rig()
    systems = Systems.load(models, rig)
    figures.people = measure_people(
        performances,
        rig,
        lambda source: systems,
        trained_sources(models),
        lambda done, of: progress(of + done, 2 * of),
    )
    return figures


def evaluate_networks(
    performances: Sequence[Performance],
    models: Path,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Figures:
    """Measure the networks of a folder on their own, and the benchmark of edits.

    Raises:
        FileError: a model is missing or damaged.
        FaceEditError: the takes are too short.
    """
    rig = shipped_rig()
    systems = Systems.load(models, rig)
    figures = measure_systems(performances, systems, rig)
    takes = [open_take(take.path) for take in performances if take.path is not None]
    figures.outcomes = run_benchmark(takes, rig, systems.engine, progress)
    return figures


def measure_systems(
    performances: Sequence[Performance],
    systems: Systems,
    rig: Rig,
    regions: Sequence[str] = REGION_IDS,
) -> Figures:
    """The figures of the regions and closures, without edits.

    Raises:
        FaceEditError: there is no take of a second or more.
    """
    takes = [take for take in performances if take.seconds >= 1.0]
    if not takes:
        raise FaceEditError("no take is as long as a second; name longer takes to measure on")
    answers = {
        (region.id, system): [_bounded(systems, system, region, take, rig) for take in takes]
        for region in REGIONS
        if region.id in regions
        for system in systems.names(region.id)
    }
    figures = Figures([(t.name, t.source, t.seconds) for t in takes], {}, {})
    for region in REGIONS:
        if region.id in regions:
            figures.regions[region.id] = {
                system: _score(takes, answers[region.id, system], region, system, systems, rig)
                for system in systems.names(region.id)
            }
    for what, (control, thresholds) in CLOSING.items():
        if control.region in regions:
            region = next(r for r in REGIONS if r.id == control.region)
            shown = {system: answers[region.id, system] for system in systems.names(region.id)}
            figures.closures[what] = _closures(takes, region, shown, control, thresholds, rig)
    if LOWER.id in regions:
        opening = CONTROL_INDEX[LIP_OPENING]
        for i, take in enumerate(takes[:3]):
            figures.curves[take.name] = {"truth": _truth(take, rig)[:, opening]} | {
                system: _controls(take, LOWER, answers[LOWER.id, system][i], rig)[:, opening]
                for system in systems.names(LOWER.id)
            }
    return figures


def _closures(
    takes: Sequence[Performance],
    region: Region,
    answers: Mapping[str, Sequence[Doubles]],
    control: Control,
    thresholds: Sequence[float],
    rig: Rig,
) -> dict[str, Closures]:
    """How well each system closes what the takes close, on those that captured the region."""
    column = CONTROL_INDEX[control.id]
    seen = [k for k, take in enumerate(takes) if take.captured[_columns(region)].any()]
    truth = _joined([_truth(takes[k], rig)[:, column] for k in seen])
    return {
        system: closures(
            _joined([_controls(takes[k], region, answer[k], rig)[:, column] for k in seen]),
            truth,
            thresholds,
        )
        for system, answer in answers.items()
    }


def _joined(parts: Sequence[Doubles]) -> Doubles:
    return np.concatenate(parts) if parts else np.zeros(0)


def _columns(region: Region) -> list[int]:
    return [ARKIT_INDEX[c] for c in region.channels]


def _truth(take: Performance, rig: Rig) -> Doubles:
    """(T, C) mm: the take's own controls."""
    return rig.arkit_distances.measure(take.weights).astype(np.float64)


def _controls(take: Performance, region: Region, answer: Doubles, rig: Rig) -> Doubles:
    """(T, C) mm: the controls with a region's weights replaced."""
    weights = take.weights.copy()
    weights[:, _columns(region)] = answer
    return rig.arkit_distances.measure(weights).astype(np.float64)


def _bounded(systems: Systems, system: str, region: Region, take: Performance, rig: Rig) -> Doubles:
    """A system's answer to the take's own controls, as the application would use it: 0..1."""
    return np.clip(systems.answer(system, region.id, _truth(take, rig)), 0.0, 1.0)


def _score(
    takes: Sequence[Performance],
    answers: Sequence[Doubles],
    region: Region,
    system: str,
    systems: Systems,
    rig: Rig,
) -> Score:
    columns = _columns(region)
    model = systems.engine.models[region.id]
    controls, natural = model.columns, model.description.natural
    squares, vertices, misses, far, wild = [], [], [], [], []
    high, rough = np.zeros(2), np.zeros(2)
    for take, answer in zip(takes, answers, strict=True):
        captured = take.captured[columns]
        if not captured.any():
            continue
        truth = take.weights[:, columns].astype(np.float64)
        squares.append(squared_errors(answer, truth, captured))
        vertices.append(vertex_errors(rig, region, np.where(captured, answer, truth), truth))
        away = _controls(take, region, answer, rig) - _truth(take, rig)
        misses.append(np.abs(away[:, controls]).ravel())
        high += high_energy(answer, truth, captured)
        rough += [jerk(answer, captured), jerk(truth, captured)]
        if natural is not None:
            far.append(natural.distance(answer))
            asked = _truth(take, rig)
            middle = len(asked) // 2
            asked[middle : middle + WILD_FRAMES, controls[0]] += WILD_MM
            wild.append(natural.distance(systems.answer(system, region.id, asked)).max())
    nan = float("nan")
    if not squares:
        return Score(nan, nan, nan, nan, nan, nan, nan)
    limit = natural.limit if natural is not None else nan
    return Score(
        mse=float(_joined(squares).mean()),
        vertex_mm=float(_joined(vertices).mean()),
        control_mm=float(_joined(misses).mean()),
        hf_kept=energy_kept(float(high[0]), float(high[1])),
        jerk_ratio=float(rough[0] / rough[1]) if rough[1] > 0 else nan,
        natural=float(np.percentile(_joined(far), 99.9)) / limit if far else nan,
        wild=float(np.max(wild)) / limit if wild else nan,
    )
