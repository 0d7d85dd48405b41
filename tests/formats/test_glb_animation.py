"""Animations of shapes in GLB files: read, edited where they stand, all else carried."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from support import recordings
from support.places import SHARED

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take

WEIGHTS = recordings.face(30)
KINDS = {"float": 1e-7, "bytes": 0.5 / 255, "shorts": 0.5 / 65535, "cubic": 1e-7}
NAMES = ("jawOpen", "eyeBlink_L", "eyeBlink_R", "smirk")


def weights_in(path: Path) -> NDArray[np.float32]:
    """The animated weights, (T, 3, N) if with tangents, as another reader finds them."""
    document = pygltflib.GLTF2().load(str(path))
    assert document is not None
    animation: Any = document.animations[0]
    accessor = document.accessors[animation.samplers[0].output]
    view = document.bufferViews[accessor.bufferView]
    kind: Any = {5121: "u1", 5123: "<u2", 5126: "<f4"}[accessor.componentType]
    start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    flat = np.frombuffer(document.binary_blob(), kind, accessor.count, start)
    return flat.astype(np.float32) / np.float32(1 if kind == "<f4" else np.iinfo(kind).max)


def edited(path: Path, out: Path) -> tuple[NDArray[np.float32], tuple[str, ...]]:
    """Set jawOpen of frame 5 to 0.75 and export."""
    take = open_take(path)
    weights = take.clip.weights.copy()
    weights[5, take.clip.channels.index("jawOpen")] = 0.75
    write_take(out, take, weights)
    return weights, take.clip.channels


@pytest.mark.parametrize("kind", KINDS)
def test_an_animation_opens_and_keeps_its_bytes(tmp_path: Path, kind: str) -> None:
    path = recordings.glb(tmp_path / "take.glb", WEIGHTS, kind=kind)
    take = open_take(path)
    assert take.format == "GLB animation"
    assert (len(take.clip), take.clip.rate) == (30, 30)
    assert take.clip.duration == pytest.approx(1)
    assert np.allclose(take.clip.arkit_weights(), WEIGHTS, atol=1.01 * KINDS[kind])
    assert take.source.encode(take.clip.weights, take.clip.weights) == path.read_bytes()


@pytest.mark.parametrize("kind", KINDS)
def test_an_edit_is_exact_in_every_way_of_storing(tmp_path: Path, kind: str) -> None:
    path, out = recordings.glb(tmp_path / "take.glb", WEIGHTS, kind=kind), tmp_path / "out.glb"
    wanted, channels = edited(path, out)
    again = open_take(out).clip
    assert again.channels == channels
    assert np.allclose(again.weights, wanted, atol=1e-7)
    found = weights_in(out)
    found = found.reshape(30, 3, 52)[:, 1] if kind == "cubic" else found.reshape(30, 52)
    assert found[5, channels.index("jawOpen")] == np.float32(0.75)


def test_floats_are_overwritten_where_they_stand(tmp_path: Path) -> None:
    path, out = recordings.glb(tmp_path / "take.glb", WEIGHTS), tmp_path / "out.glb"
    edited(path, out)
    before, after = path.read_bytes(), out.read_bytes()
    assert len(before) == len(after)
    places = [i for i in range(len(before)) if before[i] != after[i]]
    assert max(places) - min(places) < 4


def test_other_shapes_are_carried(tmp_path: Path) -> None:
    path = recordings.glb(tmp_path / "take.glb", WEIGHTS[:, :4], names=NAMES)
    take = open_take(path)
    assert take.clip.channels == ("jawOpen", "eyeBlinkLeft", "eyeBlinkRight")
    assert take.carried == ("smirk",)
    wanted, _ = edited(path, tmp_path / "out.glb")
    found = weights_in(tmp_path / "out.glb").reshape(30, 4)
    assert np.array_equal(found[:, 3], WEIGHTS[:, 3].astype(np.float32))
    assert np.array_equal(found[:, :3], wanted)


def test_meshes_that_share_an_animation_are_one_take(tmp_path: Path) -> None:
    path = recordings.glb(tmp_path / "take.glb", WEIGHTS, meshes=2)
    take = open_take(path)
    assert len(take.clip.channels) == 52
    assert take.notes == ()


@pytest.mark.parametrize(
    ("names", "says"),
    [
        (("a", "b"), "without an animation of shapes with ARKit names"),
        ((), "without an animation of shapes with ARKit names"),
    ],
)
def test_a_character_without_such_an_animation_is_no_take(
    tmp_path: Path, names: tuple[str, ...], says: str
) -> None:
    path = recordings.glb(tmp_path / "x.glb", WEIGHTS[:, : max(len(names), 1)], names=names)
    with pytest.raises(FileError, match=says):
        open_take(path)


def test_keys_out_of_order_are_named(tmp_path: Path) -> None:
    path = recordings.glb(tmp_path / "take.glb", WEIGHTS)
    content = bytearray(path.read_bytes())
    times = (np.arange(30) + 2).astype("<f4") / np.float32(30)
    at = content.index(times.astype("<f4").tobytes())
    struct.pack_into("<f", content, at + 4 * 12, 0.1)
    path.write_bytes(content)
    with pytest.raises(FileError, match="key 13 does not come after"):
        open_take(path)


@settings(
    deadline=None,
    derandomize=True,
    max_examples=150,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_damage_anywhere_opens_or_is_refused(tmp_path: Path, data: st.DataObject) -> None:
    path = recordings.glb(tmp_path / "take.glb", WEIGHTS[:, :4], names=NAMES)
    content = bytearray(path.read_bytes())
    if data.draw(st.booleans()):  # in the document
        length = struct.unpack_from("<I", content, 12)[0]
        document = json.loads(content[20 : 20 + length])
        places: list[tuple[Any, Any]] = []

        def walk(entry: Any) -> None:
            for key, value in entry.items() if isinstance(entry, dict) else enumerate(entry):
                places.append((entry, key))
                if isinstance(value, dict | list):
                    walk(value)

        walk(document)
        entry, key = data.draw(st.sampled_from(places))
        entry[key] = data.draw(st.sampled_from([-1, 0, 10**9, 1.5, None, "x", [], {}]))
        text = json.dumps(document).encode().ljust(length)
        content[12 : 20 + length] = struct.pack("<I4s", len(text), b"JSON") + text
    else:
        for _ in range(data.draw(st.integers(1, 4))):
            content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
        del content[data.draw(st.integers(12, len(content))) :]
    path.write_bytes(content)
    try:
        take = open_take(path)
    except FileError:
        return
    assert take.source.encode(take.clip.weights, take.clip.weights) == bytes(content)


def test_a_compressed_animation_opens_and_is_exported(tmp_path: Path) -> None:
    path = SHARED / "heads" / "facecap.glb"
    if not path.exists():
        pytest.skip("the public head is not here")
    pytest.importorskip("meshopt")
    take = open_take(path)
    assert (len(take.clip), take.clip.rate, len(take.clip.channels)) == (335, 30, 52)
    wanted, _ = edited(path, tmp_path / "out.glb")
    assert np.allclose(open_take(tmp_path / "out.glb").clip.weights, wanted, atol=1e-7)


def test_a_document_that_is_nested_too_deeply_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "take.glb"
    text = b'{"a":' + b"[" * 100_000
    path.write_bytes(struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text), len(text), b"JSON") + text)
    with pytest.raises(FileError):
        open_take(path)
