"""The tasks of a batch, one per take, and what came of them."""

from __future__ import annotations

import filecmp
import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

import numpy as np

from faceedit_app import api
from faceedit_app.batch.recipe import Recipe
from faceedit_app.core import on_disk
from faceedit_app.core.atomic import keep_inputs, keep_other
from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.editing import exporting
from faceedit_app.editing.files.fingerprint import fingerprint
from faceedit_app.editing.files.originals import KeptRecording
from faceedit_app.formats.registry import files_below, why_no_take

LOG = "faceedit_batch.jsonl"  # in the folder of the results
REPORT = "faceedit_report"  # there as well, as CSV and as HTML
_OTHER_FOLDER = "choose another folder for the results"
_OTHER_BATCH = "holds the results of another batch; to work on them, give this folder"
_OWN = "is a report of FaceEdit; the takes beside it are worked on"
_POINTS = 120  # of the small curve of a take


@dataclass(frozen=True)
class Task:
    """One take.

    Attributes:
        name: its path in the input folder, with slashes.
        source, output: the file to read, and the file to write.
        recipe: what to do.
        written: the path of `output` in the folder of the results, with slashes; "" = its name.
        is_ours: whether a file that is there is as this batch wrote it; of any other, a copy is
            kept.
        again: what happened to a result that is made again, such as `was removed`.
    """

    name: str
    source: Path
    output: Path
    recipe: Recipe
    written: str = ""
    is_ours: bool = False
    again: str = ""

    @property
    def result(self) -> str:
        """The path of the result in the output folder, with slashes."""
        return self.written or self.output.name


@dataclass(frozen=True)
class Outcome:
    """What came of a task.

    Attributes:
        name: of the task.
        error: why it failed, one line; "" if it did not.
        sha256, digest: of the source and of the recipe: another outcome is needed if one differs.
        written: the path of the file in the output folder, with slashes.
        frames, changed: of the take, and those that edits changed.
        seconds: how long the take is.
        problems, left: how many problems it had, and has now.
        tracked, edited: the opening of the mouth in mm, a small curve each.
        backup: the path there of the copy of a file that it replaced; "" if there was none.
        made: the SHA-256 of the file that was written.
        again: what happened to an earlier result, so that this one was made.
        note: what its file says otherwise than the take does, as `Take.rate_note`; "" if nothing.
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
    backup: str = ""
    made: str = ""
    again: str = ""
    note: str = ""


@dataclass(frozen=True)
class Skipped:
    """A file that ends like a take and is none, or a folder with the results of another batch.

    Attributes:
        name: its path in the input folder, with slashes.
        reason: what it is, and what to do.
    """

    name: str
    reason: str


def plan(source: Path, output: Path, recipe: Recipe) -> tuple[list[Task], list[Skipped]]:
    """The tasks for all takes in a folder and its subfolders, and what is left out.

    Raises:
        FileError: there are no takes, the folders are the same, or a result would be written over
            a take or another file that is read.
    """
    if not on_disk.is_folder(source):
        raise FileError(source, "is not a folder", "give the folder with the takes")
    results = Path(os.path.realpath(output))  # Path.resolve() raises if links go round in a circle
    if os.path.realpath(source) == str(results):
        raise FileError(output, "is the folder of the takes", "choose another folder for results")
    found, others = _sort_out(source, results)
    if not found:
        such = f" (one of {len(others)} files that are none: {others[0].name})" if others else ""
        raise FileError(source, f"holds no takes{such}", "choose another folder")
    ending = exporting.choose(Path(), recipe.form).ending if recipe.form else ""
    tasks: dict[Path, Task] = {}
    for path in found:
        inside = path.relative_to(source)
        target = output / (inside.with_suffix(ending) if ending else inside)
        if target in tasks:  # take.csv and take.json become one name
            target = target.with_name(f"{path.stem}_{path.suffix[1:].lower()}{target.suffix}")
        written = target.relative_to(output).as_posix()
        tasks[target] = Task(inside.as_posix(), path.absolute(), target.absolute(), recipe, written)
    _keep_what_is_read(tasks, found, recipe)
    return list(tasks.values()), others


def _sort_out(source: Path, results: Path) -> tuple[list[Path], list[Skipped]]:
    """The takes in a folder, and what is left out; each file is read once.

    Of a folder below it with the results of another batch, only the folder is named.
    """
    files = [p for p in files_below(source) if results not in Path(os.path.realpath(p)).parents]
    batches = {path.parent for path in files if path.name == LOG} - {source}
    outermost = [path for path in batches if not batches.intersection(path.parents)]
    takes, others = [], [(path, _OTHER_BATCH) for path in outermost]
    for path in files:
        if batches.intersection(path.parents):
            continue
        reason = why_no_take(path)
        if reason:
            is_own = path.name in (LOG, f"{REPORT}.csv")
            others.append((path, _OWN if is_own else reason))
        else:
            takes.append(path)
    return takes, [Skipped(p.relative_to(source).as_posix(), why) for p, why in sorted(others)]


def _keep_what_is_read(targets: Iterable[Path], takes: Iterable[Path], recipe: Recipe) -> None:
    """Raise FileError if a result would be written over a take or a file of the recipe."""
    sources = {os.path.realpath(path) for path in takes}
    others = [Path(name) for name in (*recipe.files, recipe.models) if name]
    for target in targets:
        if os.path.realpath(target) in sources:
            raise FileError(target, "is one of the takes", _OTHER_FOLDER)
        keep_inputs([target], others, _OTHER_FOLDER)


def sha256_of(path: Path) -> str:
    """The SHA-256 of a file's content; "" if it cannot be read."""
    try:
        return fingerprint(path).sha256
    except FileError:
        return ""


def perform(task: Task) -> Outcome:
    """Do a task; never raises, so that one bad file stops nothing."""
    recipe = task.recipe
    outcome = Outcome(task.name, digest=recipe.digest, again=task.again)
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
        done, backup = _export(take, task)
        changed = take.session.changed_frames()
        if done.form.is_own and recipe.rate is None:
            changed = exporting.changed_frames(take.session, task.output)
        return replace(
            outcome,
            written=task.result,
            frames=len(take.times) + take.session.count_filled(),
            changed=changed,
            seconds=round(take.duration, 3),
            problems=problems,
            left=len(take.problems()) if take.edits else problems,
            tracked=_small(take.curve(LIP_OPENING, tracked=True)),
            edited=_small(take.curve(LIP_OPENING)),
            backup="" if backup is None else str(PurePosixPath(task.result).with_name(backup.name)),
            made=fingerprint(task.output).sha256,
            note=done.rate_note,
        )
    except FileError as error:  # --fps is the rate to write here
        remedy = error.remedy.replace("fps=", "--take-fps ")
        remedy = _OTHER_FOLDER if isinstance(error, KeptRecording) else remedy
        return replace(outcome, error=str(error.with_remedy(remedy)))
    except FaceEditError as error:
        return replace(outcome, error=str(error))
    except Exception as error:  # a fault of ours in one take must not stop the others
        return replace(outcome, error=f"{task.source}: {type(error).__name__}: {error}")


def _export(take: api.Take, task: Task) -> tuple[exporting.Exported, Path | None]:
    """Write the result of a task; of a file that is not of this batch, a copy is kept.

    Returns:
        What was written, and the copy, if one was needed.
    """
    folder, recipe = task.output.parent, task.recipe
    folder.mkdir(parents=True, exist_ok=True)
    before = os.listdir(folder)
    backup = keep_other(task.output, lambda _path: task.is_ours)
    is_needed = False
    try:
        form = recipe.form or None
        done = take.export(task.output, form, recipe.rate, follow_head=recipe.follows_head)
    finally:
        if backup is not None:  # nothing is lost if the same was written, or nothing
            is_needed = not filecmp.cmp(backup, task.output, shallow=False)
            if not is_needed and backup.name not in before:
                backup.unlink()
    return done, backup if is_needed else None


def _small(curve: np.ndarray) -> tuple[float, ...]:
    places = np.linspace(0, len(curve) - 1, min(_POINTS, len(curve))).round().astype(int)
    return tuple(round(float(mm), 2) for mm in curve[places])
