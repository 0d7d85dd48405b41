"""Characters are drawn with their textures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.characters.fitted import open_character
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.core.arrays import Pixels
from faceedit_app.core.rig import Rig
from faceedit_app.render.camera import default_camera
from faceedit_app.render.renderer import open_renderer
from faceedit_app.render.surface import NormalSolver


def drawn(rig: Rig, smooth: bool) -> Pixels:
    renderer = open_renderer(rig, 200, 200)
    try:
        picture = renderer.draw(rig.neutral, default_camera(rig), smooth)
        return picture[..., 2::-1].copy()
    finally:
        renderer.close()


def textured(pixels: Pixels, cutoff: float = 0.0) -> Rig:
    """The shipped character in white, with a texture on its skin."""
    rig = shipped_rig()
    place = rig.neutral[:, :2]
    uv = (place - place.min(0)) / np.ptp(place, axis=0)
    uv[:, 1] = 1 - uv[:, 1]
    materials = tuple(
        replace(m, texture=0, cutoff=cutoff) if m.name == "skin" else m for m in rig.materials
    )
    return replace(
        rig,
        colors=np.ones_like(rig.colors),
        uv=uv.astype(np.float32),
        textures=(pixels,),
        materials=materials,
    )


@pytest.mark.parametrize("smooth", [True, False])
def test_a_texture_lies_where_its_coordinates_say(smooth: bool) -> None:
    halves = np.full((64, 64, 4), 255, np.uint8)
    halves[:, :32, 1:3] = 0  # red at the viewer's left
    halves[:, 32:, :2] = 0  # and blue at the right
    picture = drawn(textured(halves), smooth).astype(int)
    cheek = picture[110:130]
    left, right = cheek[:, 70:85], cheek[:, 115:130]
    assert (left[..., 0] > left[..., 2] + 50).mean() > 0.95
    assert (right[..., 2] > right[..., 0] + 50).mean() > 0.95


def test_both_ways_of_drawing_agree() -> None:
    grey = np.full((8, 8, 4), 160, np.uint8)
    grey[..., 3] = 255
    fine, quick = (drawn(textured(grey), smooth).astype(int) for smooth in (True, False))
    assert np.abs(fine - quick)[90:140, 80:120].mean() < 4


def test_what_is_transparent_is_not_drawn() -> None:
    clear = np.full((8, 8, 4), 255, np.uint8)
    clear[..., 3] = 0
    with_skin, without = (drawn(textured(clear, cutoff), False) for cutoff in (0.0, 0.5))
    other = np.abs(with_skin.astype(int) - without).max(axis=2) > 20
    assert other[80:150, 70:130].mean() > 0.5


def test_a_texture_of_one_colour_looks_like_the_colour() -> None:
    """sRGB in a picture is the same light as linear in a vertex."""
    grey = np.full((8, 8, 4), 188, np.uint8)
    grey[..., 3] = 255
    rig = textured(grey)
    plain = replace(
        rig,
        uv=None,
        textures=(),
        materials=shipped_rig().materials,
        colors=np.where([True, True, True, False], 0.503, rig.colors).astype(np.float32),
    )
    one, other = drawn(rig, True).astype(int), drawn(plain, True).astype(int)
    assert np.abs(one - other)[62:74, 90:110].max() < 6  # the forehead


def test_vertices_of_one_group_have_one_normal() -> None:
    """A seam of a texture, in a fold of 90 degrees."""
    vertices = np.array(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 1, 0], [0, 0, -1]], np.float32
    )
    faces = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    apart = NormalSolver(faces, 6)(vertices)
    assert not np.allclose(apart[0], apart[3])
    together = NormalSolver(faces, 6, groups=np.array([0, 1, 2, 0, 2, 3], np.int32))(vertices)
    np.testing.assert_allclose(together[0], together[3])
    np.testing.assert_allclose(np.linalg.norm(together, axis=1), 1, atol=1e-6)


def test_what_a_file_calls_opaque_hides_all_whatever_its_alpha(tmp_path: Path) -> None:
    """As our own character's hair, whose file says so for programs that cannot sort it."""
    own = shipped_rig()
    assert own.colors[:, 3].min() < 0.5
    write_rig(tmp_path / "head.glb", own)
    assert open_character(tmp_path / "head.glb").rig.colors[:, 3].min() == 1.0
