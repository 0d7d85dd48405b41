"""The networks: any length, no farther sight than they say; their files, good and bad."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from safetensors.torch import save
from support.faces import random_engine, random_model, random_models, random_networks

from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import REGIONS
from faceedit_app.lab.training.model_files import VERSION, as_file, load_model, save_model
from faceedit_app.lab.training.models import RegionNetworks, UNet
from faceedit_app.networks.engine import Engine
from faceedit_app.networks.inference import RegionAnswer

LOWER, UPPER, EYELIDS = REGIONS


def curves(frames: int, seed: int = 0, versions: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0, 30, (versions, frames, 8))


# --- the networks themselves -------------------------------------------------------------------


@pytest.mark.parametrize("widths", [(4,), (4, 6), (4, 6, 8), (4, 6, 8, 8)])
def test_no_frame_beyond_the_radius_changes_the_output(widths: tuple[int, ...]) -> None:
    torch.manual_seed(1)
    net = UNet(3, 5, widths).eval().double()
    frames = 16 * net.scale * 2 + 4 * net.radius // net.scale * net.scale
    quiet = torch.randn(1, 3, frames, dtype=torch.float64)
    farthest = 0
    with torch.inference_mode():
        before = net(quiet)
        for middle in range(frames // 2, frames // 2 + 2 * net.scale):  # every phase of the pooling
            loud = quiet.clone()
            # A large value wins every pooling it takes part in.
            loud[:, :, middle] += 50.0
            differs = (net(loud) - before).abs().amax((0, 1)) > 0
            hit = differs.nonzero()
            farthest = max(farthest, int((hit - middle).abs().max()))
    assert farthest <= net.radius
    assert farthest >= net.radius - net.scale, "the radius says far more than is true"


def test_autoencoder_starts_as_the_identity() -> None:
    torch.manual_seed(3)
    networks = RegionNetworks(6, 18, (4, 6, 8)).eval()
    weights = torch.rand(2, 18, 24)
    torch.testing.assert_close(networks.clean(weights), weights, rtol=0, atol=0)


def test_naturalness_goes_from_the_regressor_to_the_full_system() -> None:
    networks = random_networks(2, 6)
    controls = 10 * torch.rand(2, 2, 16)
    with torch.inference_mode():
        regressed = networks.regress(controls)
        full = networks.clean(regressed)
        torch.testing.assert_close(networks(controls, 0.0), regressed, rtol=0, atol=0)
        torch.testing.assert_close(networks(controls, 1.0), full)
        torch.testing.assert_close(networks(controls, 0.25), 0.75 * regressed + 0.25 * full)
    assert not torch.allclose(full, regressed, atol=0.01)


# --- the engine --------------------------------------------------------------------------------


@pytest.mark.parametrize("frames", [1, 2, 3, 4, 5, 63, 64, 65, 202])
def test_clip_of_any_length_is_answered(frames: int) -> None:
    engine = random_engine()
    for region in REGIONS:
        answer = engine.answer(region.id, curves(frames, versions=2), 1.0)
        assert answer.shape == (2, frames, len(region.channels))
        assert np.isfinite(answer).all()


def test_window_with_its_context_is_answered_like_the_whole_clip() -> None:
    engine = random_engine()
    whole = curves(400)
    first, last = 40 * engine.scale, 40 * engine.scale + 10
    window = slice(first - engine.context, last + engine.context)
    for region in REGIONS:
        expected = engine.answer(region.id, whole, 1.0)[:, first:last]
        got = engine.answer(region.id, whole[:, window], 1.0)
        inner = got[:, engine.context : engine.context + 10]
        np.testing.assert_allclose(inner, expected, atol=1e-5)


def test_region_answers_to_its_own_controls_only() -> None:
    engine = random_engine()
    before = curves(40)
    after = before.copy()
    after[..., 6:] += 3.0  # the eyelids
    for region in REGIONS:
        same = np.array_equal(
            engine.answer(region.id, before, 1.0), engine.answer(region.id, after, 1.0)
        )
        assert same == (region.id == "lower")


def test_versions_are_answered_independently() -> None:
    engine = random_engine()
    both = curves(40, versions=2)
    together = engine.answer("lower", both, 1.0)
    np.testing.assert_allclose(together[1:], engine.answer("lower", both[1:], 1.0), atol=1e-5)


@pytest.mark.parametrize("frames", [1, 50, 202])
@pytest.mark.parametrize("naturalness", [0.0, 0.6, 1.0])
def test_regions_answer_alike_alone_and_together(frames: int, naturalness: float) -> None:
    engine, curve = random_engine(seed=4), curves(frames)[0]
    regions = tuple(region.id for region in REGIONS)
    together = engine.answer_all(regions, curve, naturalness)
    pair = engine.answer_all(regions[1:], curve, naturalness)
    for region in regions:
        alone = engine.answer(region, curve[None], naturalness)[0]
        np.testing.assert_array_equal(together[region], alone)
        if region in pair:
            np.testing.assert_array_equal(pair[region], alone)


def test_networks_of_other_kinds_answer_beside_each_other() -> None:
    models = {m.region: RegionAnswer(as_file(m)) for m in random_models(seed=5)}
    plain = RegionAnswer(replace(as_file(random_model(UPPER, seed=6)), residual=False))
    assert plain.kind != models["lower"].kind
    answers = Engine(models | {"upper": plain}).answer_all(("lower", "upper"), curves(30)[0], 1.0)
    before = Engine(models).answer_all(("lower", "upper"), curves(30)[0], 1.0)
    np.testing.assert_array_equal(answers["lower"], before["lower"])
    assert answers["upper"].shape == before["upper"].shape
    assert not np.array_equal(answers["upper"], before["upper"])


# --- files -------------------------------------------------------------------------------------


def complaint(path: Path) -> str:
    with pytest.raises(FileError) as caught:
        load_model(path)
    text = str(caught.value)
    assert text.startswith(str(path))
    assert len(text.splitlines()) == 1
    assert "; " in text, "no remedy"
    return text


def saved(folder: Path, seed: int = 0) -> Path:
    for model in random_models(seed):
        save_model(folder / f"{model.region}.safetensors", model)
    return folder


def test_engine_comes_back_from_its_files_with_the_same_answers(tmp_path: Path) -> None:
    engine = random_engine(5)
    back = Engine.load(saved(tmp_path, 5))
    for region in REGIONS:
        ours, theirs = engine.models[region.id], back.models[region.id]
        np.testing.assert_array_equal(
            engine.answer(region.id, curves(50), 0.7), back.answer(region.id, curves(50), 0.7)
        )
        np.testing.assert_array_equal(ours.covariance, theirs.covariance)
        np.testing.assert_array_equal([ours.low, ours.high], [theirs.low, theirs.high])
        assert (ours.controls, ours.channels) == (theirs.controls, theirs.channels)


def test_same_model_gives_the_same_bytes(tmp_path: Path) -> None:
    save_model(tmp_path / "first", random_model(LOWER))
    content = (tmp_path / "first").read_bytes()
    for _ in range(8):
        save_model(tmp_path / "again", random_model(LOWER))
        assert content == (tmp_path / "again").read_bytes()
    save_model(tmp_path / "again", load_model(tmp_path / "first"))
    assert content == (tmp_path / "again").read_bytes()


class _Trap:
    """Unpickled, it leaves a file behind."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[Any, ...]:
        return (open, (str(self.path), "w"))


def test_pickle_is_refused_and_never_executed(tmp_path: Path) -> None:
    path, trace = tmp_path / "lower.safetensors", tmp_path / "executed"
    path.write_bytes(pickle.dumps(_Trap(trace)))
    complaint(path)
    torch.save({"trap": _Trap(trace)}, path)
    complaint(path)
    assert not trace.exists()


@pytest.mark.parametrize(
    "content", [b"", b"\x89PNG\r\n\x1a\n" + bytes(80), b"hello", bytes(8), bytes(1000)]
)
def test_file_that_is_no_model_is_told_so(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.safetensors").write_bytes(content)
    assert "no FaceEdit model" in complaint(tmp_path / "x.safetensors")


def test_missing_file_and_folder_are_told_so(tmp_path: Path) -> None:
    complaint(tmp_path / "none.safetensors")
    complaint(tmp_path)


def test_truncated_file_is_told_so_wherever_it_ends(tmp_path: Path) -> None:
    save_model(tmp_path / "whole", random_model(EYELIDS))
    content = (tmp_path / "whole").read_bytes()
    for length in (1, 7, 8, 9, 100, 1000, len(content) // 2, len(content) - 1):
        (tmp_path / "cut").write_bytes(content[:length])
        complaint(tmp_path / "cut")


def about_of(model: Any) -> dict[str, Any]:
    return {
        "version": VERSION,
        "region": model.region,
        "controls": model.controls,
        "channels": model.channels,
        "widths": model.widths,
        "notes": model.notes,
    }


def tensors_of(model: Any) -> dict[str, torch.Tensor]:
    tensors = {f"networks.{k}": v for k, v in model.networks.state_dict().items()}
    arrays = {"covariance": model.covariance, "low": model.low, "high": model.high}
    return tensors | {k: torch.from_numpy(v) for k, v in arrays.items()}


ABOUTS: dict[str, dict[str, Any]] = {
    "unknown control": {"controls": ["left_eyelid", "nose"]},
    "unknown channel": {"channels": ["noseUp"] * 6},
    "fewer controls": {"controls": ["left_eyelid"]},
    "fewer channels": {"channels": ["eyeBlinkLeft"]},
    "other widths": {"widths": [4, 6, 9]},
    "no widths": {"widths": []},
    "width of nothing": {"widths": [0, 0, 0]},
    "text as widths": {"widths": "abc"},
    "nothing as controls": {"controls": None},
    "lists as controls": {"controls": [["left_eyelid"]]},
    "nothing as version": {"version": None},
}


@pytest.mark.parametrize("name", ABOUTS)
def test_model_that_is_not_what_it_says_is_told_so(tmp_path: Path, name: str) -> None:
    model = random_model(EYELIDS)
    about = json.dumps(about_of(model) | ABOUTS[name])
    (tmp_path / "x").write_bytes(save(tensors_of(model), {"about": about}))
    complaint(tmp_path / "x")


@pytest.mark.parametrize("metadata", [None, {"about": "{"}, {"about": "[]"}, {"about": "{}"}])
def test_safetensors_of_something_else_is_told_so(
    tmp_path: Path, metadata: dict[str, str] | None
) -> None:
    (tmp_path / "x").write_bytes(save(tensors_of(random_model(EYELIDS)), metadata))
    complaint(tmp_path / "x")


@pytest.mark.parametrize("name", ["networks.mean", "covariance", "low", "high"])
def test_tensor_that_is_missing_misshapen_or_not_finite_is_told_so(
    tmp_path: Path, name: str
) -> None:
    model = random_model(EYELIDS)
    about = {"about": json.dumps(about_of(model))}
    good = tensors_of(model)
    for bad in (None, good[name][:-1].contiguous(), torch.full_like(good[name], torch.nan)):
        tensors = {k: v for k, v in (good | {name: bad}).items() if v is not None}
        (tmp_path / "x").write_bytes(save(tensors, about))
        complaint(tmp_path / "x")
    (tmp_path / "x").write_bytes(save(good, about))
    assert load_model(tmp_path / "x").region == "eyelids"


def test_later_version_is_told_by_its_number(tmp_path: Path) -> None:
    model = random_model(EYELIDS)
    about = json.dumps(about_of(model) | {"version": 2})
    (tmp_path / "x").write_bytes(save(tensors_of(model), {"about": about}))
    text = complaint(tmp_path / "x")
    assert "version 2" in text
    assert "update FaceEdit" in text


def test_engine_refuses_files_that_stand_for_each_other(tmp_path: Path) -> None:
    folder = saved(tmp_path)
    (folder / "upper.safetensors").replace(folder / "eyelids.safetensors")
    with pytest.raises(FileError, match="upper"):
        Engine.load(folder)


def test_engine_refuses_channels_in_another_order(tmp_path: Path) -> None:
    folder = saved(tmp_path)
    swapped = replace(random_model(EYELIDS), channels=EYELIDS.channels[::-1])
    save_model(folder / "eyelids.safetensors", swapped)
    with pytest.raises(FileError, match=r"eyelids\.safetensors: answers other channels"):
        Engine.load(folder)


def test_folder_without_models_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"lower\.safetensors: cannot be read"):
        Engine.load(tmp_path)
