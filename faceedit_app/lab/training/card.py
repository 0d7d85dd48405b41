"""The model card: what the models were made of, and what they measure."""

from __future__ import annotations

import hashlib
import re
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from faceedit_app import __version__
from faceedit_app.lab.training.data import Performance
from faceedit_app.lab.training.fit import FittedRegion
from faceedit_app.lab.training.settings import TrainingSettings, as_json
from faceedit_app.networks.engine import ENDING

CARD = "README.md"
LICENCES = "licences.md"
DATA_TITLE = "## Data"
FIGURES_START = "<!-- figures: written by faceedit experiment -->"
FIGURES_END = "<!-- end of figures -->"
NO_FIGURES = "Not measured yet: `faceedit experiment card` writes them here."


def model_card(
    fitted: Sequence[FittedRegion],
    performances: Sequence[Performance],
    settings: TrainingSettings,
    folder: Path,
    command: str,
) -> str:
    """What the models were made of and what they measure, in Markdown.

    Args:
        folder: where the model files are.
        command: the command line that made them.
    """
    return f"""# The networks

Written by `faceedit train` of FaceEdit {__version__}. For each face region a regressor (controls to
blendshape weights) and a stacked denoising autoencoder, after Berson, Soladié, Barrielle and
Stoiber, "A Robust Interactive Facial Animation Editing System" (MIG 2019). One ONNX file for each
region; only the operators of its graph are executed. The folder `completion` holds a small
network for a region whose curves are completed where the take breaks off inside an edit. The folder
`holden`, if present, holds the baseline that the evaluation compares with; the application does
not read it.

They are made for the character {fitted[0].model.description.made_for.name}; FaceEdit refuses them
with another one.

They are meant for editing tracked facial animation on ARKit channels, at 25 frames per second
inside. They are not meant for recognising people or feelings, and have seen few people.

    {command}

The same takes and seed give the same networks on the same kind of processor; another one rounds
differently.

{DATA_TITLE}

| source | takes | seconds |
|---|---|---|
{_source_rows(performances)}

Channels that a source does not capture are left out of the loss.{_licences_text(folder)}

## Figures on people and trackers that were not trained on

{FIGURES_START}
{NO_FIGURES}
{FIGURES_END}

## Figures on blocks of the same takes that were not trained on

Mean squared weight error, and median absolute error of the controls in mm. This flatters: the
people are the same. Losses by epoch: [losses.svg](losses.svg).

| region | controls → channels | windows (an epoch / held out) | regressor | full system |
|---|---|---|---|---|
{_figure_rows(fitted)}
{_completion_text(fitted)}
## Settings

{_settings_list(settings)}

## Files (SHA-256)

{_hashes(folder)}
"""


def _source_rows(performances: Sequence[Performance]) -> str:
    seconds: dict[str, float] = defaultdict(float)
    takes: dict[str, int] = defaultdict(int)
    for take in performances:
        seconds[take.source] += take.seconds
        takes[take.source] += 1
    return "\n".join(f"| `{name}` | {takes[name]} | {seconds[name]:.0f} |" for name in seconds)


def _licences_text(folder: Path) -> str:
    if not (folder / LICENCES).exists():
        return ""
    return f" Who made the sources and their licences: [{LICENCES}]({LICENCES})."


def _figure_rows(fitted: Sequence[FittedRegion]) -> str:
    rows = []
    for result in fitted:
        made = result.model.description
        figures = [
            f"{result.mse[stage]:.4f}, {result.control_mm[stage]:.2f}"
            for stage in ("regressor", "system")
        ]
        cells = (
            made.region,
            f"{len(made.controls)} → {len(made.channels)}",
            f"{result.windows[0]} / {result.windows[1]}",
            *figures,
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def _settings_list(settings: TrainingSettings) -> str:
    return "\n".join(f"- {name}: {value}" for name, value in as_json(settings).items())


def _hashes(folder: Path) -> str:
    return "\n".join(
        f"    {hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder)}"
        for path in sorted(folder.rglob(f"*{ENDING}"))
    )


def _completion_text(fitted: Sequence[FittedRegion]) -> str:
    """What the completion networks measure, as a part of the card."""
    rows = [
        f"| {result.model.description.region} | "
        + " | ".join(f"{result.completion[name]:.3f}" for name in ("network", "kept", "around"))
        + " |"
        for result in fitted
        if result.completion is not None
    ]
    if not rows:
        return ""
    lines = "\n".join(rows)
    return f"""
Completion: edits of such blocks, half of which were damaged under the edit. Mean squared error of
the curves that were not asked for, in variances of the take's curves; as the network completes
them, and if every take were kept, or replaced by what is around the edit.

| region | network | kept | around |
|---|---|---|---|
{lines}
"""


def trained_sources(folder: Path) -> set[str]:
    """The names of the sources that a folder's models were trained on, by its card.

    Empty if there is no card.
    """
    path = folder / CARD
    if not path.is_file():
        return set()
    data = path.read_text(encoding="utf-8").partition(DATA_TITLE)[2].partition("\n## ")[0]
    return set(re.findall(r"^\| `([^`]+)` \|", data, re.MULTILINE))


def with_figures(card: str, figures: str) -> str:
    """The card with its held-out figures replaced."""
    if FIGURES_START not in card or FIGURES_END not in card:
        return card
    before, rest = card.split(FIGURES_START, 1)
    after = rest.split(FIGURES_END, 1)[1]
    return f"{before}{FIGURES_START}\n{figures.strip()}\n{FIGURES_END}{after}"
