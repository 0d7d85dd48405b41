"""The edges of the lips, on lines across painted mouths whose edges are known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from faceedit_app.tracking.lips import colors_across, with_lip_edges

SKIN, LIP, TEETH, DARK = (205, 160, 130), (165, 85, 80), (215, 205, 185), (45, 20, 20)
SIZE, SCALE = 240, 2.0  # pixels of a side, and per mm
TOP, MIDDLE, BOTTOM = 60, 80, 104  # rows: outside of the upper lip, shut lips, lower lip
NOISE = 4.0  # of 255
Doubles = NDArray[np.float64]


def points_with(upper: float, lower: float) -> Doubles:
    """(478, 3) landmarks with the inner edges of the lips in these rows."""
    points = np.full((478, 3), 120.0)
    for number, row in ((0, TOP), (13, upper), (14, lower), (17, BOTTOM + max(lower - MIDDLE, 0))):
        points[number, 1] = row
    points[33, :2], points[263, :2] = (120 - 45 * SCALE, 30), (120 + 45 * SCALE, 30)
    return points


def picture(upper: int, lower: int, seed: int, shine: tuple[int, int] | None = None) -> Image.Image:
    """A mouth whose lips end in these rows; with teeth above, dark below, or shut."""
    pixels = np.empty((SIZE, SIZE, 3))
    pixels[:] = SKIN
    pixels[TOP : BOTTOM + max(lower - MIDDLE, 0)] = LIP
    pixels[upper:lower] = DARK
    pixels[upper : upper + int(0.6 * (lower - upper))] = TEETH
    if shine is not None:
        pixels[slice(*shine)] = 0.5 * (np.array(LIP) + TEETH)
    noisy = pixels + np.random.default_rng(seed).normal(0.0, NOISE, pixels.shape)
    return Image.fromarray(np.clip(noisy, 0, 255).astype(np.uint8))


def film(
    edges: list[tuple[int, int]], missed: float, shine: tuple[int, int] | None = None
) -> tuple[Doubles, NDArray[np.uint8]]:
    """Landmarks and colours of a film; the lower lip's landmark is too high in open mouths."""
    seen = [points_with(up, low - missed * (low - up)) for up, low in edges]
    pictures = [
        picture(up, low, seed, shine if up == low else None) for seed, (up, low) in enumerate(edges)
    ]
    colors = [colors_across(one, points) for one, points in zip(pictures, seen, strict=True)]
    return np.array(seen), np.array(colors)


def gaps(points: Doubles) -> Doubles:
    """(T,) mm between the lips."""
    apart: Doubles = np.linalg.norm(points[:, 14, :2] - points[:, 13, :2], axis=1) / SCALE
    return apart


SPEAKING = [(MIDDLE, MIDDLE)] * 4 + [(76, 90), (72, 100), (70, 106), (76, 92)] * 4
TRUE = np.array([low - up for up, low in SPEAKING]) / SCALE


def test_an_edge_that_the_landmarks_miss_is_found() -> None:
    points, colors = film(SPEAKING, missed=0.3)
    assert np.abs(gaps(points) - TRUE).max() > 5.0
    assert np.abs(gaps(with_lip_edges(points, colors)) - TRUE).max() < 0.8


def test_landmarks_that_are_right_stay() -> None:
    points, colors = film(SPEAKING, missed=0.0)
    moved = with_lip_edges(points, colors)
    assert np.abs(gaps(moved) - TRUE).max() < 0.8
    others = np.delete(np.arange(478), (13, 14))
    np.testing.assert_array_equal(moved[:, others], points[:, others])


def test_shine_on_shut_lips_does_not_open_them() -> None:
    points, colors = film(SPEAKING, missed=0.3, shine=(86, 92))
    assert gaps(with_lip_edges(points, colors))[:4].max() < 0.8


def test_a_film_whose_mouth_stays_shut_keeps_its_landmarks() -> None:
    points, colors = film([(MIDDLE, MIDDLE)] * 10, missed=0.0)
    np.testing.assert_array_equal(with_lip_edges(points, colors), points)


@pytest.mark.parametrize("turns", [1, 2])
def test_it_does_not_matter_how_the_face_is_turned(turns: int) -> None:
    points, colors = film(SPEAKING, missed=0.3)
    turned = points.copy()
    for _ in range(turns):  # a quarter, clockwise
        turned[..., 0], turned[..., 1] = SIZE - 1 - turned[..., 1], turned[..., 0].copy()
    found = with_lip_edges(turned, colors)
    np.testing.assert_allclose(gaps(found), gaps(with_lip_edges(points, colors)), atol=1e-6)


def test_colours_are_those_on_the_line_across_the_lips() -> None:
    colors = colors_across(picture(72, 100, seed=1), points_with(72, 100))
    for color, share in ((SKIN, 0.02), (LIP, 0.2), (TEETH, 0.42), (SKIN, 0.98)):
        near = np.abs(colors[int(share * len(colors))].astype(float) - color)
        assert near.max() < 15.0, color


def test_a_mouth_at_the_edge_of_the_picture_has_the_colours_that_are_left() -> None:
    points = points_with(72, 100)
    points[:, 1] += 170.0
    colors = colors_across(picture(72, 100, seed=1), points)
    assert np.isfinite(colors.astype(float)).all()
