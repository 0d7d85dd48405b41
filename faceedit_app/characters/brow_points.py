"""Find the control points of the brows from the shapes alone.

A brow is where the shapes that raise and lower it all move the face most; it may be a mesh of its
own. Its height is measured from the inner corner of the eye, which is where the shortest way around
the eye, from lid to lid, is nearest to the nose.
"""

from __future__ import annotations

import numpy as np

from faceedit_app.characters.face import Points, WeldedFace

_ABOVE = (2.5, 45.0)  # mm of the brow above the upper lid
_BESIDE = 26.0  # mm from the middle of the eye to either side
_BEHIND = 16.0  # mm behind the upper lid; hair and ears are farther back
_STILL = 3.0  # mm farther from the nose that a vertex may be for each mm that a blink moves it less
_VISIBLE = 0.5  # mm that a shape has to move the brow
_FAINT = 0.08  # of the largest move: what a shape counts where it moves nothing


def find_brow(face: WeldedFace, side: str, points: Points) -> Points:
    """The two control points of a brow; none if no shape moves it.

    Args:
        side: `left` or `right`.
        points: those that were found, with the lids of this eye.
    """
    brow = _brow(face, side, points[f"{side}_upper_lid"])
    if brow is None:
        return {}
    return {f"{side}_eye_corner": _inner_corner(face, side, points), f"{side}_brow": brow}


def _brow(face: WeldedFace, side: str, upper_lid: int) -> int | None:
    """The vertex of a brow that its shapes move most; None if no shape moves it.

    Args:
        side: `left` or `right`.
        upper_lid: the middle of the upper lid.
    """
    places, lid = face.places, face.places[upper_lid]
    near = (
        (places[:, 1] > lid[1] + _ABOVE[0])
        & (places[:, 1] < lid[1] + _ABOVE[1])
        & (np.abs(places[:, 0] - lid[0]) < _BESIDE)
        & (places[:, 2] > lid[2] - _BEHIND)
    )
    if not near.any():
        return None
    name = side.capitalize()
    score = np.ones(len(places))
    count = 0
    for channel, sign in (
        (f"browDown{name}", -1.0),
        (f"browOuterUp{name}", 1.0),
        ("browInnerUp", 1.0),
    ):
        moved = np.where(near, np.maximum(sign * face.move(channel)[:, 1], 0.0), 0.0)
        if moved.max() >= _VISIBLE:
            score *= moved / moved.max() + _FAINT
            count += 1
    if not count:
        return None
    score = np.where(near, score, 0.0)
    # The middle of what moves: the largest move alone is often on a crease or at an end.
    weight = np.where(score > 0.5 * score.max(), score, 0.0)
    middle = weight @ places / weight.sum()
    away = np.linalg.norm(places - middle, axis=1)
    return int(np.where(weight > 0, away, np.inf).argmin())


def _inner_corner(face: WeldedFace, side: str, points: Points) -> int:
    """The inner corner of an eye.

    Args:
        side: `left` or `right`.
        points: the control points that were found, with the lids of this eye.
    """
    upper, lower = points[f"{side}_upper_lid"], points[f"{side}_lower_lid"]
    places = face.places
    sign = 1.0 if side == "left" else -1.0
    inwards = -sign * (places[:, 0] - places[upper, 0])
    width = abs(float(places[upper, 0]) - face.middle)
    middle = places[[upper, lower]].mean(axis=0)
    near = (
        face.skin
        & (inwards > -2.0)
        & (inwards < width)
        & (np.abs(places[:, 1] - middle[1]) < 0.8 * width)
        & (places[:, 2] > middle[2] - 20.0)
    )
    blink = f"eyeBlink{side.capitalize()}"
    way = face.way(near, upper, lower, face.move(blink))
    if way is not None:  # a blink must not move it
        return way[int((inwards - _STILL * face.amount(blink))[way].argmax())]
    level = np.abs(places[:, 1] - middle[1]) + np.abs(inwards - 0.55 * width)
    return int(np.where(near, level, np.inf).argmin())
