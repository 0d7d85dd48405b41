"""FBX and USD with a character: what other programs find in them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support.blender import opened_in_blender
from support.character_files import picture_of, write_glb
from support.exports import CLIP, ENDINGS, export, quiet_take, take_of
from support.faces import shipped_rig

from faceedit_app.characters.base_colors import linear, material_color
from faceedit_app.characters.character import Texture
from faceedit_app.characters.pictures import decode
from faceedit_app.characters.registry import read_character
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.formats.take import Take

# --- FBX and USD ---------------------------------------------------------------------------------


def test_an_fbx_is_read_as_the_character_it_was_written_from(tmp_path: Path) -> None:
    path = tmp_path / "talk.fbx"
    export(path)
    rig, back = shipped_rig(), read_character(path)
    assert back.targets == rig.channels
    assert [p.surface.name for p in back.parts] == [m.name for m in rig.materials]
    assert back.triangle_count == len(rig.faces)
    corners = np.concatenate([0.01 * p.neutral[p.faces].reshape(-1, 3) for p in back.parts])
    np.testing.assert_allclose(corners, rig.neutral[rig.faces].reshape(-1, 3), atol=1e-6)
    jaw = np.concatenate([0.01 * p.targets["jawOpen"][p.faces].reshape(-1, 3) for p in back.parts])
    own = rig.deltas[rig.channels.index("jawOpen")][rig.faces].reshape(-1, 3)
    np.testing.assert_allclose(jaw, own, atol=1e-6)


@pytest.mark.parametrize("ending", [".fbx", ".usdz"])
def test_the_same_take_gives_the_same_file(ending: str, tmp_path: Path) -> None:
    for name in "ab":
        export(tmp_path / f"{name}{ending}")
    assert (tmp_path / f"a{ending}").read_bytes() == (tmp_path / f"b{ending}").read_bytes()


def test_usd_text_has_either_of_its_endings(tmp_path: Path) -> None:
    for ending in (".usda", ".usd"):
        export(tmp_path / f"talk{ending}")
    assert (tmp_path / "talk.usd").read_bytes() == (tmp_path / "talk.usda").read_bytes()
    assert (tmp_path / "talk.usd").read_bytes().startswith(b"#usda")


def textured_head(folder: Path) -> Path:
    return write_glb(folder / "head.glb", picture=picture_of((200, 30, 30)))


def test_textures_go_into_an_fbx(tmp_path: Path) -> None:
    path = tmp_path / "talk.fbx"
    export(path, character=textured_head(tmp_path))
    texture = read_character(path).parts[0].surface.texture
    assert texture is not None
    assert decode(texture)[3, 3].tolist() == [200, 30, 30, 255]


def test_blender_shows_the_textures(tmp_path: Path) -> None:
    head = textured_head(tmp_path)
    for ending in (".fbx", ".usdz"):
        path = tmp_path / f"talk{ending}"
        export(path, character=head)
        facts = opened_in_blender(path, 30, 2)
        assert facts["pictures"] == [[16, 16]]
        assert facts["textured"] == [True]


@pytest.mark.parametrize("ending", [".usda", ".usdz"])
def test_usd_core_finds_the_base_colour_of_each_material(ending: str, tmp_path: Path) -> None:
    usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    shade, geometry = pytest.importorskip("pxr.UsdShade"), pytest.importorskip("pxr.UsdGeom")
    path = tmp_path / f"talk{ending}"
    export(path)
    stage = usd.Stage.Open(str(path))
    mesh = stage.GetPrimAtPath("/Face/Head")
    valid, problem = geometry.Subset.ValidateFamily(
        geometry.Imageable(mesh), geometry.Tokens.face, "materialBind"
    )
    assert valid, problem
    rig = shipped_rig()
    subsets = shade.MaterialBindingAPI(mesh).GetMaterialBindSubsets()
    assert len(subsets) == len(rig.materials)
    for subset, material in zip(subsets, rig.materials, strict=True):
        bound, _ = shade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()
        surface = bound.ComputeSurfaceSource()[0]
        color = surface.GetInput("diffuseColor").Get()
        np.testing.assert_allclose(color, material_color(rig, material), atol=1e-5)


def test_usd_core_finds_the_texture_in_the_package(tmp_path: Path) -> None:
    usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    shade, resolver = pytest.importorskip("pxr.UsdShade"), pytest.importorskip("pxr.Ar")
    path = tmp_path / "talk.usdz"
    export(path, character=textured_head(tmp_path))
    stage = usd.Stage.Open(str(path))
    found = [prim for prim in stage.Traverse() if prim.GetName() == "Picture"]
    asset = shade.Shader(found[0]).GetInput("file").Get()
    content = resolver.GetResolver().OpenAsset(resolver.ResolvedPath(asset.resolvedPath))
    picture = decode(Texture("", bytes(content.GetBuffer())))
    assert picture[3, 3].tolist() == [200, 30, 30, 255]
    places = stage.GetPrimAtPath("/Face/Head").GetAttribute("primvars:st").Get()
    assert len(places) == len(stage.GetPrimAtPath("/Face/Head").GetAttribute("points").Get())


def test_usd_text_has_the_colours_of_the_textures(tmp_path: Path) -> None:
    usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    path = tmp_path / "talk.usda"
    export(path, character=textured_head(tmp_path))
    stage = usd.Stage.Open(str(path))
    mesh = stage.GetPrimAtPath("/Face/Head")
    colors = np.array(mesh.GetAttribute("primvars:displayColor").Get())
    red = linear(np.array([200, 30, 30]) / 255)
    np.testing.assert_allclose(colors, np.broadcast_to(red, colors.shape), atol=1e-4)


def test_usd_core_reads_the_weights_and_the_shapes(tmp_path: Path) -> None:
    usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    skeleton = pytest.importorskip("pxr.UsdSkel")
    geometry = pytest.importorskip("pxr.UsdGeom")
    path = tmp_path / "talk.usda"
    times = CLIP.times.copy()
    times[20:] += 0.51  # a gap, off the frames' grid
    export(path, take_of(times))
    stage = usd.Stage.Open(str(path))
    assert stage.GetTimeCodesPerSecond() == 30
    assert geometry.GetStageUpAxis(stage) == "Y"
    assert geometry.GetStageMetersPerUnit(stage) == 1
    animation = skeleton.Animation(stage.GetPrimAtPath("/Face/Skeleton/Animation"))
    weights = animation.GetBlendShapeWeightsAttr()
    codes = weights.GetTimeSamples()
    np.testing.assert_allclose(np.array(codes) / 30, times, atol=1e-6)
    np.testing.assert_array_equal(np.array([weights.Get(code) for code in codes]), CLIP.weights)
    binding = skeleton.BindingAPI(stage.GetPrimAtPath("/Face/Head"))
    assert tuple(binding.GetBlendShapesAttr().Get()) == ARKIT_CHANNELS
    rig = shipped_rig()
    for name, target in zip(
        ARKIT_CHANNELS, binding.GetBlendShapeTargetsRel().GetTargets(), strict=True
    ):
        shape = skeleton.BlendShape(stage.GetPrimAtPath(target))
        moves = np.zeros_like(rig.neutral)
        moves[np.array(shape.GetPointIndicesAttr().Get(), int)] = shape.GetOffsetsAttr().Get()
        np.testing.assert_allclose(moves, rig.deltas[rig.channels.index(name)], atol=2e-7)
    points = np.array(geometry.Mesh(stage.GetPrimAtPath("/Face/Head")).GetPointsAttr().Get())
    np.testing.assert_allclose(points, rig.neutral, atol=1e-7)


@pytest.mark.parametrize("ending", ENDINGS)
def test_blender_plays_the_take(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"talk{ending}"
    export(path)
    facts = opened_in_blender(path, 30, len(CLIP))
    assert facts["fps"] == 30
    assert tuple(facts["shapes"]) == ARKIT_CHANNELS
    np.testing.assert_allclose(np.array(facts["weights"]), CLIP.weights, atol=1e-6)
    assert facts["materials"] == [m.name for m in shipped_rig().materials]


@pytest.mark.parametrize("take", [take_of, quiet_take])
def test_blender_plays_a_compact_glb(take: Callable[[], Take], tmp_path: Path) -> None:
    path = tmp_path / "talk.glb"
    export(path, take(), compact=True)
    facts = opened_in_blender(path, 30, len(CLIP))
    np.testing.assert_allclose(np.array(facts["weights"]), take().clip.weights, atol=1e-5)
