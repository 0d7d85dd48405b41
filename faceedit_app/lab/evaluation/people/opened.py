"""A take that every system edits in the same places."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.controls import CONTROL_INDEX, MAIN_CONTROLS
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.take import Take
from faceedit_app.lab.evaluation.people import references
from faceedit_app.lab.evaluation.people.references import References
from faceedit_app.lab.evaluation.systems import Systems

FACEEDIT, PAPER, HOLDEN, SPLICE, REAL, DAMAGED = (
    *("faceedit", "paper", "holden", "splice", "real", "damaged"),
)
EDITORS = (FACEEDIT, PAPER, HOLDEN, *references.NAMES)
ALONE = Settings(Mode.RESYNTHESIZE, 1.0, 0.0)
"""The networks' own answer to all curves, as in the paper."""


class Opened:
    """A take opened by every system.

    `faceedit` is the application as it is set when it starts. `paper` and `holden` answer with
    the networks alone, in place of the take; `holden` is left out if the models have no baseline.

    Args:
        take: the take.
        rig: the character.
        systems: the networks.
        learned: the references.
    """

    def __init__(self, take: Take, rig: Rig, systems: Systems, learned: References) -> None:
        self.take, self.rig = take, rig
        self._systems, self._references = systems, learned
        self._session = open_session(take, rig, systems.engine)
        self.tracked = self._session.tracked
        self.weights: Floats = take.clip.arkit_weights()

    @property
    def times(self) -> Times:
        """(T,) seconds."""
        return self.take.clip.times

    @property
    def editors(self) -> tuple[str, ...]:
        """The systems that can edit it."""
        has_baseline = all(region.id in self._systems.baseline.models for region in REGIONS)
        return tuple(name for name in EDITORS if name != HOLDEN or has_baseline)

    @cached_property
    def _baseline(self) -> EditSession:
        return open_session(self.take, self.rig, self._systems.baseline)

    def edited(
        self, system: str, edits: Sequence[Edit], settings: Settings | None = None
    ) -> Floats:
        """The take's weights with edits.

        Args:
            system: one of `editors`.
            edits: what is asked for.
            settings: of the networks, in place of the system's own.

        Returns:
            (T, 52) in ARKit order.
        """
        if system in references.NAMES:
            self._show(self._session, edits, Settings())
            edited = {control for edit in edits for control in edit.controls}
            asked = self._session.asked
            return self._references.answer(system, self.weights, self.tracked, asked, edited)
        session = self._baseline if system == HOLDEN else self._session
        own = Settings() if system == FACEEDIT else ALONE
        self._show(session, edits, settings or own)
        return session.weights.copy()

    def regenerated(self, system: str) -> Floats:
        """(T, 52): the take answered from its own curves alone.

        FaceEdit resynthesizes; references start from the take's median face.
        """
        everything = Edit(tuple(self._controls), Op.OFFSET, 0.0, self.take.clip.duration, 0.0)
        if system in references.NAMES:
            median = np.repeat(np.median(self.weights, axis=0, keepdims=True), len(self.times), 0)
            at_rest = self.controls(median)
            return self._references.answer(system, median, at_rest, self.tracked)
        settings = Settings(Mode.RESYNTHESIZE) if system == FACEEDIT else ALONE
        return self.edited(system, [everything], settings)

    def controls(self, weights: Floats) -> Floats:
        """(T, C) mm: the curves of weights (T, 52)."""
        return self.rig.arkit_distances.measure(weights)

    @property
    def _controls(self) -> list[str]:
        return [c for c in MAIN_CONTROLS if self.rig.has_control[CONTROL_INDEX[c]]]

    @staticmethod
    def _show(session: EditSession, edits: Sequence[Edit], settings: Settings) -> None:
        session.configure(settings)
        session.put(edits)
        session.live.work()
