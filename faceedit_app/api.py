"""FaceEdit in Python: open a take, edit, fix and export it, as in the window.

    import faceedit_app

    take = faceedit_app.open("take.csv")
    take.fix("lips", "blinks")
    take.edit("mouth_opening", by=4.0, start=1.2, end=1.8)
    take.export("take_edited.csv")

docs/python.md has more. What a user can correct raises `FaceEditError`, whose text is one line.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.atomic import keep_inputs
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.given import file_name, number, number_or_none
from faceedit_app.core.rig import Rig
from faceedit_app.editing import exporting, filming
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.files.originals import KeptRecording
from faceedit_app.editing.help import by_name
from faceedit_app.editing.help.calibrating import neutral_at
from faceedit_app.editing.help.fixes import apply_preset
from faceedit_app.editing.help.presets import Alone, find_preset
from faceedit_app.editing.help.problems import Kind, Problem, find_problems
from faceedit_app.editing.help.retime import by_pins
from faceedit_app.editing.opening import load_engine, open_character, open_session, shipped_rig
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import checked_rate
from faceedit_app.networks.engine import Engine

if TYPE_CHECKING:  # it imports SciPy and trimesh, which takes do not need
    from faceedit_app.characters.fitted import FittedCharacter

FIXES = {"lips": Kind.LIPS, "blinks": Kind.BLINK, "shaking": Kind.JITTER, "gaps": Kind.DROPPED}
FALLOFF = 0.2  # seconds


def open(path: Path | str, fps: float | None = None, models: Path | None = None) -> Take:
    """Open a take of any format.

    Args:
        path: the file.
        fps: frames per second, if the file does not give them.
        models: the folder of the model that answers edits; None = the one that ships.

    Raises:
        FaceEditError: it cannot be read, or the model cannot.
    """
    path, fps = file_name(path), number_or_none("fps", fps)
    rig, engine = _loaded(None if models is None else file_name(models))
    try:
        return Take(open_session(path, rig, engine, fps))
    except FileError as error:
        raise error.with_remedy(error.command_remedy.replace("--fps ", "fps=")) from None


@lru_cache(maxsize=4)
def _loaded(models: Path | None) -> tuple[Rig, Engine]:
    rig = shipped_rig()
    return rig, load_engine(rig, models)


class Take:
    """An open take and its edits.

    Attributes:
        session: what does the work; for what this class does not offer.
    """

    def __init__(self, session: EditSession) -> None:
        self.session = session
        self._character: FittedCharacter | None = None
        self._read: list[Path] = []  # presets and lists of edits

    # --- what it holds -----------------------------------------------------------------------

    @property
    def path(self) -> Path:
        """Its file."""
        return self.session.take.path

    @property
    def rate(self) -> float:
        """Nominal frames per second."""
        return self.session.take.clip.rate

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.session.take.clip.duration

    @property
    def times(self) -> Times:
        """(T,) seconds of the frames."""
        return self.session.take.clip.times

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of its K channels."""
        return self.session.take.clip.channels

    @property
    def weights(self) -> Floats:
        """(T, K) the weights with all edits: what is exported."""
        return self.session.clip_weights()

    @property
    def tracked(self) -> Floats:
        """(T, K) the weights as they were recorded."""
        return self.session.take.clip.weights.copy()

    @property
    def edits(self) -> tuple[Edit, ...]:
        """The edits, oldest first."""
        return self.session.edits

    def curve(self, name: str, tracked: bool = False) -> Floats:
        """(T,) one of the curves in mm, with all edits or as tracked.

        Args:
            name: such as `mouth_opening` or “Mouth opening”.
            tracked: without edits.
        """
        self.session.live.work()
        values = self.session.tracked if tracked else self.session.achieved
        return np.array(values[:, CONTROL_INDEX[by_name.control_by_name(name)]], np.float32)

    def problems(self) -> list[Problem]:
        """The places that are probably wrong, in order of time."""
        self.session.live.work()
        return find_problems(self.session)

    def use_character(self, path: Path | str | None) -> Take:
        """Use your character from now on, and close lips and lids on it where edits close them.

        Args:
            path: its file; None = FaceEdit's own.

        Raises:
            FaceEditError: it cannot be read, or is not a face.
        """
        self._character = None if path is None else open_character(file_name(path))
        self.session.use_character(None if self._character is None else self._character.rig)
        return self

    # --- edit --------------------------------------------------------------------------------

    def edit(
        self,
        curves: str | Iterable[str],
        *,
        by: float | None = None,
        to: float | None = None,
        times: float | None = None,
        smooth: float | None = None,
        start: float = 0.0,
        end: float | None = None,
        falloff: float = FALLOFF,
        strength: float = 1.0,
    ) -> Take:
        """Edit one curve, or several alike; give one of `by`, `to`, `times` and `smooth`.

        Args:
            curves: names such as `mouth_opening` or “Mouth opening”; or channels such as `jawOpen`
                or `headYaw`, in weights or degrees in place of mm, without `to`.
            by: raise by so many mm.
            to: hold at so many mm.
            times: make the movement so many times as large.
            smooth: calm with a window of so many seconds.
            start, end: seconds between which it acts in full; None = the end of the take.
            falloff: seconds over which it fades in before, and out after.
            strength: 0 to 1.5.

        Returns:
            The take, so that calls can follow each other.

        Raises:
            FaceEditError: a name or a number is wrong, or the times are outside the take.
        """
        ways = {Op.OFFSET: by, Op.SET: to, Op.SCALE: times, Op.SMOOTH: smooth}
        clip, span = self.session.take.clip, (start, end)
        self.session.add(by_name.edit_by_name(clip, curves, ways, span, falloff, strength))
        return self

    def retime(
        self,
        pins: Iterable[tuple[float, float]],
        start: float | None = None,
        end: float | None = None,
    ) -> Take:
        """Show moments of the take at other times; sound, film and all that follows keep theirs.

        Args:
            pins: (was, is) seconds, in order of time, such as `[(1.2, 1.2), (1.85, 2.05)]`. The
                same moment at two times, `[(1, 1), (1, 1.5)]`, is a pause.
            start, end: seconds between which the take makes up for it; None = as far as it takes.

        Returns:
            The take, so that calls can follow each other.

        Raises:
            FaceEditError: the pins cross, or lie outside the range or the take.
        """
        self.session.add(by_pins(self.session.take.clip, tuple(pins), start, end))
        return self

    def make_neutral(self, at: float) -> Take:
        """Take the pose at a time away from the whole take; blinks and words keep their height.

        Args:
            at: seconds.

        Returns:
            The take, so that calls can follow each other.

        Raises:
            FaceEditError: the time is outside the take.
        """
        at, clip = number("at", at), self.session.take.clip
        by_name.check_inside(clip, at, at)
        self.session.live.work()
        edit = neutral_at(self.session, at, 0.0, clip.duration)
        if edit is not None:
            self.session.add(edit)
        return self

    def fix(self, *kinds: str) -> int:
        """Fix problems as “Fix all” in the window does.

        Args:
            kinds: of `lips`, `blinks`, `shaking` and `gaps`; none = all.

        Returns:
            How many were fixed.

        Raises:
            FaceEditError: there is no such kind.
        """
        for kind in kinds:
            if kind not in FIXES:
                raise FaceEditError(f"{kind}: must be {', '.join(FIXES)}")
        wanted = {FIXES[kind] for kind in kinds or FIXES}
        found = [problem for problem in self.problems() if problem.kind in wanted and problem.fix]
        edits = [edit for problem in found for edit in problem.fix]
        if edits:
            self.session.add(*edits, name=f"Fix {len(found)} problems")
        return len(found)

    def preset(
        self,
        name: str | Path,
        start: float | None = None,
        end: float | None = None,
        strength: float = 1.0,
    ) -> Take:
        """Apply a preset, such as `smile`, from `start` to `end`, or in the whole take.

        Args:
            name: its name or id, or its file.
            start, end: seconds.
            strength: 0 to 1.5.

        Raises:
            FaceEditError: there is no such preset, it is damaged, or the times are outside the
                take.
        """
        preset = find_preset(name if isinstance(name, str) else file_name(name))
        start, end = number_or_none("start", start), number_or_none("end", end)
        span, strength = None, number("strength", strength)
        if start is not None or end is not None:
            span = (start or 0.0, float(self.times[-1]) if end is None else end)
            by_name.check_inside(self.session.take.clip, *span)
        elif preset.alone is not Alone.TAKE:
            raise FaceEditError(
                f"{preset.name} acts at a place; give start and end, or fix what is wrong instead"
            )
        self.session.live.work()
        edits = apply_preset(self.session, preset, span, 0.0)
        self.session.add(*(by_name.with_strength(edit, strength) for edit in edits))
        self._read += [Path(name)] if str(name).endswith(".json") else []
        return self

    def load_edits(self, path: Path | str) -> Take:
        """Add the edits of a file.

        Raises:
            FaceEditError: it cannot be read.
        """
        self.session.load_edits(file_name(path))
        self._read.append(Path(path))
        return self

    def settings(
        self, mode: str = "preserve", naturalness: float = 1.0, reach: float = 1.0
    ) -> Take:
        """Set how edits are answered; see `faceedit apply --help`.

        Raises:
            FaceEditError: a value is wrong.
        """
        if mode not in list(Mode) or not (0 <= naturalness <= 1 and 0 <= reach <= 1):
            raise FaceEditError(f"mode must be {' or '.join(Mode)}, the others from 0 to 1")
        self.session.configure(Settings(Mode(mode), naturalness, reach))
        return self

    def undo(self) -> Take:
        """Undo the last step."""
        self.session.undo()
        return self

    # --- write -------------------------------------------------------------------------------

    def export(
        self,
        path: Path | str,
        format: str | None = None,
        fps: float | None = None,
        compact: bool = False,
        overwrite: bool = False,
        follow_head: bool = False,
    ) -> exporting.Exported:
        """Export the edited take: as it came, in another format, or as a character that plays it.

        Args:
            path: the file to write.
            format: see `faceedit convert --help`; None = by the ending, the take's own first.
            fps: frames per second; None = the take's own.
            compact: store weights in 16 bits, for GLB.
            overwrite: allow a recording to be replaced; a copy of it is kept.
            follow_head: turn a character's head as it was recorded.

        Raises:
            FaceEditError: it cannot be written.
        """
        path = file_name(path)
        fps = None if fps is None else checked_rate(path, number("fps", fps))
        keep_inputs([path], self._read)
        form = exporting.choose(path, format, self.session.take, fps)
        options = exporting.Options(fps, self._character, compact, overwrite, follow_head)
        try:
            return exporting.export_session(self.session, path, form, options)
        except KeptRecording as error:
            raise error.with_remedy(
                error.command_remedy.replace("add --overwrite", "give overwrite=True")
            ) from None

    def film(
        self,
        path: Path | str,
        view: str = "face",
        size: tuple[int, int] = (1080, 1080),
        fps: float | None = None,
        follow_head: bool = False,
    ) -> filming.Filmed:
        """Film the edited take, with the sound found beside it.

        Args:
            path: a file that ends in `.mp4` or `.webm`.
            view: `face`, `both` (tracked and edited), `film` (the take's film beside the face),
                `film-above` or `film-below`.
            size: width and height, pixels.
            fps: pictures per second; None = the take's frame rate.
            follow_head: turn the head as it was recorded.

        Raises:
            FaceEditError: it cannot be written, or this computer offers no OpenGL.
        """
        if view not in list(filming.FilmView):
            raise FaceEditError(f"{view}: must be {', '.join(filming.FilmView)}")
        path = file_name(path)
        fps = None if fps is None else checked_rate(path, number("fps", fps))
        keep_inputs([path], self._read)
        take, weights, rotations = filming.shown_by(self.session)
        shot = filming.Shot(filming.FilmView(view), size, fps, follows_head=follow_head)
        rig, media = self.session.shown_rig, filming.media_of(take)
        filmed = filming.film_take(take, weights, rig, media, path, shot, rotations=rotations)
        assert filmed is not None  # nothing stops it
        return filmed

    def save_edits(self, path: Path | str) -> None:
        """Save the edits, for another take.

        Raises:
            FaceEditError: the file cannot be written, or is the take or its character.
        """
        path, head = file_name(path), self._character
        keep_inputs([path], [self.path, None if head is None else head.character.path])
        self.session.save_edits(path)
