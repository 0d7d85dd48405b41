"""The engine: any length, no farther sight than it says, nobody's answer depends on others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from support.faces import random_engine, shipped_rig
from support.networks import random_content, random_description, random_region, write_models

from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import EYELIDS, LOWER, REGIONS, UPPER
from faceedit_app.networks import engine as networks_engine
from faceedit_app.networks.engine import Engine


def curves(frames: int, seed: int = 0) -> NDArray[np.float64]:
    return np.random.default_rng(seed).uniform(0, 30, (frames, len(CONTROL_IDS)))


@pytest.mark.parametrize("frames", [1, 2, 3, 4, 5, 63, 64, 65, 202])
@pytest.mark.parametrize("naturalness", [0.0, 0.4, 1.0])
def test_clip_of_any_length_is_answered(frames: int, naturalness: float) -> None:
    engine = random_engine()
    for region in REGIONS:
        answer = engine.answer(region.id, curves(frames), naturalness)
        assert answer.shape == (frames, len(region.channels))
        assert answer.dtype == np.float64
        assert np.isfinite(answer).all()


def test_naturalness_goes_from_the_regressor_to_the_full_system() -> None:
    engine = random_engine()
    obeying, halfway, believable = (
        engine.answer("lower", curves(40), naturalness) for naturalness in (0.0, 0.5, 1.0)
    )
    assert np.abs(obeying - believable).max() > 0.1
    np.testing.assert_allclose(halfway, (obeying + believable) / 2, atol=1e-6)


def test_window_with_its_context_is_answered_like_the_whole_clip() -> None:
    engine = random_engine()
    whole = curves(400)
    first, last = 40 * engine.scale, 40 * engine.scale + 10
    window = slice(first - engine.context, last + engine.context)
    for region in REGIONS:
        expected = engine.answer(region.id, whole, 1.0)[first:last]
        got = engine.answer(region.id, whole[window], 1.0)
        inner = got[engine.context : engine.context + 10]
        np.testing.assert_allclose(inner, expected, atol=1e-5)


@pytest.mark.parametrize("cores", [1, 2, 4])
def test_regions_side_by_side_answer_bit_for_bit_like_each_alone(
    cores: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(networks_engine, "CORES", cores)
    networks_engine._helpers.cache_clear()
    engine, asked = random_engine(), curves(208)
    names = [region.id for region in REGIONS]
    alone = {name: engine.answer(name, asked, 0.7) for name in names}
    for _ in range(20):
        together = engine.answers(names, asked, 0.7)
        assert list(together) == names
        for name in names:
            np.testing.assert_array_equal(together[name], alone[name])
    assert engine.answers((), asked, 0.7) == {}
    networks_engine._helpers.cache_clear()


def test_region_answers_to_its_own_controls_only() -> None:
    engine = random_engine()
    before = curves(40)
    after = before.copy()
    after[:, [CONTROL_INDEX[control] for control in EYELIDS.controls]] += 3.0
    for region in REGIONS:
        same = np.array_equal(
            engine.answer(region.id, before, 1.0), engine.answer(region.id, after, 1.0)
        )
        assert same == (region is LOWER)


@pytest.mark.parametrize("frames", [1, 50, 202])
@pytest.mark.parametrize("naturalness", [0.0, 0.6, 1.0])
def test_region_answers_alike_in_any_company(frames: int, naturalness: float) -> None:
    engine, other, curve = random_engine(4), random_engine(9), curves(frames)
    expected = {r.id: engine.answer(r.id, curve, naturalness) for r in REGIONS}
    for region in reversed(REGIONS):
        coarser = random_region(UPPER, shipped_rig(), 7, scale=8, context=40)
        for company in ({}, other.models, {"upper": coarser}):
            if region is UPPER:
                company = {}
            models = company | {region.id: engine.models[region.id]}
            answer = Engine(models).answer(region.id, curve, naturalness)
            np.testing.assert_array_equal(answer, expected[region.id])


def test_engine_comes_back_from_its_files_with_the_same_answers(tmp_path: Path) -> None:
    engine = random_engine(5)
    back = Engine.load(write_models(tmp_path, shipped_rig(), 5), shipped_rig())
    assert (engine.scale, engine.context) == (back.scale, back.context)
    for region in REGIONS:
        for naturalness in (0.0, 0.7, 1.0):
            np.testing.assert_array_equal(
                engine.answer(region.id, curves(50), naturalness),
                back.answer(region.id, curves(50), naturalness),
            )


# --- folders -----------------------------------------------------------------------------------


def complaint(folder: Path) -> str:
    with pytest.raises(FileError) as caught:
        Engine.load(folder, shipped_rig())
    text = str(caught.value)
    assert text.startswith(str(folder))
    assert len(text.splitlines()) == 1
    assert "; " in text, "no remedy"
    return text


def test_files_that_stand_for_each_other_are_refused(tmp_path: Path) -> None:
    folder = write_models(tmp_path, shipped_rig())
    (folder / "upper.onnx").replace(folder / "eyelids.onnx")
    (folder / "upper.onnx").write_bytes((folder / "eyelids.onnx").read_bytes())
    assert "eyelids.onnx: holds the region 'upper'" in complaint(folder)


def test_channels_in_another_order_are_refused(tmp_path: Path) -> None:
    folder = write_models(tmp_path, shipped_rig())
    swapped = random_description(EYELIDS, shipped_rig(), channels=EYELIDS.channels[::-1])
    (folder / "eyelids.onnx").write_bytes(random_content(swapped))
    assert "eyelids.onnx: answers other channels" in complaint(folder)


def test_folder_without_models_is_named(tmp_path: Path) -> None:
    assert "lower.onnx: cannot be read" in complaint(tmp_path)
    assert "nowhere" in complaint(tmp_path / "nowhere")
