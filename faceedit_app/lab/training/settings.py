"""Every number of the training, and the named recipes."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from typing import Any

# Passes of the completion network for each of the others, where their number is chosen.
COMPLETION_PASSES = 6


@dataclass(frozen=True)
class Variety:
    """How stretches of takes are altered in each epoch: other people, other trackers.

    Every weight vector has exact controls on the rig, so an altered performance is as good an
    example as a recorded one.

    Attributes:
        share: of the stretches; the others are played as recorded, or mirrored.
        tempo: slowest and fastest, 1 as recorded.
        gain: standard deviation of the logarithm of a gain common to all channels.
        channel_gain: the same of each channel (left and right alike).
        side_gain: the same of the difference between left and right.
        rest_share: share of the channels whose rest pose moves in a stretch.
        rest: mean size of that move; a quarter of the moves go down, where weights end at 0.
        drift: standard deviation of a slow swing of each channel.
        squint_share: share of the stretches seen by a tracker that sees squinting everywhere, as
            film trackers do.
        split_sides: share of the windows whose right half comes from another stretch, for winks
            and one-sided smiles, which almost never occur in takes.
    """

    share: float = 0.7
    tempo: tuple[float, float] = (0.75, 1.35)
    gain: float = 0.2
    channel_gain: float = 0.2
    side_gain: float = 0.05
    rest_share: float = 0.35
    rest: float = 0.05
    drift: float = 0.015
    squint_share: float = 0.15
    split_sides: float = 0.25


FEW = 2


@dataclass(frozen=True)
class TrainingSettings:
    """Every number of the training. Those of the paper are marked (P)."""

    window: int = 64  # frames at 25 fps (P)
    overlap: float = 0.75  # of neighbouring windows (P)
    held_out: float = 0.05  # share of five-second blocks kept for validation (P)
    batch: int = 32  # windows; 128 in the paper, on five times the data
    learning_rate: float = 1e-3  # Adam (P)
    final_rate: float | None = 0.02  # its share at the end of a cosine; None: decay as in (P) ...
    decay: float = 0.95  # ... by this factor (P) ...
    patience: int = 5  # ... after so many epochs in a row without improvement (P)
    epochs_regressor: int = 45
    epochs_autoencoder: int = 28
    epochs_completion: int = 48  # 0: requests are completed in closed form alone
    completion_widths: tuple[int, ...] = (16, 32, 64)
    l2: float = 1.0  # weight of the mean squared parameter (P)
    distance_loss: float = 1.0  # weight of the distance loss against the MSE (P) ...
    distance_loss_regressor: float = 0.5  # ... and with the regressor, 0 in the paper
    distance_unit_mm: float = 10.0  # distances enter in this unit
    near_mm: float = 2.0  # a distance this small ...
    near_weight: float = 8.0  # ... counts up to so much more: closures; 0 in the paper
    velocity_loss: float = 5.0  # of the squared error of the change per frame; 0 in the paper
    noise: float = 0.2  # share of control values set to salt or pepper (P) ...
    noisy_windows: float = 0.5  # ... in this share of the windows, 1 in the paper
    residual: bool = True  # the autoencoder starts as the identity; False in the paper
    adapt_statistics: bool = False  # of the frozen regressor to the noise; True in the paper
    architecture: str = "unet"  # key of `ARCHITECTURES`; a subclass of `Stacked`
    widths: tuple[int, ...] = (32, 64, 128)  # features at each time scale, finest first ...
    narrow_widths: tuple[int, ...] | None = None  # ... of regions that hear `FEW` controls or fewer
    activation: str = "silu"  # "elu" in the paper
    mirror: bool = True
    variety: Variety | None = dataclasses.field(default_factory=Variety)
    range_percentiles: tuple[float, float] = (0.05, 99.95)  # of each control, for `low`, `high`
    seed: int = 1

    def widths_for(self, controls: int) -> tuple[int, ...]:
        """The features at each time scale of networks that hear so many controls."""
        if self.narrow_widths is None or controls > FEW:
            return self.widths
        return self.narrow_widths

    def with_epochs(self, epochs: int) -> TrainingSettings:
        """The same with other numbers of passes over the data; completion, if any, needs more."""
        completion = COMPLETION_PASSES * epochs if self.epochs_completion else 0
        return dataclasses.replace(
            self,
            epochs_regressor=epochs,
            epochs_autoencoder=epochs,
            epochs_completion=completion,
        )


RECIPES: dict[str, TrainingSettings] = {
    "faceedit": TrainingSettings(narrow_widths=(16, 32, 64)),
    "paper": TrainingSettings(
        batch=128,
        final_rate=None,
        epochs_completion=0,
        distance_loss_regressor=0.0,
        near_weight=0.0,
        velocity_loss=0.0,
        noisy_windows=1.0,
        residual=False,
        adapt_statistics=True,
        activation="elu",
        variety=None,
    ),
}
"""`faceedit`: what ships. `paper`: Berson et al. 2019, section 3; mirrored, for we have less."""


def as_json(settings: TrainingSettings) -> dict[str, Any]:
    """The settings as plain JSON values, for model cards and checkpoints."""
    plain: dict[str, Any] = json.loads(json.dumps(dataclasses.asdict(settings)))
    return plain
