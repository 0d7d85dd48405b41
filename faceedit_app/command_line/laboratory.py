"""The laboratory's commands: bench, training, evaluation, experiments; `attacks.py` has more."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Optional

import typer

from faceedit_app.command_line.json_output import say_kept
from faceedit_app.command_line.options import JsonOption, ModelsOption
from faceedit_app.command_line.progress import bar
from faceedit_app.core import on_disk
from faceedit_app.core.atomic import (
    begins_with,
    check_folder,
    check_outputs,
    write_keeping,
)
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.fields import is_document
from faceedit_app.core.optional import require
from faceedit_app.core.resources import shipped

if TYPE_CHECKING:
    from faceedit_app.lab.training.run import TrainingPlan

# typer reads the annotations at run time, where `X | None` is not yet understood by all versions.
OptionalPath = Optional[Path]  # noqa: UP045
Paths = Optional[list[Path]]  # noqa: UP045
Texts = Optional[list[str]]  # noqa: UP045
OptionalNumber = Optional[int]  # noqa: UP045

DataOption = Annotated[Paths, typer.Option("--data", help="A folder of takes; repeatable.")]
FiguresOption = Annotated[
    OptionalPath, typer.Option("--json", help="Write all figures to this file.")
]
ExcludeOption = Annotated[
    Texts, typer.Option("--exclude", help="File names to leave out, such as 'grid__*'.")
]


def train(
    more: Annotated[
        Paths, typer.Argument(metavar="[DIR]...", help="More folders of takes.")
    ] = None,
    data: DataOption = None,
    exclude: ExcludeOption = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder of models.")] = Path(
        "models"
    ),
    recipe: Annotated[
        str,
        typer.Option(
            help="faceedit, or paper: the settings of the publication; a wrong name lists all."
        ),
    ] = "faceedit",
    epochs: Annotated[
        OptionalNumber, typer.Option(min=1, help="Passes over the data for each network.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Same seed, same data: same networks.")] = 1,
    finetune: Annotated[
        bool, typer.Option("--finetune", help="Start from the models that ship with FaceEdit.")
    ] = False,
    models: Annotated[
        OptionalPath, typer.Option("--models", help="With --finetune: start from these instead.")
    ] = None,
    baseline: Annotated[
        bool, typer.Option(help="Also train the baseline that evaluate compares with.")
    ] = True,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Do not resume an interrupted training.")
    ] = False,
) -> int:
    """Train the networks of all regions and write them with a model card.

    Ctrl+C keeps the best so far; the same command resumes.
    """
    require("torch", extra="training")
    from faceedit_app.lab.training.run import TrainingPlan

    folders = [*(data or []), *(more or [])]
    if not folders:
        raise FaceEditError("train needs takes to learn from: --data DIR")
    if models is not None and not finetune:
        raise FaceEditError("--models says where --finetune starts: give both or neither")
    check_folder(output)
    plan = TrainingPlan(
        tuple(folders),
        output,
        tuple(exclude or ()),
        recipe,
        epochs,
        seed,
        (models or shipped("models")) if finetune else None,
        baseline,
        fresh,
    )
    return _train(plan)


def _train(plan: TrainingPlan) -> int:
    """Train; returns the exit code: 130 if Ctrl+C stopped it."""
    from rich.console import Console
    from rich.progress import Progress

    from faceedit_app.lab.training.processes import processes
    from faceedit_app.lab.training.run import train_models

    with (
        processes() as shared,
        # One bar for all: two that draw in the same terminal draw over each other.
        Progress(console=Console(stderr=True), disable=shared.number > 0) as progress,
    ):
        try:
            for path in train_models(plan, progress, shared):
                print(path)
        except KeyboardInterrupt:
            progress.stop()
            print(f"Stopped. The best so far is in {plan.output}; the same command resumes.")
            return 130
    return 0


def evaluate(
    takes: Annotated[list[Path], typer.Argument(help="Takes, or folders of takes.")],
    models: ModelsOption = None,
    output: FiguresOption = None,
    report: Annotated[
        OptionalPath, typer.Option("--report", help="Write a report with plots to this folder.")
    ] = None,
    exclude: ExcludeOption = None,
) -> None:
    """Measure what users get on takes of people, and the networks on their own.

    Synthesised takes do not count as people; the references may learn from them.
    """
    require("torch", extra="training")
    from faceedit_app.lab.evaluation.evaluate import evaluate_takes
    from faceedit_app.lab.evaluation.report import summary_lines, write_report
    from faceedit_app.lab.training.data import load_performances

    check_outputs([output], [path for path in takes if on_disk.is_file(path)])
    if report is not None:
        check_folder(report)
    performances = load_performances(takes, exclude or ())
    with bar("Evaluating") as advance:
        figures = evaluate_takes(
            performances,
            models or shipped("models"),
            advance,
        )
    if output is not None:
        say_kept(
            output,
            write_keeping(
                output, (json.dumps(figures.as_json(), indent=2) + "\n").encode(), is_document
            ),
        )
    if report is not None:
        print(write_report(report, figures))
    for line in summary_lines(figures):
        print(line)


def evaluate_character(
    heads: Annotated[
        list[Path], typer.Argument(help="Heads whose own shapes are known: GLB, OBJ, FBX, npz.")
    ],
    as_json: JsonOption = False,
) -> None:
    """Make shapes for heads that have their own, and compare them."""
    from faceedit_app.lab.evaluation.making import evaluate_making

    figures = [evaluate_making(path) for path in heads]
    if as_json:
        print(json.dumps([vars(one) for one in figures], indent=2))
    else:
        print("\n\n".join(one.text() for one in figures))


def evaluate_words(
    takes: Annotated[list[Path], typer.Argument(help="Takes with their sound beside them.")],
    words: Annotated[
        Path, typer.Option(help="Folder of TextGrids with published word times, named like them.")
    ],
    models: ModelsOption = None,
    as_json: JsonOption = False,
    output: Annotated[
        OptionalPath, typer.Option("--report", help="Write the report to this file.")
    ] = None,
) -> None:
    """Measure how well words are aligned to sound, and closures found and fixed."""
    from faceedit_app.editing.opening import load_engine, shipped_rig
    from faceedit_app.lab.evaluation import words as evaluation

    check_outputs([output], [*takes, words])
    figures = evaluation.evaluate_words(takes, words, load_engine(shipped_rig(), models))
    text = evaluation.report(figures)
    if output is not None:
        say_kept(
            output, write_keeping(output, text.encode(), begins_with(text.encode().splitlines()[0]))
        )
    print(json.dumps(figures.as_json(), indent=2) if as_json else text)


def evaluate_tracking(
    takes: Annotated[list[Path], typer.Argument(help="Takes, or folders of takes, to render.")],
    seconds: Annotated[
        float, typer.Option(min=1.0, help="Length of the liveliest part of each take.")
    ] = 6.0,
    exclude: ExcludeOption = None,
    output: FiguresOption = None,
    character: Annotated[
        Paths,
        typer.Option("--character", help="A character that plays the takes too; repeatable."),
    ] = None,
    films: Annotated[
        Texts, typer.Option("--film", help="Only films like this, such as 'plain'; repeatable.")
    ] = None,
    keep: Annotated[
        OptionalPath,
        typer.Option("--keep", help="Keep what was seen in the films here, and use it again."),
    ] = None,
) -> None:
    """Render films of takes, track them, and measure what was found."""
    from faceedit_app.characters.fitted import open_character
    from faceedit_app.editing.opening import shipped_rig
    from faceedit_app.lab.evaluation import tracking
    from faceedit_app.lab.evaluation.rendered_films import CONDITIONS
    from faceedit_app.lab.training.data import take_paths

    check_outputs(
        [output], [*(path for path in takes if on_disk.is_file(path)), *(character or ())]
    )
    paths = [path for folder in takes for path in take_paths(folder, exclude or ())]
    known = {how.name: how for how in CONDITIONS}
    for name in films or ():
        if name not in known:
            raise FaceEditError(f"--film {name}: no film is like that; use {', '.join(known)}")
    with bar("Rendering and tracking") as advance:
        figures = tracking.evaluate_tracking(
            paths,
            seconds,
            [known[name] for name in films or known],
            progress=advance,
            characters=[shipped_rig(), *(open_character(path).rig for path in character or ())],
            keep=keep,
        )
    if output is not None:
        text = json.dumps(tracking.as_json(figures), indent=2) + "\n"
        say_kept(output, write_keeping(output, text.encode(), is_document))
    print(tracking.table(figures))


def experiment(
    names: Annotated[
        list[str], typer.Argument(help="Names, or all; a wrong name lists them.", metavar="NAME...")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the report.")] = Path(
        "docs/evaluation"
    ),
    data: DataOption = None,
    held_out: Annotated[
        Paths, typer.Option("--held-out", help="Takes to measure on only; repeatable.")
    ] = None,
    models: ModelsOption = None,
    epochs: Annotated[
        int, typer.Option(min=1, help="Passes over the data for each network trained here.")
    ] = 14,
) -> None:
    """Repeat the paper's experiments and ours; each writes its part of the report."""
    require("torch", extra="training")
    check_folder(output)
    from rich.console import Console
    from rich.progress import Progress

    from faceedit_app.lab.evaluation.experiments import run_experiments
    from faceedit_app.lab.evaluation.setting import Setting

    with Progress(console=Console(stderr=True)) as progress:
        setting = Setting(
            output,
            tuple(data or ()),
            tuple(held_out or ()),
            models or shipped("models"),
            epochs,
            progress,
        )
        for path in run_experiments(names, setting):
            print(path)


def synthesize(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the takes.")],
    minutes: Annotated[float, typer.Option(min=0.05, help="Length of all takes together.")] = 10.0,
    seed: Annotated[int, typer.Option(min=0, help="Same seed: same takes.")] = 1,
) -> None:
    """Write synthetic performances, spoken and acted, to train on."""
    from faceedit_app.lab.training.synthesis import write_performances

    check_folder(output)
    with bar("Synthesizing") as advance:
        paths = write_performances(
            output,
            minutes,
            seed,
            advance,
        )
    for path in paths:
        print(path)


def statistics(
    takes: Annotated[list[Path], typer.Argument(help="Folders of takes, compared by source.")],
    exclude: ExcludeOption = None,
) -> None:
    """Compare takes: blinks, closures, jaw peaks, spectrum, correlation of channels."""
    require("torch", extra="training")
    from faceedit_app.lab.training.sources import by_source
    from faceedit_app.lab.training.statistics import measure, table

    try:
        print(
            table({name: measure(some) for name, some in by_source(takes, exclude or ()).items()})
        )
    except ValueError as error:
        raise FileError(takes[0], str(error), "name longer takes") from error


def bench(
    as_json: JsonOption = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="Few repetitions and short takes: a trial run.")
    ] = False,
    as_table: Annotated[
        bool, typer.Option("--table", help="Print the rows of docs/performance.md.")
    ] = False,
) -> None:
    """Measure the window on this machine: drags, wide edits, playback, start."""
    from faceedit_app.lab.bench.report import QUICK, BenchPlan, run, text
    from faceedit_app.lab.bench.table import table

    found = run(QUICK if quick else BenchPlan(), lambda what: print(f"{what}…", file=sys.stderr))
    if as_json:
        print(json.dumps(found, indent=2))
    else:
        print(table(found) if as_table else text(found))


COMMANDS = (
    *(bench, train, evaluate, evaluate_character, evaluate_words, evaluate_tracking),
    *(experiment, synthesize, statistics),
)
