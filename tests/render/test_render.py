"""The face view, drawn offscreen."""

from __future__ import annotations

import dataclasses
import gc
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.cameras import seen
from support.faces import shipped_rig
from support.renderers import need_opengl, opened_renderer
from support.rigs import ball

from faceedit_app.core.controls import CONTROL_INDEX, LIDS
from faceedit_app.core.errors import FaceEditError, FileError, Unavailable
from faceedit_app.core.resources import CHARACTER, shipped
from faceedit_app.core.rig import Material, Rig
from faceedit_app.render import (
    Aim,
    FaceRenderer,
    aimed_camera,
    contexts,
    default_camera,
    open_ahead,
    open_renderer,
)
from faceedit_app.render.snapshot import snapshot, write_png
from faceedit_app.render.surface import NormalSolver, Shading, by_shading, look_of, vertex_looks

SIZE = 96
BLINKS = dict(zip(LIDS, ("eyeBlinkLeft", "eyeBlinkRight"), strict=True))


@pytest.fixture(scope="module")
def rig() -> Rig:
    return ball()


@pytest.fixture(scope="module")
def renderer(rig: Rig) -> Iterator[FaceRenderer]:
    yield from opened_renderer(rig, SIZE)


def test_turned_head_moves_what_no_blendshape_moves(rig: Rig, renderer: FaceRenderer) -> None:
    camera = default_camera(rig, 1.0)
    straight = [renderer.draw(rig.neutral, camera).copy() for _ in range(2)][1]
    lower = rig.neutral - np.array([0.0, 0.02, 0.0], np.float32)
    pictures = [renderer.draw(lower, camera).copy() for _ in range(2)]
    assert (pictures[0] == pictures[1]).all()
    fresh = open_renderer(dataclasses.replace(rig, neutral=lower), SIZE, SIZE)
    expected = fresh.draw(lower, camera).copy()
    fresh.close()
    assert np.abs(pictures[1].astype(int) - expected.astype(int)).mean() < 1.0
    assert (renderer.draw(rig.neutral, camera) == straight).all()


def test_what_was_opened_ahead_in_another_thread_draws_the_same(
    rig: Rig, renderer: FaceRenderer
) -> None:
    camera = default_camera(rig, 1.0)
    with ThreadPoolExecutor(1) as thread:
        ahead = thread.submit(open_ahead, rig).result()
        if ahead is None:
            pytest.skip("an OpenGL context cannot change threads on this computer")
        try:
            ahead.resize(SIZE, SIZE)
            for smooth in (False, True, False):
                expected = renderer.draw(rig.neutral, camera, smooth)
                assert (ahead.draw(rig.neutral, camera, smooth) == expected).all()
        finally:
            ahead.close()


def test_normals_match_the_slow_sum_over_faces(rig: Rig) -> None:
    vertices = rig.vertices(np.array([0.7], np.float32))
    slow = np.zeros((len(vertices), 3))
    for a, b, c in rig.faces:
        slow[[a, b, c]] += np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a])
    slow /= np.linalg.norm(slow, axis=1, keepdims=True)
    fast = NormalSolver(rig.faces, len(vertices))(vertices)
    np.testing.assert_allclose(fast, slow, atol=1e-4)


def test_normals_of_some_vertices_are_those_of_all(rig: Rig) -> None:
    vertices = rig.vertices(np.array([0.7], np.float32))
    everywhere = NormalSolver(rig.faces, len(vertices))(vertices)
    wanted = np.array([40, 7, 300, 7])
    some = NormalSolver(rig.faces, len(vertices), wanted=wanted)(vertices)
    np.testing.assert_array_equal(some, everywhere[wanted])


def test_vertices_without_faces_have_no_normal() -> None:
    normals = NormalSolver(np.array([[0, 1, 2]], np.int32), 4)(np.eye(4, 3, dtype=np.float32))
    assert np.isfinite(normals).all()
    assert not normals[3].any()


def test_looks_are_mixed_where_materials_meet() -> None:
    base = ball(4, 6)
    half = len(base.faces) // 2
    materials = (
        Material("skin", 0, half, 0.6),
        Material("teeth", half, len(base.faces), 0.2),
    )
    rig = dataclasses.replace(base, materials=materials)
    looks = vertex_looks(rig, np.ones(len(rig.neutral), np.float32))
    assert looks[:, 0].min() == pytest.approx(0.2)
    assert looks[:, 0].max() == pytest.approx(0.6)
    assert ((looks[:, 0] > 0.21) & (looks[:, 0] < 0.59)).any()
    groups = by_shading(rig)
    assert [group.shading for group in groups] == [Shading.FLESH, Shading.WET]
    assert sum(len(group.still) + len(group.moving) for group in groups) == len(rig.faces)


@pytest.mark.parametrize(
    ("name", "shading"),
    [
        ("skin", Shading.FLESH),
        ("Eyelashes", Shading.THIN),
        ("Teeth.001", Shading.WET),
        ("Hat", Shading.PLAIN),
    ],
)
def test_a_material_is_known_by_its_name(name: str, shading: Shading) -> None:
    assert look_of(Material(name, 0, 1)).shading is shading


def test_draws_a_lit_shape_on_a_dark_wall(renderer: FaceRenderer, rig: Rig) -> None:
    image = renderer.draw(rig.neutral, default_camera(rig))
    assert image.shape == (SIZE, SIZE, 4)
    assert image.dtype == np.uint8
    assert image.flags.c_contiguous
    middle, corner = image[SIZE // 2, SIZE // 2, :3], image[2, 2, :3]
    assert middle[2] > middle[0]  # BGRA: skin is red
    assert int(middle.max()) > int(corner.max()) + 60
    assert (image[..., 3] == 255).all()


def test_top_row_comes_first_and_left_stays_left(renderer: FaceRenderer, rig: Rig) -> None:
    camera = default_camera(rig)
    straight = renderer.draw(rig.neutral, camera).copy()
    shape = _inside(straight)
    assert (shape == shape[:, ::-1]).mean() > 0.97  # a symmetric ball looks symmetric
    raised = _inside(renderer.draw(rig.neutral + np.array([0, 0.03, 0], np.float32), camera))
    assert _middle(raised)[0] < _middle(shape)[0]
    moved = _inside(renderer.draw(rig.neutral + np.array([0.03, 0, 0], np.float32), camera))
    assert _middle(moved)[1] > _middle(shape)[1]  # the character's left is on the right


def test_opening_the_jaw_changes_the_mouth_and_little_else(
    renderer: FaceRenderer, rig: Rig
) -> None:
    camera = default_camera(rig)
    closed = renderer.draw(rig.neutral, camera).astype(int)
    opened = renderer.draw(rig.vertices(np.array([1.0], np.float32)), camera).astype(int)
    changed = np.abs(opened - closed).max(axis=2) > 8
    rows = np.flatnonzero(changed.any(axis=1))
    assert changed.sum() > 50
    assert rows.min() > SIZE * 0.3


def test_smooth_and_fast_agree_but_for_the_edges(renderer: FaceRenderer, rig: Rig) -> None:
    camera = default_camera(rig)
    smooth = renderer.draw(rig.neutral, camera, smooth=True).astype(int)
    fast = renderer.draw(rig.neutral, camera, smooth=False).astype(int)
    difference = np.abs(smooth - fast).max(axis=2)
    assert np.median(difference) <= 1
    assert (difference > 12).mean() < 0.08
    assert difference.max() > 12  # edges do differ


def test_the_image_is_reused_until_a_resize(renderer: FaceRenderer, rig: Rig) -> None:
    camera = default_camera(rig)
    first = renderer.draw(rig.neutral, camera)
    assert renderer.draw(rig.neutral, camera) is first
    kept = first.copy()
    renderer.resize(50, 70)
    second = renderer.draw(rig.neutral, camera, smooth=False)
    assert second.shape == (70, 50, 4)
    np.testing.assert_array_equal(first, kept)
    renderer.resize(SIZE, SIZE)


def test_closing_one_renderer_leaves_the_other(renderer: FaceRenderer, rig: Rig) -> None:
    camera = default_camera(rig)
    before = renderer.draw(rig.neutral, camera).copy()
    other = open_renderer(rig, 40, 40)
    other.draw(rig.neutral, camera)
    np.testing.assert_array_equal(renderer.draw(rig.neutral, camera), before)
    other.close()
    other.close()
    np.testing.assert_array_equal(renderer.draw(rig.neutral, camera), before)
    with pytest.raises(Unavailable):
        other.draw(rig.neutral, camera)


def test_a_forgotten_renderer_does_no_harm(renderer: FaceRenderer, rig: Rig) -> None:
    camera = default_camera(rig)
    before = renderer.draw(rig.neutral, camera).copy()
    forgotten = open_renderer(rig, 40, 40)
    forgotten.draw(rig.neutral, camera)
    renderer.draw(rig.neutral, camera)
    del forgotten
    gc.collect()
    np.testing.assert_array_equal(renderer.draw(rig.neutral, camera), before)


def test_closing_collects_no_garbage(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    """In another thread than the window's, that would delete its widgets."""
    need_opengl()
    other = open_renderer(rig, 40, 40)
    monkeypatch.setattr(gc, "collect", pytest.fail)
    other.close()


def test_without_opengl_the_user_reads_one_line(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    monkeypatch.delenv("PYOPENGL_PLATFORM", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(contexts, "egl_devices", lambda: 0)
    monkeypatch.setattr(contexts, "_load", lambda *names: None)
    with pytest.raises(Unavailable, match=r"no OpenGL was found.*libegl1") as caught:
        open_renderer(rig, 32, 32)
    assert "\n" not in str(caught.value)


def test_a_failing_driver_is_reported_in_one_line(
    monkeypatch: pytest.MonkeyPatch, rig: Rig
) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("eglInitialize\nfailed")

    monkeypatch.setenv("PYOPENGL_PLATFORM", "egl")
    monkeypatch.setattr(contexts, "open_platform", fail)
    with pytest.raises(Unavailable, match="eglInitialize failed; ") as caught:
        open_renderer(rig, 32, 32)
    assert isinstance(caught.value, FaceEditError)
    assert "\n" not in str(caught.value)


def test_osmesa_stands_in_for_egl(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("PYOPENGL_PLATFORM", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(contexts, "egl_devices", lambda: 0)
    monkeypatch.setattr(contexts, "_load", lambda *names: object())
    assert contexts.choose_backend() == "osmesa"


def test_snapshot_is_rgb_and_takes_arkit_weights(renderer: FaceRenderer, rig: Rig) -> None:
    neutral = snapshot(rig, np.zeros(1, np.float32), 64, 48)
    assert neutral.shape == (48, 64, 3)
    assert neutral[24, 32, 0] > neutral[24, 32, 2]
    np.testing.assert_array_equal(neutral, snapshot(rig, np.zeros(52, np.float32), 64, 48))


def test_png_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    from PIL import Image

    image = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)
    write_png(tmp_path / "face.png", image)
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "face.png")), image)
    with pytest.raises(FileError):
        write_png(tmp_path / "missing" / "face.png", image)


@pytest.mark.parametrize("prepared", [True, False])
def test_what_stands_still_is_kept_and_looks_as_if_it_were_drawn(
    prepared: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    from faceedit_app.characters.glb import read_rig
    from faceedit_app.render.painter import Painter

    character = read_rig(shipped(CHARACTER))
    # Where everything may move, everything is drawn.
    restless = dataclasses.replace(
        character,
        channels=(*character.channels, "all"),
        deltas=np.concatenate([character.deltas, np.ones_like(character.deltas[:1])]),
    )
    need_opengl()
    kept, anew = (open_renderer(rig, 150, 200) for rig in (character, restless))
    indices, draw = [0], Painter._bind_and_draw_primitive

    def draw_counted(painter: Painter, primitive: Any, *how: Any) -> None:
        indices.append(0 if primitive.indices is None else primitive.indices.size)
        draw(painter, primitive, *how)

    monkeypatch.setattr(Painter, "_bind_and_draw_primitive", draw_counted)
    random = np.random.default_rng(5)
    here = default_camera(character)
    there = here.orbit(0.4, 0.2).zoom(0.7)
    tint = random.random(len(character.neutral)).astype(np.float32)
    steps = [(here, True), (here, False), (here, False), (here, False), (there, False)]
    steps += [(there, False), (there, False), (there, True), (there, False), (here, False)]
    drawn = []
    for i, (camera, smooth) in enumerate(steps * 2):
        if i == len(steps):
            kept.resize(90, 110)
            anew.resize(90, 110)
        face = character.vertices(random.random(len(character.channels)).astype(np.float32))
        if i in (3, 13):
            kept.draw(face, camera, smooth, tint)
        before = sum(indices)
        picture = kept.draw(face, camera, smooth)
        drawn.append(sum(indices) - before)
        if prepared:
            kept.prepare()
        # Where hair meets skin, two surfaces are equally far in a pixel or so: order decides.
        differs = (picture != anew.draw(face, camera, smooth)).any(axis=-1)
        assert differs.sum() <= 4, i
    assert min(drawn) < 0.8 * max(drawn), "the still part was drawn again and again"
    kept.close()
    anew.close()


def test_a_character_that_never_moves_is_drawn(renderer: FaceRenderer, rig: Rig) -> None:
    statue = dataclasses.replace(rig, deltas=np.zeros_like(rig.deltas))
    camera = default_camera(rig)
    opened = open_renderer(statue, SIZE, SIZE)
    whole = opened.draw(rig.neutral, camera, smooth=False).copy()
    assert (_inside(whole) == _inside(renderer.draw(rig.neutral, camera, smooth=False))).all()
    np.testing.assert_array_equal(opened.draw(rig.neutral, camera, smooth=False), whole)
    opened.close()


def test_while_the_camera_turns_nothing_is_prepared(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    from faceedit_app.render.painter import Painter
    from faceedit_app.render.targets import Target

    need_opengl()
    turned = open_renderer(rig, SIZE, SIZE)
    calls: list[object] = []
    render, copy = Painter.render, Target.copy_to
    monkeypatch.setattr(Painter, "render", lambda *a: (calls.append(a), render(*a)))
    monkeypatch.setattr(Target, "copy_to", lambda *a, **k: (calls.append(a), copy(*a, **k)))
    camera = default_camera(rig)

    def prepared(smooth: bool) -> int:
        turned.draw(rig.neutral, camera, smooth)
        calls.clear()
        turned.prepare()
        return len(calls)

    for _ in range(3):
        camera = camera.orbit(0.1, 0.0)
        assert prepared(smooth=False) == 0
    assert prepared(smooth=True) == 2, "at rest: what is still, and its copy"
    assert prepared(smooth=False) == 1, "the copy alone"
    turned.close()


@pytest.mark.parametrize("blinking", [LIDS[:1], LIDS[1:], LIDS])
def test_the_shipped_character_blinks(renderer: FaceRenderer, blinking: tuple[str, ...]) -> None:
    """Where the eye was there is skin, on that side, and nothing but the lids has moved."""
    rig, size = shipped_rig(), 160
    camera = aimed_camera(rig, Aim.EYES)

    def eyes(*closed: str) -> np.ndarray:
        """(size, size) grey levels."""
        weights = np.zeros(len(rig.channels), np.float32)
        for lid in closed:
            weights[rig.channel_index[BLINKS[lid]]] = 1.0
        lengths = rig.controls(weights[None])[0]
        assert {lid for lid in LIDS if lengths[CONTROL_INDEX[lid]] < 1.0} == {*closed}
        grey: np.ndarray = snapshot(rig, weights, size, size, camera).mean(axis=2)
        return grey

    awake, asleep = eyes(), eyes(*blinking)
    untouched = np.ones((size, size), bool)
    for lid in LIDS:
        lids = rig.neutral[rig.control_pairs[CONTROL_INDEX[lid]]]
        (x, top), (_, bottom) = (
            np.round(size * (1.0 + seen(camera, at, 1.0) * [1, -1]) / 2).astype(int) for at in lids
        )
        top, bottom = sorted((top, bottom))
        opening = np.s_[top : bottom + 1, x - 12 : x + 13]
        assert awake[opening].std() > 40, "white, iris and pupil"
        if lid in blinking:
            # Lashes, with fine hair between them, lie along its lower border.
            assert asleep[opening].std() < 0.7 * awake[opening].std()
            untouched[top - 20 : bottom + 20, x - 30 : x + 31] = False
    changed = np.abs(asleep - awake) > 15
    assert changed.sum() > 400 * len(blinking)
    assert not changed[untouched].any()


def _inside(image: np.ndarray) -> np.ndarray:
    return image[..., 2] > 80


def _middle(shape: np.ndarray) -> np.ndarray:
    return np.asarray(np.argwhere(shape).mean(axis=0))
