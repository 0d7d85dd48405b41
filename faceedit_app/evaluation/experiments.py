"""The paper's experiments and ours, one function each; each writes one part of the report.

    faceedit experiment all --data DIR... --held-out DIR... -o docs/evaluation

`held-out` are takes that nothing is ever trained on. The shipped models answer where an
experiment does not need networks of its own; those it trains get `epochs` passes, which is less
than the shipped ones had.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import torch
from rich.progress import Progress

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.regions import CONTROL_IDS, REGIONS, Region
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.evaluation.evaluate import Figures, evaluate_takes, measure_systems
from faceedit_app.evaluation.report import (
    LABELS,
    NOTES,
    cell,
    closure_charts,
    closures_table,
    curve_charts,
    edits_table,
    kinds_table,
    make_folder,
    markdown_table,
    regions_table,
)
from faceedit_app.evaluation.robustness import robustness_part
from faceedit_app.evaluation.systems import Systems
from faceedit_app.formats.glb import read_rig
from faceedit_app.training.card import with_figures
from faceedit_app.training.charts import Line, chart
from faceedit_app.training.data import Performance, load_performances
from faceedit_app.training.examples import SYNTHETIC
from faceedit_app.training.fit import Epoch, fit_region
from faceedit_app.training.holden import fit_holden
from faceedit_app.training.run import CARD, THREADS
from faceedit_app.training.settings import RECIPES, FitSettings
from faceedit_app.training.sources import by_source
from faceedit_app.training.statistics import measure, spectrum, table

LOWER, UPPER, EYELIDS = REGIONS
MOUTH_AT, LIDS_AT = 2.0, 2.0  # mm, the stated threshold of detection in short tables


@dataclass
class Setting:
    """What experiments work with.

    Attributes:
        output: folder of the report.
        data: folders of takes to train on.
        held_out: folders of takes to measure on only.
        models: folder of the models that are measured.
        epochs: passes over the data for each network that is trained here.
        progress: where to show it.
    """

    output: Path
    data: tuple[Path, ...]
    held_out: tuple[Path, ...]
    models: Path
    epochs: int
    progress: Progress

    @cached_property
    def rig(self) -> Rig:
        """The character that distances are measured on."""
        return read_rig(shipped("assets/character.glb"))

    @cached_property
    def unseen(self) -> list[Performance]:
        """The takes to measure on."""
        if not self.held_out:
            raise FaceEditError("this experiment needs takes to measure on: --held-out DIR")
        return load_performances(self.held_out)

    @cached_property
    def known(self) -> list[Performance]:
        """The takes to train on: none that is held out."""
        if not self.data:
            raise FaceEditError("this experiment needs takes to train on: --data DIR")
        unseen = {p.name for p in self.unseen} if self.held_out else set()
        return [p for p in load_performances(self.data) if p.name not in unseen]

    @cached_property
    def figures(self) -> Figures:
        """The shipped models on the held-out takes."""
        bar = self.progress.add_task("Shipped models on held-out takes", total=None)
        figures = evaluate_takes(
            self.unseen,
            self.models,
            lambda done, of: self.progress.update(bar, completed=done, total=of),
        )
        self.progress.update(bar, visible=False)
        return figures

    def settings(self, recipe: str = "faceedit") -> FitSettings:
        """A recipe with the experiments' budget."""
        return replace(
            RECIPES[recipe], epochs_regressor=self.epochs, epochs_autoencoder=self.epochs
        )

    def train(
        self,
        label: str,
        regions: Sequence[Region],
        takes: Sequence[Performance],
        settings: FitSettings,
        baseline: bool = False,
    ) -> Systems:
        """Train some regions on some takes."""
        torch.set_num_threads(THREADS)
        total = (4 if baseline else 2) * self.epochs * len(regions)
        bar = self.progress.add_task(label, total=total)

        def report(epoch: Epoch) -> None:
            self.progress.update(bar, advance=1)

        distances = self.rig.arkit_distances
        models = [fit_region(r, takes, distances, settings, report).model for r in regions]
        others = (
            [fit_holden(r, takes, distances, settings, report)[0] for r in regions]
            if baseline
            else []
        )
        self.progress.update(bar, visible=False)
        if not self.progress.console.is_terminal:
            self.progress.console.print(f"trained: {label}")
        return Systems.of(*models, baseline=tuple(others))

    def write(self, name: str, text: str) -> Path:
        """Write one part of the report."""
        make_folder(self.output)
        path = self.output / f"{name}.md"
        write_atomically(path, (text.strip() + "\n").encode())
        return path


Experiment = Callable[[Setting], Path]


def held_out(setting: Setting) -> Path:
    """Everything about the shipped models on takes that they were not trained on."""
    figures = setting.figures
    make_folder(setting.output)
    parts = [
        "# The shipped models on held-out takes",
        f"{_takes_text(figures)} {NOTES}",
        regions_table(figures),
        closures_table(figures),
        *closure_charts(figures, setting.output),
        "## Edits",
        "Each take: a spike of one frame, a smile over the whole take, conflicting corners, a wild "
        "40 mm, and up to three lip closures and blinks, at places fixed by the take's name.",
        edits_table(figures.outcomes),
        "Preserve mode at naturalness 1, by kind of edit:",
        kinds_table(figures.outcomes),
    ]
    return setting.write("held-out", "\n\n".join(parts))


def table1(setting: Setting) -> Path:
    """The paper's Table 1: mean squared errors of the three systems."""
    figures = setting.figures
    paper = {"regressor": (0.0028, 0.0064), "holden": (0.004, 0.009), "system": (0.0082, 0.0086)}
    rows = [
        [
            LABELS[system],
            cell(figures.regions["lower"][system].mse),
            cell(figures.regions["eyelids"][system].mse),
            *(f"{value:.4f}" for value in paper[system]),
        ]
        for system in ("regressor", "holden", "system")
        if system in figures.regions["lower"]
    ]
    titles = ["", "lower face", "eyelids", "the paper: lower face", "eyelids"]
    text = f"""# Table 1: mean squared error

{_takes_text(figures)} The paper's numbers are on its own data and other channels, beside ours for
the proportions only.

{markdown_table(titles, rows)}"""
    return setting.write("table1", text)


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
            figures = measure_systems(sets[test][1], systems, setting.rig, ["lower"])
            rows.append([name, test, *_mouth_cells(figures)])
    titles = ["trained on", "tested on", "MSE", "TPR", "FPR"]
    text = f"""# Table 2: training on one source, testing on another

Full system, lower face, closures at {MOUTH_AT:g} mm. The sources stand in for the paper's two
databases. Of each source the later half of each take is kept for testing. {_budget(setting)}

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
            what = "mouth" if region is LOWER else "left_eyelid"
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


def robustness(setting: Setting) -> Path:
    """The paper's robustness figure: believable and unbelievable mouth openings in."""
    make_folder(setting.output)
    systems = Systems.load(setting.models)
    return setting.write("robustness", robustness_part(setting.unseen, systems, setting))


def oversmoothing(setting: Setting) -> Path:
    """The paper's curve figure: the baseline smooths, we do not."""
    figures = setting.figures
    make_folder(setting.output)
    rows = [
        [
            region,
            LABELS[system],
            cell(score.hf_kept, 2),
            cell(score.jerk_ratio, 2),
        ]
        for region, scores in figures.regions.items()
        for system, score in scores.items()
    ]
    text = "\n\n".join(
        [
            "# Over-smoothing",
            "Mouth opening of held-out takes: as tracked (dashed), and as each system gives it "
            "back from the controls.",
            *curve_charts(figures, setting.output),
            "Energy above 4 Hz, and jerk, by that of the takes:",
            markdown_table(["region", "system", "energy above 4 Hz kept", "jerk ratio"], rows),
        ]
    )
    return setting.write("oversmoothing", text)


def recipes(setting: Setting) -> Path:
    """What our changes to the paper's recipe do, one at a time, and which controls brows hear."""
    ours = setting.settings()
    assert ours.variety is not None
    variants: list[tuple[str, FitSettings]] = [
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
        figures = measure_systems(setting.unseen, systems, setting.rig, ["lower"])
        for system, score in figures.regions["lower"].items():
            rates = figures.closures["mouth"][system]
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
        ("eyelids", UPPER),
        ("all eight", replace(UPPER, controls=CONTROL_IDS)),
    ):
        systems = setting.train(f"Brows hear {name}", [region], setting.known, setting.settings())
        scores = {
            source: measure_systems(
                [p for p in setting.unseen if p.source == source], systems, setting.rig, ["upper"]
            ).regions["upper"]
            for source in dict.fromkeys(p.source for p in setting.unseen)
        }
        for source, found in scores.items():
            rows.append([name, source, cell(found["regressor"].mse), cell(found["system"].mse)])
    titles = ["the upper face hears", "tested on", "regressor, MSE", "full system, MSE"]
    return markdown_table(titles, rows)


def statistics(setting: Setting) -> Path:
    """Synthesised takes beside real ones: figures and spectrum."""
    takes = by_source([*setting.data, *setting.held_out])
    figures = {name: measure(some) for name, some in takes.items()}
    lines = [
        Line(name, *(values.tolist() for values in spectrum(some))) for name, some in takes.items()
    ]
    make_folder(setting.output)
    text = chart("Spectrum of the mouth", "Hz", "share of the variance per Hz", lines, log_y=True)
    write_atomically(setting.output / "spectrum.svg", text.encode())
    return setting.write(
        "statistics",
        f"""# Synthesised and recorded performances

Measured at 25 frames a second, by source. A dash: the source does not capture it, or never does
it. `synthetic` is what `faceedit synthesize` writes; no person was recorded for it.

```
{table(figures).rstrip()}
```

![Spectrum of the mouth](spectrum.svg)""",
    )


def card(setting: Setting) -> Path:
    """Write the held-out figures into the model card, reached or not."""
    from faceedit_app.evaluation.goals import goals_part

    path = setting.models / CARD
    text = with_figures(path.read_text(encoding="utf-8"), goals_part(setting.figures))
    write_atomically(path, text.encode())
    return path


EXPERIMENTS: dict[str, Experiment] = {
    "statistics": statistics,
    "held-out": held_out,
    "card": card,
    "table1": table1,
    "oversmoothing": oversmoothing,
    "robustness": robustness,
    "leave-one-out": leave_one_out,
    "table2": table2,
    "recipes": recipes,
}


def run_experiment(name: str, setting: Setting) -> Iterator[Path]:
    """Run one experiment, or all; yields each part of the report as it is written.

    Raises:
        FaceEditError: there is no such experiment, or it lacks takes.
    """
    if name not in EXPERIMENTS and name != "all":
        raise FaceEditError(f"no experiment {name!r}; there are {', '.join(EXPERIMENTS)} and all")
    for some in EXPERIMENTS if name == "all" else [name]:
        yield EXPERIMENTS[some](setting)
        yield _index(setting)


def _index(setting: Setting) -> Path:
    """The report's first page: its parts, by their titles."""
    make_folder(setting.output)
    parts = [setting.output / f"{name}.md" for name in EXPERIMENTS]
    links = [
        f"- [{path.read_text(encoding='utf-8').splitlines()[0].lstrip('# ')}]({path.name})"
        for path in parts
        if path.exists()
    ]
    text = "\n".join(
        [
            "# Evaluation",
            "",
            "Written by `faceedit experiment`; each part can be written again on its own.",
            "",
            *links,
        ]
    )
    path = setting.output / "README.md"
    write_atomically(path, f"{text}\n".encode())
    return path


def _takes_text(figures: Figures) -> str:
    seconds: dict[str, float] = {}
    for _, source, length in figures.takes:
        seconds[source] = seconds.get(source, 0.0) + length
    parts = [f"`{name}` ({length:.0f} s)" for name, length in seconds.items()]
    return f"Held out, never trained on: {', '.join(parts)}."


def _budget(setting: Setting) -> str:
    return f"Networks of this experiment: {setting.epochs} passes over the data for each."


def _mouth_cells(figures: Figures) -> list[str]:
    rates = figures.closures["mouth"]["system"]
    at = rates.thresholds.index(MOUTH_AT)
    score = figures.regions["lower"]["system"]
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
    from faceedit_app.core.arkit import ARKIT_INDEX

    columns = [ARKIT_INDEX[c] for c in region.channels]
    return bool(np.any([take.captured[columns].any() for take in takes]))
