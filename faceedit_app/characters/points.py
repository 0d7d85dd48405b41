"""Find the control points from the shapes alone.

Without landmarks or knowledge of the mesh, a vertex is recognised by how the shapes move it. The
inner lips are the two points on the midline that are together until jawOpen parts them; a mouth
corner is where the shortest way around the mouth, from one inner lip to the other, is farthest out;
the upper lid is what eyeBlink lowers most, and the lower lid is where it arrives. The points of the
brows are found in `brow_points`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from faceedit_app.characters.brow_points import find_brow
from faceedit_app.characters.face import NotFound, Points, WeldedFace
from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.controls import CONTROLS

# Each control that can be looked for, and its two control points, in the order of the table.
PAIRS: tuple[tuple[str, str, str], ...] = tuple(
    (control.id, *control.between) for control in CONTROLS if control.between is not None
)
POINTS: tuple[str, ...] = tuple(dict.fromkeys(name for pair in PAIRS for name in pair[1:]))
# Those that every face has; the others are found only if shapes move them.
MAIN_POINTS: tuple[str, ...] = tuple(
    dict.fromkeys(name for c in CONTROLS if c.between and not c.optional for name in c.between)
)
# Channels that part the lips; the first that does is used.
_OPENERS = ("jawOpen", "mouthFunnel", "mouthUpperUpLeft")
_PARTED = 3.0  # mm
_MIDLINE, _WIDEST = 1.5, 9.0  # mm to either side of the midline where lips are looked for
_TOUCHING = 2.5  # mm; inner lips that rest farther apart are looked for beside the midline, too
_LEVEL = (9.0, 20.0)  # mm above or below the eyes; the second for coarse meshes
_PROFILE, _NO_CHIN = 3, 15.0  # vertices of a profile; mm beside the midline that are no chin
_BLINKS = 1.5  # mm that a blink moves the upper lid at least
_ACROSS = (1.5, 4.0)  # mm beyond the middle where the rim of the mouth may run


def find_points(face: WeldedFace) -> tuple[Points, list[str]]:
    """Find the control points, as vertices of `face`.

    Returns:
        The points that were found, and a sentence about each that was not.
    """
    points: Points = {}
    problems: list[str] = []

    def look(find: Callable[[], Points]) -> None:
        try:
            points.update(find())
        except NotFound as error:
            problems.append(str(error))

    look(lambda: _mouth(face))
    look(lambda: _lids(face, "left"))
    look(lambda: _lids(face, "right"))
    look(lambda: {"nose_bridge": _bridge(face)})
    if "lower_lip" in points:
        look(lambda: {"chin": _chin(face, points["lower_lip"])})
    for side in ("left", "right"):
        if f"{side}_upper_lid" in points:
            points.update(find_brow(face, side, points))
    return {name: points[name] for name in POINTS if name in points}, problems


def _mouth(face: WeldedFace) -> Points:
    """Lips and mouth corners."""
    opener = next((c for c in _OPENERS if face.amount(c)[face.skin].max() > _PARTED), None)
    if opener is None:
        raise NotFound("no shape opens the mouth (jawOpen)")
    opened = face.move(opener)
    points = _lips(face, opened)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        points[f"{side}_mouth_corner"] = _corner(face, opened, points, sign)
    return points


def _lips(face: WeldedFace, opened: Doubles) -> Points:
    """Inner and outer lips on the midline."""
    places = face.places
    middle = np.zeros(0, np.intp)
    tolerance, best = _MIDLINE, -np.inf
    below = np.where(face.skin & (places[:, 1] < -20), face.lips, 0.0)
    inner: tuple[int, int] | None = None
    while tolerance < _WIDEST and (inner is None or _apart(places, *inner) > _TOUCHING):
        # Compared on the midline: the corners move much more if there are few shapes.
        near = np.where(np.abs(places[:, 0] - face.middle) < tolerance, below, 0.0)
        strip = _both_lips(near, opened[:, 1])
        tolerance *= 1.3
        if len(strip) < (8 if tolerance < _WIDEST else 4):
            continue
        pair, score = _inner_lips(face, opened, strip)
        if score > best:  # a crooked mouth has its nearest pair farther from the midline
            inner, best, middle = pair, score, strip
    if inner is None:
        raise NotFound("the lips cannot be found on the midline")
    points = dict(zip(("inner_upper_lip", "inner_lower_lip"), inner, strict=True))
    # No shape shows the border of the red: use the most forward vertex of each lip.
    for name, number, sign in (("upper_lip", inner[0], 1.0), ("lower_lip", inner[1], -1.0)):
        above = sign * (places[middle, 1] - places[number, 1])
        near_it = middle[(above > -0.5) & (above < 12)]
        points[name] = int(near_it[places[near_it, 2].argmax()])
    return points


def _both_lips(near: Doubles, drop: Doubles) -> Indices:
    """The vertices that shapes of lips clearly move.

    Args:
        near: (N,) how much they move each vertex near the midline; 0 for others.
        drop: (N,) mm, how the opened mouth moves each upwards.
    """
    moved = near > 0.0
    clearly = moved & (near > 0.5 * near.max())
    deepest = float(drop[moved].min(initial=0.0))
    lower = drop < 0.5 * deepest
    for lip in (lower, ~lower):
        if not (clearly & lip).any():  # the other one has more shapes
            clearly |= moved & lip & (near > 0.5 * near[lip].max(initial=0.0))
    strip: Indices = np.flatnonzero(clearly)
    return strip


def _inner_lips(face: WeldedFace, opened: Doubles, strip: Indices) -> tuple[tuple[int, int], float]:
    """The vertices of a strip at the midline that are together until the mouth opens; a score."""
    places = face.places
    drop = opened[strip, 1]
    upper, lower = strip[drop > 0.35 * drop.min()], strip[drop < 0.65 * drop.min()]
    if not len(upper) or not len(lower):
        raise NotFound("no shape parts the lips (jawOpen)")
    moved = places + opened
    at_rest = np.linalg.norm(places[upper][:, None] - places[lower], axis=2)
    parted = np.linalg.norm(moved[upper][:, None] - moved[lower], axis=2)
    forward = places[upper][:, None, 2] + places[lower][:, 2]
    aside = np.abs(places[upper, 0] - face.middle)[:, None] + np.abs(places[lower, 0] - face.middle)
    score = (parted - at_rest) - 3 * at_rest + 0.5 * forward - 0.25 * aside
    i, k = np.unravel_index(score.argmax(), score.shape)
    return (int(upper[i]), int(lower[k])), float(score[i, k])


def _apart(places: Doubles, one: int, other: int) -> float:
    return float(np.linalg.norm(places[one] - places[other]))


def _corner(face: WeldedFace, opened: Doubles, points: Points, sign: float) -> int:
    """The vertex where the way around the mouth is farthest out on one side."""
    places = face.places
    start, end = points["inner_upper_lip"], points["inner_lower_lip"]
    close = (
        face.skin
        & (places[:, 2] > places[start, 2] - 45)
        & (np.abs(places[:, 1] - places[start, 1]) < 25)
    )
    for across in _ACROSS:  # a crooked mouth crosses the midline beside its own middle
        way = face.way(
            close & (sign * (places[:, 0] - places[start, 0]) > -across), start, end, opened
        )
        if way is not None:
            return way[int((sign * places[way, 0]).argmax())]
    raise NotFound("the lips are not joined at the mouth corners")


def _lids(face: WeldedFace, side: str) -> Points:
    """The middle of the upper lid, and the point of the lower lid where it arrives in a blink."""
    blink, places = face.move(f"eyeBlink{side.capitalize()}"), face.places
    drop = np.where(face.skin, -blink[:, 1], -np.inf)
    if drop.max() < 0.5:
        raise NotFound(f"no shape closes the {side} eye (eyeBlink{side.capitalize()})")
    if drop.max() < _BLINKS:
        raise NotFound(
            f"eyeBlink{side.capitalize()} moves the lid by only {drop.max():.1f} mm: open the "
            f"{side} eye in the neutral shape of the file if it is closed there"
        )
    lid = places[drop > 0.5 * drop.max(), 0]
    middle = (lid.min() + lid.max()) / 2
    shut = places + blink
    # The rim is what comes lowest; take its middle, without the corners of the eye.
    aside = np.abs(places[:, 0] - middle)
    upper = int(np.where(drop > 0.7 * drop.max(), shut[:, 1] + 0.4 * aside, np.inf).argmin())
    near = np.flatnonzero(
        face.skin
        & (places[:, 1] < places[upper, 1] - 2)
        & (np.abs(places[:, 0] - places[upper, 0]) < 6)
        & (-blink[:, 1] < 0.45 * drop[upper])
        & (places[:, 2] > places[upper, 2] - 14)
    )
    if not len(near):
        raise NotFound(f"the {side} lower lid cannot be found")
    gap = np.linalg.norm(shut[near] - shut[upper], axis=1)
    gap = gap + 0.3 * np.abs(places[near, 0] - places[upper, 0])
    return {f"{side}_upper_lid": upper, f"{side}_lower_lid": int(near[gap.argmin()])}


def _midline(face: WeldedFace) -> Indices:
    width = 2.5
    found = np.flatnonzero(face.skin & (np.abs(face.places[:, 0] - face.middle) < width))
    while len(found) < 12 and width < 10:
        width *= 1.3
        found = np.flatnonzero(face.skin & (np.abs(face.places[:, 0] - face.middle) < width))
    return found


def _bridge(face: WeldedFace) -> int:
    """The nose bridge: on the midline at the height of the eyes, in front."""
    middle = _midline(face)
    x, y, z = face.places[middle].T
    for within in _LEVEL:
        level = np.abs(y) < within
        if level.any():
            forward = z - 0.25 * np.abs(y) - 0.5 * np.abs(x - face.middle)
            return int(middle[np.where(level, forward, -np.inf).argmax()])
    raise NotFound("the nose bridge cannot be found between the eyes")


def _chin(face: WeldedFace, lower_lip: int) -> int:
    """The chin: the most forward point of the midline below the fold under the lip."""
    places, middle = face.places, _midline(face)
    lip = places[lower_lip, 1]
    below = middle[(places[middle, 1] < lip - 1) & (places[middle, 1] > lip - 48)]
    if len(below) < _PROFILE:
        return _lone_chin(face, lip)
    heights = np.arange(lip - 4, lip - 44, -1.0)
    profile = _profile(places[below], heights)
    fold = next(
        (i for i in range(2, 22) if profile[i] <= profile[i - 1] and profile[i] < profile[i + 1]),
        None,
    )
    top = 20 if fold is None else fold + int(np.argmax(profile[fold : fold + 20]))
    apart = np.abs(places[below, 1] - heights[top]) + 0.7 * np.abs(places[below, 0] - face.middle)
    nearest = below[np.argsort(apart)[:6]]
    return int(nearest[places[nearest, 2].argmax()])


def _lone_chin(face: WeldedFace, lip: float) -> int:
    """The chin of a mesh too coarse for a profile: the most forward vertex below the lip."""
    x, y, z = face.places.T
    aside = np.abs(x - face.middle)
    near = face.skin & (y < lip - 8) & (y > lip - 48) & (aside < _NO_CHIN)
    if not near.any():
        raise NotFound("the chin cannot be found below the lower lip")
    return int(np.where(near, z - aside, -np.inf).argmax())


def _profile(places: Doubles, heights: Doubles) -> Doubles:
    """How far forward the midline is at each height, mm, smoothed."""
    near = np.abs(places[:, 1][:, None] - heights) < 2.5
    forward = np.where(near, places[:, 2][:, None], -np.inf).max(axis=0)
    known = np.flatnonzero(np.isfinite(forward))
    if not len(known):
        raise NotFound("the chin cannot be found below the lower lip")
    filled = np.interp(np.arange(len(heights)), known, forward[known])
    smooth: Doubles = np.convolve(np.pad(filled, 2, "edge"), np.ones(5) / 5, "valid")
    return smooth
