"""The figures about people as Markdown: against the goals, and beside the references."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.lab.evaluation.people.figures import PeopleFigures
from faceedit_app.lab.evaluation.people.inpainting import (
    HOLD,
    JUMP,
    LINEAR,
    MOVEMENT,
    NEAREST,
    RESTORATION,
)
from faceedit_app.lab.evaluation.people.opened import (
    DAMAGED,
    FACEEDIT,
    HOLDEN,
    PAPER,
    REAL,
    SPLICE,
)
from faceedit_app.lab.evaluation.people.sources import Tracker
from faceedit_app.lab.evaluation.people.telling_apart import FIGURE as REAL_OR_EDITED
from faceedit_app.lab.evaluation.tables import markdown_table

LABELS = {
    FACEEDIT: "FaceEdit",
    PAPER: "networks alone, as in the paper",
    HOLDEN: "Holden et al. 2016",
    "ridge": "ridge regression",
    "covariance": "covariance",
    "bump": "bump on one channel",
    SPLICE: "another real stretch, spliced in",
    REAL: "the takes themselves",
    DAMAGED: "damaged, not restored",
    LINEAR: "straight line",
    HOLD: "last frame held",
    NEAREST: "the take's stretch that is nearest to the truth",
}
TRACKERS = {Tracker.IPHONE: "iPhone", Tracker.FILM: "film", Tracker.OTHER: "other"}


@dataclass(frozen=True)
class FigureStyle:
    """How a figure is written.

    Attributes:
        label: its name.
        scale: what a value is multiplied by.
        digits: behind the point.
        unit: behind the number.
    """

    label: str
    scale: float = 1.0
    digits: int = 3
    unit: str = ""

    def text(self, value: float) -> str:
        """A value; a dash if there is none."""
        if not np.isfinite(value):
            return "–"
        return f"{round(self.scale * value, self.digits) + 0.0:.{self.digits}f}{self.unit}"


def _error(label: str) -> FigureStyle:
    return FigureStyle(f"restoration, {label}: mean squared weight error x 1000", 1000.0, 2)


def _share(label: str) -> FigureStyle:
    return FigureStyle(label, 100.0, 0, " %")


FIGURES: dict[str, FigureStyle] = {
    REAL_OR_EDITED: _share("real or edited: windows that a classifier gets right"),
    "closures.met": _share("closure met within 0.5 mm of the take's own"),
    "closures.frown": FigureStyle("closure: mouthFrown added"),
    "closures.mouth_close": FigureStyle("closure: mouthClose"),
    "closures.events_tpr_at_fpr_05": _share("closures kept, at 5 % false ones"),
    "blinks.events_tpr_at_fpr_05": _share("blinks kept, at 5 % false ones"),
    "restoration.six": _error("all curves of the mouth"),
    "restoration.opening": _error("mouth opening only"),
    "restoration.half": _error("half amplitude, all curves of the mouth"),
    "restoration.lids": _error("eyelids"),
    JUMP: FigureStyle("in-painting: change of velocity at the ends, mm per frame"),
    RESTORATION: FigureStyle("in-painting: mean squared weight error x 1000", 1000.0, 2),
    MOVEMENT: FigureStyle("in-painting: change of a weight per frame x 1000", 1000.0, 2),
    "smile.mouthSmile": FigureStyle("smile of 3 mm: mouthSmile added"),
    "smile.mouthStretch": FigureStyle("smile of 3 mm: mouthStretch added"),
    "smile.cheekSquint": FigureStyle("smile of 3 mm: cheekSquint added"),
    "smile.eyeSquint": FigureStyle("smile of 3 mm: eyeSquint added"),
    "smile.mouthDimple": FigureStyle("smile of 3 mm: mouthDimple added"),
    "asymmetry": FigureStyle("symmetric request: largest difference of left and right", digits=4),
    "smooth_roughness": FigureStyle(
        "Smooth: largest rise of a channel's second difference", digits=4
    ),
    "wild.distance": FigureStyle("wild requests: distance from natural motion", digits=2),
}


@dataclass(frozen=True)
class PeopleGoal:
    """A goal for a figure: at most, or at least, so much; iPhone and film apart.

    Attributes:
        figure: its name.
        iphone, film: the goal; None = only relative to others.
        least: at least, not at most.
        below: systems that FaceEdit must be below as well.
        beyond_splice: at most so much more than a real splice.
    """

    figure: str
    iphone: float | None = None
    film: float | None = None
    least: bool = False
    below: tuple[str, ...] = ()
    beyond_splice: float | None = None

    def limit(self, figures: PeopleFigures, tracker: Tracker) -> float:
        """The value that must be reached; NaN if it cannot be said."""
        limits = [self.iphone if tracker is Tracker.IPHONE else self.film]
        limits += [figures.value(self.figure, system, tracker) for system in self.below]
        if self.beyond_splice is not None:
            limits.append(figures.value(self.figure, SPLICE, tracker) + self.beyond_splice)
        known = [limit for limit in limits if limit is not None]
        return min(known)

    def text(self, figures: PeopleFigures, tracker: Tracker) -> str:
        """The goal for a table."""
        sign = "≥" if self.least else "≤"
        return f"{sign} {FIGURES[self.figure].text(self.limit(figures, tracker))}"

    def reached(self, figures: PeopleFigures, tracker: Tracker) -> bool:
        """Whether FaceEdit reaches it."""
        value, limit = figures.value(self.figure, FACEEDIT, tracker), self.limit(figures, tracker)
        return bool(value >= limit if self.least else value <= limit)


AIMS = (
    PeopleGoal(REAL_OR_EDITED, beyond_splice=0.02),
    PeopleGoal("closures.met", 0.95, 0.95, least=True),
    PeopleGoal("closures.frown", 0.03, 0.03),
    PeopleGoal("restoration.six", 0.9e-3, 2.2e-3),
    PeopleGoal("restoration.opening", 2.5e-3, 9e-3, below=("ridge", "covariance")),
    PeopleGoal("restoration.lids", 2.0e-3, 2.8e-3),
    PeopleGoal("asymmetry", 1e-4, 1e-4),
    PeopleGoal("smooth_roughness", 0.002, 0.002),
)


def goals_table(figures: PeopleFigures) -> str:
    """FaceEdit's figures beside the goals; iPhone and film apart."""
    trackers = [t for t in (Tracker.IPHONE, Tracker.FILM) if _has(figures, t)]
    rows = []
    for aim in AIMS:
        shown = FIGURES[aim.figure]
        row = [shown.label]
        for tracker in trackers:
            value = figures.value(aim.figure, FACEEDIT, tracker)
            reached = "" if not np.isfinite(value) else _verdict(aim.reached(figures, tracker))
            row += [shown.text(value), aim.text(figures, tracker), reached]
        rows.append(row)
    titles = ["figure"]
    for tracker in trackers:
        titles += [TRACKERS[tracker], "goal", "reached"]
    return markdown_table(titles, rows)


def goals_reached(figures: PeopleFigures) -> tuple[int, int]:
    """How many goals are reached, and of how many that could be measured."""
    verdicts = [
        aim.reached(figures, tracker)
        for aim in AIMS
        for tracker in (Tracker.IPHONE, Tracker.FILM)
        if np.isfinite(figures.value(aim.figure, FACEEDIT, tracker))
    ]
    return sum(verdicts), len(verdicts)


def _verdict(reached: bool) -> str:
    return "yes" if reached else "**no**"


def _has(figures: PeopleFigures, tracker: Tracker) -> bool:
    return any(source.tracker is tracker for source in figures.sources)


def systems_table(figures: PeopleFigures) -> str:
    """Every figure of every system: by tracker, and over all sources."""
    trackers = [t for t in Tracker if _has(figures, t)]
    rows = []
    for figure, shown in FIGURES.items():
        systems = figures.tally.systems(figure)
        label = shown.label  # in the figure's first row only
        for system in (s for s in LABELS if s in systems):
            values = [figures.value(figure, system, tracker) for tracker in (*trackers, None)]
            if np.isfinite(values).any():
                rows.append([label, LABELS[system], *map(shown.text, values)])
                label = ""
    titles = ["figure", "system", *(TRACKERS[t] for t in trackers), "all"]
    return markdown_table(titles, rows)


def sources_table(figures: PeopleFigures) -> str:
    """The sources that were measured."""
    rows = [
        [
            f"`{source.name}`",
            TRACKERS[source.tracker],
            str(len(source.takes)),
            f"{source.seconds:.0f}",
            "yes, which flatters FaceEdit" if source.trained_on else "no",
        ]
        for source in figures.sources
    ]
    titles = ["source", "recorded by", "takes", "seconds", "networks trained on it"]
    return markdown_table(titles, rows)


def people_part(figures: PeopleFigures) -> str:
    """Everything about people as one part of a report."""
    return "\n\n".join(
        [
            sources_table(figures),
            left_out(figures),
            *(f"Note: {note}." for note in figures.notes),
            EXPLAINED,
            "### Goals",
            goals_table(figures),
            "### Beside the references",
            systems_table(figures),
        ]
    )


def goals_part(figures: PeopleFigures) -> str:
    """The figures against the goals, for the model card."""
    reached, count = goals_reached(figures)
    return "\n\n".join(
        [
            f"{reached} of {count} goals are reached by FaceEdit as it is set when it starts. How "
            "each is measured, and what simple references reach: `docs/evaluation/people.md`.",
            sources_table(figures),
            left_out(figures),
            *(f"Note: {note}." for note in figures.notes),
            goals_table(figures),
        ]
    )


def left_out(figures: PeopleFigures) -> str:
    """How many takes do not count, in a sentence."""
    takes = "take was" if figures.synthesised == 1 else "takes were"
    return (
        f"{figures.synthesised} synthesised {takes} left out: only people count. A figure is "
        "the mean of a source, or over several sources the median of their means."
    )


EXPLAINED = """Every system is asked for the same edits. *FaceEdit* is the application as it
starts: what the window shows and the export writes. *Networks alone* and *Holden et al.* answer
the whole region from its curves, without reach. *Ridge regression* (quadratic, one frame) and
*covariance* (one Gaussian step) learned from the other sources; *bump* moves one channel.

- **Restoration.** 0.8 s of a take are replaced by another stretch of it, or brought half-way to its
  median; then the true curves are drawn. Mean squared error of the region's weights against the
  take, times 1000 (JSON: not multiplied).
- **In-painting.** Stretches of 0.5 to 2 s are lost, and filled from what is around them; FaceEdit
  by *Fill*, without sound. Change of velocity: of the curve with the largest, at the four frames of
  both ends. The error alone favours what does not move: a straight line is never far off.
- **Real or edited.** A logistic regression on windows of 64 frames at 25 a second, half of them
  with a drag of one curve (or pair) by 1 to 2 times its spread in the take. It learns from the
  other sources; 50 % is chance, and with 240 windows of a source the standard error is 2 points.
  The reference is a stretch of the same take, spliced in.
- **Closures.** Asked for where the mouth is more than 3 mm farther open than in the take's own
  closures (median of their lowest openings, or 1.15 mm), for 0.2 s. Frown: what is added to
  mouthFrown; the takes themselves: what their closures of up to 0.6 s add to the frames around.
  mouthClose: the weight in the closure.
- **Closures and blinks kept.** The take is answered from its curves alone (FaceEdit resynthesizes).
  The share of its closures that come nearer than 95 % of its open stretches of 0.2 s do.
- **Smiles.** Both corners are raised by 3 mm for 0.5 s; only channels that the source captures. The
  takes themselves: where mouthSmile exceeds 0.3 and the jaw rests, for as many millimetres.
- **Symmetric request.** A closure, a smile and a blink in the take made symmetric: the largest
  channel's mean difference of left and right. The takes themselves: in their closures and smiles.
- **Smooth.** All curves of the whole take, by 0.04 and 0.1 s: the largest rise of a channel's rms
  second difference.
- **Wild requests.** Four of them, through the session like a drag: the largest Mahalanobis distance
  from natural motion; 1 is the 99.9th percentile of recorded takes."""


def summary_lines(figures: PeopleFigures) -> list[str]:
    """The main figures for the terminal."""
    lines = [left_out(figures)]
    for aim in AIMS:
        shown = FIGURES[aim.figure]
        parts = [
            f"{TRACKERS[t]} {shown.text(figures.value(aim.figure, FACEEDIT, t))}"
            for t in Tracker
            if np.isfinite(figures.value(aim.figure, FACEEDIT, t))
        ]
        if parts:
            lines.append(f"{shown.label}: {', '.join(parts)}")
    return lines
