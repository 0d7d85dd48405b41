"""Every GLB that FaceEdit writes, the shipped character first, is valid glTF 2.0."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import random_rig
from support.gltf import NO_VALIDATOR, accessor_errors, has_validator, parts, validator_errors
from support.places import ROOT

from faceedit_app.characters.glb import read_rig
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.core.rig import Material, Rig

SHIPPED = ROOT / "assets" / "character.glb"


def _still_shape(rig: Rig) -> Rig:
    deltas = rig.deltas.copy()
    deltas[3] = 0.0
    return replace(rig, deltas=deltas)


RIGS: dict[str, Callable[[Rig], Rig]] = {
    "an ordinary one": lambda rig: rig,
    "a shape that moves nothing": _still_shape,
    "a material without faces": lambda rig: replace(
        rig, materials=(Material("hat", 0, 0), Material("skin", 0, len(rig.faces)))
    ),
    "colours that are too bright": lambda rig: replace(rig, colors=rig.colors * np.float32(3)),
    "neither name nor attribution": lambda rig: replace(rig, name="", attribution=""),
}


@pytest.fixture(params=["shipped", *RIGS])
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """The shipped character, and characters of all kinds as they are written."""
    if request.param == "shipped":
        return SHIPPED
    write_rig(tmp_path / "face.glb", RIGS[request.param](random_rig(4)))
    return tmp_path / "face.glb"


def test_accessors_are_sound(path: Path) -> None:
    assert accessor_errors(path.read_bytes()) == []


def test_khronos_validator_finds_no_error(path: Path) -> None:
    if not has_validator():
        pytest.skip(NO_VALIDATOR)
    assert validator_errors(path) == []


def test_the_shipped_character_is_what_the_writer_writes(tmp_path: Path) -> None:
    write_rig(tmp_path / "again.glb", read_rig(SHIPPED))
    assert (tmp_path / "again.glb").read_bytes() == SHIPPED.read_bytes()


def test_shapes_are_stored_sparsely(path: Path) -> None:
    """The check above must meet accessors without a buffer view to find a fault in them."""
    document, _ = parts(path.read_bytes())
    targets = document["meshes"][0]["primitives"][0]["targets"]
    accessors = [document["accessors"][target["POSITION"]] for target in targets]
    assert accessors
    assert all("sparse" in a and "bufferView" not in a for a in accessors)


def test_a_material_without_faces_is_left_out(tmp_path: Path) -> None:
    rig = RIGS["a material without faces"](random_rig(4))
    write_rig(tmp_path / "face.glb", rig)
    back = read_rig(tmp_path / "face.glb")
    assert [material.name for material in back.materials] == ["skin"]
    np.testing.assert_array_equal(back.faces, rig.faces)
