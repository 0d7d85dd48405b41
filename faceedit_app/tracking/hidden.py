"""Which pictures show something before the face, such as a hand, a cup or a microphone.

The landmarker goes on where it cannot see, and says that it is sure. But a landmark is a place on
the skin: its colour stays, and with it the pattern of light and dark around mouth and eyes. That
pattern is compared with the usual one of the film, up to brightness and contrast, as normalised
cross-correlation does (Lewis, "Fast normalized cross-correlation", 1995).
"""

from __future__ import annotations

import numpy as np
from PIL import Image

from faceedit_app.core.arrays import Doubles, Indices, Pixels
from faceedit_app.tracking.face_model import FaceModel
from faceedit_app.tracking.face_points import INNER_LIPS, IRISES, OUTLINE
from faceedit_app.tracking.landmarker import LANDMARKS

_AROUND = 0.012  # of the face's width, around a landmark
_BELOW_NOSE, _ABOVE_CHEEKS = 2, 168  # landmarks: beneath the nose, and between the eyes
_CHEEKS = 28.0  # mm below that
_HIDDEN, _PLAIN = 0.55, 0.8  # correlations at which all is hidden, and none
_TURNED = 0.75  # by how much less they are for a head turned by a radian
_ALIKE = 0.75  # correlation of pictures that show the same
# Shares of the film that look like a picture, from which on it is unusual, and usual: where all of
# the face looks different, and where only mouth or eyes do.
_SCENE, _HABIT = (0.2, 0.4), (0.4, 0.6)
_MOST = 200  # pictures with which each is compared


def colors_at(image: Image.Image, points: Doubles) -> Pixels:
    """(478, 3) uint8 RGB, the mean around each landmark (478, 2 or 3), pixels, of a picture."""
    pixels = np.asarray(image)
    height, width = pixels.shape[:2]
    step = max(1.0, float(np.ptp(points[:, 0])) * _AROUND)
    total = np.zeros((LANDMARKS, 3))
    for across in (-step, 0.0, step):
        for down in (-step, 0.0, step):
            x = np.clip(np.round(points[:, 0] + across), 0, width - 1).astype(np.intp)
            y = np.clip(np.round(points[:, 1] + down), 0, height - 1).astype(np.intp)
            total += pixels[y, x, :3]
    return np.round(total / 9.0).astype(np.uint8)


def seen_share(model: FaceModel, colors: Pixels, yaw: Doubles) -> Doubles:
    """(T,) 0..1: 1 where the face is as it usually is, 0 where something hides mouth or eyes.

    Args:
        model: where the landmarks are on the face.
        colors: (T, 478, 3), see `colors_at`.
        yaw: (T,) radians, how far the head is turned: light and shade change with it.
    """
    parts = [_usual(colors[:, part].astype(np.float64)) for part in _parts(model)]
    often = np.min([often for _, often in parts], axis=0)
    plain = [
        np.interp(alike + _TURNED * np.abs(yaw), (_HIDDEN, _PLAIN), (0.0, 1.0))
        for alike, _ in parts
    ]
    # A scene of its own, in other light, is no hand: it changes all of the face.
    partly = np.max(plain, axis=0)
    scene = np.interp(often, _SCENE, (0.0, 1.0)), np.interp(often, _HABIT, (0.0, 1.0))
    share: Doubles = np.maximum(
        np.min(plain, axis=0), (1.0 - partly) * scene[0] + partly * scene[1]
    )
    return share


def _parts(model: FaceModel) -> tuple[Indices, Indices]:
    """The landmarks of the lower and of the upper face whose colour stays.

    Between the lips it does not, and the outline lies on the background.
    """
    height = model.rest[:, 1]
    stays = ~np.isin(model.numbers, (*INNER_LIPS, *OUTLINE, *IRISES)) & (model.numbers < IRISES[0])
    lower = height < height[model.row(_BELOW_NOSE)]
    upper = height > height[model.row(_ABOVE_CHEEKS)] - _CHEEKS
    return model.numbers[stays & lower], model.numbers[stays & upper]


def _usual(colors: Doubles) -> tuple[Doubles, Doubles]:
    """How like the film's usual pattern each picture (T, n, 3) is, and how often it is like it.

    Returns:
        (T,) correlations -1..1, and (T,) shares of the film 0..1.
    """
    patterns = _normal(colors)
    usual = _normal(np.median(patterns, axis=0)[None])[0]
    some = patterns[:: -(-len(patterns) // _MOST)].reshape(-1, usual.size)
    flat = patterns.reshape(len(patterns), -1)
    return flat @ usual.ravel(), (flat @ some.T > _ALIKE).mean(axis=1)


def _normal(colors: Doubles) -> Doubles:
    """Patterns (T, n, 3) without brightness and contrast: mean 0 in each colour, length 1."""
    centred = colors - colors.mean(axis=1, keepdims=True)
    length = np.sqrt((centred**2).sum(axis=(1, 2), keepdims=True))
    patterns: Doubles = centred / np.maximum(length, 1e-9)
    return patterns
