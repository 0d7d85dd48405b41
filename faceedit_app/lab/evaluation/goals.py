"""Target figures and measured ones, for the model card."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.regions import EYELIDS, LOWER
from faceedit_app.lab.evaluation.benchmark import GOALS
from faceedit_app.lab.evaluation.evaluate import Figures, edit_figures
from faceedit_app.lab.evaluation.report import WHAT
from faceedit_app.lab.evaluation.tables import cell, markdown_table

NEAR_MM = 0.5
TPR_WANTED, FPR_ALLOWED, FPR_AIM = 0.98, 0.22, 0.05


@dataclass(frozen=True)
class FigureGoal:
    """One figure to reach."""

    what: str
    measured: str
    reached: bool


def goals(figures: Figures) -> list[FigureGoal]:
    """All goals that the figures cover."""
    return [*_closures(figures), *_errors(figures), *_edits(figures), *_wild(figures)]


def _closures(figures: Figures) -> list[FigureGoal]:
    out = []
    for what, found in figures.closures.items():
        ours = found["system"]
        if "holden" in found:
            half = len(ours.thresholds) // 2
            pairs = [
                (a, b)
                for a, b in zip(ours.tpr[:half], found["holden"].tpr[:half], strict=True)
                if np.isfinite(a) and np.isfinite(b)
            ]
            won = [a > b for a, b in pairs]
            out.append(
                FigureGoal(
                    f"{WHAT[what]}: more closures kept than Holden et al. at every threshold up to "
                    f"{ours.thresholds[half - 1]:g} mm",
                    f"at {sum(won)} of {len(won)}; on average "
                    f"{cell(float(np.mean([a for a, _ in pairs] or [np.nan])), 2)} against "
                    f"{cell(float(np.mean([b for _, b in pairs] or [np.nan])), 2)}",
                    bool(won) and all(won),
                )
            )
        threshold, fpr = ours.fpr_at(TPR_WANTED)
        out.append(
            FigureGoal(
                f"{WHAT[what]}: FPR at most {FPR_ALLOWED} (aim {FPR_AIM}) at the "
                f"threshold from which the TPR is {TPR_WANTED}",
                f"{cell(fpr, 2)} at {cell(threshold, 1)} mm",
                bool(fpr <= FPR_ALLOWED),
            )
        )
    return out


def _errors(figures: Figures) -> list[FigureGoal]:
    out = []
    for region in (LOWER.id, EYELIDS.id):
        scores = figures.regions[region]
        regressor, system = scores["regressor"], scores["system"]
        ratio = system.mse / regressor.mse
        if "holden" in scores:
            holden = scores["holden"]
            out += [
                FigureGoal(
                    f"{region}: more high-frequency energy kept than Holden et al.",
                    f"{cell(system.hf_kept, 2)} against {cell(holden.hf_kept, 2)}",
                    system.hf_kept > holden.hf_kept,
                ),
                FigureGoal(
                    f"{region}: MSE of the regressor below that of Holden et al.",
                    f"{cell(regressor.mse)} against {cell(holden.mse)}",
                    regressor.mse < holden.mse,
                ),
                FigureGoal(
                    f"{region}: MSE of the full system below that of Holden et al. (an aim)",
                    f"{cell(system.mse)} against {cell(holden.mse)}",
                    system.mse < holden.mse,
                ),
            ]
        out.append(
            FigureGoal(
                f"{region}: MSE of the full system at most twice the regressor's",
                f"{cell(system.mse)}, {cell(ratio, 2)} times",
                ratio <= 2.0,
            )
        )
    return out


def _edits(figures: Figures) -> list[FigureGoal]:
    if not figures.outcomes:
        return []
    mine = [o for o in figures.outcomes if o.mode == "preserve"]
    outside = max(o.changed_outside for o in mine)
    goals = [
        FigureGoal("preserve: nothing changes where no edit reaches", f"{outside:g}", outside == 0)
    ]
    for kind, kinds in (("closure or blink", GOALS), *((kind, (kind,)) for kind in GOALS)):
        missed = [o.reached_mm for o in mine if o.kind in kinds and o.naturalness == 1.0]
        share = float(np.mean([m <= NEAR_MM for m in missed])) if missed else float("nan")
        goals.append(
            FigureGoal(
                f"preserve, naturalness 1: a {kind} is reached within {NEAR_MM} mm in 95 % of "
                f"the edits",
                f"{100 * share:.1f} % of {len(missed)}" if missed else "–",
                share >= 0.95,
            )
        )
    jump = edit_figures(figures.outcomes, "preserve")["boundary_jump"]
    goals.append(
        FigureGoal(
            "preserve: no visible jump of velocity at an edit's ends", cell(jump, 4), jump < 0.01
        )
    )
    return goals


def _wild(figures: Figures) -> list[FigureGoal]:
    out = []
    for region in (LOWER.id, EYELIDS.id):
        system, regressor = (figures.regions[region][name] for name in ("system", "regressor"))
        if np.isfinite(system.wild):
            out.append(
                FigureGoal(
                    f"{region}: after a wild edit no frame of the full system is further from "
                    "natural motion than the 99.9th percentile of real takes (1), where the "
                    "regressor alone is",
                    f"{cell(system.wild, 2)}; regressor {cell(regressor.wild, 2)}",
                    system.wild <= 1.0 < regressor.wild,
                )
            )
    return out


def networks_goals_part(figures: Figures) -> str:
    """All goals as Markdown, with the takes that they were measured on."""
    seconds: dict[str, float] = {}
    for _, source, length in figures.takes:
        seconds[source] = seconds.get(source, 0.0) + length
    takes = ", ".join(f"`{name}` ({length:.0f} s)" for name, length in seconds.items())
    found: Sequence[FigureGoal] = goals(figures)
    rows = [[goal.what, goal.measured, "yes" if goal.reached else "**no**"] for goal in found]
    reached = sum(goal.reached for goal in found)
    return "\n\n".join(
        [
            f"{reached} of {len(found)} figures are reached. Measured on {takes}, in one run of "
            "`faceedit experiment card`.",
            markdown_table(["figure", "measured", "reached"], rows),
        ]
    )
