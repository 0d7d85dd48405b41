"""The processor's instruction set, and what to set so that another one is used."""

from __future__ import annotations

from typing import Any

import numpy as np

AVX512, AVX2 = "AVX-512", "AVX2"
# numpy's names of what a processor can do, from the most to the least.
_NAMES = {
    AVX512: ("X86_V4", "AVX512F"),
    AVX2: ("X86_V3", "AVX2"),
    "NEON": ("NEON", "ASIMD"),
}
# What ONNX Runtime uses cannot be chosen: it asks the processor.
UNCHANGED = "networks: ONNX Runtime asks the processor, and stays with its widest instructions"


def instructions() -> str:
    """The widest instruction set that numpy, OpenBLAS and software OpenGL use in this process."""
    found = _found()
    return next((name for name, signs in _NAMES.items() if found.intersection(signs)), "other")


def narrower() -> dict[str, str] | None:
    """Environment variables with which a process uses AVX2; None if this one has no more."""
    if instructions() != AVX512:
        return None
    wider = " ".join(sorted(name for name in _found() if name == "X86_V4" or "AVX512" in name))
    return {
        "OPENBLAS_CORETYPE": "Haswell",
        "NPY_DISABLE_CPU_FEATURES": wider,
        "LP_NATIVE_VECTOR_WIDTH": "256",  # Mesa's software OpenGL
    }


def _found() -> set[str]:
    """numpy's names of the instruction sets that it uses."""
    shown: Any = np.show_config(mode="dicts")
    simd = shown["SIMD Extensions"]
    return {*simd["baseline"], *simd.get("found", ())}
