"""The figures as Markdown tables and SVG plots, and in a few lines for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.lab.evaluation.benchmark import NATURALNESS, TrialResult
from faceedit_app.lab.evaluation.evaluate import CLOSING, Figures, edit_figures
from faceedit_app.lab.evaluation.people.report import people_part
from faceedit_app.lab.evaluation.people.report import summary_lines as people_lines
from faceedit_app.lab.evaluation.systems import SYSTEMS
from faceedit_app.lab.evaluation.tables import cell, markdown_table
from faceedit_app.lab.training.charts import Line, chart

REPORT = "evaluation.md"
LABELS = {"regressor": "regressor alone", "system": "full system", "holden": "Holden et al. 2016"}
WHAT = {what: what.replace("_", " ") for what in CLOSING}
CURVE_SECONDS = 6.0


def regions_table(figures: Figures) -> str:
    """The figures of each system in each region."""
    rows = [
        [
            region,
            LABELS[system],
            cell(score.mse),
            cell(score.vertex_mm, 2),
            cell(score.control_mm, 2),
            cell(score.hf_kept, 2),
            cell(score.jerk_ratio, 2),
            cell(score.natural, 2),
            cell(score.wild, 2),
        ]
        for region, scores in figures.regions.items()
        for system, score in scores.items()
    ]
    titles = ["region", "system", "MSE", "vertices, mm", "controls, mm", "energy above 4 Hz kept"]
    return markdown_table(
        [*titles, "jerk ratio", "distance from natural motion", "the same, wild edit"], rows
    )


def closures_table(figures: Figures) -> str:
    """TPR and FPR at three thresholds, and the FPR from where on the TPR is 0.98."""
    rows = []
    for what, found in figures.closures.items():
        for system, rates in found.items():
            at = [i for i, t in enumerate(rates.thresholds) if t in (1.0, 2.0, 3.0)]
            threshold, fpr = rates.fpr_at(0.98)
            rows.append(
                [
                    WHAT[what],
                    LABELS[system],
                    *(f"{cell(rates.tpr[i], 2)} / {cell(rates.fpr[i], 2)}" for i in at),
                    f"{cell(fpr, 2)} at {cell(threshold, 1)} mm",
                ]
            )
    titles = ["closure", "system", "TPR / FPR at 1 mm", "at 2 mm", "at 3 mm"]
    return markdown_table([*titles, "FPR from where TPR ≥ 0.98"], rows)


def edits_table(outcomes: Sequence[TrialResult]) -> str:
    """The benchmark by mode and naturalness."""
    rows = []
    for mode in ("preserve", "resynthesize"):
        for naturalness in NATURALNESS:
            found = edit_figures(outcomes, mode, naturalness)
            mine = [o for o in outcomes if o.mode == mode and o.naturalness == naturalness]
            goals = [o.reached_mm <= 0.5 for o in mine if o.kind in ("closure", "blink")]
            far = [o.distance > 1.0 for o in mine if np.isfinite(o.distance)]
            rows.append(
                [
                    mode,
                    f"{naturalness:g}",
                    f"{100 * np.mean(goals):.0f} %" if goals else "–",
                    cell(found["reached_mm_p95"], 2),
                    cell(found["changed_outside"], 3),
                    cell(found["boundary_jump"], 4),
                    cell(found["clipped_share"], 3),
                    f"{100 * np.mean(far):.0f} %" if far else "–",
                ]
            )
    titles = [
        "mode",
        "naturalness",
        "closures and blinks within 0.5 mm",
        "their 95th percentile, mm",
    ]
    more = ["changed outside", "boundary jump", "at the limits", "beyond natural motion"]
    return markdown_table([*titles, *more], rows)


def kinds_table(outcomes: Sequence[TrialResult], mode: str = "preserve") -> str:
    """The benchmark by kind of edit, at naturalness 1."""
    mine = [o for o in outcomes if o.mode == mode and o.naturalness == 1.0]
    rows = []
    for kind in dict.fromkeys(o.kind for o in mine):
        some = [o for o in mine if o.kind == kind]
        reached = [o.reached_mm for o in some]
        rows.append(
            [
                kind,
                str(len(some)),
                cell(float(np.median(reached)), 2),
                cell(float(np.percentile(reached, 95)), 2),
                cell(max(o.changed_outside for o in some), 3),
                cell(float(np.median([o.boundary_jump for o in some])), 4),
                cell(float(np.mean([o.clipped for o in some])), 3),
                cell(float(np.median([o.distance for o in some])), 2),
            ]
        )
    titles = ["edit", "number", "missed by (median), mm", "95th percentile, mm", "changed outside"]
    return markdown_table([*titles, "boundary jump", "at the limits", "distance"], rows)


def closure_charts(figures: Figures, folder: Path) -> list[str]:
    """Write the TPR and FPR curves; returns Markdown that shows them."""
    out = []
    for what, found in figures.closures.items():
        lines = [
            Line(
                f"{LABELS[system]}, {name.upper()}", rates.thresholds, values, _color(system), dash
            )
            for system, rates in found.items()
            for name, values, dash in (("tpr", rates.tpr, False), ("fpr", rates.fpr, True))
        ]
        text = chart(f"Closures of the {WHAT[what]}", "threshold, mm", "rate", lines, 0.0, 1.2)
        write_atomically(folder / f"closures_{what}.svg", text.encode())
        out.append(f"![Closures of the {WHAT[what]}](closures_{what}.svg)")
    return out


def curve_charts(figures: Figures, folder: Path) -> list[str]:
    """Write the mouth opening of some takes; returns Markdown that shows them."""
    out = []
    for number, (name, curves) in enumerate(figures.curves.items(), start=1):
        frames = int(CURVE_SECONDS * GRID_RATE)
        lines = [
            Line(
                LABELS.get(system, "as tracked"),
                [i / GRID_RATE for i in range(len(values[:frames]))],
                [float(v) for v in values[:frames]],
                "#000000" if system == "truth" else _color(system),
                system == "truth",
            )
            for system, values in curves.items()
        ]
        file = f"opening_{number}.svg"
        text = chart(f"Mouth opening, {name}", "seconds", "mm", lines)
        write_atomically(folder / file, text.encode())
        out.append(f"![Mouth opening]({file})")
    return out


def _color(system: str) -> str:
    return ("#d55e00", "#0072b2", "#009e73")[SYSTEMS.index(system)]


def write_report(folder: Path, figures: Figures) -> Path:
    """Write `evaluation.md` with its plots to a folder, and return its path.

    Raises:
        FileError: the folder cannot be made or written.
    """
    make_folder(folder)
    seconds = sum(s for _, _, s in figures.takes)
    text = "\n\n".join(
        [
            "# Evaluation",
            "## On people",
            people_part(figures.people),
            "## The networks on their own",
            f"{len(figures.takes)} takes, {seconds:.0f} seconds. {NOTES}",
            "## Regions",
            regions_table(figures),
            "## Closures",
            closures_table(figures),
            *closure_charts(figures, folder),
            "## Edits",
            edits_table(figures.outcomes),
            "Preserve mode at naturalness 1, by kind of edit:",
            kinds_table(figures.outcomes),
            "## Curves",
            *curve_charts(figures, folder),
        ]
    )
    path = folder / REPORT
    write_atomically(path, f"{text}\n".encode())
    return path


NOTES = """Each system is given the controls that were measured on the take and should give the
take back. MSE: mean squared weight error over the channels that the take's source captures.
Vertices: mean distance of the lip, lid or brow vertices from where they should be. Closures: a
frame is one where the distance is below the threshold; TPR by, and FPR relative to, the number of
actual ones. Energy above 4 Hz kept: of the take's fast motion, what the answer has as well; jitter
that the answer makes up does not count, and shows in the jerk, which is by that of the take.
Distance from natural motion: Mahalanobis distance of weights and their change per
frame, 99.9th percentile of the frames, 1 being the 99.9th percentile of recorded takes; wild edit:
40 mm more on the region's first control for six frames, the largest distance."""


def make_folder(folder: Path) -> None:
    """Make a folder for a report.

    Raises:
        FileError: it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(folder, "cannot be made", "choose another folder") from error


def summary_lines(figures: Figures) -> list[str]:
    """The main figures for the terminal."""
    out = people_lines(figures.people)
    for region, scores in figures.regions.items():
        parts = [f"{LABELS[s]} MSE {cell(score.mse)}" for s, score in scores.items()]
        out.append(f"{region}: " + ", ".join(parts))
    for what, found in figures.closures.items():
        parts = []
        for system, rates in found.items():
            threshold, fpr = rates.fpr_at(0.98)
            parts.append(f"{LABELS[system]} {cell(fpr, 2)} (at {cell(threshold, 1)} mm)")
        out.append(f"{WHAT[what]} closures, FPR where TPR is 0.98: " + ", ".join(parts))
    for mode in ("preserve", "resynthesize"):
        edits = edit_figures(figures.outcomes, mode)
        reached = cell(edits["reached_mm_p95"], 2)
        out.append(f"{mode}: 95 % of closures and blinks reached within {reached} mm")
    return out
