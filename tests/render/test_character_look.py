"""How the shipped character looks from close up: eyes, lashes, mouth, hairline."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from support.faces import shipped_rig
from support.renderers import opened_renderer

from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.controls import CONTROL_INDEX, LIDS
from faceedit_app.core.rig import MILLIMETRES, Rig
from faceedit_app.render import Camera
from faceedit_app.render.camera import Aim, aimed_camera, default_camera
from faceedit_app.render.renderer import FaceRenderer
from faceedit_app.render.surface import Shading, by_shading

SIZE = 240
SIDES = ("Left", "Right")


@pytest.fixture(scope="module")
def rig() -> Rig:
    return shipped_rig()


@pytest.fixture(scope="module")
def renderer(rig: Rig) -> Iterator[FaceRenderer]:
    yield from opened_renderer(rig, SIZE)


def weights(rig: Rig, **channels: float) -> np.ndarray:
    """(52,) with the named channels set."""
    return np.array([channels.get(name, 0.0) for name in rig.channels], np.float32)


def picture(
    renderer: FaceRenderer, rig: Rig, camera: Camera, /, smooth: bool = True, **channels: float
) -> np.ndarray:
    """(SIZE, SIZE, 3) float RGB, 0..255."""
    image = renderer.draw(rig.vertices(weights(rig, **channels)), camera, smooth)
    return np.asarray(image[..., 2::-1], float)


def vertices_of(rig: Rig, *materials: str) -> np.ndarray:
    """The vertices of the faces of some materials."""
    faces = [rig.faces[m.start : m.stop] for m in rig.materials if m.name in materials]
    return np.unique(np.concatenate(faces))


def eye_camera(rig: Rig, left: bool = True) -> Camera:
    """One eye, close up."""
    x, y, z = rig.neutral[rig.control_pairs[CONTROL_INDEX[LIDS[not left]]]].mean(axis=0).tolist()
    return Camera(distance=0.12, target=(x, y, z))


@pytest.mark.parametrize("smooth", [True, False])
@pytest.mark.parametrize("left", [True, False])
@pytest.mark.parametrize("turned", [0.0, 0.5])
def test_eyes_have_a_highlight_wherever_they_look(
    renderer: FaceRenderer, rig: Rig, smooth: bool, left: bool, turned: float
) -> None:
    image = picture(
        renderer, rig, eye_camera(rig, left), smooth, eyeLookOutLeft=turned, eyeLookInRight=turned
    )
    eye = image[SIZE // 4 : -SIZE // 4].min(axis=2)
    assert 20 < (eye > 235).sum() < 0.01 * eye.size
    _, columns = np.nonzero(eye > 235)
    assert columns.mean() < SIZE / 2, "the lamp stands to the left of the camera, whatever moves"


@pytest.mark.parametrize("closed", [0.25, 0.5, 0.75, 1.0])
@pytest.mark.parametrize("squint", [0.0, 0.6])
def test_lashes_stay_rooted_in_the_lids(rig: Rig, closed: float, squint: float) -> None:
    faces = np.concatenate([rig.faces[m.start : m.stop] for m in rig.materials if m.name == "skin"])
    lashes = vertices_of(rig, "lashes")
    skin = trimesh.Trimesh(rig.neutral, faces, process=False)
    places, distances, triangles = trimesh.proximity.closest_point(skin, rig.neutral[lashes])
    rooted = distances * MILLIMETRES < 0.2
    assert rooted.sum() > 80
    lids = faces[triangles[rooted]]
    shares = trimesh.triangles.points_to_barycentric(rig.neutral[lids], places[rooted])
    channels = {"eyeBlinkLeft": closed, "eyeBlinkRight": closed}
    channels |= {"eyeSquintLeft": squint, "eyeSquintRight": squint}
    moved = rig.vertices(weights(rig, **channels)) - rig.neutral
    lid_moved = np.einsum("pc,pcx->px", shares, moved[lids])
    strayed = _mean_of_each_lash(rig, moved[lashes[rooted]] - lid_moved, lashes[rooted])
    assert np.median(strayed) < 0.1
    assert np.quantile(strayed, 0.95) < 0.7


def _mean_of_each_lash(rig: Rig, moved: Doubles, roots: Indices) -> Doubles:
    """How far (mm) each lash's root moves; lashes grow thin as lids close, about their middle."""
    lashes = [m for m in rig.materials if m.name == "lashes"]
    faces = np.concatenate([rig.faces[m.start : m.stop] for m in lashes])
    edges = trimesh.geometry.faces_to_edges(faces)
    lash = trimesh.graph.connected_component_labels(edges, node_count=len(rig.neutral))[roots]
    means = [moved[lash == one].mean(axis=0) for one in np.unique(lash)]
    return np.asarray(np.linalg.norm(means, axis=1) * MILLIMETRES, np.float64)


def test_lashes_of_a_nearly_shut_eye_are_no_comb_over_the_iris(
    renderer: FaceRenderer, rig: Rig
) -> None:
    camera, shown = eye_camera(rig), {"eyeBlinkLeft": 0.75}
    image = picture(renderer, rig, camera, True, **shown).mean(axis=2)
    lids = rig.vertices(weights(rig, **shown))[rig.control_pairs[CONTROL_INDEX[LIDS[0]]]]
    upper, lower = camera.project(lids, SIZE, SIZE)[:, 1]
    under_the_lid = image[int(upper) + 1 : int((upper + lower) / 2) + 2, 85:155]
    assert np.abs(np.diff(under_the_lid, axis=1)).mean() < 9, "from one pixel to the next"


@pytest.mark.parametrize("left", [True, False])
def test_eyeballs_stay_behind_the_skin_of_a_squeezed_eye(
    renderer: FaceRenderer, rig: Rig, left: bool
) -> None:
    side, camera = SIDES[not left], eye_camera(rig, left)
    shown = {f"{stem}{side}": 1.0 for stem in ("eyeSquint", "cheekSquint", "mouthSmile")}
    lids = rig.vertices(weights(rig, **shown))[rig.control_pairs[CONTROL_INDEX[LIDS[not left]]]]
    lower = int(camera.project(lids, SIZE, SIZE)[1, 1])
    seen = _only(renderer, rig, ("sclera", "iris", "pupil"), camera, **shown)
    assert seen[:lower].sum() > 300
    assert not seen[lower + 8 :].any()


def test_teeth_are_light_and_not_grey(renderer: FaceRenderer, rig: Rig) -> None:
    shown = {"mouthUpperUpLeft": 1.0, "mouthUpperUpRight": 1.0}
    shown |= {"mouthLowerDownLeft": 1.0, "mouthLowerDownRight": 1.0}
    image = picture(renderer, rig, aimed_camera(rig, Aim.MOUTH), True, **shown)
    teeth = image[_only(renderer, rig, ("teeth",), None, **shown)]
    assert len(teeth) > 1000
    red, _, blue = np.median(teeth, axis=0)
    assert red > 185
    assert red > blue + 8


def test_an_open_mouth_is_dark_red_and_not_a_hole(renderer: FaceRenderer, rig: Rig) -> None:
    image = picture(renderer, rig, aimed_camera(rig, Aim.MOUTH), jawOpen=0.9)
    inside = image[_only(renderer, rig, ("mouth", "gums", "tongue"), jawOpen=0.9)]
    assert len(inside) > 2000
    assert (inside.max(axis=1) < 30).mean() < 0.02
    assert np.median(inside[:, 0] - inside[:, 2]) > 25
    assert inside[:, 0].mean() < 160, "darker than the lips"


def test_gums_reach_down_between_the_upper_teeth(rig: Rig) -> None:
    x, y, _ = (rig.neutral[vertices_of(rig, "gums")] * MILLIMETRES).T
    upper = y > y.mean()

    def edge(at: float) -> float:
        return float(y[upper & (np.abs(np.abs(x) - at) < 0.5)].min())

    middle_of_first_tooth, between_first_teeth = edge(4.3), edge(0.0)
    assert between_first_teeth < middle_of_first_tooth - 1.5


def test_the_hairline_is_soft(renderer: FaceRenderer, rig: Rig) -> None:
    image = picture(renderer, rig, default_camera(rig)).mean(axis=2)
    forehead = image[: SIZE // 2, SIZE // 2 - 12 : SIZE // 2 + 12].mean(axis=1)
    hair = vertices_of(rig, "hair")
    places = default_camera(rig).project(rig.neutral[hair], SIZE, SIZE)
    front = places[np.abs(places[:, 0] - SIZE / 2) < 12]
    line = int(front[front[:, 2] < front[:, 2].min() + 0.05, 1].max())
    around = forehead[line - 20 : line + 8]
    rise = np.diff(around)
    assert around.max() - around.min() > 70, "hair is darker than the forehead"
    assert rise.max() < 0.22 * (around.max() - around.min()), "over several pixels"


def test_brows_and_lashes_of_a_small_picture_at_rest_look_as_in_a_large_one(
    renderer: FaceRenderer, rig: Rig
) -> None:
    camera, larger = default_camera(rig), 4
    renderer.resize(larger * SIZE, larger * SIZE)
    large = picture(renderer, rig, camera).reshape(SIZE, larger, SIZE, larger, 3).mean((1, 3))
    renderer.resize(SIZE, SIZE)
    brows = camera.project(rig.neutral[vertices_of(rig, "brows", "lashes")], SIZE, SIZE)
    (left, top), (right, low) = (np.array(edge, int)[:2] for edge in (brows.min(0), brows.max(0)))
    off = {}
    for renderer.fine in (False, True):
        small = picture(renderer, rig, camera)
        off[renderer.fine] = np.abs(small - large)[top:low, left:right].mean()
    assert off[True] < 0.6 * off[False]


def test_a_doubled_picture_in_playback_is_nearer_to_one_at_rest(
    renderer: FaceRenderer, rig: Rig
) -> None:
    camera, off = default_camera(rig), {}
    rest = picture(renderer, rig, camera, jawOpen=0.2)
    for renderer.doubled in (False, True, False):
        for jaw in (0.0, 0.1, 0.2):  # what stays still is kept from the first on
            played = picture(renderer, rig, camera, False, jawOpen=jaw)
            renderer.prepare()
        off[renderer.doubled] = np.abs(played - rest).mean()
    assert off[True] < 0.6 * off[False]


def test_what_moves_is_few_vertices(rig: Rig) -> None:
    """Their normals are computed, and they are uploaded, for each picture."""
    moving = np.any(rig.deltas, axis=(0, 2))
    assert moving.sum() < 7_500
    hair = vertices_of(rig, "hair")
    assert moving[hair].mean() < 0.35


@pytest.mark.parametrize("smooth", [True, False])
def test_skin_that_no_light_reaches_is_not_lit_from_behind(rig: Rig, smooth: bool) -> None:
    """As in nostrils, which had grey spots."""
    unlit = replace(rig, shade=np.zeros(len(rig.neutral), np.float32))
    for dark in opened_renderer(unlit, SIZE):
        image = picture(dark, unlit, default_camera(unlit), smooth)
    across = image[SIZE * 13 // 24 : SIZE * 5 // 8].mean(axis=(0, 2))
    face = across[across > across.max() / 2]
    assert len(face) > SIZE / 4
    assert face.max() < 1.5 * np.median(face), "its edge is no brighter"


def test_what_cannot_be_seen_of_a_lash_hides_nothing(rig: Rig) -> None:
    """Single lashes are drawn before the fine hair around them, wherever they lie."""
    (lashes,) = (slice(m.start, m.stop) for m in rig.materials if m.name == "lashes")
    edges = trimesh.geometry.faces_to_edges(rig.faces[lashes])
    lash = trimesh.graph.connected_component_labels(edges, node_count=len(rig.neutral))
    single = np.bincount(lash)[lash] == 5  # vertices
    colors, faces = rig.colors.copy(), rig.faces.copy()
    colors[single, 3] = 0.0
    faces[lashes][single[faces[lashes]].all(axis=1)] = rig.faces[0, 0]  # no longer there
    camera, shown = eye_camera(rig), {"eyeBlinkLeft": 0.6}
    images = [
        picture(opened, other, camera, True, **shown)
        for other in (replace(rig, colors=colors), replace(rig, faces=faces))
        for opened in opened_renderer(other, SIZE)
    ]
    assert np.abs(images[0] - images[1]).max() <= 1


def test_an_eyeball_darkens_where_a_lid_comes_near(renderer: FaceRenderer, rig: Rig) -> None:
    camera = eye_camera(rig)
    opened = picture(renderer, rig, camera)
    half = picture(renderer, rig, camera, eyeBlinkLeft=0.5)
    ball = camera.project(rig.neutral[vertices_of(rig, "sclera", "iris")], SIZE, SIZE)
    x, y = ball[:, 0].astype(int), ball[:, 1].astype(int)
    lids = rig.vertices(weights(rig, eyeBlinkLeft=0.5))[rig.control_pairs[CONTROL_INDEX[LIDS[0]]]]
    (upper, lower), middle = camera.project(lids, SIZE, SIZE)[:, 1], SIZE / 2
    share = (y - upper) / (lower - upper)
    near = (np.abs(x - middle) < 0.12 * SIZE) & (share > 0.2) & (share < 0.4)
    far = (np.abs(x - middle) < 0.12 * SIZE) & (share > 0.6) & (share < 0.8)
    assert min(near.sum(), far.sum()) > 4
    darker = [np.median(half[y[at], x[at]] / opened[y[at], x[at]]) for at in (near, far)]
    assert darker[0] < 0.8 < darker[1]


def test_teeth_are_darker_behind_lips_that_have_just_parted(
    renderer: FaceRenderer, rig: Rig
) -> None:
    """The same teeth, which stay where they are."""
    camera, light, seen = aimed_camera(rig, Aim.MOUTH), [], []
    for share in (0.3, 1.0):
        shown = {f"mouth{lip}{side}": share for lip in ("UpperUp", "LowerDown") for side in SIDES}
        light.append(picture(renderer, rig, camera, True, **shown))
        seen.append(_only(renderer, rig, ("teeth",), None, **shown))
    both = np.logical_and(*seen)
    assert both.sum() > 300
    assert np.median(light[0][both] / light[1][both]) < 0.85


def test_what_one_can_see_through_is_drawn_after_what_it_covers(rig: Rig) -> None:
    groups = by_shading(rig)
    sheer = [group for group in groups if group.sheer]
    assert {group.shading for group in sheer} == {Shading.HAIR, Shading.THIN}
    for group in groups:
        through = rig.colors[group.moving, 3].min(axis=1) < 1.0
        assert through.all() if group.sheer else not through.any()
    assert not any(len(group.still) for group in sheer), "the skin under it moves"
    order = [group.shading is Shading.FLESH for group in groups]
    assert order == sorted(order, reverse=True)


def _only(
    renderer: FaceRenderer,
    rig: Rig,
    materials: tuple[str, ...],
    camera: Camera | None = None,
    /,
    **channels: float,
) -> np.ndarray:
    """(SIZE, SIZE) bool: where a picture, of the mouth if no camera is given, shows materials.

    They are tinted.
    """
    camera = camera or aimed_camera(rig, Aim.MOUTH)
    tint = np.zeros(len(rig.neutral), np.float32)
    tint[vertices_of(rig, *materials)] = 1.0
    vertices = rig.vertices(weights(rig, **channels))
    plain = renderer.draw(vertices, camera).astype(int)
    changed = np.abs(renderer.draw(vertices, camera, tint=tint).astype(int) - plain)
    return np.asarray(changed.max(axis=2) > 12)
