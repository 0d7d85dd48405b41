"""The systems that are compared: regressor alone, full system, and the baseline."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import REGIONS
from faceedit_app.lab.training.holden import FOLDER, HoldenModel, load_holden
from faceedit_app.lab.training.model_files import RegionModel, as_file
from faceedit_app.networks.engine import Engine
from faceedit_app.networks.inference import RegionAnswer

SYSTEMS = ("regressor", "system", "holden")


@dataclass(frozen=True)
class Systems:
    """Trained systems by region.

    Attributes:
        engine: regressor and full system; may lack regions, for experiments on some.
        baseline: the baseline; may be empty.
    """

    engine: Engine
    baseline: dict[str, HoldenModel] = field(default_factory=dict)

    @classmethod
    def load(cls, folder: Path) -> Systems:
        """Read a folder of models; the baseline, if the folder has one.

        Raises:
            FileError: a model is missing or damaged.
        """
        engine, baseline = Engine.load(folder), {}
        for region in REGIONS:
            path = folder / FOLDER / f"{region.id}.safetensors"
            if path.exists():
                baseline[region.id] = load_holden(path)
                if baseline[region.id].channels != region.channels:
                    raise FileError(path, "answers other channels", "train the models again")
        return cls(engine, baseline)

    @classmethod
    def of(cls, *models: RegionModel, baseline: tuple[HoldenModel, ...] = ()) -> Systems:
        """Systems that were just trained."""
        engine = Engine({m.region: RegionAnswer(as_file(m)) for m in models})
        return cls(engine, {m.region: m for m in baseline})

    def names(self, region: str) -> tuple[str, ...]:
        """The systems that know a region."""
        return SYSTEMS if region in self.baseline else SYSTEMS[:2]

    def answer(self, system: str, region: str, curves: Doubles) -> Doubles:
        """Curves (T, C) mm at 25 fps -> (T, K) weights of a region, not bounded."""
        if system == "holden":
            return self.baseline[region].answer(curves)
        answers = self.engine.answer(region, curves[None], 1.0 if system == "system" else 0.0)
        weights: Doubles = answers[0]
        return weights
