"""What the lips should do at the phonemes of a take, where they do not, and edits that help.

Tracked lips and sound are not exactly in step, and lips close before a /b/ is heard. Each phoneme
is therefore looked for at the nearest dip of the curve, at most 80 ms away.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.characters.closure import ARE_LIPS, CLOSE_ENOUGH, Openings
from faceedit_app.core.arrays import Doubles, Floats, Times
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import STRONGEST, Edit, Op
from faceedit_app.editing.help.sound_presets import About, SoundPreset, sound_presets
from faceedit_app.editing.session import EditSession
from faceedit_app.words.speech_sounds import Lips, lips_of, spelled
from faceedit_app.words.transcript import Phoneme, Transcript, Word

NEAR = 0.08  # seconds between a phoneme and its dip
_FAR = 2.0  # mm that a dip at that distance must be lower than one inside the phoneme
# Seconds on either side of the dip. The networks' grid of 25 fps widens them: with these, nothing
# moves by more than 0.3 mm farther away than `NEAR`. Wider ones would disturb closures that follow
# each other, although real lips stay shut for longer.
_HOLD, _FALLOFF = 0.005, 0.04
_MISSING = 0.5  # mm that must be missing before a shape is changed
_LIPS = int(np.flatnonzero(ARE_LIPS)[0])


@dataclass(frozen=True)
class Closure:
    """An m, b or p, and whether the lips meet.

    Attributes:
        word, phoneme: what is said.
        frame, time: the dip of the mouth opening that belongs to it: its place in `times`, and
            seconds.
        gap: mm between the lips there.
        touching: the mouth opening of lips that touch, mm.
    """

    word: Word
    phoneme: Phoneme
    frame: int
    time: float
    gap: float
    touching: float

    @property
    def is_open(self) -> bool:
        """Whether the lips stay visibly apart."""
        return self.gap > CLOSE_ENOUGH

    @property
    def name(self) -> str:
        """The sound and its word, for the user."""
        return f"{spelled(self.phoneme.symbol)} of “{self.word.text}”"

    @property
    def message(self) -> str:
        """One line for the user."""
        return f"The {self.name} is open by {self.gap:.1f} mm"


@dataclass(frozen=True)
class LipGap:
    """How far the lips of a character are apart.

    Attributes:
        gaps: measures it.
        touching: the mouth opening of lips that touch, mm.
    """

    gaps: Openings
    touching: float

    @classmethod
    def of(cls, rig: Rig) -> LipGap:
        """Make it for a character."""
        gaps = Openings.of(rig)
        return cls(gaps, float(gaps.touching[_LIPS]))

    def measure(self, weights: Floats) -> Doubles:
        """(T, 52) weights in ARKit's order -> (T,) mm."""
        gap: Doubles = self.gaps.measure(weights)[:, _LIPS]
        return gap


def closures(words: Transcript, times: Times, gap: Doubles, touching: float) -> list[Closure]:
    """Each m, b and p within the take, in order of time.

    Args:
        words: in seconds of the take.
        times: (T,) seconds.
        gap: (T,) mm between the lips.
        touching: the mouth opening of lips that touch, mm.
    """
    found = []
    for word, phoneme in words.phonemes():
        if lips_of(phoneme.symbol) is Lips.CLOSE:
            frame = dip_at(times, gap, phoneme)
            if frame is not None:
                found.append(
                    Closure(word, phoneme, frame, float(times[frame]), float(gap[frame]), touching)
                )
    return found


def dip_at(times: Times, curve: Doubles, phoneme: Phoneme) -> int | None:
    """The frame at which a curve dips for a phoneme; None outside the take.

    A dip inside the phoneme wins over one beside it, unless that is much lower.
    """
    first, last = np.searchsorted(times, (phoneme.start - NEAR, phoneme.end + NEAR))
    frames = np.arange(first, last)
    if not len(frames) or phoneme.end < times[0] or phoneme.start > times[-1]:
        return None
    before, after = curve[np.maximum(frames - 1, 0)], curve[np.minimum(frames + 1, len(curve) - 1)]
    low = frames[(curve[frames] <= before) & (curve[frames] <= after)]
    inside = frames[(times[frames] >= phoneme.start) & (times[frames] <= phoneme.end)]
    frames = np.union1d(low, inside) if len(low) + len(inside) else frames
    outside = np.maximum(np.maximum(phoneme.start - times[frames], times[frames] - phoneme.end), 0)
    middle = np.abs(times[frames] - 0.5 * (phoneme.start + phoneme.end))
    cost = curve[frames] + _FAR * outside / NEAR + 1e-3 * middle
    return int(frames[np.argmin(cost)])


def close_at(closure: Closure) -> Edit:
    """An edit that closes the lips at one phoneme, and ends within 80 ms of its dip."""
    return Edit(
        (LIP_OPENING,),
        Op.SET,
        round(closure.time - _HOLD, 4),
        round(closure.time + _HOLD, 4),
        falloff=_FALLOFF,
        value=round(closure.touching, 2),
        name=f"Close lips: {spelled(closure.phoneme.symbol)} of {closure.word.text}"[:200],
    )


def closures_of(session: EditSession) -> list[Closure]:
    """Each m, b and p of a take with its edits, on the character that is shown."""
    words = session.words
    if words is None or LIP_OPENING in session.lacks:
        return []
    frames = session.all_frames()
    gap = LipGap.of(session.shown_rig).measure(frames.weights)
    touching = LipGap.of(session.rig).touching  # edits are made on the session's character
    return closures(words, frames.times, gap, touching)


def closing_edits(
    session: EditSession, span: tuple[float, float] | None = None
) -> tuple[Edit, ...]:
    """Edits that close the lips at each m, b and p at which they stay open.

    Args:
        span: first and last second to look at; None = the whole take.
    """
    return tuple(
        close_at(closure)
        for closure in closures_of(session)
        if closure.is_open and _within(closure.time, span)
    )


def shaping_edits(
    session: EditSession, span: tuple[float, float] | None = None
) -> tuple[Edit, ...]:
    """Edits that shape the lips at f, w, oo, sh and ch as far as they fall short.

    Args:
        span: as in `closing_edits`.
    """
    words = session.words
    if words is None:
        return ()
    presets = {preset.lips: preset for preset in sound_presets()}
    frames, made = session.all_frames(), []
    times = frames.times
    touching = LipGap.of(session.rig).touching
    for word, phoneme in words.phonemes():
        preset = presets.get(lips_of(phoneme.symbol) or Lips.CLOSE)
        if preset is None or preset.control in session.lacks:
            continue
        curve = frames.achieved[:, CONTROL_INDEX[preset.control]].astype(np.float64)
        frame = dip_at(times, curve, phoneme)
        if frame is None or not _within(float(times[frame]), span):
            continue
        usual = touching if preset.about is About.CLOSED else float(np.median(curve))
        missing = float(curve[frame]) - usual - preset.most
        if missing > _MISSING:
            made.append(_shaped(preset, word, phoneme, float(times[frame]), missing))
    return tuple(made)


def _shaped(preset: SoundPreset, word: Word, phoneme: Phoneme, time: float, missing: float) -> Edit:
    edit = preset.edit
    middle = time - 0.5 * (edit.start + edit.end)
    moved = edit.shifted(round(middle, 4))
    strength = round(min(missing / -edit.value, STRONGEST), 2)
    name = f"{preset.name}: {spelled(phoneme.symbol)} of {word.text}"[:200]
    return replace(moved, strength=strength, name=name)


def _within(time: float, span: tuple[float, float] | None) -> bool:
    return span is None or span[0] <= time <= span[1]
