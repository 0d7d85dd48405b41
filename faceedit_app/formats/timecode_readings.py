"""Find out what the last fields of timecodes mean: frames of some base, or something else.

`HH:MM:SS:FF.sss` counts frames `FF` and thousandths of a frame `sss` within a second. How many
frames make a second (the base) is not in the file, and rows need not come once per frame of the
base: a 30 fps recording on a 60 fps timecode steps by two. Other tools write other values into the
same fields: milliseconds instead of frames, or milliseconds of the second or a running frame number
after the point. All rows decide: each possible reading places every row. A reading that the digits
prove wins; otherwise the one with the most even rows, and the simpler one of equals.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.formats.rates import unsure

DEFAULT_BASE = 60  # what Live Link Face uses
MILLISECONDS = 1000  # the base of a timecode that gives milliseconds in place of frames
BASES = (24, 25, 30, 48, 50, 60, 72, 90, 100, 120, 240)
_BROADCAST = {24: 24 / 1.001, 30: 30 / 1.001, 60: 60 / 1.001}
_OFF = 0.25  # frames by which a step is off the ordinary one
_SHORT_OF = 0.05  # steps by which a second may end later than after its last frame
_SLOWER = 1.5  # frames from row to row, if there is none for each frame of the base
_WORST = 4.0  # the most that one step adds to the unevenness, in ordinary steps
_LOST = 0.5  # the factor of that for a step of several ordinary ones
_CHANCE = 0.02  # the probability that counts as chance
_CLEARLY = 0.4  # ordinary steps by which a less common reading must be more even
_NEAR_ANOTHER = (24, 48)  # bases that are little below another
_MOST_EVEN = 0.9  # share of the seconds that a reading must join without a loss
_AGREE = 3  # seconds that must end alike to show an unusual base
_FILM = 3 * 3600  # seconds; a timecode that begins earlier may be a film's


@dataclass(frozen=True)
class Stamps:
    """Parsed timecodes, (T,) each.

    Attributes:
        clock: seconds since midnight of the first day; a recording may pass midnight.
        last: the field after the seconds, in most files frames.
        fraction: the digits after the point, as a whole number.
        digits: the number of these digits; 0 = no point.
        width: the least number of digits of the last field.
        drop: whether they are marked as drop-frame (`;` before the frames).
    """

    clock: Times
    last: Times
    fraction: Times
    digits: Times
    width: int
    drop: bool

    @property
    def frames(self) -> Times:
        """(T,) frames within the second, with their fraction."""
        frames: Times = self.last + self.fraction / 10.0**self.digits
        return frames


@dataclass(frozen=True)
class Reading:
    """A possible meaning of a column of timecodes.

    Attributes:
        places: (T,) the place of each row, in frames of the base.
        second: frames in a real second.
        base: frames that the timecode counts in a second.
        resolution: of the places, in frames.
        begin: of the first row, in seconds since midnight.
        notes: what is unusual about it.
    """

    places: Times
    second: float
    base: int
    resolution: float
    begin: float
    notes: tuple[str, ...] = ()


def read_stamps(stamps: Stamps) -> Reading:
    """The meaning of T >= 2 timecodes: what their digits prove, else the most even reading."""
    plain = _plain(stamps, stamps.drop)
    proven = [*_milliseconds_of_the_second(stamps), *_running_number(stamps, plain)]
    milliseconds = [*_milliseconds(stamps)]
    if stamps.last.max() > max(BASES):
        proven += milliseconds
    possible = [*milliseconds, plain, *_wrongly_marked(stamps)]
    best, *others = proven or [*possible, *_numbered_at_broadcast_rate(stamps, plain)]
    least = _unevenness(best.places)
    for reading in others:
        uneven = _unevenness(reading.places)
        if uneven < least - _CLEARLY:
            best, least = reading, uneven
    return best


def _plain(stamps: Stamps, drop: bool) -> Reading:
    """`FF.sss`: frames and thousandths of a frame."""
    base, notes = _plain_base(stamps)
    drop = drop and can_drop(base)
    whole = bool(np.all(stamps.fraction == 0))
    # Drop-frame is itself the evidence for a broadcast rate, however short the take.
    resolution = 0.0 if drop else (1.0 if whole else 0.001)
    second = base / 1.001 if drop else float(base)
    places = count_frames(stamps, base, drop)
    return Reading(places, second, base, resolution, float(places[0]) / second, notes)


def _plain_base(stamps: Stamps) -> tuple[int, tuple[str, ...]]:
    frames = stamps.frames
    steps, seconds = np.diff(frames), np.diff(stamps.clock)
    over = np.flatnonzero(seconds == 1)
    inside = steps[(seconds == 0) & (steps > 0)]
    step = float(np.median(inside)) if len(inside) else 1.0
    most = frames.max()
    possible = [base for base in BASES if base > most]
    if _is_rounded_up(stamps, most, step):
        possible.insert(0, int(most))
    if len(over):
        # Where the second rolls over, the frames fall by the base less one ordinary step; by
        # less where frames were lost just there.
        falls = step - steps[over]
        excess = [np.abs(base - falls) / step for base in possible]
        shares = [float((late < max(_OFF, 0.6 / step)).mean()) for late in excess]
        best = max(shares, default=0.0)
        if best > 1 / 3:
            base = possible[shares.index(best)]
            agree = round(best * len(over))
            # 24 without its last number looks like 25 that lost a frame there, 48 like 50.
            unsure = base == most or base in _NEAR_ANOTHER or agree < len(over)
            few = agree < _AGREE - 1 or best < _LOST
            guessed = unsure and few and not _is_reached(base, most, step)
            return base, _assumed(base) if guessed else ()
        fall = float(np.percentile(falls, 75, method="higher"))
        nearest = min(possible, key=lambda base: abs(base - fall), default=0)
        few = len(over) < _AGREE
        if abs(nearest - fall) <= 0.1 * fall:
            guessed = few and nearest - fall > step / 2 and not _is_reached(nearest, most, step)
            return nearest, _assumed(nearest) if guessed else ()
        if few:
            # An unusual base takes more proof; frames lost at the second are likelier.
            likely = [base for base in possible if base >= fall]
            if likely and step > _SLOWER and DEFAULT_BASE in likely:
                likely = [DEFAULT_BASE]  # cameras slower than their timecode count on this one
            if likely:
                sure = _is_reached(likely[0], most, step)
                return likely[0], () if sure else _assumed(likely[0])
        if round(fall) > most:
            return round(fall), ()
    base = assumed_base(stamps)
    sure = bool(np.any(seconds > 0)) and _is_reached(base, most, step)
    return base, () if sure else _assumed(base)


def _is_reached(base: int, most: float, step: float) -> bool:
    """Whether the largest frame is the last before the next second, so that the base is shown.

    Only of the usual base: others have neighbours that lost frames may make of them.
    """
    return base == DEFAULT_BASE and 0 < base - most <= (1 + _SHORT_OF) * step


def _is_rounded_up(stamps: Stamps, most: float, step: float) -> bool:
    """Whether the largest frame is the base itself: the next second's first, rounded up."""
    if most not in BASES or not np.all(np.diff(stamps.clock * most + stamps.frames) > 0):
        return False
    frames, over = stamps.frames, np.diff(stamps.clock) == 1
    shown = (frames[:-1] < most) & (np.abs(frames[:-1] + step - frames[1:] - most) < _OFF)
    return most not in _NEAR_ANOTHER or bool(np.any(over & shown))


def _assumed(base: int) -> tuple[str, ...]:
    note = "the timecode does not show how many frames it counts in a second"
    return (unsure(f"{note}: {base} fps is assumed"),)


OWN_BASE_NOTES = _assumed(DEFAULT_BASE)  # needless for what FaceEdit wrote


def assumed_base(stamps: Stamps) -> int:
    """The base of timecodes that do not show it."""
    at_least = int(stamps.frames.max()) + 1
    return next((b for b in BASES if b >= max(at_least, DEFAULT_BASE)), at_least)


def _milliseconds(stamps: Stamps) -> Iterator[Reading]:
    """`HH:MM:SS:mmm`: milliseconds instead of frames."""
    if stamps.width == 3 or stamps.last.max() > max(BASES):
        note = "the timecode gives milliseconds in place of frames"
        places = 1000.0 * stamps.clock + stamps.last
        yield Reading(places, 1000.0, MILLISECONDS, 1.0, float(places[0]) / 1000, (note,))


def _milliseconds_of_the_second(stamps: Stamps) -> Iterator[Reading]:
    """`FF.mmm`: the frame, then the milliseconds of the second."""
    part, frames = stamps.fraction, stamps.last
    if not np.all(stamps.digits == 3) or len(np.unique(part[frames > 0])) < 3:
        return
    note = "the digits after the frames are milliseconds of the second"
    for base in BASES:
        late = part * (base / 1000) - frames  # in frames; some writers round down, some to even
        if np.all(np.abs(late) < 0.1 + base / 1000):
            places = stamps.clock * base + frames
            begin = float(places[0]) / base
            yield Reading(places, float(base), base, 1.0, begin, (f"{note}: not counted",))
        for rate in (base, _BROADCAST.get(base, base)):
            late = part * (rate / 1000) - frames
            if np.all((late > -0.6) & (late < 1.1)) and np.corrcoef(part, frames)[0, 1] > 0.99:
                places = 1000.0 * stamps.clock + part
                yield Reading(places, 1000.0, MILLISECONDS, 1.0, float(places[0]) / 1000, (note,))
                return


def _running_number(stamps: Stamps, plain: Reading) -> Iterator[Reading]:
    """`FF.nnn`: nnn is the number of the frame in the film, modulo 1000."""
    if not np.all(stamps.digits == 3):
        return
    base = plain.base
    more = np.diff(stamps.fraction)
    numbers = np.concatenate([[0.0], np.cumsum(more % 1000)])
    frames = stamps.clock * base + stamps.last
    differs = np.diff(numbers) - np.diff(frames)
    inside = np.diff(stamps.clock) == 0
    if not np.any(more) or np.any(differs[inside]) or np.any(np.abs(differs) > 1):
        return
    # Thousandths of a frame can also grow by one a row, if a camera runs 0.1 % slow. But they carry
    # over into the frames, and a frame number begins with the film.
    is_first = abs((frames[0] - stamps.fraction[0] + 2) % 1000 - 2) <= 1
    if not np.any((more < 0) & inside) and not (is_first and stamps.clock[0] < _FILM):
        return
    rates = [float(base), _BROADCAST.get(base, float(base))]
    spans = [np.ptp(numbers - (stamps.clock * rate + stamps.last)) for rate in rates]
    rate = rates[int(np.argmin(spans))]
    note = "the digits after the frames number the frames of the film: not counted"
    begin = float(stamps.clock[0] + stamps.last[0] / rate)
    yield Reading(numbers, rate, base, 0.0, begin, (note, *plain.notes))


def _wrongly_marked(stamps: Stamps) -> Iterator[Reading]:
    """Drop-frame timecode written with a colon, or the reverse."""
    if stamps.clock[0] // 60 == stamps.clock[-1] // 60:
        return
    other = _plain(stamps, not stamps.drop)
    if can_drop(other.base) and (stamps.drop or not _has_dropped_number(stamps, other.base)):
        what = "leaves out no numbers" if stamps.drop else "leaves out numbers at full minutes"
        is_drop = "not drop-frame" if stamps.drop else "drop-frame"
        note = f"the timecode {what}: it is read as {is_drop}"
        yield replace(other, notes=(*other.notes, note))


def _numbered_at_broadcast_rate(stamps: Stamps, plain: Reading) -> Iterator[Reading]:
    """Frame n of a film of 29.97 fps at second n / 29.97 and frame n % 29.97, rounded down.

    Every 33 s a number is skipped, which looks like a lost frame. This reading is used if that
    cannot be chance, because fewer frames are lost elsewhere.
    """
    rate = _BROADCAST.get(plain.base)
    if stamps.drop or rate is None or np.ptp(stamps.fraction):
        return
    places = np.ceil(stamps.clock * rate + stamps.last - 1e-6)
    steps, plain_steps = np.diff(places), np.diff(plain.places)
    inside = plain_steps[np.diff(stamps.clock) == 0]
    left_out = int((steps != plain_steps).sum())
    over = steps[np.diff(stamps.clock) > 0]
    even = len(over) > 0 and np.mean(over == 1) > _MOST_EVEN
    if left_out and even and len(inside) and np.median(inside) == 1:
        lost = (inside != 1).sum() + 1
        if (lost / len(plain_steps)) ** left_out < _CHANCE:
            note = f"frame numbers skip as at {rate:.2f} fps: no frame is lost there"
            yield Reading(places, rate, plain.base, 0.0, float(places[0]) / rate, (note,))


def _unevenness(places: Times) -> float:
    """How much the steps between rows differ from the ordinary one, in ordinary steps."""
    steps = np.diff(places)
    if not np.any(steps > 0):
        return np.inf
    step = float(np.median(steps[steps > 0]))
    ratio = steps / step
    off = np.minimum(np.abs(ratio - 1), _WORST)
    off[off < _OFF] = 0.0
    # Lost frames count little against a reading.
    lost = (ratio > 1.5) & (np.abs(ratio - np.round(ratio)) < _OFF)
    off[lost] *= _LOST
    off[steps <= 0] = _WORST
    return float(off.sum())


def _has_dropped_number(stamps: Stamps, base: int) -> bool:
    """Whether a row has a number that drop-frame timecode does not have."""
    full = (stamps.clock % 60 == 0) & (stamps.clock % 600 != 0)
    return bool(np.any(full & (stamps.last < dropped_numbers(base))))


def dropped_numbers(base: int) -> int:
    """How many numbers drop-frame skips at each full minute except every tenth: 2 of 30."""
    return max(1, round(base / 15))


def can_drop(base: int) -> bool:
    """Whether there is drop-frame timecode of this base; `;` may stand in any timecode."""
    return base % 30 == 0


def count_frames(stamps: Stamps, base: int, drop: bool) -> Times:
    """(T,) frames of the base since midnight of the first day."""
    counts: Times = stamps.clock * base + stamps.frames
    if drop:
        minutes = stamps.clock // 60
        counts = counts - dropped_numbers(base) * (minutes - minutes // 10)
    return counts
