"""Valid files of FaceEdit itself: edits, projects, journals, presets, logs, landmarks."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from dataclasses import asdict
from functools import partial
from pathlib import Path

import numpy as np

from faceedit_app.batch.log import Log, to_do
from faceedit_app.batch.recipe import Recipe, parse_recipe
from faceedit_app.batch.report import write_reports
from faceedit_app.batch.tasks import LOG, Outcome, Task
from faceedit_app.core.controls import CONTROL_IDS, LIP_OPENING, MOUTH_CORNERS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.media import MediaFile
from faceedit_app.editing.files.edits_file import write_edits
from faceedit_app.editing.files.fingerprint import fingerprint
from faceedit_app.editing.files.journal import Journal
from faceedit_app.editing.files.pending import pending_journals
from faceedit_app.editing.files.project import (
    CharacterFile,
    Project,
    ViewState,
    locate_take,
    read_project,
    write_project,
)
from faceedit_app.editing.help.presets import read_preset, save_preset
from faceedit_app.editing.opening import open_session, shipped_rig
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.steps import EditState, Origin
from faceedit_app.formats.opening import encoded_take
from faceedit_app.lab.attacks.reader import Reader, Wrong, reader_of
from faceedit_app.lab.attacks.valid_takes import small_take
from faceedit_app.lab.attacks.valid_words import SAID
from faceedit_app.tracking.drawing import DRAWN
from faceedit_app.tracking.landmark_file import read_landmarks

_EDITS = (
    Edit((LIP_OPENING,), Op.OFFSET, 0.1, 0.3, 0.1, 4.0, name="wider"),
    Edit(MOUTH_CORNERS, Op.SCALE, 0.0, 0.2, 0.1, 1.5, strength=0.5),
    Edit((LIP_OPENING,), Op.DRAW, 0.1, 0.4, 0.1, points=((0.1, 3.0), (0.3, 9.0))),
    Edit((), Op.LIMIT, 0.1, 0.3, 0.1, 0.5, channels=("jawOpen", "mouthClose")),
)
_RETIME = Edit(CONTROL_IDS, Op.RETIME, 0.0, 0.35, 0.0, pins=((0.1, 0.2), (0.2, 0.2), (0.2, 0.3)))


class _Applied:
    """Applies edits to a take, which stays open: each file's edits are undone again."""

    def __init__(self, take: Path) -> None:
        self._take = take
        self._session: EditSession | None = None

    def __call__(self, path: Path) -> None:
        """What is shown must be finite, can be exported, and undoing brings the take back."""
        session = self._session or open_session(self._take, shipped_rig())
        self._session = session
        session.load_edits(path)
        self._session = None  # if it fails from here on, the next file must not suffer from it
        session.live.work()
        for name in ("asked", "achieved", "weights"):
            if not np.isfinite(getattr(session, name)).all():
                raise Wrong(f"{name} is not finite")
        encoded_take(path, session.take, session.clip_weights(), session.filled_rows())
        session.undo()
        if not np.array_equal(session.clip_weights(), session.take.clip.weights):
            raise Wrong("undoing the edits does not bring the take back")
        self._session = session


def document_readers(folder: Path) -> Iterator[Reader]:
    """The readers of what FaceEdit saves.

    Args:
        folder: where files are made.
    """
    take = folder / "take.csv"
    take.write_bytes(small_take())
    applied = _Applied(take)
    for name, edits in (("edits", _EDITS), ("retimes", (_RETIME, _EDITS[0]))):
        write_edits(folder / f"{name}.json", edits)
        yield reader_of("edits", folder / f"{name}.json", applied)
    for number, project in enumerate(_projects(take, folder)):
        path = folder / f"project{number}.faceedit"
        write_project(path, project)
        yield reader_of("projects", path, _read_project)
    yield Reader("journals", ".jsonl", _journal(take, folder), read_journal)
    preset = save_preset("Wider", _EDITS, 0.0, 1.0, folder / "presets")
    yield reader_of("presets", preset.path, read_preset)
    yield reader_of("recipes", preset.path, _read_recipe)
    yield Reader("batch logs", ".jsonl", _log(), partial(_read_log, take))
    yield Reader("landmarks", ".npz", _landmarks(), read_landmarks)


def _projects(take: Path, folder: Path) -> Iterator[Project]:
    """One with edits, and one with all that a project can have."""
    mark = fingerprint(take)
    yield Project(take, mark, EditState(_EDITS))
    yield Project(
        take,
        mark,
        EditState((_RETIME, *_EDITS), words=SAID),
        ViewState(0.1, (0.0, 0.3), (0.1, 0.2), ui={"panes": [1, 2], "curves": ["jaw"]}),
        MediaFile(folder / "take.wav", 0.1),
        MediaFile(folder / "take.mov", -0.1),
        60.0,
        CharacterFile(folder / "head.glb", mark),
        mark,
    )


def _read_project(path: Path) -> None:
    """Read a project, and look for its take; saved again, it is the same."""
    project = read_project(path)
    locate_take(project, path)
    again = path.with_name("again.faceedit")
    write_project(again, project)
    if read_project(again) != project:
        raise Wrong("saved and read again, it is another project")


def _journal(take: Path, folder: Path) -> bytes:
    """Three gestures in a project with an edit, the last with words."""
    origin = Origin(EditState(_EDITS[:1]), 30.0)
    journal = Journal(take, folder=folder / "journals", origin=origin)
    for count in (1, 2, 3):
        journal.record(EditState(_EDITS[:count], words=SAID if count == 3 else None))
    content = journal.path.read_bytes()
    journal.close()
    return content


def read_journal(path: Path) -> None:
    """Look for what can be recovered."""
    pending_journals(path.parent)


def _read_recipe(path: Path) -> None:
    """Read what a batch does, which takes presets and edits."""
    parse_recipe(str(path)).digest  # noqa: B018  (reads the files that it names)


def _log() -> bytes:
    outcome = Outcome("a/take.csv", "", "ab" * 32, "cd" * 8, "a/take.csv", 24, 3, 0.4, 1, 0, (1.0,))
    failed = Outcome("b.csv", "b.csv: is empty; choose a take")
    return "".join(f"{json.dumps(asdict(one))}\n" for one in (outcome, failed)).encode()


def _read_log(take: Path, path: Path) -> None:
    """Go on with a batch."""
    folder = path.with_name("results")
    folder.mkdir()
    (folder / LOG).write_bytes(path.read_bytes())
    log = Log(folder)
    try:
        to_do([Task("a/take.csv", take, folder / "take.csv", Recipe())], log)
        log.add(Outcome("c.csv", "b.csv: is empty; choose a take"))
        outcomes = log.outcomes()
        if "c.csv" not in outcomes:
            raise Wrong("an outcome is not in the log to which it was added")
        write_reports(folder, list(outcomes.values()))
    finally:
        log.close()


def _landmarks() -> bytes:
    """Landmarks of two pictures, as the tracker writes them."""
    content = io.BytesIO()
    np.savez_compressed(
        content,
        film=np.array("take.mov"),
        size=np.array((640, 480)),
        numbers=np.array(DRAWN, np.int16),
        points=np.full((2, len(DRAWN), 2), 1600, np.int16),
        confidence=np.full(2, 250, np.uint8),
    )
    return content.getvalue()
