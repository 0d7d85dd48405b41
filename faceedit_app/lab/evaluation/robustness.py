"""The paper's robustness figure: what comes out of mouth openings that no mouth can do."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.regions import LOWER
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.core.rig import Rig
from faceedit_app.lab.evaluation.metrics import high_energy
from faceedit_app.lab.evaluation.report import LABELS
from faceedit_app.lab.evaluation.systems import Systems
from faceedit_app.lab.evaluation.tables import cell, markdown_table
from faceedit_app.lab.training.charts import Line, chart
from faceedit_app.lab.training.data import Performance

SECONDS = 2.8
OPENING = CONTROL_INDEX[LIP_OPENING]


class ReportSetting(Protocol):
    """Where the plots go, and the character to measure on."""

    output: Path

    @property
    def rig(self) -> Rig:
        """The character."""


def inputs(rest: Doubles, frames: int) -> dict[str, Doubles]:
    """Mouth openings to try, from a resting face's controls (C,): (frames, C) mm each."""
    time = np.arange(frames) / GRID_RATE
    middle = time[frames // 2]
    bump = np.exp(-0.5 * ((time - middle) / 0.12) ** 2)
    held = (np.abs(time - middle) < 0.3) * 1.0
    flicker = ((np.arange(frames) // 2) % 2) * (np.abs(time - middle) < 0.6)
    out = {}
    for name, curve, size in (
        ("a syllable, 12 mm", bump, 12.0),
        ("a step of 60 mm", held, 60.0),
        ("flicker of 25 mm", flicker, 25.0),
    ):
        asked = np.repeat(rest[None], frames, axis=0)
        asked[:, OPENING] += size * curve
        out[name] = asked
    return out


def robustness_part(takes: Sequence[Performance], systems: Systems, place: ReportSetting) -> str:
    """The figure and a table, as Markdown; the plots are written to `place.output`.

    Raises:
        FaceEditError: there is no take.
    """
    if not takes:
        raise FaceEditError("robustness needs takes to measure on: --held-out DIR")
    natural = systems.engine.models[LOWER.id].description.natural
    distances = place.rig.arkit_distances
    controls = np.concatenate([distances.measure(take.weights) for take in takes])
    rest = np.median(controls, axis=0).astype(np.float64)
    rows, pictures = [], []
    for number, (name, asked) in enumerate(inputs(rest, int(SECONDS * GRID_RATE)).items(), 1):
        lines = [_line("asked for", asked[:, OPENING], "#000000", True)]
        for system, color in (("regressor", "#d55e00"), ("system", "#0072b2")):
            answer = systems.answer(system, LOWER.id, asked)
            weights = np.zeros((len(answer), 52), np.float32)
            weights[:, _columns()] = answer
            opening = distances.measure(weights)[:, OPENING].astype(np.float64)
            lines.append(_line(LABELS[system], opening, color, False))
            far = natural.distance(answer) / natural.limit if natural else None
            rows.append(
                [
                    name,
                    LABELS[system],
                    cell(float(opening.max()), 1),
                    cell(float(max(answer.max() - 1.0, -answer.min(), 0.0)), 2),
                    cell(float(far.max()) if far is not None else float("nan"), 2),
                    cell(high_energy(answer, answer, np.ones(answer.shape[1], bool))[1], 1),
                ]
            )
        file = f"robustness_{number}.svg"
        text = chart(f"In: {name}", "seconds", "mouth opening, mm", lines)
        write_atomically(place.output / file, text.encode())
        pictures.append(f"![{name}]({file})")
    titles = ["mouth opening in", "system", "largest opening out, mm", "weights outside 0..1 by"]
    more = ["distance from natural motion", "energy above 4 Hz"]
    return "\n\n".join(
        [
            "# Robustness: what the autoencoder is for",
            "A resting face is asked for mouth openings, believable and not. The answers are the "
            "networks' own, before the application bounds anything. Distance from natural motion: "
            "1 is the 99.9th percentile of recorded takes.",
            *pictures,
            markdown_table([*titles, *more], rows),
        ]
    )


def _columns() -> list[int]:
    return [ARKIT_INDEX[c] for c in LOWER.channels]


def _line(name: str, values: Doubles, color: str, dashed: bool) -> Line:
    times = (np.arange(len(values)) / GRID_RATE).tolist()
    return Line(name, times, values.tolist(), color, dashed)
