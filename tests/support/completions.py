"""Completion networks for tests: one that answers what a test wants, and random ones as files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.regions import LOWER, Region
from faceedit_app.core.rig import Rig
from faceedit_app.networks.completion import FEATURES, CompletionDescription, CompletionNetwork
from faceedit_app.networks.made_for import MadeFor
from support.networks import SCALE, as_model, random_graph

COUNT = len(LOWER.own)


def completion_description(region: Region, rig: Rig) -> CompletionDescription:
    """That of a random network."""
    return CompletionDescription(
        region=region.id,
        controls=region.own,
        made_for=MadeFor.of(rig, region.own),
        architecture={"name": "random"},
        scale=SCALE,
    )


def random_completion(
    region: Region, rig: Rig, seed: int = 0, about: CompletionDescription | None = None
) -> bytes:
    """The content of a file with a random network; what it answers is nonsense."""
    count = len(region.own)
    about = about or completion_description(region, rig)
    graph = random_graph(FEATURES * count, 1 + count, seed)
    content: bytes = as_model(graph, about.to_json()).SerializeToString()
    return content


class Answering(CompletionNetwork):
    """Answers the same share everywhere, and keeps what it was asked.

    Args:
        share: in 0..1, how far the take gives way to what is around.
        further: standard deviations, of every curve.
    """

    def __init__(self, share: float, further: float = 0.0, rig: Rig | None = None) -> None:
        self._share, self._further = share, further
        self.seen: list[Doubles] = []
        if rig is not None:
            self.description = completion_description(LOWER, rig)

    def __call__(self, features: Doubles) -> tuple[Doubles, Doubles]:
        """See `CompletionNetwork`."""
        self.seen.append(features)
        length, count = len(features), features.shape[1] // FEATURES
        return np.full(length, self._share), np.full((length, count), self._further)


def write_completion(folder: Path, rig: Rig, seed: int = 0) -> Path:
    """A random network as the completion of the lower face in a folder of models."""
    path = folder / "completion" / f"{LOWER.id}.onnx"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(random_completion(LOWER, rig, seed))
    return path
