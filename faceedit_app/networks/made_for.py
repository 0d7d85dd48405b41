"""The character that a model was made for.

Networks turn distances on one character into weights, which have another effect on a head of
another size or with other blendshapes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_INDEX, control_named
from faceedit_app.core.fields import LARGEST, FieldError, Fields
from faceedit_app.core.rig import Rig

TOLERANCE = 0.01  # mm; files round, and a hundredth has no visible effect
LONGEST_NAME = 80
_DECIMALS = 4


@dataclass(frozen=True)
class MadeFor:
    """The properties of a character that the answers of networks depend on.

    Attributes:
        name: the name of the character.
        controls: by control, (1 + 52, 3) mm: the vector between its control points on the neutral
            face, and how each ARKit channel at weight 1 changes that vector.
    """

    name: str
    controls: dict[str, Doubles]

    @classmethod
    def of(cls, rig: Rig, controls: Iterable[str]) -> MadeFor:
        """Measure controls on a rig."""
        distances = rig.arkit_distances
        vectors = np.concatenate([distances.offsets[None], distances.gradients]).astype(np.float64)
        rounded = np.round(vectors, _DECIMALS) + 0.0  # -0 is 0
        return cls(
            rig.name[:LONGEST_NAME],
            {control: rounded[:, CONTROL_INDEX[control]] for control in controls},
        )

    def difference(self, rig: Rig) -> str:
        """How a rig differs from the character, as a phrase; "" if it does not."""
        here = MadeFor.of(rig, self.controls).controls
        for control, vectors in self.controls.items():
            if np.abs(vectors - here[control]).max() <= TOLERANCE:
                continue
            label = control_named(control).label.lower()
            if control in rig.missing_controls:
                return f"it has a {label}, this one does not"
            ours, theirs = (float(np.linalg.norm(v[0])) for v in (vectors, here[control]))
            if abs(ours - theirs) > TOLERANCE:
                return f"its {label} at rest is {ours:.1f} mm, here {theirs:.1f} mm"
            return f"its blendshapes change the {label} differently"
        return ""

    def to_json(self) -> dict[str, Any]:
        """JSON values; channels that do not move a control are left out."""
        controls = {
            control: {
                "rest": vectors[0].tolist(),
                "channels": {
                    channel: move.tolist()
                    for channel, move in zip(ARKIT_CHANNELS, vectors[1:], strict=True)
                    if move.any()
                },
            }
            for control, vectors in self.controls.items()
        }
        return {"name": self.name, "controls": controls}

    @classmethod
    def from_json(cls, entry: Fields, controls: Iterable[str]) -> MadeFor:
        """Read JSON values.

        Args:
            entry: the values.
            controls: ids of the controls that must be there.

        Raises:
            FieldError: the values are not from `to_json`.
        """
        measured, found = entry.fields("controls"), {}
        for control in controls:
            known = measured.fields(control)
            vectors = found[control] = np.zeros((1 + len(ARKIT_CHANNELS), 3))
            vectors[0] = _vector(known, "rest")
            moves = known.fields("channels")
            for i, channel in enumerate(ARKIT_CHANNELS, 1):
                if moves.has(channel):
                    vectors[i] = _vector(moves, channel)
            moves.finish()
        measured.finish()
        return cls(entry.text("name", longest=LONGEST_NAME), found)


def _vector(entry: Fields, name: str) -> tuple[float, float, float]:
    match entry.items(name, most=3):
        case [int() | float() as x, int() | float() as y, int() | float() as z] if (
            max(abs(x), abs(y), abs(z)) <= LARGEST
        ):
            return x, y, z
        case _:
            raise FieldError(f'"{name}" is not a vector')
