"""Where the lips end and the mouth begins, by the colours between them.

The landmarker takes teeth and tongue for a lip, and so it shows less of an open mouth than there
is. But lips have their own colours, and a film shows them in all its pictures: on the outer part of
each lip, and everywhere while the mouth is shut. Teeth, tongue and dark are what is well inside an
open mouth. Along the line across the lips, the edges are where the colours change from those of
one to those of the other: the maximum of the likelihood (Zhu and Yuille, "Region competition",
1996), on a line, where all pairs of edges can be compared.

Edges are looked for outside the landmarks: it is there that they are missed. The farther away, the
less likely, all the more where the landmarks show a mouth that is shut. A film that never opens the
mouth keeps its landmarks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter

from faceedit_app.core.arrays import Bools, Doubles, Indices, Pixels
from faceedit_app.tracking.landmarker import OUTER_EYES

SAMPLES = 80
"""How many colours are kept of a line across the lips."""

_LINE = 0, 13, 14, 17  # landmarks: upper lip outside and inside, lower lip inside and outside
_EYES = 90.0  # mm between the outer corners of the eyes, on most faces
_BEYOND = 4.0  # mm of skin on either end of the line
_BESIDE = (-1.0, -0.5, 0.0, 0.5, 1.0)  # mm beside the line, of which the mean is taken
_LIP_SHARES = 0.75, 0.65  # of upper and lower lip, from outside, that are surely lip
_MOUTH_SHARE = 0.7  # of an open mouth that is surely not lip
_OPEN, _SHUT = 3.0, 0.8  # mm between lips that are open, and above the least of lips that are shut
_TOUCH = 3.0  # percentile that is the least
_SKIN = 0.1  # how much a sample of skin tells about lips
_FEWEST = 40  # samples inside the mouth
_LEVELS, _BLUR = 16, 0.7  # of the histograms, in each of three colours
_LEAST = 2e-5  # the share of colours that were never seen
_MOST = 3.0  # a colour says no more than that, in logarithms of a mm of it
# Mm by which the landmarks of upper and lower lip are too far inside, in shut and in open mouths.
_SPREAD = (1.0, 1.0), (1.0, 3.0)
_INWARD = 0.4  # mm by which they may be too far outside


@dataclass(frozen=True)
class _Lines:
    """Lines across the lips in T pictures.

    Attributes:
        starts, ends: (T, 2) pixels.
        places: (T, 4) samples from the start, of the landmarks in `_LINE`.
        step: (T,) mm from sample to sample.
    """

    starts: Doubles
    ends: Doubles
    places: Doubles
    step: Doubles

    @property
    def gap(self) -> Doubles:
        """(T,) mm between the landmarks of the inner edges."""
        gap: Doubles = (self.places[:, 2] - self.places[:, 1]) * self.step
        return gap


def colors_across(image: Image.Image, points: Doubles) -> Pixels:
    """(SAMPLES, 3) uint8 RGB across the lips, from above to below, of a picture.

    Args:
        image: an RGB picture.
        points: (478, 2 or 3) pixels, its landmarks.
    """
    pixels = np.asarray(image)[..., :3]
    starts, ends = _ends(points[None])
    way, scale = (ends - starts)[0], _pixels_per_mm(points[None])[0]
    line = starts[0] + np.linspace(0.0, 1.0, SAMPLES)[:, None] * way
    beside = scale * np.array([-way[1], way[0]]) / max(float(np.linalg.norm(way)), 1e-6)
    total = np.zeros((SAMPLES, 3))
    for aside in _BESIDE:
        total += _between(pixels, line + aside * beside)
    return np.round(total / len(_BESIDE)).astype(np.uint8)


def with_lip_edges(points: Doubles, colors: Pixels) -> Doubles:
    """Landmarks with those in the middle of the lips' inner edges where the lips end.

    Args:
        points: (T, 478, 3) pixels.
        colors: (T, SAMPLES, 3), see `colors_across`.
    """
    lines = _lines(points)
    edges = _edges(lines, colors)
    if edges is None:
        return points
    moved = points.copy()
    step = (lines.ends - lines.starts) / (SAMPLES - 1)
    for column, number in enumerate(_LINE[1:3]):
        away = edges[:, column] - lines.places[:, 1 + column]
        moved[:, number, :2] += away[:, None] * step
    return moved


def _edges(lines: _Lines, colors: Pixels) -> Doubles | None:
    """(T, 2) where upper lip and lower lip end, in samples; None if the mouth is never open."""
    upper, lower, mouth = _surely(lines)
    if mouth.sum() < _FEWEST:
        return None
    outside = np.arange(SAMPLES) < lines.places[:, :1], np.arange(SAMPLES) > lines.places[:, 3:]
    skin = np.where(outside[0] | outside[1], _SKIN, 1.0)
    inside = _likelihood(colors, mouth, np.ones_like(skin))
    spread = np.stack([np.interp(lines.gap, (0.0, _OPEN), mm) for mm in _SPREAD], axis=1)
    # What each edge gains by lying before a sample: the lip above or below it, the mouth between.
    before = np.arange(SAMPLES + 1) - 0.5
    gains = []
    for column, (lip, sign) in enumerate(((upper, 1.0), (lower, -1.0))):
        more = np.clip(_likelihood(colors, lip, skin) - inside, -_MOST, _MOST)
        sums = np.cumsum(sign * more * lines.step[:, None], axis=1)
        gain = np.pad(sums, ((0, 0), (1, 0)))
        outward = sign * (lines.places[:, 1 + column, None] - before) * lines.step[:, None]
        gain -= 0.5 * (outward / spread[:, column, None]) ** 2
        end = lines.places[:, 3 * column, None]
        gains.append(np.where((outward < -_INWARD) | (sign * (before - end) < 0), -np.inf, gain))
    return _best(gains[0], gains[1], lines.places[:, 1:3])


def _best(upper: Doubles, lower: Doubles, landmarks: Doubles) -> Doubles:
    """(T, 2) the pair of edges with the largest sum of gains (T, SAMPLES + 1), in their order."""
    rows = np.arange(len(upper))
    sums = np.maximum.accumulate(upper, axis=1) + lower
    second = sums.argmax(axis=1)
    above = np.arange(SAMPLES + 1) <= second[:, None]
    first = np.where(above, upper, -np.inf).argmax(axis=1)
    edges = np.stack([first, second], axis=1) - 0.5
    return np.where(np.isfinite(sums[rows, second])[:, None], edges, landmarks)


def _surely(lines: _Lines) -> tuple[Bools, Bools, Bools]:
    """(T, SAMPLES) each: what is surely upper lip or the skin above, lower lip, and mouth."""
    samples = np.arange(SAMPLES)
    top, above, below, bottom = (place[:, None] for place in lines.places.T)
    gap = lines.gap[:, None]
    least = float(np.percentile(gap, _TOUCH))
    shut = (gap <= least + _SHUT) & (least < _OPEN)
    middle = (above + below) / 2.0
    upper = (samples < top + _LIP_SHARES[0] * (above - top)) | (shut & (samples < middle))
    lower = (samples > bottom - _LIP_SHARES[1] * (bottom - below)) | (shut & (samples > middle))
    half = _MOUTH_SHARE / 2.0 * (below - above)
    mouth = (gap > _OPEN) & (np.abs(samples - middle) < half) & ~shut
    return upper, lower, mouth


def _likelihood(colors: Pixels, some: Bools, weights: Doubles) -> Doubles:
    """(T, SAMPLES) logarithms of how likely each colour is among some of the samples."""
    level = colors.astype(np.intp) * _LEVELS // 256
    bins: Indices = (level[..., 0] * _LEVELS + level[..., 1]) * _LEVELS + level[..., 2]
    counts = np.bincount(bins[some], weights=weights[some], minlength=_LEVELS**3)
    smooth = gaussian_filter(counts.reshape((_LEVELS,) * 3), _BLUR, mode="nearest").ravel()
    likely: Doubles = np.log(smooth[bins] / max(smooth.sum(), 1.0) + _LEAST)
    return likely


def _lines(points: Doubles) -> _Lines:
    """The lines for landmarks (T, 478, 2 or 3)."""
    starts, ends = _ends(points)
    way = ends - starts
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-6)
    along = np.einsum("tnx,tx->tn", points[:, list(_LINE), :2] - starts[:, None], way)
    places = along / (length**2)[:, None] * (SAMPLES - 1)
    step = length / (SAMPLES - 1) / _pixels_per_mm(points)
    return _Lines(starts, ends, places, step)


def _ends(points: Doubles) -> tuple[Doubles, Doubles]:
    """(T, 2) pixels each: where the lines for landmarks (T, 478, 2 or 3) start and end."""
    top, bottom = points[:, _LINE[0], :2], points[:, _LINE[3], :2]
    way = bottom - top
    length = np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
    beyond = way / length * (_BEYOND * _pixels_per_mm(points))[:, None]
    return top - beyond, bottom + beyond


def _pixels_per_mm(points: Doubles) -> Doubles:
    """(T,) from landmarks (T, 478, 2 or 3)."""
    right, left = (points[:, number, :2] for number in OUTER_EYES)
    scale: Doubles = np.maximum(np.linalg.norm(left - right, axis=1), 1.0) / _EYES
    return scale


def _between(pixels: Pixels, places: Doubles) -> Doubles:
    """(n, 3) colours at places (n, 2) between the pixels of a picture, interpolated."""
    high = np.array([pixels.shape[1] - 1, pixels.shape[0] - 1])
    places = np.clip(places, 0.0, high)
    first = np.minimum(places.astype(np.intp), np.maximum(high - 1, 0))
    second = np.minimum(first + 1, high)
    across, down = (places - first).T[..., None]
    above = (
        pixels[first[:, 1], first[:, 0]] * (1 - across) + pixels[first[:, 1], second[:, 0]] * across
    )
    below = (
        pixels[second[:, 1], first[:, 0]] * (1 - across)
        + pixels[second[:, 1], second[:, 0]] * across
    )
    colors: Doubles = above * (1 - down) + below * down
    return colors
