"""Open a session: read the take, the character and the model, and put them together."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.characters.glb import read_rig
from faceedit_app.core.resources import CHARACTER, shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.formats.timecode import start_of_day, time_of_day
from faceedit_app.media import beside, offset_by_clock

if TYPE_CHECKING:  # they import SciPy and trimesh, PyAV, and ONNX Runtime
    from faceedit_app.characters.fitted import FittedCharacter
    from faceedit_app.media.sound import Sound
    from faceedit_app.networks.engine import Engine


def shipped_rig() -> Rig:
    """Read the character that ships with FaceEdit.

    Raises:
        FileError: it is missing or damaged.
    """
    return read_rig(shipped(CHARACTER))


def open_character(path: Path) -> FittedCharacter:
    """Open a user's character.

    Raises:
        FileError: it or its map cannot be read, or it is not a face.
    """
    from faceedit_app.characters import fitted  # takes do not wait for what only characters need

    return fitted.open_character(path)


def load_engine(rig: Rig, models: Path | None = None) -> Engine:
    """Load a model for a rig.

    Args:
        rig: the character; the model must be made for it.
        models: the folder of the model; None = the one that ships.

    Raises:
        FileError: the model is missing or damaged, or made for another character.
    """
    from faceedit_app.networks.engine import Engine  # ONNX Runtime; the take does not wait for it

    return Engine.load(models if models is not None else shipped("models"), rig)


def open_session(
    take: Take | Path | str,
    rig: Rig | None = None,
    engine: Engine | None = None,
    fps: float | None = None,
) -> EditSession:
    """Open a take for editing.

    Args:
        take: the take, or its file.
        rig: the character; None = the one that ships.
        engine: answers edits; None = the rig alone answers them.
        fps: frames per second, if the file does not give them or is wrong.

    Raises:
        RateNeeded: the file does not give its frame rate, and `fps` is None.
        FileError: the take or the character cannot be read.
    """
    if not isinstance(take, Take):
        take = open_take(take, fps)
    return EditSession(take, rig if rig is not None else shipped_rig(), engine)


def open_sound(take: Take) -> tuple[Sound, float] | None:
    """The sound beside a take, and when its file begins, in seconds of the take.

    As in the window: a sound file, else a film's own sound, placed by timecode if it has one.

    Raises:
        FileError: it cannot be read.
    """
    from faceedit_app.media.film import Film
    from faceedit_app.media.sound import read_sound

    path, film = beside(take.path.absolute())
    path = path or film
    sound = read_sound(path) if path is not None else None
    if path is None or sound is None:
        return None
    codes = take.clip.timecodes
    began, lasts = sound.began, sound.end
    if path == film:
        pictures = Film(path)
        code, lasts = pictures.timecode, pictures.duration
        began = None if code is None else time_of_day(code, round(pictures.rate))
    day = start_of_day(codes) if codes else None
    return sound, offset_by_clock(day, began, lasts, take.lead)
