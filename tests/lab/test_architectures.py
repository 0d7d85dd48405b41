"""The kinds of networks in torch, and as the files that they are exported to."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
import torch
from support.faces import shipped_rig
from support.graphs import exported, kept_in, of_size
from support.networks import random_content, random_description
from support.performances import RIG, performance, smallest
from support.trained import random_networks, random_trained

from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.regions import EYELIDS, REGIONS
from faceedit_app.core.resample import grid_length, to_grid
from faceedit_app.core.resources import shipped
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.training import architectures
from faceedit_app.lab.training.architectures import ARCHITECTURES, Architecture, Stacked
from faceedit_app.lab.training.architectures.unet import ACTIVATIONS, UNet, UNets
from faceedit_app.lab.training.export import export
from faceedit_app.lab.training.fit import fit_region
from faceedit_app.lab.training.model_files import load_trained, save_trained
from faceedit_app.lab.training.run import TrainingPlan
from faceedit_app.lab.training.settings import RECIPES
from faceedit_app.networks.engine import Engine, load_region

# --- in torch ----------------------------------------------------------------------------------


def farthest_change(net: Any, inputs: int, scale: int, radius: int) -> int:
    """How many frames away an input changes an output of `net`, at most."""
    frames = 32 * scale + 4 * radius // scale * scale
    quiet = torch.randn(1, inputs, frames, dtype=torch.float64)
    farthest = 0
    with torch.inference_mode():
        before = net(quiet)
        for middle in range(frames // 2, frames // 2 + 2 * scale):  # every phase of the pooling
            loud = quiet.clone()
            loud[:, :, middle] += 50.0  # a large value wins every pooling that it takes part in
            hit = ((net(loud) - before).abs().amax((0, 1)) > 0).nonzero()
            farthest = max(farthest, int((hit - middle).abs().max()))
    return farthest


@pytest.mark.parametrize("widths", [(4,), (4, 6), (4, 6, 8), (4, 6, 8, 8)])
def test_no_frame_beyond_the_radius_changes_the_output(widths: tuple[int, ...]) -> None:
    torch.manual_seed(1)
    net = UNet(3, 5, widths).eval().double()
    farthest = farthest_change(net, 3, net.scale, net.radius)
    assert net.radius - net.scale <= farthest <= net.radius


@pytest.mark.parametrize("name", ARCHITECTURES)
def test_every_architecture_sees_no_farther_than_it_says(name: str) -> None:
    torch.manual_seed(1)
    settings = replace(RECIPES["faceedit"], widths=(4, 6))
    networks = ARCHITECTURES[name].of(3, 5, settings).eval().double()

    def answer(controls: torch.Tensor) -> torch.Tensor:
        return networks.answers(controls)["system"]

    assert farthest_change(answer, 3, networks.scale, networks.radius) <= networks.radius


@pytest.mark.parametrize("name", ARCHITECTURES)
def test_every_architecture_is_made_again_from_its_settings(name: str) -> None:
    settings = replace(RECIPES["faceedit"], widths=(4, 6))
    networks = ARCHITECTURES[name].of(3, 5, settings)
    again = ARCHITECTURES[name](3, 5, **networks.settings)
    again.load_state_dict(networks.state_dict())
    assert again.settings == networks.settings


def test_autoencoder_starts_as_the_identity() -> None:
    torch.manual_seed(3)
    networks = UNets(6, 18, (4, 6, 8)).eval()
    weights = torch.rand(2, 18, 24)
    torch.testing.assert_close(networks.clean(weights), weights, rtol=0, atol=0)


# --- exported ----------------------------------------------------------------------------------


# Each takes seconds to export; what the first has is the same in networks with more layers, and its
# graph is that of other tests.
@pytest.mark.parametrize(("adapted", "activation"), zip([True, False], ACTIVATIONS, strict=True))
def test_file_answers_as_torch_does(adapted: bool, activation: str) -> None:
    trained = random_trained(EYELIDS, seed=3)
    if adapted or activation != trained.networks.settings["activation"]:
        networks = UNets(2, 6, (4,), not adapted, adapted, activation).eval()
        description = replace(
            trained.description,
            architecture={"name": networks.name, **networks.settings},
            scale=networks.scale,
            context=networks.radius,
        )
        trained = replace(trained, networks=networks, description=description)
    answer = trained.answering()
    for frames in (4, 12, 64, 208):
        controls = np.random.default_rng(frames).uniform(0, 60, (frames, 2)).astype(np.float32)
        with torch.inference_mode():
            found = trained.networks.answers(torch.from_numpy(controls.T[None]))
        ours = {name: value[0].T.numpy() for name, value in found.items()}
        for naturalness in (0.0, 0.4, 1.0):
            wanted = ours["regressor"] + naturalness * (ours["system"] - ours["regressor"])
            close = 1e-5 * max(1.0, float(np.abs(wanted).max()))
            np.testing.assert_allclose(answer(controls, naturalness), wanted, rtol=1e-5, atol=close)


def test_shipped_models_answer_as_torch_does() -> None:
    take, rig = open_take(shipped("assets/demo_take.csv")), shipped_rig()
    measured = rig.controls(rig.from_arkit(take.clip.arkit_weights()))
    curves = to_grid(take.clip.times, measured, 0, grid_length(take.clip.times))
    curves = curves[: len(curves) // 4 * 4]
    engine = Engine.load(shipped("models"), rig)
    for region in REGIONS:
        networks = load_trained(shipped("models") / f"{region.id}.onnx").networks
        heard = curves[:, engine.models[region.id].columns].astype(np.float32)
        with torch.inference_mode():
            found = networks.answers(torch.from_numpy(heard.T[None].copy()))
        for naturalness, name in ((0.0, "regressor"), (1.0, "system")):
            answer = engine.answer(region.id, curves, naturalness)
            np.testing.assert_allclose(answer, found[name][0].T.numpy(), rtol=0, atol=1e-6)


def test_same_networks_give_the_same_bytes(tmp_path: Path) -> None:
    trained = random_trained(EYELIDS)
    save_trained(tmp_path / "first.onnx", trained)
    content = (tmp_path / "first.onnx").read_bytes()
    for _ in range(3):
        assert export(trained.networks, trained.description) == content
    back = load_trained(tmp_path / "first.onnx")
    assert export(back.networks, back.description) == content
    assert export(random_networks(2, 6, seed=1), trained.description) != content


def test_networks_of_another_size_have_the_same_graph(graphs: Path) -> None:
    """The tests of the laboratory rely on it: torch exports a graph once for all sizes."""
    text = json.dumps(UNets.of(2, 6, smallest()).settings)
    kept_in(graphs)(UNets, 2, 6, text)
    ours = kept_in(graphs)(UNets, 3, 7, text)
    assert ours == of_size(exported(UNets, 3, 7, text), UNets, 3, 7, text)


def test_file_tells_nothing_of_the_machine_that_wrote_it(tmp_path: Path) -> None:
    trained = random_trained(EYELIDS)
    content = export(trained.networks, trained.description)
    for word in (str(Path.home()), str(Path(torch.__file__).parent), "site-packages", ".py"):
        assert word.encode() not in content


class Folded(Architecture):
    """Uses a parameter only by what can be worked out beforehand."""

    name = "folded"

    def __init__(self, controls: int, channels: int) -> None:
        super().__init__(controls, channels)
        self.gain = torch.nn.Parameter(torch.full((channels, controls), 0.5))

    @classmethod
    def of(cls, controls: int, channels: int, settings: object) -> Folded:
        return cls(controls, channels)

    settings: dict[str, Any] = {}  # noqa: RUF012
    scale = 1
    radius = 0

    def answers(self, controls: torch.Tensor) -> dict[str, torch.Tensor]:
        gain = (self.gain * 0.01).T.unsqueeze(-1).sum(0, keepdim=True)
        return {"system": controls.sum(1, keepdim=True) * gain}


def test_export_that_answers_otherwise_is_not_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(architectures.ARCHITECTURES, "folded", Folded)
    description = random_description(
        EYELIDS, shipped_rig(), scale=1, context=0, architecture={"name": "folded"}
    )
    with pytest.raises(FaceEditError, match="'folded'"):
        export(Folded(2, 6).eval(), description)


# --- what a new architecture needs: a module such as this, an entry, and a recipe -----------------


class Pointwise(Stacked):
    """Answers each frame by itself."""

    name = "pointwise"
    settings: dict[str, Any] = {}  # noqa: RUF012
    scale = 1
    radius = 0

    def __init__(self, controls: int, channels: int) -> None:
        super().__init__(controls, channels, residual=True, adapted=False)

    @classmethod
    def of(cls, controls: int, channels: int, settings: object) -> Pointwise:
        return cls(controls, channels)

    def network(self, inputs: int, outputs: int) -> torch.nn.Conv1d:
        return torch.nn.Conv1d(inputs, outputs, 1)


def test_a_new_architecture_is_trained_by_its_recipe_and_answers_in_the_application(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(architectures.ARCHITECTURES, "pointwise", Pointwise)
    monkeypatch.setitem(RECIPES, "pointwise", smallest(architecture="pointwise"))
    plan = TrainingPlan((tmp_path,), tmp_path, recipe="pointwise")
    model = fit_region(EYELIDS, [performance()], RIG, plan.settings).model
    save_trained(tmp_path / "eyelids.onnx", model)
    answer = load_region(tmp_path, EYELIDS, RIG)
    assert answer.description.architecture == {"name": "pointwise"}
    controls = np.random.default_rng(1).uniform(0, 12, (20, 2)).astype(np.float32)
    with torch.inference_mode():
        wanted = model.networks.answers(torch.from_numpy(controls.T[None]))["system"][0].T
    np.testing.assert_allclose(answer(controls, 1.0), wanted.numpy(), rtol=1e-4, atol=1e-5)


# --- back into torch ---------------------------------------------------------------------------


def complaint(path: Path) -> str:
    with pytest.raises(FileError) as caught:
        load_trained(path)
    text = str(caught.value)
    assert text.startswith(str(path))
    assert "; " in text, "no remedy"
    return text


def test_architecture_that_is_unknown_is_named(tmp_path: Path) -> None:
    (tmp_path / "x.onnx").write_bytes(random_content(random_description(EYELIDS, shipped_rig())))
    assert "unknown architecture 'random'" in complaint(tmp_path / "x.onnx")


@pytest.mark.parametrize(
    "architecture",
    [
        {"name": "unet"},
        {"name": "unet", "widths": [4, 9], "residual": True, "adapted": False},
        {"name": "unet", "widths": [4, 6], "residual": True, "adapted": True},
        {"name": "unet", "widths": "abc"},
        {"name": "unet", "widths": [], "residual": True},
        {"name": "unet", "widths": [4, 6], "more": 1},
        {"name": "holden", "hidden": 64},
    ],
)
def test_file_without_the_parameters_of_its_architecture_is_refused(
    tmp_path: Path, architecture: dict[str, Any]
) -> None:
    trained = random_trained(EYELIDS)
    content = export(trained.networks, trained.description)
    description = replace(trained.description, architecture=architecture)
    model = onnx.load_model_from_string(content)
    model.metadata_props[0].value = description.to_json()
    (tmp_path / "x.onnx").write_bytes(model.SerializeToString())
    assert "does not hold the parameters" in complaint(tmp_path / "x.onnx")


def test_baseline_cannot_be_trained_further(tmp_path: Path) -> None:
    assert "does not hold the parameters" in complaint(shipped("models") / "holden/lower.onnx")


def test_regions_that_hear_few_controls_have_narrow_networks() -> None:
    settings = replace(RECIPES["faceedit"], widths=(8, 12), narrow_widths=(4, 6))
    assert UNets.of(2, 5, settings).widths == (4, 6)
    assert UNets.of(3, 5, settings).widths == (8, 12)
    assert UNets.of(2, 5, replace(settings, narrow_widths=None)).widths == (8, 12)
