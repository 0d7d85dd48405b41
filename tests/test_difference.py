"""The edited face, tinted where and how far it is from the tracked one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from faces import shipped_rig
from test_render import ball

from faceedit_app.core.errors import Unavailable
from faceedit_app.core.rig import Rig
from faceedit_app.render import FaceRenderer, default_camera, open_renderer
from faceedit_app.render.difference import FULL, Tinter, ramp, tint_of
from faceedit_app.ui.palette import ACCENT, ORANGE

SIZE = 96
# Linear RGB as seen without one kind of cone: Machado, Oliveira and Fernandes (2009).
EYES = {
    "all cones": np.eye(3),
    "no red": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "no green": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "no blue": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def seen(colors: np.ndarray, eyes: str) -> np.ndarray:
    """(..., 3) sRGB in 0..1 -> (..., 3) CIELAB, as some eyes see it."""
    linear = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    linear = np.clip(linear @ EYES[eyes].T, 0.0, 1.0)
    x, y, z = np.moveaxis(linear @ XYZ.T / [0.9505, 1.0, 1.089], -1, 0)
    x, y, z = (np.where(v > 0.008856, np.cbrt(v), 7.787 * v + 16 / 116) for v in (x, y, z))
    return np.stack((116 * y - 16, 500 * (x - y), 200 * (y - z)), axis=-1)


def srgb(name: str) -> np.ndarray:
    return np.array([int(name[at : at + 2], 16) / 255 for at in (1, 3, 5)])


# --- the colours ---------------------------------------------------------------------------------


def test_the_tint_tells_millimetres() -> None:
    others = np.float32([[0, 0, 0], [0.1, 0.2, 0.3], [0.1, 0, 0], [0, 0, 0.05]])
    moved = np.float32([[0, 0, 0], [0, 0.6, 0.8], [1, 0, 0], [0, 3, 4]])
    tint = tint_of(others + moved * np.float32(FULL / 2000), others)
    np.testing.assert_allclose(tint, [0.0, 0.5, 0.5, 1.0], atol=1e-4)
    assert tint[0] == 0.0
    assert tint.dtype == np.float32


def test_without_a_tint_colours_are_the_characters() -> None:
    colors = shipped_rig().colors
    tinter, none = Tinter(colors), np.zeros(len(colors), np.float32)
    np.testing.assert_allclose(tinter(none), colors, atol=1e-6)
    full = tinter(none + 1)
    np.testing.assert_allclose(full[:, :3], np.broadcast_to(full[0, :3], (len(full), 3)), atol=1e-6)
    np.testing.assert_allclose(full[:, 3], colors[:, 3], atol=1e-6)


@pytest.mark.parametrize("eyes", EYES)
def test_everybody_can_read_the_ramp(eyes: str) -> None:
    steps = seen(ramp(shipped_rig(), 9), eyes)
    assert (np.diff(steps[:, 0]) < -1).all(), "darker all the way"
    apart = np.linalg.norm(np.diff(steps, axis=0), axis=1)
    assert apart.min() > 4
    assert apart.max() < 2 * apart.min(), "equal steps look about equal"
    # What the window means by blue and orange is not on the face: 40 is far more than a nuance.
    for other in (ramp(shipped_rig(), 1)[0], srgb(ACCENT), srgb(ORANGE)):
        assert np.linalg.norm(steps[-1] - seen(other, eyes)) > 39


# --- the picture ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def rig() -> Rig:
    return ball()


@pytest.fixture(scope="module")
def renderer(rig: Rig) -> Iterator[FaceRenderer]:
    try:
        opened = open_renderer(rig, SIZE, SIZE)
    except Unavailable as error:
        pytest.skip(str(error))
    yield opened
    opened.close()


@pytest.mark.parametrize("smooth", [True, False])
def test_only_what_moved_is_tinted_in_quick_and_fine_pictures(
    renderer: FaceRenderer, rig: Rig, smooth: bool
) -> None:
    camera, opened = default_camera(rig), rig.vertices(np.float32([1.0]))
    plain = renderer.draw(opened, camera, smooth).copy().astype(int)
    tint = tint_of(opened, rig.neutral)
    tinted = renderer.draw(opened, camera, smooth, tint).copy().astype(int)
    differs = np.abs(tinted - plain).max(axis=2) > 4
    assert differs[SIZE * 5 // 8, SIZE // 2]
    assert not differs[: SIZE // 4].any()
    blue, _, red = tinted[differs][:, :3].T
    assert (blue > red - 40).mean() > 0.9
    assert (plain[differs][:, 2] > plain[differs][:, 0]).all(), "BGRA: skin is red"


@pytest.mark.parametrize("smooth", [True, False])
def test_nothing_of_a_tint_stays(renderer: FaceRenderer, rig: Rig, smooth: bool) -> None:
    camera, full = default_camera(rig), np.ones(len(rig.neutral), np.float32)
    plain = renderer.draw(rig.neutral, camera, smooth).copy()
    tinted = renderer.draw(rig.neutral, camera, smooth, full).copy()
    none = renderer.draw(rig.neutral, camera, smooth, 0 * full).copy()
    assert np.abs(tinted.astype(int) - plain).max() > 60
    assert np.abs(none.astype(int) - plain).max() <= 1
    np.testing.assert_array_equal(renderer.draw(rig.neutral, camera, smooth), plain)


def test_a_tint_costs_no_further_call_and_none_costs_nothing(
    renderer: FaceRenderer, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    from faceedit_app.render import studio

    camera, full = default_camera(rig), np.ones(len(rig.neutral), np.float32)
    fills, draws = [], []
    fill, draw = studio._fill, studio.GL.glDrawElements
    monkeypatch.setattr(studio, "_fill", lambda *a: (fills.append(a), fill(*a)))
    monkeypatch.setattr(studio.GL, "glDrawElements", lambda *a: (draws.append(a), draw(*a)))
    counts = []
    for tint in (None, full, full, None, None):
        renderer.draw(rig.neutral, camera, smooth=False, tint=tint)
        counts.append((len(fills), len(draws)))
        fills.clear()
        draws.clear()
    # Once after a tint the plain colours are put back.
    assert counts == [(2, 1), (3, 1), (3, 1), (3, 1), (2, 1)]
