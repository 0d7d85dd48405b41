"""The paper's experiments and ours, one function each; each writes one part of the report.

    faceedit experiment all --data DIR... --held-out DIR... -o docs/evaluation

`held-out` are takes that nothing is ever trained on. The shipped models answer where an
experiment does not need networks of its own; those it trains get `epochs` passes, which is less
than the shipped ones had.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.regions import EYELIDS, LOWER
from faceedit_app.editing.opening import load_engine
from faceedit_app.lab.evaluation.evaluate import Figures
from faceedit_app.lab.evaluation.faces import faces_part
from faceedit_app.lab.evaluation.goals import networks_goals_part
from faceedit_app.lab.evaluation.people.report import goals_part, people_part
from faceedit_app.lab.evaluation.people.sources import sources_of
from faceedit_app.lab.evaluation.report import (
    LABELS,
    NOTES,
    closure_charts,
    closures_table,
    curve_charts,
    edits_table,
    kinds_table,
    make_folder,
    regions_table,
)
from faceedit_app.lab.evaluation.retraining import leave_one_out, recipes, table2
from faceedit_app.lab.evaluation.robustness import robustness_part
from faceedit_app.lab.evaluation.setting import Setting
from faceedit_app.lab.evaluation.systems import Systems
from faceedit_app.lab.evaluation.tables import cell, markdown_table
from faceedit_app.lab.evaluation.untouched import measure_untouched, untouched_part
from faceedit_app.lab.training.card import CARD, trained_sources, with_figures
from faceedit_app.lab.training.charts import Line, chart
from faceedit_app.lab.training.sources import by_source
from faceedit_app.lab.training.statistics import measure, spectrum, table

Experiment = Callable[[Setting], Path]


def held_out(setting: Setting) -> Path:
    """Everything about the shipped models on takes that they were not trained on."""
    figures = setting.figures
    make_folder(setting.output)
    parts = [
        "# The shipped models on held-out takes",
        f"{_takes_text(figures)} {NOTES}",
        regions_table(figures),
        closures_table(figures),
        *closure_charts(figures, setting.output),
        "## Edits",
        "Each take: a spike of one frame, a smile over the whole take, conflicting corners, a wild "
        "40 mm, and up to three lip closures and blinks, at places fixed by the take's name. Lips "
        "count as closed where the take's own do.",
        edits_table(figures.outcomes),
        "Preserve mode at naturalness 1, by kind of edit:",
        kinds_table(figures.outcomes),
    ]
    return setting.write("held-out", "\n\n".join(parts))


def table1(setting: Setting) -> Path:
    """The paper's Table 1: mean squared errors of the three systems."""
    figures = setting.figures
    paper = {"regressor": (0.0028, 0.0064), "holden": (0.004, 0.009), "system": (0.0082, 0.0086)}
    rows = [
        [
            LABELS[system],
            cell(figures.regions[LOWER.id][system].mse),
            cell(figures.regions[EYELIDS.id][system].mse),
            *(f"{value:.4f}" for value in paper[system]),
        ]
        for system in ("regressor", "holden", "system")
        if system in figures.regions[LOWER.id]
    ]
    lower, lids = LOWER.label.lower(), EYELIDS.label.lower()
    titles = ["", lower, lids, f"the paper: {lower}", lids]
    text = f"""# Table 1: mean squared error

{_takes_text(figures)} The paper's numbers are on its own data and other channels; compare only
the proportions.

{markdown_table(titles, rows)}"""
    return setting.write("table1", text)


def robustness(setting: Setting) -> Path:
    """The paper's robustness figure: believable and unbelievable mouth openings in."""
    make_folder(setting.output)
    systems = Systems.load(setting.models, setting.rig)
    return setting.write("robustness", robustness_part(setting.unseen, systems, setting))


def oversmoothing(setting: Setting) -> Path:
    """The paper's curve figure: the baseline smooths, we do not."""
    figures = setting.figures
    make_folder(setting.output)
    rows = [
        [
            region,
            LABELS[system],
            cell(score.hf_kept, 2),
            cell(score.jerk_ratio, 2),
        ]
        for region, scores in figures.regions.items()
        for system, score in scores.items()
    ]
    text = "\n\n".join(
        [
            "# Over-smoothing",
            "Mouth opening of held-out takes: as tracked (dashed), and as each system gives it "
            "back from the controls.",
            *curve_charts(figures, setting.output),
            "Energy above 4 Hz, and jerk, by that of the takes:",
            markdown_table(["region", "system", "energy above 4 Hz kept", "jerk ratio"], rows),
        ]
    )
    return setting.write("oversmoothing", text)


def statistics(setting: Setting) -> Path:
    """Synthesised and real takes compared: figures and spectrum."""
    takes = by_source([*setting.data, *setting.held_out])
    figures = {name: measure(some) for name, some in takes.items()}
    lines = [
        Line(name, *(values.tolist() for values in spectrum(some))) for name, some in takes.items()
    ]
    make_folder(setting.output)
    text = chart("Spectrum of the mouth", "Hz", "share of the variance per Hz", lines, log_y=True)
    write_atomically(setting.output / "spectrum.svg", text.encode())
    return setting.write(
        "statistics",
        f"""# Synthesised and recorded performances

Measured at 25 frames a second, by source. A dash means that the source does not capture it, or
never does it. `synthetic` is what `faceedit synthesize` writes; no person was recorded for it.

```
{table(figures).rstrip()}
```

![Spectrum of the mouth](spectrum.svg)""",
    )


def people(setting: Setting) -> Path:
    """What users get on takes of people, against the goals and the references."""
    return setting.write("people", f"# What users get, on people\n\n{people_part(setting.people)}")


def faces(setting: Setting) -> Path:
    """Pictures before and after gestures on the demo take."""
    engine = load_engine(setting.rig, setting.models)
    return setting.write("faces", faces_part(setting.output, setting.rig, engine))


def untouched(setting: Setting) -> Path:
    """How far edits on takes of people move curves that they do not name."""
    sources, _ = sources_of(setting.unseen, trained_sources(setting.models))
    engine = load_engine(setting.rig, setting.models)
    bar = setting.progress.add_task("Edits of single curves", total=None)
    found = measure_untouched(
        sources,
        setting.rig,
        engine,
        lambda done, of: setting.progress.update(bar, completed=done, total=of),
    )
    setting.progress.update(bar, visible=False)
    return setting.write("untouched", untouched_part(found))


def card(setting: Setting) -> Path:
    """Write the figures on people into the model card, reached or not."""
    path = setting.models / CARD
    parts = [goals_part(setting.people)]
    if setting.held_out:
        parts += ["### The networks on their own", networks_goals_part(setting.figures)]
    text = with_figures(path.read_text(encoding="utf-8"), "\n\n".join(parts))
    write_atomically(path, text.encode())
    return path


EXPERIMENTS: dict[str, Experiment] = {
    "people": people,
    "faces": faces,
    "untouched": untouched,
    "statistics": statistics,
    "held-out": held_out,
    "card": card,
    "table1": table1,
    "oversmoothing": oversmoothing,
    "robustness": robustness,
    "leave-one-out": leave_one_out,
    "table2": table2,
    "recipes": recipes,
}


def run_experiments(names: Sequence[str], setting: Setting) -> Iterator[Path]:
    """Run some experiments, or all; yields each part of the report as it is written.

    What several of them need is measured once.

    Raises:
        FaceEditError: there is no such experiment, or it lacks takes.
    """
    for name in names:
        if name not in EXPERIMENTS and name != "all":
            raise FaceEditError(
                f"no experiment {name!r}; there are {', '.join(EXPERIMENTS)} and all"
            )
    for name in EXPERIMENTS if "all" in names else dict.fromkeys(names):
        yield EXPERIMENTS[name](setting)
        yield _index(setting)


def _index(setting: Setting) -> Path:
    """The report's first page: its parts, by their titles."""
    make_folder(setting.output)
    parts = [setting.output / f"{name}.md" for name in EXPERIMENTS]
    links = [
        f"- [{path.read_text(encoding='utf-8').splitlines()[0].lstrip('# ')}]({path.name})"
        for path in parts
        if path.exists()
    ]
    text = "\n".join(
        [
            "# Evaluation",
            "",
            "Written by `faceedit experiment`; each part can be written again on its own.",
            "",
            *links,
        ]
    )
    path = setting.output / "README.md"
    write_atomically(path, f"{text}\n".encode())
    return path


def _takes_text(figures: Figures) -> str:
    seconds: dict[str, float] = {}
    for _, source, length in figures.takes:
        seconds[source] = seconds.get(source, 0.0) + length
    parts = [f"`{name}` ({length:.0f} s)" for name, length in seconds.items()]
    return f"Held out, never trained on: {', '.join(parts)}."
