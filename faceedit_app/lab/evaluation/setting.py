"""What experiments work with: takes, models, a budget, a folder for the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import torch
from rich.progress import Progress

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.rig import Rig
from faceedit_app.editing.opening import shipped_rig
from faceedit_app.lab.evaluation.evaluate import Figures, evaluate_networks
from faceedit_app.lab.evaluation.people.figures import PeopleFigures, measure_people
from faceedit_app.lab.evaluation.people.references import captures_all_regions
from faceedit_app.lab.evaluation.people.sources import of_people
from faceedit_app.lab.evaluation.report import make_folder
from faceedit_app.lab.evaluation.systems import Systems
from faceedit_app.lab.training.card import trained_sources
from faceedit_app.lab.training.completion import fit_completion, is_completed
from faceedit_app.lab.training.data import Performance, load_performances
from faceedit_app.lab.training.fit import Epoch, fit_region
from faceedit_app.lab.training.holden import fit_holden
from faceedit_app.lab.training.run import THREADS
from faceedit_app.lab.training.settings import COMPLETION_PASSES, RECIPES, TrainingSettings


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
        return shipped_rig()

    @cached_property
    def unseen(self) -> list[Performance]:
        """The takes to measure on: those of people."""
        if not self.held_out:
            raise FaceEditError("this experiment needs takes to measure on: --held-out DIR")
        people = of_people(load_performances(self.held_out))
        if not people:
            raise FaceEditError("all takes of --held-out are synthesised; name takes of people")
        return people

    @cached_property
    def known(self) -> list[Performance]:
        """The takes to train on: none that is held out."""
        if not self.data:
            raise FaceEditError("this experiment needs takes to train on: --data DIR")
        unseen = {p.name for p in self.unseen} if self.held_out else set()
        return [p for p in load_performances(self.data) if p.name not in unseen]

    @cached_property
    def figures(self) -> Figures:
        """The shipped models on the held-out takes, on their own."""
        bar = self.progress.add_task("Shipped models on held-out takes", total=None)
        figures = evaluate_networks(
            self.unseen,
            self.models,
            lambda done, of: self.progress.update(bar, completed=done, total=of),
        )
        self.progress.update(bar, visible=False)
        return figures

    @cached_property
    def people(self) -> PeopleFigures:
        """What users get on all takes of people, each source by networks that never saw it.

        The shipped models answer sources that they were not trained on; for the others, networks
        are trained here on everything else. Where what is left lacks a region, the shipped models
        answer, and the figures say so.
        """
        learnable = self.known if self.data else []
        takes = [*learnable, *(self.unseen if self.held_out else ())]
        shipped_models = Systems.load(self.models, self.rig)
        known = trained_sources(self.models)
        retrained: list[str] = []

        def systems_for(source: str) -> Systems:
            rest = [take for take in learnable if take.source != source]
            if source not in known or not captures_all_regions(rest):
                return shipped_models
            retrained.append(source)
            return self.train(f"Without {source}", REGIONS, rest, self.settings(), baseline=True)

        bar = self.progress.add_task("People", total=None)
        figures = measure_people(
            takes,
            self.rig,
            systems_for,
            known,
            lambda done, of: self.progress.update(bar, completed=done, total=of),
        )
        self.progress.update(bar, visible=False)
        figures.sources = [
            replace(source, trained_on=source.trained_on and source.name not in retrained)
            for source in figures.sources
        ]
        if retrained:
            names = " and ".join(f"`{name}`" for name in retrained)
            passes = "1 pass" if self.epochs == 1 else f"{self.epochs} passes"
            figures.notes.append(
                f"{names}: answered by networks that were trained here on everything else, with "
                f"{passes} over the data for each, and {COMPLETION_PASSES} times as many for "
                "completion; the shipped ones had more"
            )
        return figures

    def settings(self, recipe: str = "faceedit") -> TrainingSettings:
        """A recipe with the experiments' budget."""
        return RECIPES[recipe].with_epochs(self.epochs)

    def train(
        self,
        label: str,
        regions: Sequence[Region],
        takes: Sequence[Performance],
        settings: TrainingSettings,
        baseline: bool = False,
    ) -> Systems:
        """Train some regions on some takes."""
        torch.set_num_threads(THREADS)
        total = (4 if baseline else 2) * self.epochs * len(regions)
        total += settings.epochs_completion * sum(map(is_completed, regions))
        bar = self.progress.add_task(label, total=total)

        def report(epoch: Epoch) -> None:
            self.progress.update(bar, advance=1)

        regions = [self.rig.measures(region) for region in regions]
        models = [fit_region(r, takes, self.rig, settings, report).model for r in regions]
        others = (
            [fit_holden(r, takes, self.rig, settings, report)[0] for r in regions]
            if baseline
            else []
        )
        found = (fit_completion(r, takes, self.rig, settings, report) for r in regions)
        completions = tuple(each for each in found if each is not None)
        self.progress.update(bar, visible=False)
        if not self.progress.console.is_terminal:
            self.progress.console.print(f"trained: {label}")
        return Systems.of(*models, baseline=tuple(others), completions=completions)

    def write(self, name: str, text: str) -> Path:
        """Write one part of the report."""
        make_folder(self.output)
        path = self.output / f"{name}.md"
        write_atomically(path, (text.strip() + "\n").encode())
        return path
