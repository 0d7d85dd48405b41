"""What is a person's own: their neutral face on the rig, and how far their lids open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Indices
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING, MOUTH_WIDTH
from faceedit_app.tracking.face_model import FaceModel
from faceedit_app.tracking.face_points import CONTROL_PAIRS, IRISES
from faceedit_app.tracking.face_points import LIDS as LIDS_AROUND
from faceedit_app.tracking.pose import Lens, Poses, fit_poses

_NEUTRAL = 1 / 15  # share of the pictures that count as neutral
_FEWEST = 3
_MOST = 1500  # pictures, spread over the film, that show enough of a person
_WHILE = 9  # pictures
_DEPTH = 0.5  # how far the landmarks' depth is believed
_TOUCH = 3.0  # percentile of the distance between the lips at which they touch
_ALIKE = 1.0  # mm above it; lips that look like that touch
_FARTHEST_TOUCH = 3.0  # mm; lips whose landmarks are farther apart never touch in the film
_USUAL_TOUCH = 0.5  # mm between the landmarks of lips that touch, in most films
_OPEN = 70.0  # percentile of the distance between the lids at which an eye is at rest
_SHUT = 2.0  # percentile at which it is shut, if it ever is
_SHUT_SHARE = (0.05, 0.3)  # of the distance at rest; a shut eye is in this range
_DISTANCES = (600.0, 800.0, 1100.0, 1600.0, 3000.0)  # mm from the camera that are tried


@dataclass(frozen=True)
class Person:
    """The person in a film, seen on the rig.

    Attributes:
        rest: (n, 3) mm, the landmarks of the person's neutral face, in the rig's place and size.
        neutral: indices of the pictures from which it is taken.
        lens: how the camera sees them.
        touch: mm between the lips where they touch.
        lids: (2, 2) mm between the lids, left and right: shut, and at rest.
        is_ajar: whether the lips never touch.
    """

    rest: Doubles
    neutral: Indices
    lens: Lens
    touch: float
    lids: Doubles
    is_ajar: bool = False


def find_person(model: FaceModel, seen: Doubles, good: Bools, middle: Doubles) -> Person:
    """Find a person's neutral face.

    Args:
        model: the landmarks on the rig.
        seen: (T, n, 3) pixels, see `fit_poses`.
        good: (T,) the pictures that may be used.
        middle: (2,) the middle of the picture, pixels, with the second axis upwards.
    """
    used = np.flatnonzero(good)
    used = used[:: max(len(used) // _MOST, 1)]
    lens, poses = _lens(model, seen[used], middle)
    some = lens.flatten(seen[used], poses, model.rest)
    placed = _placed(some, poses)
    gaps = {c: gap_of(model, placed, c) for c in (LIP_OPENING, MOUTH_WIDTH, *LIDS)}
    neutral = used[_quiet(gaps)]
    # Turned heads are foreshortened: the pictures in which the person looks at the camera count.
    calm = np.isin(used, neutral)
    depth = _DEPTH * (np.median(placed[calm, :, 2], axis=0) - model.rest[:, 2])
    # The iris's depth is not measured, and would turn the eyes with the head.
    pupils, around = (np.isin(model.numbers, some) for some in (IRISES, LIDS_AROUND))
    depth[pupils] = depth[around].mean()
    rest = model.rest.copy()
    rest[:, 2] += depth
    poses = fit_poses(some, rest, model.steady)
    flat = poses.on_face(some[..., :2], rest[:, 2])
    rest[:, :2] = np.median(flat[calm], axis=0)
    rest[pupils, :2] = np.median(flat[:, pupils], axis=0)
    rest -= _opened(model, gaps[LIP_OPENING], calm)
    touch, is_ajar = _touch(gap_of(model, flat, LIP_OPENING))
    lids = np.array([_lid(gap_of(model, flat, control)) for control in LIDS])
    return Person(rest, neutral, lens, touch, lids, is_ajar)


def _lens(model: FaceModel, seen: Doubles, middle: Doubles) -> tuple[Lens, Poses]:
    """The distance at which turned heads keep their shape best, and the poses there."""
    tried = []
    for distance in _DISTANCES:
        lens = Lens(middle, distance)
        poses = fit_poses(seen, model.rest, model.steady)
        for _ in range(2):
            flat = lens.flatten(seen, poses, model.rest)
            poses = fit_poses(flat, model.rest, model.steady)
        placed = poses.on_face(flat[..., :2], model.rest[:, 2])
        away = placed - np.median(placed, axis=0)
        tried.append((float(model.weights @ (away**2).mean(axis=(0, 2))), lens, poses))
    _, lens, poses = min(tried, key=lambda one: one[0])
    return lens, poses


def _opened(model: FaceModel, gap: Doubles, calm: Bools) -> Doubles:
    """(n, 3) mm: what an open jaw moves in the neutral pictures, where the lips are to be shut.

    Args:
        gap: (T,) mm between the lips.
        calm: (T,) which pictures are neutral.
    """
    upper, lower = (model.row(number) for number in CONTROL_PAIRS[CONTROL_INDEX[LIP_OPENING]])
    moves = model.moves[ARKIT_INDEX["jawOpen"]]
    opens = float(moves[upper, 1] - moves[lower, 1])
    moved: Doubles = max(float(np.median(gap[calm])) - _touch(gap)[0], 0.0) / opens * moves
    return moved


def _placed(seen: Doubles, poses: Poses) -> Doubles:
    """Landmarks (T, n, 3) in the rig's place, mm, their depth as it was seen."""
    middle = seen[..., 2].mean(axis=1)
    whole = np.concatenate([poses.shifts, middle[:, None]], axis=1)
    turned = (seen - whole[:, None]) / poses.scales[:, None, None]
    placed: Doubles = np.einsum("tji,tnj->tni", poses.turns, turned)
    return placed


def gap_of(model: FaceModel, points: Doubles, control: str) -> Doubles:
    """(T,) mm between the two landmarks of a control: up for lids and lips, else across as well."""
    first, second = (model.row(number) for number in CONTROL_PAIRS[CONTROL_INDEX[control]])
    apart = points[:, first] - points[:, second]
    gap: Doubles = (
        np.linalg.norm(apart[:, :2], axis=1) if control == MOUTH_WIDTH else np.abs(apart[:, 1])
    )
    return gap


def _quiet(gaps: dict[str, Doubles]) -> Indices:
    """The calmest pictures: mouth shut, lids and width as they mostly are, nothing moving."""

    def apart(values: Doubles) -> Doubles:
        away: Doubles = np.abs(values / max(float(np.median(values)), 1e-6) - 1.0)
        return away

    lips = gaps[LIP_OPENING]
    unrest = (lips - lips.min()) / 5.0 + apart(gaps[MOUTH_WIDTH])
    unrest = unrest + 2.0 * sum(apart(gaps[lid]) for lid in LIDS)
    # Lips that are pressed for a b are shut as well: a face at rest stays as it is for a while.
    together = np.stack(list(gaps.values()))
    steps = np.abs(np.diff(together, axis=1, prepend=together[:, :1])).sum(axis=0)
    unrest = unrest + uniform_filter1d(steps, _WHILE, mode="nearest")
    count = max(_FEWEST, round(len(lips) * _NEUTRAL))
    return np.argsort(unrest, kind="stable")[:count].astype(np.intp)


def _touch(gap: Doubles) -> tuple[float, bool]:
    """Mm between the landmarks of lips that touch, and whether they never do, by all pictures (T,).

    Lips that touch look alike in many pictures, and a little closer in some. Of lips that never do,
    the film does not show it.
    """
    least = float(np.percentile(gap, _TOUCH))
    if least > _FARTHEST_TOUCH:
        return _USUAL_TOUCH, True
    touch = float(np.median(gap[gap <= least + _ALIKE]))
    return min(touch, _FARTHEST_TOUCH), False


def _lid(gap: Doubles) -> Doubles:
    """(2,) mm between the lids of an eye: shut, at rest."""
    rest = float(np.percentile(gap, _OPEN))
    least, most = _SHUT_SHARE
    shut = float(np.clip(np.percentile(gap, _SHUT), least * rest, most * rest))
    return np.array([shut, rest])
