"""The experiments that train networks of their own: what to train on, and by which recipe."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_IDS, LIDS
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.regions import EYELIDS, LOWER, UPPER, Region
from faceedit_app.lab.evaluation.evaluate import MOUTH, Figures, measure_systems
from faceedit_app.lab.evaluation.report import LABELS
from faceedit_app.lab.evaluation.setting import Setting
from faceedit_app.lab.evaluation.tables import cell, markdown_table
from faceedit_app.lab.training.data import Performance
from faceedit_app.lab.training.examples import SYNTHETIC
from faceedit_app.lab.training.settings import TrainingSettings

MOUTH_AT = 2.0  # mm, the stated threshold of detection in short tables


def table2(setting: Setting) -> Path:
    """The paper's Table 2: train on one source, test on another, and on both."""
    sources = [s for s in dict.fromkeys(p.source for p in setting.known) if s != SYNTHETIC]
    if len(sources) < 2:
        raise FaceEditError("table2 needs takes of two sources that people played: --data DIR")
    chosen = sources[:2]
    settings = setting.settings()
    sets = {
        name: _halves([p for p in setting.known if p.source in parts])
        for name, parts in [(chosen[0], chosen[:1]), (chosen[1], chosen[1:]), ("both", chosen)]
    }
    rows = []
    for name, (learned, _) in sets.items():
        systems = setting.train(f"Table 2, {name}", [LOWER], learned, settings)
        for test in chosen:
            figures = measure_systems(sets[test][1], systems, setting.rig, [LOWER.id])
            rows.append([name, test, *_mouth_cells(figures)])
    titles = ["trained on", "tested on", "MSE", "TPR", "FPR"]
    text = f"""# Table 2: training on one source, testing on another

Full system, lower face, closures at {MOUTH_AT:g} mm. The sources stand in for the paper's two
databases. The later half of each take is kept for testing. {_budget(setting)}

{markdown_table(titles, rows)}"""
    return setting.write("table2", text)


def leave_one_out(setting: Setting) -> Path:
    """Each source that people played, judged by networks that never saw it."""
    sources = [s for s in dict.fromkeys(p.source for p in setting.known) if s != SYNTHETIC]
    rows = []
    for source in sources:
        rest = [p for p in setting.known if p.source != source]
        mine = [p for p in setting.known if p.source == source]
        regions = [r for r in (LOWER, EYELIDS) if _captured(mine, r) and _captured(rest, r)]
        systems = setting.train(f"Without {source}", regions, rest, setting.settings(), True)
        figures = measure_systems(mine, systems, setting.rig, [r.id for r in regions])
        for region in regions:
            what = MOUTH if region is LOWER else LIDS[0]
            for system, score in figures.regions[region.id].items():
                rates = figures.closures[what][system]
                at = rates.thresholds.index(MOUTH_AT)
                threshold, fpr = rates.fpr_at(0.98)
                rows.append(
                    [
                        source,
                        region.id,
                        LABELS[system],
                        cell(score.mse),
                        cell(score.vertex_mm, 2),
                        cell(score.hf_kept, 2),
                        f"{cell(rates.tpr[at], 2)} / {cell(rates.fpr[at], 2)}",
                        f"{cell(fpr, 2)} at {cell(threshold, 1)} mm",
                    ]
                )
    titles = ["left out", "region", "system", "MSE", "vertices, mm", "energy above 4 Hz kept"]
    text = f"""# Leaving one source out

Each source in turn is judged by networks trained on all the others, synthesised speakers
included. Closures of the mouth or the left eyelid. {_budget(setting)}

{markdown_table([*titles, f"TPR / FPR at {MOUTH_AT:g} mm", "FPR from where TPR ≥ 0.98"], rows)}"""
    return setting.write("leave-one-out", text)


def recipes(setting: Setting) -> Path:
    """What our changes to the paper's recipe do, one at a time, and which controls brows hear."""
    ours = setting.settings()
    assert ours.variety is not None
    variants: list[tuple[str, TrainingSettings]] = [
        ("the paper's", setting.settings("paper")),
        ("the paper's, residual", replace(setting.settings("paper"), residual=True)),
        ("ours", ours),
        ("ours without variety", replace(ours, variety=None)),
        ("ours without velocity loss", replace(ours, velocity_loss=0.0)),
        ("ours without distance loss in the regressor", replace(ours, distance_loss_regressor=0.0)),
        ("ours with a plain autoencoder", replace(ours, residual=False)),
    ]
    rows = []
    for name, settings in variants:
        systems = setting.train(f"Recipe: {name}", [LOWER], setting.known, settings)
        figures = measure_systems(setting.unseen, systems, setting.rig, [LOWER.id])
        for system, score in figures.regions[LOWER.id].items():
            rates = figures.closures[MOUTH][system]
            at = rates.thresholds.index(MOUTH_AT)
            threshold, fpr = rates.fpr_at(0.98)
            rows.append(
                [
                    name,
                    LABELS[system],
                    cell(score.mse),
                    f"{cell(rates.tpr[at], 2)} / {cell(rates.fpr[at], 2)}",
                    f"{cell(fpr, 2)} at {cell(threshold, 1)} mm",
                    cell(score.hf_kept, 2),
                    cell(score.natural, 2),
                    cell(score.wild, 2),
                ]
            )
    titles = [
        "recipe",
        "system",
        "MSE",
        f"TPR / FPR at {MOUTH_AT:g} mm",
        "FPR from where TPR ≥ 0.98",
    ]
    more = ["energy above 4 Hz kept", "distance from natural motion", "the same, wild edit"]
    text = f"""# What changes to the paper's recipe do

Lower face, on the held-out takes. {_budget(setting)}

{markdown_table([*titles, *more], rows)}

## What the brows listen to

The paper does not say which controls feed the upper-face network.

{_brows(setting)}"""
    return setting.write("recipes", text)


def _brows(setting: Setting) -> str:
    rows = []
    for name, region in (
        ("eyelids alone", UPPER),
        ("all controls", replace(UPPER, controls=CONTROL_IDS)),
    ):
        systems = setting.train(f"Brows hear {name}", [region], setting.known, setting.settings())
        scores = {
            source: measure_systems(
                [p for p in setting.unseen if p.source == source], systems, setting.rig, [UPPER.id]
            ).regions[UPPER.id]
            for source in dict.fromkeys(p.source for p in setting.unseen)
        }
        for source, found in scores.items():
            rows.append([name, source, cell(found["regressor"].mse), cell(found["system"].mse)])
    titles = ["the upper face listens to", "tested on", "regressor, MSE", "full system, MSE"]
    return markdown_table(titles, rows)


def _budget(setting: Setting) -> str:
    return f"Networks of this experiment: {setting.epochs} passes over the data for each."


def _mouth_cells(figures: Figures) -> list[str]:
    rates = figures.closures[MOUTH]["system"]
    at = rates.thresholds.index(MOUTH_AT)
    score = figures.regions[LOWER.id]["system"]
    return [cell(score.mse), cell(rates.tpr[at], 2), cell(rates.fpr[at], 2)]


def _halves(
    takes: Sequence[Performance],
) -> tuple[list[Performance], list[Performance]]:
    """The first and the second half of each take."""
    cuts = [len(take.weights) // 2 for take in takes]
    pairs = list(zip(takes, cuts, strict=True))
    return (
        [replace(take, weights=take.weights[:cut]) for take, cut in pairs],
        [replace(take, weights=take.weights[cut:]) for take, cut in pairs],
    )


def _captured(takes: Sequence[Performance], region: Region) -> bool:
    columns = [ARKIT_INDEX[c] for c in region.channels]
    return any(bool(take.captured[columns].any()) for take in takes)
