"""From a folder of takes to the windows that networks learn from."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX, mirrored_channel
from faceedit_app.core.arrays import Bools, Floats, Indices
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import Region
from faceedit_app.core.resample import GRID_RATE, grid_length, to_grid
from faceedit_app.core.rig import Distances
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.registry import endings, takes_below
from faceedit_app.lab.training.settings import TrainingSettings

# A channel that never moves by this much in any take of a source was not captured.
ALIVE = 1e-3
_MIRROR = np.array([ARKIT_INDEX[mirrored_channel(c)] for c in ARKIT_CHANNELS])


@dataclass(frozen=True)
class Performance:
    """One take on the networks' grid.

    Attributes:
        name: of the file.
        source: takes of one source share their set of captured channels.
        weights: (T, 52) float32 at 25 fps, ARKit order.
        captured: (52,) bool, the channels that the source's tracker produces.
        path: the file it came from.
    """

    name: str
    source: str
    weights: Floats
    captured: Bools
    path: Path | None = None

    @property
    def seconds(self) -> float:
        """Length of the take."""
        return len(self.weights) / GRID_RATE


def load_performances(
    folders: Iterable[Path | str],
    exclude: Sequence[str] = (),
    on_file: Callable[[Path], None] = lambda path: None,
) -> list[Performance]:
    """Read every take below some folders (or single files).

    Takes named `SOURCE__NAME.csv` belong to that source; others to their folder's.

    Args:
        folders: folders of takes, or takes.
        exclude: file name patterns to leave out, such as `grid__*`.
        on_file: called before each file is read, for progress.

    Raises:
        FileError: a folder is missing or holds no take, or a take cannot be read.
    """
    loaded = []
    for folder in folders:
        for path in take_paths(folder, exclude):
            on_file(path)
            clip = open_take(path).clip
            weights = to_grid(clip.times, clip.arkit_weights(), 0, grid_length(clip.times))
            present = np.isin(ARKIT_CHANNELS, clip.channels)
            loaded.append(
                Performance(path.name, source_of(path), weights.astype(np.float32), present, path)
            )
    return _mark_captured(loaded)


def take_paths(folder: Path | str, exclude: Sequence[str] = ()) -> list[Path]:
    """Every take below a folder, in order of name; of a file, the file.

    Raises:
        FileError: there is none.
    """
    folder = Path(folder)
    paths = takes_below(folder) if folder.is_dir() else [folder]
    paths = [p for p in paths if not any(fnmatch(p.name, pattern) for pattern in exclude)]
    if not paths:
        raise FileError(folder, f"holds no take ({', '.join(endings())})", "name a folder of takes")
    return paths


def source_of(path: Path) -> str:
    """`SOURCE` of a take named `SOURCE__NAME.csv`, else the name of its folder."""
    return path.stem.split("__")[0] if "__" in path.stem else path.resolve().parent.name


def _mark_captured(performances: list[Performance]) -> list[Performance]:
    alive: dict[str, Bools] = {}
    for take in performances:
        moves = np.ptp(take.weights, axis=0) > ALIVE
        alive[take.source] = alive.get(take.source, np.zeros(len(moves), bool)) | moves
    return [replace(take, captured=take.captured & alive[take.source]) for take in performances]


def mirrored(weights: Floats) -> Floats:
    """Swap left and right: (..., 52) -> (..., 52)."""
    return weights[..., _MIRROR]


@dataclass(frozen=True)
class Windows:
    """Training examples of one region, time last as the networks want it.

    Attributes:
        controls: (N, C, W) mm.
        weights: (N, K, W) of the region's channels.
        captured: (N, K) bool: channels that the source has; the others are not learned from.
        still: (N, C, 3, W) mm: the part of each control's vector that other channels make.
    """

    controls: Floats
    weights: Floats
    captured: Bools
    still: Floats

    def __len__(self) -> int:
        return len(self.controls)

    def __getitem__(self, rows: Indices) -> Windows:
        return Windows(
            self.controls[rows], self.weights[rows], self.captured[rows], self.still[rows]
        )


def stretches(
    performances: Sequence[Performance], settings: TrainingSettings
) -> tuple[list[Performance], list[Performance]]:
    """Split takes into stretches to learn from and blocks that are held out.

    Takes are cut into blocks of two windows; a share of the blocks, drawn by the seed, is held
    out. What lies between is handed out in stretches of up to six windows, so that no frame is in
    both.
    """
    size = 2 * settings.window
    blocks = [
        (take, first, min(first + size, len(take.weights)))
        for take in performances
        for first in range(0, len(take.weights), size)
    ]
    order = np.random.default_rng(settings.seed).permutation(len(blocks))
    whole = [i for i in order if blocks[i][2] - blocks[i][1] >= settings.window]
    held = set(whole[: max(1, round(settings.held_out * len(blocks)))])
    train: list[Performance] = []
    open_run: tuple[Performance, int, int] | None = None
    for i, (take, first, last) in enumerate(blocks):
        joins = open_run is not None and open_run[0] is take and open_run[2] == first
        if open_run is not None and (not joins or i in held or first - open_run[1] >= 3 * size):
            train.append(_part(*open_run))
            open_run = None
        if i not in held:
            open_run = (take, open_run[1] if open_run else first, last)
    if open_run is not None:
        train.append(_part(*open_run))
    return train, [_part(*blocks[i]) for i in sorted(held)]


def _part(take: Performance, first: int, last: int) -> Performance:
    return replace(take, weights=take.weights[first:last])


def cut_windows(
    performances: Iterable[Performance], frames: int, overlap: float
) -> tuple[Floats, Bools]:
    """All windows of some takes: weights (N, frames, 52) and captured channels (N, 52)."""
    step = max(1, round(frames * (1 - overlap)))
    windows = [
        (take.weights[first : first + frames], take.captured)
        for take in performances
        for first in range(0, len(take.weights) - frames + 1, step)
    ]
    if not windows:
        nothing = np.zeros((0, frames, len(ARKIT_CHANNELS)), np.float32)
        return nothing, np.zeros((0, len(ARKIT_CHANNELS)), bool)
    return np.stack([w for w, _ in windows]), np.stack([c for _, c in windows])


def region_windows(
    region: Region, weights: Floats, captured: Bools, distances: Distances
) -> Windows:
    """The examples of one region among windows (N, W, 52); those without its channels are left out.

    Args:
        distances: the controls as a function of the 52 weights in ARKit order.
    """
    columns = [ARKIT_INDEX[c] for c in region.channels]
    rows = captured[:, columns].any(axis=1)
    weights, captured = weights[rows], captured[rows]
    controls = [CONTROL_INDEX[c] for c in region.controls]
    mine = distances.select(controls)
    others = weights.copy()
    others[:, :, columns] = 0.0
    shape = (*weights.shape[:2], len(controls))
    flat = (-1, weights.shape[2])
    return Windows(
        mine.measure(weights.reshape(flat)).reshape(shape).transpose(0, 2, 1).copy(),
        weights[:, :, columns].transpose(0, 2, 1).copy(),
        captured[:, columns],
        mine.vectors(others.reshape(flat)).reshape(*shape, 3).transpose(0, 2, 3, 1).copy(),
    )
