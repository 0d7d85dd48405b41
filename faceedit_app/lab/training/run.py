"""The whole training: from takes to a folder of models with a model card."""

from __future__ import annotations

import dataclasses
import shlex
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import torch
from rich.progress import Progress

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.rig import Rig
from faceedit_app.editing.opening import shipped_rig
from faceedit_app.lab.training.card import CARD, model_card
from faceedit_app.lab.training.charts import Line, chart
from faceedit_app.lab.training.completion import fit_completion, is_completed, save_completion
from faceedit_app.lab.training.data import Performance, load_performances
from faceedit_app.lab.training.fit import Epoch, FittedRegion, fit_region
from faceedit_app.lab.training.holden import FOLDER, fit_holden
from faceedit_app.lab.training.loop import History
from faceedit_app.lab.training.model_files import TrainedRegion, load_trained, save_trained
from faceedit_app.lab.training.processes import Processes
from faceedit_app.lab.training.settings import RECIPES, TrainingSettings
from faceedit_app.networks.completion import FOLDER as FOLDER_OF_COMPLETION
from faceedit_app.networks.engine import ENDING

LOSSES = "losses.svg"
CHECKPOINTS = "checkpoint"
LOG_EVERY = 5  # epochs, where no progress bar can be drawn

# So that the same data and seed give the same networks on one core or many. It is also as fast:
# on networks this small, threads wait for each other.
THREADS = 1

# Fine-tuning: fewer epochs, smaller steps.
FINETUNE_EPOCHS = 15
FINETUNE_RATE = 0.2  # of the recipe's

Report = Callable[[Epoch], None]


@dataclass(frozen=True)
class TrainingPlan:
    """What to train.

    Attributes:
        folders: folders of takes, or takes.
        output: folder for the models.
        exclude: file name patterns to leave out.
        recipe: key of `RECIPES`.
        epochs: passes over the data for each network; the recipe's if None.
        seed: same seed, same data: same networks.
        finetune: start from these models.
        baseline: train the baseline of the evaluation as well.
        fresh: do not resume an interrupted training in `output`.
    """

    folders: tuple[Path, ...]
    output: Path
    exclude: tuple[str, ...] = ()
    recipe: str = "faceedit"
    epochs: int | None = None
    seed: int = 1
    finetune: Path | None = None
    baseline: bool = True
    fresh: bool = False

    @property
    def settings(self) -> TrainingSettings:
        """The recipe with what the plan changes.

        Raises:
            FaceEditError: there is no such recipe.
        """
        if self.recipe not in RECIPES:
            raise FaceEditError(f"--recipe {self.recipe}: must be {' or '.join(RECIPES)}")
        settings = dataclasses.replace(RECIPES[self.recipe], seed=self.seed)
        if self.finetune is not None:
            settings = dataclasses.replace(
                settings,
                learning_rate=FINETUNE_RATE * settings.learning_rate,
                epochs_regressor=FINETUNE_EPOCHS,
                epochs_autoencoder=FINETUNE_EPOCHS,
                epochs_completion=0,
            )
        if self.epochs is not None:
            settings = settings.with_epochs(self.epochs)
        return settings

    @property
    def command(self) -> str:
        """The command line of this plan, folders by their last name."""
        words = ["faceedit train"]
        words += [f"--data {folder.name}" for folder in self.folders]
        words += [f"--exclude {shlex.quote(pattern)}" for pattern in self.exclude]
        words += [f"-o {self.output.name}", f"--recipe {self.recipe}", f"--seed {self.seed}"]
        if self.epochs is not None:
            words.append(f"--epochs {self.epochs}")
        if self.finetune is not None:
            words.append(f"--finetune --models {self.finetune.name}")
        if not self.baseline:
            words.append("--no-baseline")
        return " ".join(words)


def train_models(
    plan: TrainingPlan, progress: Progress, shared: Processes | None = None
) -> Iterator[Path]:
    """Train the networks of each region; yields each file as it is written.

    The state of each epoch is kept in the folder `checkpoint` of the output until training ends:
    the same command resumes it. Ctrl+C writes the best networks so far of the region
    that is being trained.

    Args:
        shared: the processes that share the work; each yields what it wrote itself.

    Raises:
        FileError: a folder holds no take, or the output cannot be written.
        KeyboardInterrupt: the user stopped the training; what was written is usable.
    """
    torch.set_num_threads(THREADS)
    shared = shared or Processes()
    settings = plan.settings
    begin = _beginnings(plan.finetune)
    performances = load_performances(plan.folders, plan.exclude)
    _make_folders(plan)
    rig = shipped_rig()
    mine = _Trained()
    for number, region in enumerate(map(rig.measures, REGIONS)):
        report = _reporter(progress, region.label, _epochs(settings, region, plan.baseline))
        work = _Work(region, performances, rig, settings, report, plan.output)
        if shared.takes(number):
            mine.fitted.append(work.networks(begin.get(region.id)))
            yield plan.output / f"{region.id}{ENDING}"
            if mine.fitted[-1].stopped:
                raise KeyboardInterrupt
            if path := work.completion(plan.finetune, mine.fitted[-1]):
                yield path
                if mine.fitted[-1].stopped:
                    raise KeyboardInterrupt
        if plan.baseline and shared.takes(len(REGIONS) + number):
            histories = mine.baselines[region.id] = work.baseline()
            yield plan.output / FOLDER / f"{region.id}{ENDING}"
            if any(history.stopped for history in histories.values()):
                raise KeyboardInterrupt
    parts = shared.gather(mine)
    if shared.number:
        return
    fitted = _joined(parts)
    chart_file = plan.output / LOSSES
    write_atomically(chart_file, losses_chart(fitted).encode())
    yield chart_file
    card = plan.output / CARD
    text = model_card(fitted, performances, settings, plan.output, plan.command)
    write_atomically(card, text.encode())
    yield card
    shutil.rmtree(plan.output / CHECKPOINTS, ignore_errors=True)


def _make_folders(plan: TrainingPlan) -> None:
    checkpoints = plan.output / CHECKPOINTS
    try:
        if plan.fresh:
            shutil.rmtree(checkpoints, ignore_errors=True)
        checkpoints.mkdir(parents=True, exist_ok=True)
        if plan.baseline:
            (plan.output / FOLDER).mkdir(exist_ok=True)
        if plan.settings.epochs_completion or plan.finetune is not None:
            (plan.output / FOLDER_OF_COMPLETION).mkdir(exist_ok=True)
    except OSError as error:
        raise FileError(plan.output, "cannot be made", "choose another folder") from error


@dataclass
class _Trained:
    """What one process has trained: networks, and the losses of baselines by region."""

    fitted: list[FittedRegion] = dataclasses.field(default_factory=list)
    baselines: dict[str, dict[str, History]] = dataclasses.field(default_factory=dict)


def _joined(parts: Sequence[_Trained]) -> list[FittedRegion]:
    """All networks in the order of the regions, with the losses of their baselines."""
    fitted = {one.model.description.region: one for part in parts for one in part.fitted}
    for part in parts:
        for region, histories in part.baselines.items():
            fitted[region].histories.update(histories)
    return [fitted[region.id] for region in REGIONS]


@dataclass(frozen=True)
class _Work:
    """The training of one region."""

    region: Region
    performances: Sequence[Performance]
    rig: Rig
    settings: TrainingSettings
    report: Report
    output: Path

    def networks(self, start: TrainedRegion | None) -> FittedRegion:
        """Train and save the networks, from others or from scratch."""
        result = fit_region(*self._what, self.report, start, self.output / CHECKPOINTS)
        save_trained(self.output / f"{self.region.id}{ENDING}", result.model)
        return result

    def completion(self, begin: Path | None, fitted: FittedRegion) -> Path | None:
        """Train and save the network that completes requests; fine-tuning takes it over.

        What its training says is added to `fitted`.

        Returns:
            Its file; None if the region has none.
        """
        place = Path(FOLDER_OF_COMPLETION) / f"{self.region.id}{ENDING}"
        path = self.output / place
        if begin is not None:
            if not (begin / place).exists():
                return None
            write_atomically(path, (begin / place).read_bytes())
            return path
        trained = fit_completion(*self._what, self.report, self.output / CHECKPOINTS)
        if trained is None:
            return None
        save_completion(path, trained)
        fitted.completion = trained.errors
        fitted.histories["completion"] = trained.history
        fitted.stopped |= trained.history.stopped
        return path

    def baseline(self) -> dict[str, History]:
        """Train and save the baseline."""
        model, histories = fit_holden(*self._what, self.report, self.output / CHECKPOINTS)
        save_trained(self.output / FOLDER / f"{self.region.id}{ENDING}", model)
        return histories

    @property
    def _what(self) -> tuple[Region, Sequence[Performance], Rig, TrainingSettings]:
        return self.region, self.performances, self.rig, self.settings


def _beginnings(folder: Path | None) -> dict[str, TrainedRegion]:
    if folder is None:
        return {}
    return {r.id: load_trained(folder / f"{r.id}{ENDING}") for r in REGIONS}


def _epochs(settings: TrainingSettings, region: Region, baseline: bool) -> int:
    once = settings.epochs_regressor + settings.epochs_autoencoder
    completion = settings.epochs_completion if is_completed(region) else 0
    return once * (2 if baseline else 1) + completion


def _reporter(progress: Progress, label: str, total: int) -> Report:
    bar = progress.add_task(label, total=total)

    def report(epoch: Epoch) -> None:
        text = f"{label}: {epoch.stage}, held-out loss {epoch.validation:.5f}"
        progress.update(bar, advance=1, description=text)
        if not progress.console.is_terminal and epoch.number % LOG_EVERY == 0:
            progress.console.print(f"{text}, epoch {epoch.number} of {epoch.of}")

    return report


def losses_chart(fitted: Sequence[FittedRegion]) -> str:
    """Held-out loss of each network over the epochs, as SVG."""

    def line(region: str, stage: str, history: History) -> Line:
        return Line(f"{region} {stage}", range(1, len(history.held) + 1), history.held)

    lines = [
        line(result.model.description.region, stage, history)
        for result in fitted
        for stage, history in result.histories.items()
        if not stage.startswith("holden")
    ]
    return chart("Held-out loss", "epoch", "loss", lines, log_y=True)
