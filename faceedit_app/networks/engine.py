"""The engine: answers edits by the networks of all regions, in process, on the CPU."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path

import numpy as np

from faceedit_app.core import on_disk
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.rig import Rig
from faceedit_app.networks.completion import FOLDER, CompletionNetwork, read_completion
from faceedit_app.networks.made_for import MadeFor
from faceedit_app.networks.region import RegionAnswer, read_region

ENDING = ".onnx"
CORES = os.cpu_count() or 1
Work = Callable[[], list[Floats]]
PATIENCE = 0.0015  # seconds to wait for another thread; a region takes about one millisecond


def load_region(folder: Path, region: Region, rig: Rig) -> RegionAnswer:
    """Read a region's networks from a folder.

    Raises:
        FileError: the file is missing or not a model, or was made for another character.
    """
    path = folder / f"{region.id}{ENDING}"
    model = read_region(path)
    about = model.description
    if about.region != region.id:
        raise FileError(path, f"holds the region {about.region!r}", "restore the models")
    if about.channels != region.channels:  # in the same order
        raise FileError(path, "answers other channels", "train the models again")
    _check_character(path, about.made_for, rig)
    return model


def load_completion(folder: Path, region: Region, rig: Rig) -> CompletionNetwork | None:
    """Read a region's completion network from a folder of models; None if there is none.

    It may be for other curves than the region has by now; no request is then completed.

    Raises:
        FileError: the file is not a model, or was made for another character.
    """
    path = folder / FOLDER / f"{region.id}{ENDING}"
    if not on_disk.exists(path):
        return None
    network = read_completion(path)
    about = network.description
    if about.region != region.id:
        raise FileError(path, f"holds the region {about.region!r}", "restore the models")
    _check_character(path, about.made_for, rig)
    return network


def _check_character(path: Path, made_for: MadeFor, rig: Rig) -> None:
    if difference := made_for.difference(rig):
        raise FileError(
            path,
            f"was made for another character, {made_for.name!r}: {difference}",
            "use that character, or a model made for this one",
        )


@cache
def _helpers() -> ThreadPoolExecutor:
    """The threads beside the calling one."""
    return ThreadPoolExecutor(min(CORES, len(REGIONS)) - 1, thread_name_prefix="networks")


def _begun(work: Mapping[str, Work]) -> dict[str, Work]:
    """The same calls, which other threads begin meanwhile."""
    if CORES == 1:
        return dict(work)
    return {name: partial(_result, _helpers().submit(part), part) for name, part in work.items()}


def _result(other: Future[list[Floats]], part: Work) -> list[Floats]:
    """What another thread computes, or the same computed here: if that is late, or not begun."""
    if not other.cancel():
        with suppress(TimeoutError):
            return other.result(PATIENCE)
    return part()


@dataclass(frozen=True)
class Engine:
    """Trained networks for each region, keyed by `Region.id`.

    Attributes:
        models: what answers curves.
        completions: what completes requests, in regions that have such a network.
    """

    models: dict[str, RegionAnswer]
    completions: dict[str, CompletionNetwork] = field(default_factory=dict)

    @classmethod
    def load(cls, folder: Path | str, rig: Rig) -> Engine:
        """Read `REGION.onnx` for each region from a folder, and what completes requests.

        Raises:
            FileError: a file is missing or not a model, or was made for another character.
        """
        folder = Path(folder)
        models = {region.id: load_region(folder, region, rig) for region in REGIONS}
        completions = ((r.id, load_completion(folder, r, rig)) for r in REGIONS)
        return cls(models, {name: network for name, network in completions if network})

    @property
    def scale(self) -> int:
        """Input must begin and end at multiples of this many grid frames."""
        return max(model.description.scale for model in self.models.values())

    @property
    def context(self) -> int:
        """Grid frames on either side that an answer depends on."""
        most = max(model.description.context for model in self.models.values())
        return -(-most // self.scale) * self.scale

    def answer(self, region: str, curves: Doubles, naturalness: float) -> Doubles:
        """Answer curves with a region's weights.

        The answer depends only on the curves that the region listens to and on their length: not
        on other regions or earlier answers.

        Args:
            region: `Region.id`.
            curves: (N, C) mm of all controls at 25 fps; N any length.
            naturalness: 0 = the regressor alone, 1 = regressor and autoencoder.

        Returns:
            (N, K) weights of the region's channels, not limited to 0..1.
        """
        return self.answers((region,), curves, naturalness)[region]

    def answers(
        self, regions: Sequence[str], curves: Doubles, naturalness: float
    ) -> dict[str, Doubles]:
        """(N, K) weights of several regions, by region; see `begin`."""
        begun = self.begin(regions, curves, naturalness)
        return {region: answer() for region, answer in begun.items()}

    def begin(
        self, regions: Sequence[str], curves: Doubles, naturalness: float
    ) -> dict[str, Callable[[], Doubles]]:
        """Begin to answer several regions, side by side on the cores that there are.

        Each region's networks run on one thread, so the answers have the same bits on any number
        of cores. What another core has not begun, or does not finish soon, is computed by the
        caller's thread: cores that other programs keep busy cost little.

        Args:
            regions: `Region.id`s, in the order in which the answers will be needed.
            curves, naturalness: see `answer`.

        Returns:
            By region, what waits for (N, K) weights. Each is called once.
        """
        if not regions:
            return {}
        # Other threads only run the networks: every other line would make this one wait for them.
        work: dict[str, Work] = {}
        for name in regions:
            model = self.models[name]
            heard = _padded(curves[:, model.columns], model.description.scale)
            work[name] = partial(model.run, heard, naturalness)
        begun = _begun(work)

        def answer(name: str) -> Doubles:
            found = self.models[name].answer(begun[name](), naturalness)
            return found[: len(curves)].astype(np.float64, order="F")

        return {name: partial(answer, name) for name in regions}


def _padded(curves: Doubles, scale: int) -> Floats:
    """(M, C) float32: curves (N, C), whose last frame is repeated up to a multiple of `scale`."""
    heard = curves.astype(np.float32, order="C")
    if missing := -len(heard) % scale:
        heard = np.concatenate([heard, np.repeat(heard[-1:], missing, axis=0)])
    return heard
