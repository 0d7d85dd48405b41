"""Exports of a short take, as a take or with a character."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from faceedit_app.editing.exporting import (
    Exported,
    Options,
    choose,
    export_take,
)
from faceedit_app.formats.take import Take
from support.faces import talking_clip
from support.takes import NoFile

ENDINGS = (".glb", ".fbx", ".usda", ".usdz")
CLIP = talking_clip(frames=40, rate=30.0)


def take_of(times: np.ndarray | None = None) -> Take:
    """A short take that talks, at these times."""
    clip = CLIP if times is None else replace(CLIP, times=times)
    return Take(Path("talk.csv"), "Test", clip, ("HeadYaw",), (), NoFile())


def export(path: Path, take: Take | None = None, **options: object) -> Exported:
    """Export a take in the format of the ending."""
    take = take or take_of()
    chosen = Options(**options)  # type: ignore[arg-type]
    return export_take(take, take.clip, path, choose(path), chosen)


def quiet_take() -> Take:
    """Few weights that are not 0."""
    weights = np.where(np.arange(52) < 6, CLIP.weights, np.float32(0))
    return replace(take_of(), clip=replace(CLIP, weights=weights))
