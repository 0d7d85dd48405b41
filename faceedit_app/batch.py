"""Do the same to many takes: fixes, presets or edits, and another format.

Each take is a task that any process, here or on another computer, can do by itself. Its outcome is
one line of a log in the output folder, so that a run that was stopped goes on where it was, and
nothing is done twice.
"""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app import api
from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.optional import require
from faceedit_app.editing import exporting
from faceedit_app.editing.files.edits_file import read_edits
from faceedit_app.editing.files.fingerprint import fingerprint
from faceedit_app.editing.help.presets import Alone, find_preset
from faceedit_app.formats.registry import takes_below
from faceedit_app.formats.timing import RateNeeded

LOG = "faceedit_batch.jsonl"
_FIX = "fix:"
_POINTS = 120  # of the small curve of a take
_LOST = "the process that worked on it ended; try this take alone"


@dataclass(frozen=True)
class Recipe:
    """What is done to each take.

    Attributes:
        fixes: kinds of problems to fix, see `api.FIXES`.
        preset: the name or file of a preset.
        edits: the file of a list of edits.
        form: the key of the format to write; "" = as the take came.
        rate: frames per second to write; None = the take's own.
        character: the file of a character, on which lips and lids close as well.
        fps: frames per second of takes that do not give them.
        models: the folder of a model; None = the one that ships.
        follows_head: turn the head of a character that is written as it was recorded.
    """

    fixes: tuple[str, ...] = ()
    preset: str = ""
    edits: str = ""
    form: str = ""
    rate: float | None = None
    character: str | None = None
    fps: float | None = None
    models: str | None = None
    follows_head: bool = False

    @property
    def digest(self) -> str:
        """Differs between recipes that do different things, also if a file that they name does."""
        text = json.dumps(asdict(self), sort_keys=True)
        for name in (self.edits, self.preset, self.character or ""):
            if name and Path(name).is_file():
                text += fingerprint(Path(name)).sha256
        return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Task:
    """One take.

    Attributes:
        name: its path in the input folder, with slashes.
        source, output: the file to read, and the file to write.
        recipe: what to do.
    """

    name: str
    source: Path
    output: Path
    recipe: Recipe


@dataclass(frozen=True)
class Outcome:
    """What came of a task.

    Attributes:
        name: of the task.
        error: why it failed, one line; "" if it did not.
        sha256, digest: of the source and of the recipe: another outcome is needed if one differs.
        written: the name of the file, in the output folder.
        frames, changed: of the take, and those that edits changed.
        seconds: how long the take is.
        problems, left: how many problems it had, and has now.
        tracked, edited: the opening of the mouth in mm, a small curve each.
    """

    name: str
    error: str = ""
    sha256: str = ""
    digest: str = ""
    written: str = ""
    frames: int = 0
    changed: int = 0
    seconds: float = 0.0
    problems: int = 0
    left: int = 0
    tracked: tuple[float, ...] = ()
    edited: tuple[float, ...] = ()


def parse_recipe(text: str) -> Recipe:
    """The recipe for what a user wrote: `fix:lips,blinks`, a preset, or the file of edits.

    Raises:
        FaceEditError: it is none of these.
    """
    if text.startswith(_FIX):
        kinds = tuple(kind.strip() for kind in text.removeprefix(_FIX).split(",") if kind.strip())
        for kind in kinds:
            if kind not in api.FIXES:
                raise FaceEditError(f"{text}: {kind} must be one of {', '.join(api.FIXES)}")
        return Recipe(fixes=kinds or tuple(api.FIXES))
    if text == "none":
        return Recipe()
    if Path(text).suffix.lower() == ".json":
        with suppress(FaceEditError):
            return _with_preset(text)
        read_edits(text)
        return Recipe(edits=str(Path(text).absolute()))
    return _with_preset(text)


def _with_preset(text: str) -> Recipe:
    preset = find_preset(text)
    if preset.alone is not Alone.TAKE:
        raise FaceEditError(f"{text}: acts at a place, not in a whole take; use fix:lips,blinks")
    is_file = Path(text).suffix.lower() == ".json"
    return Recipe(preset=str(Path(text).absolute()) if is_file else text)


def plan(source: Path, output: Path, recipe: Recipe) -> list[Task]:
    """The tasks for all takes in a folder and its subfolders.

    Raises:
        FileError: there are no takes, or the folders are the same.
    """
    if not source.is_dir():
        raise FileError(source, "is not a folder", "give the folder with the takes")
    results = Path(os.path.realpath(output))  # Path.resolve() raises if links go round in a circle
    if os.path.realpath(source) == str(results):
        raise FileError(output, "is the folder of the takes", "choose another folder for results")
    found = [p for p in takes_below(source) if results not in Path(os.path.realpath(p)).parents]
    if not found:
        raise FileError(source, "holds no takes", "choose another folder")
    ending = exporting.choose(Path(), recipe.form).ending if recipe.form else ""
    tasks: dict[Path, Task] = {}
    for path in found:
        inside = path.relative_to(source)
        target = output / (inside.with_suffix(ending) if ending else inside)
        if target in tasks:  # take.csv and take.json become one name
            target = target.with_name(f"{path.stem}_{path.suffix[1:].lower()}{target.suffix}")
        tasks[target] = Task(inside.as_posix(), path.absolute(), target.absolute(), recipe)
    return list(tasks.values())


def perform(task: Task) -> Outcome:
    """Do a task; never raises, so that one bad file stops nothing."""
    recipe = task.recipe
    outcome = Outcome(task.name, digest=recipe.digest)
    try:
        outcome = replace(outcome, sha256=fingerprint(task.source).sha256)
        models = None if recipe.models is None else Path(recipe.models)
        take = api.open(task.source, recipe.fps, models)
        if recipe.character:
            take.use_character(recipe.character)
        problems = len(take.problems())
        if recipe.fixes:
            take.fix(*recipe.fixes)
        if recipe.preset:
            take.preset(recipe.preset)
        if recipe.edits:
            take.load_edits(recipe.edits)
        task.output.parent.mkdir(parents=True, exist_ok=True)
        form = recipe.form or None
        take.export(task.output, form, recipe.rate, follow_head=recipe.follows_head)
        return replace(
            outcome,
            written=task.output.name,
            frames=len(take.times),
            changed=take.session.changed_frames(),
            seconds=round(take.duration, 3),
            problems=problems,
            left=len(take.problems()) if take.edits else problems,
            tracked=_small(take.curve(LIP_OPENING, tracked=True)),
            edited=_small(take.curve(LIP_OPENING)),
        )
    except RateNeeded as error:  # --fps is the rate to write here
        remedy = error.remedy.replace("--fps", "--take-fps")
        return replace(outcome, error=str(FileError(error.path, error.problem, remedy)))
    except FaceEditError as error:
        return replace(outcome, error=str(error))
    except Exception as error:  # a fault of ours in one take must not stop the others
        return replace(outcome, error=f"{task.source}: {type(error).__name__}: {error}")


def _small(curve: np.ndarray) -> tuple[float, ...]:
    places = np.linspace(0, len(curve) - 1, min(_POINTS, len(curve))).round().astype(int)
    return tuple(round(float(mm), 2) for mm in curve[places])


# --- the log -------------------------------------------------------------------------------------


class Log:
    """The outcomes so far, in the output folder."""

    def __init__(self, folder: Path) -> None:
        """Raises FileError: the folder or its log cannot be written."""
        self.path = folder / LOG
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = self.path.open("a+", encoding="utf-8")
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise FileError(folder, f"cannot be written ({reason})", "choose another") from error

    def outcomes(self) -> dict[str, Outcome]:
        """The last outcome of each take, by name; a line cut off by a crash is left out."""
        found = {}
        self._file.seek(0)
        for line in self._file:
            with suppress(ValueError, TypeError):
                entry = json.loads(line)
                lists: dict[str, Any] = {
                    k: tuple(v) if isinstance(v, list) else v for k, v in entry.items()
                }
                found[entry["name"]] = Outcome(**lists)
        return found

    def add(self, outcome: Outcome) -> None:
        """Add an outcome."""
        self._file.write("\n" * self._is_cut() + json.dumps(asdict(outcome)) + "\n")
        self._file.flush()

    def _is_cut(self) -> bool:
        """Whether the last line was cut off."""
        with self.path.open("rb") as file:
            end = file.seek(0, 2)
            if end:
                file.seek(end - 1)
            return end > 0 and file.read() != b"\n"

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def to_do(tasks: Iterable[Task], done: dict[str, Outcome]) -> list[Task]:
    """The tasks without a good outcome for the same source and the same recipe."""

    def is_done(task: Task) -> bool:
        outcome = done.get(task.name)
        return (
            outcome is not None
            and not outcome.error
            and outcome.digest == task.recipe.digest
            and task.output.is_file()
            and outcome.sha256 == fingerprint(task.source).sha256
        )

    return [task for task in tasks if not is_done(task)]


# --- workers -------------------------------------------------------------------------------------


def run_here(tasks: list[Task], jobs: int) -> Iterator[Outcome]:
    """Do the tasks in `jobs` processes of this computer; outcomes as they come."""
    if jobs <= 1:
        yield from map(perform, tasks)
        return
    broken: list[Task] = []
    with _pool(jobs) as pool:
        waiting: dict[Future[Outcome], Task] = {pool.submit(perform, task): task for task in tasks}
        for future in as_completed(waiting):
            try:
                yield future.result()
            except BrokenProcessPool:
                broken.append(waiting[future])
    for task in broken:  # one of them ended its process, and the others with it: each alone now
        with _pool(1) as pool:
            try:
                yield pool.submit(perform, task).result()
            except BrokenProcessPool:
                yield Outcome(task.name, f"{task.source}: {_LOST}")


def _pool(jobs: int) -> ProcessPoolExecutor:
    # Not by fork: the parent has threads of numpy and ONNX Runtime.
    return ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn"))


def run_on_cluster(tasks: list[Task], scheduler: str) -> Iterator[Outcome]:
    """Do the tasks on a Dask cluster whose workers see the same folders; outcomes as they come.

    Dask gives the task of a lost worker to another one. Writing is atomic and gives the same bytes,
    so a task that was done but not reported may be done again without harm.

    Raises:
        Unavailable: Dask is not installed.
        FaceEditError: the scheduler does not answer.
    """
    require("dask.distributed", extra="cluster")
    from dask import distributed

    try:
        client = distributed.Client(scheduler, timeout=10)  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TimeoutError) as error:
        raise FaceEditError(f"--scheduler {scheduler}: does not answer ({error})") from error
    with client:
        futures = {client.submit(perform, task, pure=False): task for task in tasks}
        for future in distributed.as_completed(futures):  # type: ignore[no-untyped-call]
            if future.status == "finished":
                yield future.result()
            else:
                yield Outcome(futures[future].name, f"{futures[future].source}: {_LOST}")


def run(
    tasks: list[Task],
    log: Log,
    jobs: int = 1,
    scheduler: str | None = None,
    progress: Callable[[Outcome, int, int], None] = lambda outcome, done, all_: None,
) -> list[Outcome]:
    """Do what is left to do, and return the outcome of every task, in order.

    Args:
        tasks: all of them.
        log: what is done, and gets what will be.
        jobs: how many processes work here.
        scheduler: the address of a Dask scheduler to use instead.
        progress: called with each new outcome, how many there are now, and how many there will be.
    """
    outcomes = log.outcomes()
    left = to_do(tasks, outcomes)
    done = len(tasks) - len(left)
    found = run_on_cluster(left, scheduler) if scheduler else run_here(left, jobs)
    for outcome in found if left else ():
        log.add(outcome)
        outcomes[outcome.name] = outcome
        done += 1
        progress(outcome, done, len(tasks))
    return [outcomes[task.name] for task in tasks]
