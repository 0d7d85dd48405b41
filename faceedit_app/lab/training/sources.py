"""Takes at their own rate, gathered by source, for comparing them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from faceedit_app.formats.opening import open_take
from faceedit_app.lab.training.data import source_of, take_paths
from faceedit_app.lab.training.statistics import TimedWeights


def by_source(
    folders: Sequence[Path], exclude: Sequence[str] = ()
) -> dict[str, list[TimedWeights]]:
    """Takes below some folders (or single files) by their source, each file once.

    Raises:
        FileError: a folder is missing or holds no take, or a take cannot be read.
    """
    takes: dict[str, list[TimedWeights]] = defaultdict(list)
    seen: set[Path] = set()
    for folder in folders:
        for path in take_paths(folder, exclude):
            if path.resolve() in seen:
                continue
            seen.add(path.resolve())
            clip = open_take(path).clip
            takes[source_of(path)].append((clip.times, clip.arkit_weights().astype(np.float32)))
    return dict(takes)
