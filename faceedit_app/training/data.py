"""From a folder of takes to the windows that networks learn from."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX, mirrored_channel
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import CONTROL_INDEX, Region
from faceedit_app.core.resample import GRID_RATE, grid_length, to_grid
from faceedit_app.core.rig import Distances
from faceedit_app.formats.opening import open_take

Floats = NDArray[np.float32]

# A channel that never moves by this much in any take of a source was not captured.
ALIVE = 1e-3
_MIRROR = np.array([ARKIT_INDEX[mirrored_channel(c)] for c in ARKIT_CHANNELS])
_LEFT = np.array([c.endswith("Left") for c in ARKIT_CHANNELS])


@dataclass(frozen=True)
class Performance:
    """One take on the networks' grid.

    Attributes:
        name: of the file.
        source: takes of one source share their set of captured channels.
        weights: (T, 52) float32 at 25 fps, ARKit order.
        captured: (52,) bool, the channels that the source's tracker produces.
    """

    name: str
    source: str
    weights: Floats
    captured: NDArray[np.bool_]

    @property
    def seconds(self) -> float:
        """Length of the take."""
        return len(self.weights) / GRID_RATE


def load_performances(
    folders: Iterable[Path | str],
    exclude: Sequence[str] = (),
    on_file: Callable[[Path], None] = lambda path: None,
) -> list[Performance]:
    """Read every CSV take below some folders (or single files).

    Takes named `SOURCE__NAME.csv` belong to that source; others to their folder's.

    Args:
        folders: folders of takes, or takes.
        exclude: file name patterns to leave out, such as `grid__*`.
        on_file: called before each file is read, for progress.

    Raises:
        FileError: a folder is missing or holds no take, or a take cannot be read.
    """
    loaded = []
    for folder in map(Path, folders):
        paths = sorted(folder.rglob("*.csv")) if folder.is_dir() else [folder]
        paths = [p for p in paths if not any(fnmatch(p.name, pattern) for pattern in exclude)]
        if not paths:
            raise FileError(folder, "holds no take (*.csv)", "name a folder of takes")
        for path in paths:
            on_file(path)
            clip = open_take(path).clip
            weights = to_grid(clip.times, clip.arkit_weights(), 0, grid_length(clip.times))
            source = path.stem.split("__")[0] if "__" in path.stem else path.parent.name
            present = np.isin(ARKIT_CHANNELS, clip.channels)
            loaded.append(Performance(path.name, source, weights.astype(np.float32), present))
    return _mark_captured(loaded)


def _mark_captured(performances: list[Performance]) -> list[Performance]:
    alive: dict[str, NDArray[np.bool_]] = {}
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
    captured: NDArray[np.bool_]
    still: Floats

    def __len__(self) -> int:
        return len(self.controls)

    def __getitem__(self, rows: NDArray[np.intp]) -> Windows:
        return Windows(
            self.controls[rows], self.weights[rows], self.captured[rows], self.still[rows]
        )


@dataclass(frozen=True)
class Augmentation:
    """What is added to the recorded windows. Every weight vector has exact controls on the rig,
    so an altered performance is as good an example as a recorded one.

    Attributes:
        mirror: add each window with left and right swapped.
        split_sides: share of additional windows whose right half comes from another take, for
            winks and one-sided smiles, which almost never occur in takes.
        gain: share of additional windows played stronger or weaker.
        gain_range: smallest and largest factor.
    """

    mirror: bool = True
    split_sides: float = 0.25
    gain: float = 0.25
    gain_range: tuple[float, float] = (0.4, 1.6)


def cut_windows(
    performances: Sequence[Performance], frames: int, overlap: float
) -> tuple[Floats, NDArray[np.bool_], NDArray[np.intp]]:
    """Cut takes into windows.

    Returns:
        Weights (N, frames, 52), captured (N, 52), and block (N,): windows of one block overlap,
        windows of different blocks do not share a frame, so that whole blocks can be held out.
    """
    step = max(1, round(frames * (1 - overlap)))
    windows, captured, blocks = [], [], []
    block = 0
    for take in performances:
        for first in range(0, len(take.weights) - frames + 1, 2 * frames):
            part = take.weights[first : first + 2 * frames]
            for start in range(0, len(part) - frames + 1, step):
                windows.append(part[start : start + frames])
                captured.append(take.captured)
                blocks.append(block)
            block += 1
    if not windows:
        raise FileError(
            "training data", f"no take is as long as a window of {frames} frames", "add takes"
        )
    return np.stack(windows), np.stack(captured), np.array(blocks)


def augment(
    weights: Floats,
    captured: NDArray[np.bool_],
    how: Augmentation,
    random: np.random.Generator,
) -> tuple[Floats, NDArray[np.bool_]]:
    """Add altered windows: (N, W, 52), (N, 52) -> more of both."""
    if how.mirror:
        weights = np.concatenate([weights, mirrored(weights)])
        captured = np.concatenate([captured, captured[:, _MIRROR]])
    n = len(weights)
    extra_w, extra_c = [weights], [captured]
    if count := int(n * how.split_sides):
        left, right = random.integers(n, size=count), random.integers(n, size=count)
        extra_w.append(np.where(_LEFT, weights[left], weights[right]))
        extra_c.append(np.where(_LEFT, captured[left], captured[right]))
    if count := int(n * how.gain):
        which = random.integers(n, size=count)
        gain = random.uniform(*how.gain_range, size=(count, 1, 1)).astype(np.float32)
        extra_w.append(np.clip(weights[which] * gain, 0.0, 1.0))
        extra_c.append(captured[which])
    return np.concatenate(extra_w), np.concatenate(extra_c)


def region_windows(
    region: Region, weights: Floats, captured: NDArray[np.bool_], distances: Distances
) -> Windows:
    """The examples of one region among windows (N, W, 52); those without its channels are left out.

    Args:
        distances: the eight controls as a function of the 52 weights in ARKit order.
    """
    columns = [ARKIT_INDEX[c] for c in region.channels]
    rows = captured[:, columns].any(axis=1)
    weights, captured = weights[rows], captured[rows]
    controls = [CONTROL_INDEX[c] for c in region.controls]
    mine = Distances(distances.offsets[controls], distances.gradients[:, controls])
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
