"""The systems that are compared: regressor alone, full system, and the baseline."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.rig import Rig
from faceedit_app.lab.training.completion import TrainedCompletion
from faceedit_app.lab.training.holden import FOLDER
from faceedit_app.lab.training.model_files import TrainedRegion
from faceedit_app.networks.engine import ENDING, Engine, load_region

SYSTEMS = ("regressor", "system", "holden")


@dataclass(frozen=True)
class Systems:
    """Trained systems by region.

    Attributes:
        engine: regressor and full system; may lack regions, for experiments on some.
        baseline: the baseline; may be empty.
    """

    engine: Engine
    baseline: Engine = field(default_factory=lambda: Engine({}))

    @classmethod
    def load(cls, folder: Path, rig: Rig) -> Systems:
        """Read a folder of models; the baseline, if the folder has one.

        Raises:
            FileError: a model is missing or damaged, or for another character.
        """
        others = folder / FOLDER
        baseline = {
            region.id: load_region(others, region, rig)
            for region in REGIONS
            if (others / f"{region.id}{ENDING}").exists()
        }
        return cls(Engine.load(folder, rig), Engine(baseline))

    @classmethod
    def of(
        cls,
        *models: TrainedRegion,
        baseline: tuple[TrainedRegion, ...] = (),
        completions: tuple[TrainedCompletion, ...] = (),
    ) -> Systems:
        """Systems that were just trained."""
        ours, theirs = (
            Engine({one.description.region: one.answering() for one in some})
            for some in (models, baseline)
        )
        completing = {one.description.region: one.answering() for one in completions}
        return cls(replace(ours, completions=completing), theirs)

    def names(self, region: str) -> tuple[str, ...]:
        """The systems that know a region."""
        return SYSTEMS if region in self.baseline.models else SYSTEMS[:2]

    def answer(self, system: str, region: str, curves: Doubles) -> Doubles:
        """Curves (T, C) mm at 25 fps -> (T, K) weights of a region, not bounded."""
        if system == "holden":
            return self.baseline.answer(region, curves, 1.0)
        return self.engine.answer(region, curves, 1.0 if system == "system" else 0.0)
