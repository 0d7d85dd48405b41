"""The numpy networks answer as the torch networks that were trained."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from support.faces import random_model

from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.lab.training.model_files import as_file
from faceedit_app.networks.inference import RegionAnswer


@pytest.mark.parametrize("region", REGIONS, ids=lambda region: region.id)
@pytest.mark.parametrize("frames", [4, 12, 64, 208])
@pytest.mark.parametrize("naturalness", [0.0, 0.4, 1.0])
def test_numpy_answers_as_torch_does(region: Region, frames: int, naturalness: float) -> None:
    model = random_model(region, seed=3)
    random = np.random.default_rng(frames)
    shape = (2, frames, len(model.controls))
    controls = random.uniform(0, 60, shape).astype(np.float32)
    with torch.inference_mode():
        inputs = torch.from_numpy(controls).transpose(1, 2)
        wanted = model.networks(inputs, naturalness).transpose(1, 2).numpy()
    answer = RegionAnswer(as_file(model))
    got = answer(controls, naturalness)
    np.testing.assert_allclose(got, wanted, rtol=1e-5, atol=1e-5 * max(1, np.abs(wanted).max()))
    assert answer.scale == model.networks.scale
    assert answer.radius == model.networks.radius
