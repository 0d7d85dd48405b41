"""All figures about people: measured source by source, reported as medians over sources."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from faceedit_app.core.regions import EYELIDS
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.lab.evaluation.people import gestures, references, telling_apart
from faceedit_app.lab.evaluation.people.events import Events, add_events
from faceedit_app.lab.evaluation.people.inpainting import measure_inpainting
from faceedit_app.lab.evaluation.people.opened import Opened
from faceedit_app.lab.evaluation.people.references import References
from faceedit_app.lab.evaluation.people.restoration import measure_restoration
from faceedit_app.lab.evaluation.people.sources import TakeSource, Tracker, sources_of, with_weights
from faceedit_app.lab.evaluation.people.tally import Tally
from faceedit_app.lab.evaluation.systems import Systems
from faceedit_app.lab.training.data import Performance, load_performances

ONE_SOURCE = (
    "there is only one source: real_or_edited learns from its other takes, so that people may be "
    "shared, and the references learn from the demo take"
)


@dataclass
class PeopleFigures:
    """What `measure_people` finds.

    Attributes:
        tally: the values.
        sources: the sources that were measured.
        synthesised: the number of takes that were left out because a synthesiser made them.
        notes: what a reader has to know.
    """

    tally: Tally = field(default_factory=Tally)
    sources: list[TakeSource] = field(default_factory=list)
    synthesised: int = 0
    notes: list[str] = field(default_factory=list)

    def value(self, figure: str, system: str, tracker: Tracker | None = None) -> float:
        """The median over the sources, of all or of one tracker; NaN without any value."""
        names = [s.name for s in self.sources if tracker is None or s.tracker is tracker]
        return self.tally.median(figure, system, names)

    def as_json(self) -> dict[str, Any]:
        """The figures as nested JSON values, `{group: {figure: {system: number}}}`."""
        by_tracker = {t.value: self._tree(t) for t in self._trackers()}
        return self._tree(None) | {
            "people": {
                "sources": [
                    {
                        "name": source.name,
                        "tracker": source.tracker.value,
                        "takes": len(source.takes),
                        "seconds": source.seconds,
                        "trained_on": source.trained_on,
                    }
                    for source in self.sources
                ],
                "synthesised_left_out": self.synthesised,
                "by_tracker": by_tracker,
                "notes": self.notes,
            }
        }

    def _trackers(self) -> list[Tracker]:
        return [t for t in Tracker if any(s.tracker is t for s in self.sources)]

    def _tree(self, tracker: Tracker | None) -> dict[str, Any]:
        out: dict[str, Any] = {}
        for figure in self.tally.figures:
            numbers = {
                system: _number(self.value(figure, system, tracker))
                for system in self.tally.systems(figure)
            }
            group, _, name = figure.partition(".")
            if name:
                out.setdefault(group, {})[name] = numbers
            else:
                out[group] = numbers
        return out


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def measure_people(
    performances: Sequence[Performance],
    rig: Rig,
    systems_for: Callable[[str], Systems],
    trained_on: Collection[str] = (),
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> PeopleFigures:
    """Measure what users get on takes of people.

    Args:
        performances: takes with the paths of their files. Synthesised ones are left out; only
            the references learn from them.
        rig: the character.
        systems_for: the networks to measure a source with, by its name.
        trained_on: names of the sources that these networks were trained on.
        progress: called with the number of takes done and of all.
    """
    sources, synthesised = sources_of(performances, trained_on)
    figures = PeopleFigures(sources=sources, synthesised=len(synthesised))
    if len(sources) == 1:
        figures.notes.append(ONE_SOURCE)
    seen = {}
    done, count = 0, sum(len(source.takes) for source in sources)
    for source in sources:
        systems = systems_for(source.name)
        learned = References(_pool(source, sources, synthesised), rig)
        measure_restoration(source, rig, systems, learned, figures.tally)
        measure_inpainting(source, rig, figures.tally)
        _measure_gestures(source, rig, systems, learned, figures.tally)
        found = telling_apart.see(source, rig, systems, learned)
        if len(found.real):
            seen[source.name] = found
        done += len(source.takes)
        progress(done, count)
    for name, by_system in telling_apart.accuracies(seen).items():
        for system, share in by_system.items():
            figures.tally.add(telling_apart.FIGURE, system, name, share)
    return figures


def _pool(
    source: TakeSource, sources: Sequence[TakeSource], synthesised: Sequence[Performance]
) -> list[Performance]:
    """What the references learn from: other people, and synthesised takes."""
    pool = [p for other in sources if other is not source for p in other.performances]
    pool += synthesised
    if not references.captures_all_regions(pool):
        pool += load_performances([shipped("assets/demo_take.csv")])
    return pool


def _measure_gestures(
    source: TakeSource, rig: Rig, systems: Systems, learned: References, tally: Tally
) -> None:
    closures, blinks = Events(), Events()
    for take in source.takes:
        opened = Opened(take, rig, systems, learned)
        alike = with_weights(take, gestures.symmetric_weights(opened.weights))
        symmetric = Opened(alike, rig, systems, learned)
        gestures.measure_closures(opened, source.name, tally)
        gestures.measure_smiles(opened, source.name, source.captures, tally)
        gestures.measure_asymmetry(opened, symmetric, source.name, tally)
        gestures.measure_smooth(opened, source.name, tally)
        gestures.measure_wild(opened, systems.engine, source.name, tally)
        add_events(opened, closures, blinks, source.captures(*EYELIDS.channels[:2]))
    for name, events in (("closures", closures), ("blinks", blinks)):
        for system in events.systems:
            figure = f"{name}.events_tpr_at_fpr_05"
            tally.add(figure, system, source.name, events.rate(system))
