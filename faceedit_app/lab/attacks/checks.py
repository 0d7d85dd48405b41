"""What must hold after any gestures: shown = exported = what a fresh session makes of the edits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from faceedit_app.editing.files.project import Project, read_project, write_project
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.attacks.opened import session_of
from faceedit_app.ui.start.window import MainWindow

_ROUNDING = 6e-5  # of weights in files, which have at least 4 decimals
_ROUNDING_TURNS = 2e-4  # radians: a hundredth of a degree
_ANSWERS = ("asked", "achieved", "weights", "rotations")


def wrong_after(window: MainWindow, folder: Path) -> Iterator[str]:
    """What is wrong with the open take, one line each.

    Args:
        window: no gesture is in progress.
        folder: for files.
    """
    session = session_of(window)
    if session.is_previewing:
        yield "a preview stays after all gestures"
    session.live.work()
    yield from _made_otherwise(window, session, folder)
    yield from _not_exported(window, session, folder)


def _made_otherwise(window: MainWindow, session: EditSession, folder: Path) -> Iterator[str]:
    """What a fresh session answers otherwise to the same edits, read from a project."""
    project, state = folder / "work.faceedit", session.state
    write_project(project, Project(session.take.path, session.fingerprint, state))
    read = replace(read_project(project).state, media=state.media)  # media have fields of their own
    if read != state:
        yield "a project does not hold the edits as they are"
    fresh = EditSession(session.take, session.rig, window.document.engine)
    if window.document.character is not None:
        fresh.use_character(window.document.character.rig)
    fresh.begin_with(read)
    fresh.live.work()
    for name in _ANSWERS:
        shown, other = getattr(session, name), getattr(fresh, name)
        if shown is None:
            continue
        if not np.isfinite(shown).all():
            yield f"{name} is not finite"
        differs = (shown != other).any(axis=1)
        if differs.any():
            most = float(np.abs(shown - other).max())
            frames = f"{differs.sum()} frames from {differs.argmax()}, by up to {most:.2g}"
            yield f"{name} depends on how the edits were made ({frames})"


def _not_exported(window: MainWindow, session: EditSession, folder: Path) -> Iterator[str]:
    """What an export does not hold as it is shown."""
    exported = folder / f"exported{session.take.path.suffix}"
    window.document.export(exported)
    clip = open_take(exported, session.take.fps).clip
    if np.abs(clip.weights - session.clip_weights()).max() > _ROUNDING:
        yield "what is exported is not what is shown"
    if session.rotations is None or clip.rotations is None:
        if (session.rotations is None) != (clip.rotations is None):
            yield "the rotations are not exported"
        return
    if np.abs(clip.rotations - session.rotations).max() > _ROUNDING_TURNS:
        yield "exported rotations are not those that are shown"


def wrong_when_undone(
    window: MainWindow, folder: Path, undone: Callable[[], object] = lambda: None
) -> Iterator[str]:
    """Undo all steps; what is wrong then: an export is the source, byte for byte.

    Args:
        undone: called after each step.
    """
    while session_of(window).can_undo:
        window.document.undo()
        undone()
    session = session_of(window)
    exported = folder / f"undone{session.take.path.suffix}"
    window.document.export(exported)
    if exported.read_bytes() != session.take.path.read_bytes():
        yield "undoing everything does not bring back the source's bytes"
