"""Find the place, size and orientation of a character's face from its shapes.

Files may be in any unit, with any axis up. The shapes that close the eyes show where the eyes are
(the eyeballs, if there are none), and those of the mouth show the mouth: the eyes are 63 mm apart,
up is from the mouth to the eyes, and forward is from inside the head to the mouth. How far a head
nods is also seen in how its shapes move it: lids fall, brows rise, and lips are pushed forward.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray

from faceedit_app.characters.character import Character
from faceedit_app.characters.eyeballs import find_eyeballs
from faceedit_app.characters.matches import Half, Share
from faceedit_app.core.arrays import Bools, Doubles, Indices
from faceedit_app.core.errors import FileError

Shares = Mapping[str, Sequence[Share]]

EYES_APART = 63.0  # mm, the mean of adults
_EYES = ("eyeBlinkLeft", "eyeBlinkRight")
_MOUTH = (
    *("mouthPucker", "mouthFunnel", "mouthSmileLeft", "mouthSmileRight", "mouthRollUpper"),
    *("mouthRollLower", "mouthUpperUpLeft", "mouthUpperUpRight", "mouthLowerDownLeft"),
    *("mouthLowerDownRight", "mouthStretchLeft", "mouthStretchRight"),
)
_FAR = 0.5  # of a blink's largest move; what moves farther is the lid
_HEAD = 2.5  # eye distances around the eyes; the size of the head
_BODY = 8.0  # eye distances; a file that reaches farther holds a body, which stands upright
_UPRIGHT = 0.85  # cosine to an axis of the file above which that axis is up
_SURELY = 0.94  # the same, if the moves of shapes show which way is up, too
# Shapes that show which way is up by moving there (1), or away from it (-1).
_RISING = ((("browInnerUp",), 1.0), (_EYES, -1.0))
_FORWARD = ("mouthPucker", "mouthFunnel")
_STRAIGHT = 0.5  # of a shape: the share of its moves that have one direction
_CUES, _AGREED = 3, 0.9  # how many cues are needed, and how long their mean must be
_MASK = 0.4  # eye distances; a head's mouth is farther than this before its middle
_LEVEL = 0.9976  # cosine of 4 degrees, for the axis through the eyes


@dataclass(frozen=True)
class FaceFrame:
    """Transforms the file's coordinates to the face's: metres, X left, Y up, Z forward.

    Attributes:
        axes: (3, 3), rows X, Y and Z in the file's coordinates.
        origin: (3,) in the file's coordinates: midway between the eyes.
        scale: metres per unit of the file.
        swapped: whether the shapes named left move the character's right side.
        nods: degrees by which the moves of its shapes differ from upright as it is shown.
    """

    axes: Doubles
    origin: Doubles
    scale: float
    swapped: bool = False
    nods: float = 0.0

    def places(self, points: NDArray[np.floating]) -> Doubles:
        """Points (..., 3) of the file in the face's coordinates."""
        return self.moves(points - self.origin)

    def moves(self, vectors: NDArray[np.floating]) -> Doubles:
        """Vectors (..., 3) of the file in the face's coordinates."""
        turned: Doubles = (vectors @ self.axes.T) * self.scale
        return turned


def find_frame(
    character: Character, shares: Shares, target: Callable[[int, str], NDArray[np.float32] | None]
) -> FaceFrame:
    """Find the face of a character.

    Args:
        shares: the shapes that make each channel.
        target: returns the displacements (V, 3) of a part's target by its name.

    Raises:
        FileError: no shape closes one of the eyes, or none moves the mouth.
    """
    path = character.path
    points = np.concatenate([part.neutral for part in character.parts]).astype(np.float64)

    def amount(channels: Sequence[str]) -> Doubles:
        """(V,) how far channels move each vertex; all channels count the same."""
        total = np.zeros(len(points))
        for channel in channels:
            moves = [_moves(character, i, shares.get(channel, ()), target) for i in parts]
            one = np.linalg.norm(np.concatenate(moves), axis=1)
            total += one / max(float(one.max(initial=0.0)), 1e-12)
        return total

    parts = range(len(character.parts))
    mouth = amount([c for c in _MOUTH if c in shares])
    if not mouth.any():
        mouth = amount(["jawOpen"])
    if not any(shares.get(channel) for channel in _EYES) and mouth.any():
        eyes = find_eyeballs(character, _centre(points, mouth))
        if eyes is not None:
            kept = _each_once(points, mouth > 0)
            return _frame(path, points[kept], eyes, _centre(points[kept], mouth[kept]), False, ())
    _need_eyes(path, shares)
    left, right = (amount([channel]) for channel in _EYES)
    for name, moved in (("left eye", left), ("right eye", right), ("mouth", mouth)):
        if not moved.any():
            raise FileError(path, f"its shapes for the {name} move nothing", "export them again")
    # Each vertex counts once, even if seams repeat it.
    kept = _each_once(points, left + right + mouth > 0)
    points, left, right, mouth = points[kept], left[kept], right[kept], mouth[kept]
    is_one = any(share.half != Half.WHOLE for c in _EYES for share in shares[c])
    centres = _two_eyes(points, left) if is_one else (_lids(points, left), _lids(points, right))
    cues = _cues(character, shares, target)
    return _frame(path, points, centres, _centre(points, mouth), not is_one, cues)


def _cues(
    character: Character, shares: Shares, target: Callable[[int, str], NDArray[np.float32] | None]
) -> list[tuple[Doubles, bool]]:
    """Directions (3,) that are up, or forward (True), in which shapes move the face."""

    def direction(channels: Sequence[str]) -> Doubles | None:
        mine = [share for channel in channels for share in shares.get(channel, ())]
        if any(share.half not in (Half.WHOLE, Half.LEFT, Half.RIGHT) for share in mine):
            return None  # a part of an expression
        parts = range(len(character.parts))
        moves = np.concatenate([_moves(character, i, mine, target) for i in parts])
        amount = np.linalg.norm(moves, axis=1)
        total: Doubles = amount @ moves
        is_straight = np.linalg.norm(total) > _STRAIGHT * float(amount @ amount)
        return total / np.linalg.norm(total) if is_straight else None

    found = [(direction(names), sign, False) for names, sign in _RISING]
    found.append((direction(_FORWARD), 1.0, True))
    return [(sign * way, forward) for way, sign, forward in found if way is not None]


def _each_once(points: Doubles, moved: Bools) -> Indices:
    """The vertices to count: all, but of moved vertices in the same place only one."""
    rows = np.flatnonzero(moved)
    first = trimesh.grouping.unique_rows(points[rows] / np.ptp(points[rows], axis=0).max(), 6)[0]
    kept: Indices = np.concatenate((rows[first], np.flatnonzero(~moved)))
    return kept


def _moves(
    character: Character,
    part: int,
    shares: Sequence[Share],
    target: Callable[[int, str], NDArray[np.float32] | None],
) -> Doubles:
    total = np.zeros(character.parts[part].neutral.shape)
    for share in shares:
        moves = target(part, share.name)
        if moves is not None:
            total += share.weight * moves
    return total


def _need_eyes(path: object, shares: Shares) -> None:
    missing = [channel for channel in _EYES if not shares.get(channel)]
    if not missing:
        return
    if len(missing) == 1:
        side = missing[0].removeprefix("eyeBlink").lower()
        problem = f"has no shape that closes the {side} eye ({missing[0]})"
    else:
        problem = "has no shapes that close the eyes (eyeBlinkLeft, eyeBlinkRight)"
    raise FileError(str(path), problem, "name or add them, or name them in its map")


def _centre(points: Doubles, amount: Doubles) -> Doubles:
    centre: Doubles = (points * amount[:, None]).sum(axis=0) / amount.sum()
    return centre


def _two_eyes(points: Doubles, amount: Doubles) -> tuple[Doubles, Doubles]:
    """The centres of the two eyes that one shape closes, as two clusters of moved vertices."""
    centre = _centre(points, amount)
    spread = (points - centre) * np.sqrt(amount)[:, None]
    across = np.linalg.svd(spread, full_matrices=False)[2][0]
    side = (points - centre) @ across
    one, other = (_lids(points, np.where(s * side > 0, amount, 0.0)) for s in (1, -1))
    return one, other


def _lids(points: Doubles, amount: Doubles) -> Doubles:
    """The centre of an eye: of what a blink moves far; skin beside it may follow a little."""
    return _centre(points, (amount > _FAR * amount.max()).astype(np.float64))


def _frame(
    path: object,
    points: Doubles,
    eyes: tuple[Doubles, Doubles],
    mouth: Doubles,
    named: bool,
    cues: Sequence[tuple[Doubles, bool]],
) -> FaceFrame:
    middle, across = (eyes[0] + eyes[1]) / 2, eyes[0] - eyes[1]
    apart = float(np.linalg.norm(across))
    if not np.isfinite(apart) or apart < 1e-9:
        raise FileError(str(path), "its two eyes are in one place", "check its eyeBlink shapes")
    x = _snapped(across / apart, _LEVEL)
    up = middle - mouth
    up -= x * (up @ x)
    if np.linalg.norm(up) < 0.2 * apart:
        raise FileError(str(path), "its mouth is not below its eyes", "check its mouth shapes")
    away = np.linalg.norm(points - middle, axis=1)
    head = points[away < _HEAD * apart].mean(axis=0)
    forward = [way for way, is_forward in cues if is_forward]
    if away.max() > _BODY * apart:
        cues = ()
    y, shown_by_moves = _upwards(up / np.linalg.norm(up), x, cues)
    nods = np.degrees(np.arccos(np.clip(y @ shown_by_moves, -1.0, 1.0)))
    y -= x * (y @ x)
    y /= np.linalg.norm(y)
    z = np.cross(x, y)
    ahead = float((mouth - head) @ z) / apart
    if abs(ahead) < _MASK and forward:  # no back of the head shows where the front is
        ahead = float(forward[0] @ z)
    backwards = ahead < 0
    if backwards:  # left and right are swapped
        x, z = -x, -z
    scale, axes = EYES_APART / 1000.0 / apart, np.stack((x, y, z))
    return FaceFrame(axes, middle, scale, backwards and named, float(nods))


def _upwards(
    up: Doubles, x: Doubles, cues: Sequence[tuple[Doubles, bool]]
) -> tuple[Doubles, Doubles]:
    """Which way is up, given that from the mouth to the eyes and the axis through the eyes.

    Returns:
        The way up, and that which the moves of shapes show, or the same if they do not agree.
    """
    ways = [up]
    for cue, is_forward in cues:
        way = np.cross(cue, x) if is_forward else cue - x * (cue @ x)
        if is_forward:  # x may be the face's right
            way = way * np.sign(way @ up)
        size = float(np.linalg.norm(way))
        if size > _STRAIGHT:
            ways.append(way / size)
    mean: Doubles = np.mean(ways, axis=0)
    length = float(np.linalg.norm(mean))
    if len(ways) < _CUES or length < _AGREED:
        way = _snapped(up, _UPRIGHT)
        return way, way
    return _snapped(mean / length, _SURELY), mean / length


def _snapped(axis: Doubles, nearness: float) -> Doubles:
    """The axis of the file near a given one, else that one: most heads are upright."""
    largest = int(np.abs(axis).argmax())
    if abs(axis[largest]) < nearness:
        return axis.copy()
    snapped = np.zeros(3)
    snapped[largest] = np.sign(axis[largest])
    return snapped
