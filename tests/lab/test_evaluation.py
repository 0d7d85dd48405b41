"""Evaluate, experiment and train by the command line, on tiny data and networks."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from support.faces import random_engine, shipped_rig
from support.networks import write_models
from support.performances import RIG, folder_of_takes, performance, smallest
from support.sessions import session_by_networks, shipped_engine

from faceedit_app.cli import main
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.evaluation import evaluate
from faceedit_app.lab.evaluation.benchmark import run_benchmark, trials
from faceedit_app.lab.evaluation.evaluate import (
    CLOSING,
    Figures,
    evaluate_networks,
    measure_systems,
)
from faceedit_app.lab.evaluation.faces import FACES, faces_part
from faceedit_app.lab.evaluation.goals import goals, networks_goals_part
from faceedit_app.lab.evaluation.people import telling_apart
from faceedit_app.lab.evaluation.systems import Systems
from faceedit_app.lab.training import settings as recipes
from faceedit_app.lab.training.card import (
    FIGURES_END,
    FIGURES_START,
    trained_sources,
    with_figures,
)
from faceedit_app.lab.training.charts import Line, chart
from faceedit_app.lab.training.completion import is_completed
from faceedit_app.lab.training.fit import fit_region
from faceedit_app.render.camera import Camera, default_camera


@pytest.fixture(scope="module", autouse=True)
def few_rounds() -> Iterator[None]:
    """Telling apart goes through the takes twice, not eight times: its figures are not judged."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(telling_apart, "ROUNDS", 2)
        yield


@pytest.fixture(scope="module")
def takes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folder_of_takes(tmp_path_factory.mktemp("data") / "someone", seconds=9.0)


@pytest.fixture(scope="module")
def models(takes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("models")
    with pytest.MonkeyPatch.context() as patch:
        small = {name: smallest(name) for name in recipes.RECIPES}
        patch.setattr("faceedit_app.lab.training.run.RECIPES", small)
        assert main(["train", "--data", str(takes), "-o", str(folder), "--epochs", "1"]) == 0
    return folder


@dataclass(frozen=True)
class Evaluated:
    """What `faceedit evaluate` measured and printed, and the folder with its files."""

    figures: Figures
    printed: str
    folder: Path


@pytest.fixture(scope="module")
def evaluated(takes: Path, models: Path, tmp_path_factory: pytest.TempPathFactory) -> Evaluated:
    folder, found = tmp_path_factory.mktemp("evaluated"), []

    def kept(*given: Any) -> Figures:
        found.append(evaluate_networks(*given))
        return found[-1]

    with pytest.MonkeyPatch.context() as patch, redirect_stdout(StringIO()) as printed:
        patch.setattr(evaluate, "evaluate_networks", kept)
        given = ["evaluate", str(takes), "--models", str(models), "--json", str(folder / "e.json")]
        assert main([*given, "--report", str(folder / "report")]) == 0
    return Evaluated(found[0], printed.getvalue(), folder)


def test_training_writes_models_card_losses_and_no_checkpoint(models: Path) -> None:
    names = {p.relative_to(models).as_posix() for p in models.rglob("*") if p.is_file()}
    regions = [region.id for region in REGIONS]
    assert names == {
        *(f"{r}.onnx" for r in regions),
        *(f"holden/{r}.onnx" for r in regions),
        *(f"completion/{region.id}.onnx" for region in REGIONS if is_completed(region)),
        "README.md",
        "losses.svg",
    }
    card = (models / "README.md").read_text()
    assert "`someone`" in card
    assert FIGURES_START in card
    assert trained_sources(models) == {"someone"}
    ElementTree.fromstring((models / "losses.svg").read_text())


def test_evaluate_writes_the_json_of_the_promise(evaluated: Evaluated) -> None:
    assert "regressor" in evaluated.printed
    found = json.loads((evaluated.folder / "e.json").read_text())
    report = evaluated.folder / "report"
    assert set(found) == {
        "regions", "closures", "edits", "takes", "people", "restoration", "real_or_edited",
        "smile", "asymmetry", "smooth_roughness", "wild", "blinks", "inpainting",
    }  # fmt: skip
    assert set(found["regions"]) == {"lower", "upper", "eyelids"}
    for scores in found["regions"].values():
        assert set(scores) == {"regressor", "system", "holden"}
        for score in scores.values():
            assert set(score) == {"mse", "vertex_mm", "hf_kept", "jerk_ratio"}
            assert all(isinstance(v, float) for v in score.values())
    ours = {"met", "frown", "mouth_close", "events_tpr_at_fpr_05"}
    assert set(found["closures"]) == {*CLOSING, *ours}
    for closing in (found["closures"][what] for what in CLOSING):
        count = len(closing["threshold_mm"])
        for system in ("regressor", "system", "holden"):
            assert len(closing[system]["tpr"]) == len(closing[system]["fpr"]) == count
    assert set(found["edits"]) == {"preserve", "resynthesize"}
    for figures in found["edits"].values():
        assert set(figures) == {
            "reached_mm_p95", "changed_outside", "boundary_jump", "clipped_share",
        }  # fmt: skip
    assert found["edits"]["preserve"]["changed_outside"] == 0.0
    assert [t["name"] for t in found["takes"]] == ["take_0.csv", "take_1.csv"]
    text = (report / "evaluation.md").read_text()
    pictures = list(report.glob("*.svg"))
    assert pictures
    for picture in pictures:
        assert picture.name in text
        ElementTree.fromstring(picture.read_text())


def test_models_without_the_baseline_are_measured_without_it(takes: Path, tmp_path: Path) -> None:
    write_models(tmp_path, shipped_rig())
    file = tmp_path / "e.json"
    one = str(takes / "take_0.csv")
    assert main(["evaluate", one, "--models", str(tmp_path), "--json", str(file)]) == 0
    found = json.loads(file.read_text())
    assert found["regions"]["lower"]["holden"]["mse"] is None
    assert set(found["closures"]["mouth"]["holden"]["tpr"]) == {None}


@pytest.mark.parametrize(
    "given",
    [
        ["train"],
        ["train", "--data", "nowhere"],
        ["train", "--data", "TAKES", "--recipe", "soup"],
        ["train", "--data", "TAKES", "--models", "x"],
        ["train", "--data", "TAKES", "--finetune", "--models", "nowhere"],
        ["train", "--data", "TAKES", "--epochs", "0"],
        ["train", "--data", "TAKES", "--seed", "-1"],
        ["train", "--data", "TAKES", "--exclude", "*"],
        ["evaluate"],
        ["evaluate", "nowhere"],
        ["evaluate", "TAKES", "--models", "nowhere"],
        ["evaluate", "SHORT"],
        ["evaluate", "DEMO"],
        ["experiment", "held-out", "--held-out", "DEMO"],
        ["experiment", "faces", "soup"],
        ["experiment", "soup"],
        ["experiment", "table2"],
        ["experiment", "table1"],
        ["statistics", "nowhere"],
    ],
)
def test_wrong_usage_is_one_line_and_code_2(
    given: list[str], takes: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    folder_of_takes(tmp_path / "short", count=1, seconds=0.5)
    names = {
        "TAKES": str(takes),
        "SHORT": str(tmp_path / "short"),
        "DEMO": str(shipped("assets/demo_take.csv")),
    }
    assert main([names.get(word, word) for word in given]) == 2
    said = capfd.readouterr().err.strip().splitlines()
    assert len([line for line in said if line.startswith("faceedit: ")]) == 1, said
    assert "Traceback" not in "\n".join(said)


def test_ctrl_c_keeps_what_there_is_and_says_so(
    takes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    small = {name: smallest(name, epochs_regressor=9) for name in recipes.RECIPES}
    monkeypatch.setattr("faceedit_app.lab.training.run.RECIPES", small)
    from faceedit_app.lab.training import loop

    calls = []
    real = loop._epoch

    def epoch(*given: object) -> float:
        calls.append(given)
        if len(calls) == 6:
            raise KeyboardInterrupt
        return real(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(loop, "_epoch", epoch)
    out = tmp_path / "m"
    given = ["train", "--data", str(takes), "-o", str(out), "--no-baseline"]
    assert main(given) == 130
    assert "Stopped" in capsys.readouterr().out
    assert (out / "lower.onnx").exists()
    assert (out / "checkpoint" / "lower.regressor.safetensors").exists()
    monkeypatch.setattr(loop, "_epoch", real)
    assert main(given) == 0
    assert not (out / "checkpoint").exists()


def test_finetuning_starts_from_models(
    takes: Path, models: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = ["train", "--data", str(takes), "-o", str(tmp_path / "m"), "--finetune"]
    assert main([*given, "--models", str(models), "--epochs", "1", "--no-baseline"]) == 0
    assert (tmp_path / "m" / "lower.onnx").exists()
    assert not (tmp_path / "m" / "holden").exists()


def test_statistics_tell_sources_apart(takes: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["statistics", str(takes)]) == 0
    assert "someone" in capsys.readouterr().out


def test_systems_that_give_the_truth_back_have_no_error() -> None:
    """A stand-in that knows the take: every metric must say that it is right."""
    take = performance(8.0)
    small = smallest()
    fitted = [fit_region(r, [performance(25.0)], RIG, small).model for r in REGIONS]
    systems = Systems.of(*fitted)
    from faceedit_app.core.arkit import ARKIT_INDEX

    def truth(system: str, region: str, curves: np.ndarray) -> np.ndarray:
        channels = next(r for r in REGIONS if r.id == region).channels
        return take.weights[:, [ARKIT_INDEX[c] for c in channels]].astype(np.float64)

    object.__setattr__(systems, "answer", truth)
    figures = measure_systems([take], systems, shipped_rig())
    for scores in figures.regions.values():
        assert scores["system"].mse == pytest.approx(0.0, abs=1e-12)
        assert scores["system"].vertex_mm == pytest.approx(0.0, abs=1e-4)
        assert scores["system"].hf_kept == pytest.approx(1.0)
        assert scores["system"].jerk_ratio == pytest.approx(1.0)
    for found in figures.closures.values():
        for tpr, fpr in zip(found["system"].tpr, found["system"].fpr, strict=True):
            assert (math.isnan(tpr) and math.isnan(fpr)) or (tpr == 1.0 and fpr == 0.0)


def test_benchmark_is_the_same_every_time_and_leaves_the_take_alone(takes: Path) -> None:
    take = open_take(takes / "take_0.csv")
    engine = random_engine()
    session = session_by_networks(take, engine)
    controls = session.tracked.astype(np.float64)
    assert trials(take, controls) == trials(take, controls)
    kinds = {trial.kind for trial in trials(take, controls)}
    assert {"spike", "smile", "conflict", "wild"} <= kinds
    other = replace(take, path=takes / "take_1.csv")
    assert trials(other, controls) != trials(take, controls)
    outcomes = run_benchmark([take], shipped_rig(), engine)
    assert len(outcomes) == 6 * len(trials(take, controls))
    assert {(o.mode, o.naturalness) for o in outcomes} == {
        (mode, n) for mode in ("preserve", "resynthesize") for n in (0.0, 0.5, 1.0)
    }
    assert all(o.changed_outside == 0.0 for o in outcomes if o.mode == "preserve")
    assert (
        trials(replace(take, clip=replace(take.clip, times=take.clip.times / 20)), controls) == []
    )


def test_goals_tell_reached_from_missed(evaluated: Evaluated) -> None:
    found = goals(evaluated.figures)
    assert len(found) > 15
    text = networks_goals_part(evaluated.figures)
    assert text.count("| yes |") == sum(goal.reached for goal in found)
    assert text.count("**no**") == sum(not goal.reached for goal in found)


def test_the_card_measures_each_source_by_networks_that_never_saw_it(
    takes: Path,
    models: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    small = {name: smallest(name) for name in recipes.RECIPES}
    monkeypatch.setattr("faceedit_app.lab.evaluation.setting.RECIPES", small)
    mine = tmp_path / "models"
    shutil.copytree(models, mine)
    other = folder_of_takes(tmp_path / "other", seconds=6.0)
    held_out = folder_of_takes(tmp_path / "another", count=1, seconds=6.0)
    (held_out / "take_0.csv").rename(held_out / "held_out.csv")
    for number, take in enumerate(sorted(other.iterdir())):
        take.rename(other / f"other_{number}.csv")
    given = ["experiment", "people", "card", "-o", str(tmp_path / "report"), "--epochs", "1"]
    given += ["--models", str(mine), "--data", str(takes), "--data", str(other)]
    assert main([*given, "--held-out", str(held_out)]) == 0
    assert "trained: Without someone" in capsys.readouterr().err
    people, card = (tmp_path / "report" / "people.md").read_text(), (mine / "README.md").read_text()
    for text in (people, card):
        assert "| `someone` | iPhone | 2 | 15 | no |" in text
        assert "| `another` | iPhone | 1 | 5 | no |" in text
        assert "`someone`: answered by networks that were trained here" in text
        assert "1 pass over" in text
        assert "closure met within 0.5 mm" in text
    assert "The networks on their own" in card


def test_before_and_after_are_drawn_for_every_gesture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn, cameras = [], []

    def picture(
        rig: Rig, weights: np.ndarray, width: int, height: int, camera: Camera
    ) -> np.ndarray:
        drawn.append(weights)
        cameras.append(camera)
        return np.full((height, width, 3), 7, np.uint8)

    monkeypatch.setattr("faceedit_app.lab.evaluation.faces.snapshot", picture)
    text = faces_part(tmp_path, shipped_rig(), shipped_engine())
    files = {f"faces/{path.name}" for path in (tmp_path / "faces").iterdir()}
    assert len(files) == len(FACES) == 9
    assert all(f"]({name})" in text for name in files)
    for before, after in zip(drawn[::2], drawn[1::2], strict=True):
        assert (before != after).any()
    blink = [list(shipped_rig().channels).index(f"eyeBlink{side}") for side in ("Left", "Right")]
    wink = [face.name for face in FACES].index("wink")
    change = (drawn[2 * wink + 1] - drawn[2 * wink])[blink]
    assert change[0] > 0.1 > change[1]
    portrait = default_camera(shipped_rig())
    near = {
        face.name for face, camera in zip(FACES, cameras[::2], strict=True) if camera != portrait
    }
    assert near == {"wink", "half-closed eyes"}, "eyes are too small in a portrait"


def test_figures_in_a_card_are_replaced_and_nothing_else() -> None:
    card = f"before\n{FIGURES_START}\nold\n{FIGURES_END}\nafter\n"
    changed = with_figures(card, "new")
    assert changed == f"before\n{FIGURES_START}\nnew\n{FIGURES_END}\nafter\n"
    assert with_figures(changed, "new") == changed
    assert with_figures("a card of another hand", "new") == "a card of another hand"


@pytest.mark.parametrize(
    "ys", [[], [1.0], [2.0, 2.0], [0.0, math.nan, 5.0], [-3.0, 1e6, 0.2], [1e-9, 2e-9]]
)
@pytest.mark.parametrize("log", [False, True])
def test_chart_of_any_numbers_is_an_image(ys: list[float], log: bool) -> None:
    line = Line("a <b> & c", range(len(ys)), ys)
    text = chart("t & u", "x", "y", [line], log_y=log)
    root = ElementTree.fromstring(text)
    assert root.tag.endswith("svg")
    assert "nan" not in text
    assert text == chart("t & u", "x", "y", [line], log_y=log)
