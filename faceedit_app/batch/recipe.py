"""What is done to each take of a batch."""

from __future__ import annotations

import hashlib
import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path

from faceedit_app import api
from faceedit_app.core import on_disk
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.files.edits_file import read_edits
from faceedit_app.editing.files.fingerprint import fingerprint
from faceedit_app.editing.help.presets import Alone, find_preset

_FIX = "fix:"


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
    def files(self) -> tuple[str, ...]:
        """The files that it names."""
        names = (self.edits, self.preset, self.character or "")
        return tuple(name for name in names if name and on_disk.is_file(Path(name)))

    @cached_property
    def digest(self) -> str:
        """Differs between recipes that do different things, also if a file that they name does.

        The files are read once, also for the processes that work on the tasks. If one is changed
        while they work, the next run does the takes again.
        """
        text = json.dumps(asdict(self), sort_keys=True)
        for name in self.files:
            text += fingerprint(Path(name)).sha256
        return hashlib.sha256(text.encode()).hexdigest()[:16]


def parse_recipe(text: str) -> Recipe:
    """The recipe for what a user wrote: `fix:lips,blinks`, a preset, or the file of edits.

    Raises:
        FaceEditError: it is none of these.
    """
    if text.startswith(_FIX):
        known = ", ".join(api.FIXES)
        kinds = tuple(kind.strip() for kind in text.removeprefix(_FIX).split(",") if kind.strip())
        for kind in kinds:
            if kind not in api.FIXES:
                raise FaceEditError(f"{text}: {kind} must be one of {known}")
        if not kinds:
            raise FaceEditError(f"{text} names nothing to fix; give one or more of {known}")
        return Recipe(fixes=kinds)
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
