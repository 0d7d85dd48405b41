"""A smooth of all curves of a region is one of its channels.

A face whose curves become calm is the same face with calm channels. Curves that are smoothed one by
one would not tell that: where they are not those of any face, as around a blink, channels that were
still would begin to shake. So a smooth of all curves of a region smooths its channels first, by the
same kernel, and the rest of the answer only brings what then still lacks. That keeps every channel
as calm as it was, and the other regions as they were.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices, Times
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.solving.bridging import smoothed_without
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.request import smoothing, smoothing_frames


@dataclass(frozen=True)
class Calmed:
    """A region that smooths calm.

    Attributes:
        controls: ids of all its own controls that edits can ask for.
        columns: (K,) its channels among the 52.
    """

    controls: tuple[str, ...]
    columns: Indices

    def __call__(
        self,
        edits: Sequence[Edit],
        times: Times,
        rate: float,
        weights: Floats,
        curves: Doubles,
        far: Bools | None = None,
    ) -> tuple[Floats, Doubles]:
        """Smooth the region by those of the edits that smooth all of it.

        A reset takes smooths back where all controls are reset.

        Args:
            edits: in the user's order.
            times: (N,) seconds.
            rate: frames per second.
            weights, curves: (N, 52), and (N, C) mm, before these edits.
            far: (N,) the frames that smooths leave out, see `bridging.py`; None = none.

        Returns:
            The same, smoothed; without any smooth, the same arrays.
        """
        whole = [edit for edit in edits if edit.op is Op.SMOOTH and self._covered(edit)]
        if not whole or not self.controls:
            return weights, curves
        own = [CONTROL_INDEX[control] for control in self.controls]
        recorded = np.concatenate([weights[:, self.columns], curves[:, own]], axis=1)
        calm, back = recorded.copy(), np.zeros((len(times), len(self.controls)))
        for edit in edits:
            if edit.op is Op.RESET:
                share = edit.mask(times) * min(edit.strength, 1.0)
                mine = [i for i, control in enumerate(self.controls) if control in edit.controls]
                back[:, mine] += share[:, None] * (1.0 - back[:, mine])
            elif edit in whole:
                calm = _back(calm, recorded, back)
                back[:] = 0.0
                _smooth(calm, edit, times, rate, far)
        calm = _back(calm, recorded, back)
        new_weights, new_curves = weights.copy(), curves.copy()
        count = len(self.columns)
        new_weights[:, self.columns] = calm[:, :count].astype(weights.dtype)
        new_curves[:, own] = calm[:, count:]
        return new_weights, new_curves

    def _covered(self, edit: Edit) -> bool:
        return set(self.controls).issubset(edit.controls)


def _smooth(values: Doubles, edit: Edit, times: Times, rate: float, far: Bools | None) -> None:
    """Smooth values (N, V) by an edit, in place; `far` as in `Calmed`."""
    around = smoothing_frames(edit, rate)
    first, last = edit.span
    rows = slice(*map(int, np.searchsorted(times, (first - 1e-9, last + 1e-9))))
    if not around or rows.start == rows.stop:
        return
    begin, end = max(rows.start - around, 0), min(rows.stop + around, len(times))
    left_out = None if far is None else far[begin:end]
    smooth = smoothed_without(
        values[begin:end], left_out, lambda kept: smoothed(kept, smoothing(edit) * rate)
    )
    share = edit.mask(times[rows])[:, None] * min(edit.strength, 1.0)
    now = values[rows]
    values[rows] = now + share * (smooth[rows.start - begin : rows.stop - begin] - now)


def _back(values: Doubles, recorded: Doubles, back: Doubles) -> Doubles:
    """Values (N, V), as recorded as far as all controls are back, (N, C) in 0..1."""
    share = back.min(axis=1, keepdims=True)
    mixed: Doubles = np.where(share >= 1.0, recorded, values + share * (recorded - values))
    return mixed
