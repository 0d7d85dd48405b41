"""The whole training: takes in, a folder of models with a model card out."""

from __future__ import annotations

import dataclasses
import hashlib
import os
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import torch
from rich.progress import Progress

from faceedit_app import __version__
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resources import shipped
from faceedit_app.formats.glb import read_rig
from faceedit_app.formats.opening import open_take
from faceedit_app.networks.store import save_model
from faceedit_app.training.data import Performance, load_performances
from faceedit_app.training.fit import Epoch, FitSettings, Fitted, fit_region
from faceedit_app.training.statistics import Take, measure, table

CARD = "README.md"
LICENCES = "licences.md"
LOG_EVERY = 5  # epochs, where no progress bar can be drawn


def train_models(
    folders: Sequence[Path],
    output: Path,
    exclude: Sequence[str],
    epochs: int | None,
    seed: int,
    progress: Progress,
) -> Iterator[Path]:
    """Train the networks of each region; yields each file as it is written.

    Raises:
        FileError: a folder holds no take, or the output cannot be written.
    """
    torch.set_num_threads(os.cpu_count() or 1)
    settings = FitSettings(seed=seed)
    if epochs is not None:
        settings = dataclasses.replace(settings, epochs_regressor=epochs, epochs_autoencoder=epochs)
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(output, "cannot be made", "choose another folder") from error
    performances = load_performances(folders, exclude)
    distances = read_rig(shipped("assets/character.glb")).arkit_distances
    fitted = []
    for region in REGIONS:
        total = settings.epochs_regressor + settings.epochs_autoencoder
        bar = progress.add_task(region.label, total=total)

        def report(epoch: Epoch, bar: object = bar, label: str = region.label) -> None:
            text = f"{label}: {epoch.stage}, held-out loss {epoch.validation:.5f}"
            progress.update(bar, advance=1, description=text)  # type: ignore[arg-type]
            if not progress.console.is_terminal and epoch.number % LOG_EVERY == 0:
                progress.console.print(f"{text}, epoch {epoch.number} of {epoch.of}")

        result = fit_region(region, performances, distances, settings, report)
        path = output / f"{region.id}.safetensors"
        save_model(path, result.model)
        fitted.append(result)
        yield path
    card = output / CARD
    write_atomically(card, model_card(fitted, performances, settings, output).encode())
    yield card


def model_card(
    fitted: Sequence[Fitted],
    performances: Sequence[Performance],
    settings: FitSettings,
    folder: Path,
) -> str:
    """What the models were made of and what they measure, in Markdown."""
    seconds: dict[str, float] = defaultdict(float)
    for take in performances:
        seconds[take.source] += take.seconds
    sources = "\n".join(f"| `{name}` | {length:.0f} |" for name, length in seconds.items())
    figures = "\n".join(
        f"| {result.model.region} | {len(result.model.controls)} → {len(result.model.channels)} | "
        f"{result.windows[0]} / {result.windows[1]} | "
        + " | ".join(
            f"{result.mse[k]:.4f}, {result.control_mm[k]:.2f}" for k in ("regressor", "system")
        )
        + " |"
        for result in fitted
    )
    hashes = "\n".join(
        f"    {hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}"
        for path in sorted(folder.glob("*.safetensors"))
    )
    numbers = "\n".join(
        f"- {name}: {value}" for name, value in dataclasses.asdict(settings).items()
    )
    return f"""# The networks

Written by `faceedit train` of FaceEdit {__version__}. For each face region a regressor (controls to
blendshape weights) and a stacked denoising autoencoder, after Berson, Soladié, Barrielle and
Stoiber, "A Robust Interactive Facial Animation Editing System" (MIG 2019); the autoencoder is
residual. One safetensors file a region; nothing in it is ever executed.

They are meant for editing tracked facial animation on ARKit channels, at 25 frames per second
inside. They are not meant for recognising people or feelings, and have seen few people.

## Data

| source | seconds |
|---|---|
{sources}

Each window is mirrored; part of the windows is added again with the two sides of the face taken
from different takes, or played stronger or weaker. Channels that a source does not capture are
left out of the loss. Who made the sources and their licences: [{LICENCES}]({LICENCES}).

## Held-out figures

Mean squared weight error, and median absolute error of the controls in mm, on blocks of the same
takes that were not trained on. This flatters: the people are the same.

| region | controls → channels | windows (trained / held out) | regressor | full system |
|---|---|---|---|---|
{figures}

## Settings

{numbers}

## Files (SHA-256)

{hashes}
"""


def statistics_of(folders: Sequence[Path]) -> str:
    """A table of the figures of `statistics.measure`, one column for each source.

    Raises:
        FileError: a folder holds no take, or no take of a second.
    """
    takes: dict[str, list[Take]] = defaultdict(list)
    for folder in folders:
        paths = sorted(folder.rglob("*.csv")) if folder.is_dir() else [folder]
        if not paths:
            raise FileError(folder, "holds no take (*.csv)", "name a folder of takes")
        for path in paths:
            clip = open_take(path).clip
            source = path.stem.split("__")[0] if "__" in path.stem else path.parent.name
            takes[source].append((clip.times, clip.arkit_weights().astype(np.float32)))
    try:
        return table({name: measure(some) for name, some in takes.items()})
    except ValueError as error:
        raise FileError(folders[0], str(error), "name longer takes") from error
