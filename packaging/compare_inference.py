"""Compare numpy with torch in answering edits: python packaging/compare_inference.py numpy|torch.

Two versions of 208 frames through the shipped networks of all regions, on one thread; CPU time, so
that other work on the machine counts little. The figures of docs/adr/0008-numpy-inference.md.
"""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable
from statistics import median

import numpy as np
from threadpoolctl import threadpool_limits

from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resources import shipped

FRAMES, VERSIONS, REPEATS = 208, 2, 300


def in_numpy() -> Callable[[], object]:
    """The application's way."""
    from faceedit_app.networks.files import read_region
    from faceedit_app.networks.inference import RegionAnswer

    nets = [RegionAnswer(read_region(shipped("models") / f"{r.id}.safetensors")) for r in REGIONS]
    inputs = [curves(len(net.controls)) for net in nets]
    return lambda: [net(x, 1.0) for net, x in zip(nets, inputs, strict=True)]


def in_torch() -> Callable[[], object]:
    """The same with the networks as they are trained."""
    import torch

    from faceedit_app.lab.training.model_files import load_model

    torch.set_num_threads(1)
    models = [load_model(shipped("models") / f"{r.id}.safetensors") for r in REGIONS]
    inputs = [torch.from_numpy(curves(len(m.controls)).transpose(0, 2, 1).copy()) for m in models]

    def answer() -> object:
        with torch.inference_mode():
            return [m.networks(x, 1.0) for m, x in zip(models, inputs, strict=True)]

    return answer


def curves(controls: int) -> np.ndarray:
    """Some curves (versions, frames, controls) in mm."""
    random = np.random.default_rng(1)
    return random.normal(20, 3, (VERSIONS, FRAMES, controls)).astype(np.float32)


if __name__ == "__main__":
    began = time.process_time()
    answer = {"numpy": in_numpy, "torch": in_torch}[sys.argv[1]]()
    loaded = time.process_time() - began
    threadpool_limits(1)
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        answer()
        times.append(1000 * (time.process_time() - start))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{sys.argv[1]}: loaded in {loaded:.2f} s, {median(times):.1f} ms, {peak:.0f} MB at most")
