"""Figures on people: each on a small take whose right answer is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import random_engine, shipped_rig
from support.people import source_with, take_with, talking
from support.performances import RIG, folder_of_takes, performance
from support.sessions import demo_take, session_by_rig, take_of
from support.takes import make_livelink_csv, make_plain_csv

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING
from faceedit_app.core.regions import LOWER
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.lab.evaluation.people import telling_apart
from faceedit_app.lab.evaluation.people.figures import PeopleFigures, measure_people
from faceedit_app.lab.evaluation.people.opened import FACEEDIT, SPLICE
from faceedit_app.lab.evaluation.people.places import inside, pick, runs
from faceedit_app.lab.evaluation.people.references import References, Ridge, columns_of
from faceedit_app.lab.evaluation.people.report import AIMS, goals_table, people_part
from faceedit_app.lab.evaluation.people.sources import (
    Tracker,
    is_synthesised,
    sources_of,
    with_weights,
)
from faceedit_app.lab.evaluation.people.tally import Tally
from faceedit_app.lab.evaluation.systems import Systems
from faceedit_app.lab.training.data import load_performances
from faceedit_app.lab.training.synthesis import write_livelink

OPENING = CONTROL_INDEX[LIP_OPENING]
NAN = float("nan")


@pytest.fixture(scope="module")
def learned() -> References:
    return References([performance(20.0, seed=5)], RIG)


@pytest.fixture(scope="module")
def systems() -> Systems:
    return Systems(random_engine())


# --- which takes count -----------------------------------------------------------------------


def test_takes_of_our_synthesiser_are_recognised_by_content(tmp_path: Path) -> None:
    assert is_synthesised(demo_take())
    person = make_livelink_csv(tmp_path / "person.csv")
    ours = tmp_path / "renamed.csv"
    write_livelink(ours, performance(3.0).weights)
    performances = load_performances([person, ours])
    people, synthesised = sources_of(performances)
    assert [take.path for source in people for take in source.takes] == [person]
    assert [take.name for take in synthesised] == ["renamed.csv"]


def test_an_edited_take_of_the_synthesiser_is_still_no_person(tmp_path: Path) -> None:
    session = session_by_rig(demo_take())
    session.add(Edit((LIP_OPENING,), Op.OFFSET, 0.0, 3.0, 0.0, 2.0))
    session.export(tmp_path / "edited.csv")
    (performance_of_edited,) = load_performances([tmp_path / "edited.csv"])
    assert sources_of([performance_of_edited])[0] == []


@pytest.mark.parametrize(
    "path", ["speaker_03_take_01.csv", "synthetic/anything.csv", "synthetic__anything.csv"]
)
def test_takes_of_our_synthesiser_are_recognised_by_name(path: str, tmp_path: Path) -> None:
    (tmp_path / "synthetic").mkdir()
    file = make_plain_csv(tmp_path / path)
    (found,) = load_performances([file])
    assert sources_of([found])[1] == [found]


def test_trackers_are_recognised_by_format_and_by_what_never_moves(tmp_path: Path) -> None:
    def saved(name: str, *moving: str) -> Path:
        file = make_plain_csv(tmp_path / f"{name}__take.csv", seconds=3.0)
        if moving:
            head, *rows = file.read_text().splitlines()
            columns = [1 + ARKIT_INDEX[channel] for channel in moving]
            for i, row in enumerate(rows):
                cells = row.split(",")
                for column in columns:
                    cells[column] = f"{0.1 + 0.05 * (i % 7):.3f}"
                rows[i] = ",".join(cells)
            file.write_text("\n".join([head, *rows]))
        return file

    files = [saved("phone", "cheekSquintLeft", "noseSneerRight"), saved("webcam")]
    files.append(make_livelink_csv(tmp_path / "app__take.csv", seconds=3.0))
    phone = files[0].read_bytes()
    files.append(tmp_path / "film__scene_tracked.csv")
    files[-1].write_bytes(phone)
    solved = saved("solved")
    found = load_performances([*files, solved])
    lids = [ARKIT_INDEX[c] for c in ("eyeBlinkLeft", "eyeBlinkRight")]
    found[-1].captured[lids] = False
    people, _ = sources_of(found, trained_on={"webcam"})
    trackers = {source.name: source.tracker for source in people}
    assert trackers == {
        "phone": Tracker.IPHONE,
        "webcam": Tracker.FILM,
        "app": Tracker.FILM,  # an app that writes the layout of Live Link Face
        "film": Tracker.FILM,
        "solved": Tracker.OTHER,
    }
    assert [source.name for source in people if source.trained_on] == ["webcam"]


# --- references ------------------------------------------------------------------------------


def test_ridge_finds_a_quadratic_and_learns_only_from_what_was_captured() -> None:
    random = np.random.default_rng(0)
    curves = random.normal(20.0, 4.0, (4000, 2))
    truth = np.stack([0.01 * curves[:, 0] + 0.001 * curves[:, 0] * curves[:, 1]] * 2, axis=1)
    seen = np.ones(truth.shape, bool)
    seen[2000:, 1] = False
    wrong = truth.copy()
    wrong[2000:, 1] = -99.0
    found = Ridge.fit(curves, wrong, seen)(np.array([[20.0, 20.0], [22.0, 18.0]]))
    np.testing.assert_allclose(found, [[0.6, 0.6], [0.616, 0.616]], atol=0.01)


@pytest.mark.parametrize("name", ["ridge", "covariance", "bump"])
def test_references_change_the_asked_for_frames_and_region_only(
    name: str, learned: References
) -> None:
    weights = performance(4.0).weights
    before = RIG.arkit_distances.measure(weights)
    asked = before.copy()
    asked[30:40, OPENING] += 3.0
    after = learned.answer(name, weights, before, asked)
    changed = after != weights
    assert set(np.flatnonzero(changed.any(axis=1))) == set(range(30, 40))
    assert set(np.flatnonzero(changed.any(axis=0))) <= set(columns_of(LOWER))
    moved = RIG.arkit_distances.measure(after)[30:40, OPENING]
    assert (moved > before[30:40, OPENING]).mean() > 0.6


def test_covariance_reaches_what_was_asked_and_a_bump_moves_one_channel_a_side(
    learned: References,
) -> None:
    weights = np.full((20, 52), 0.3, np.float32)
    before = RIG.arkit_distances.measure(weights)
    asked = before.copy()
    asked[:, OPENING] += 1.0
    after = learned.answer("covariance", weights, before, asked)
    reached = RIG.arkit_distances.measure(after)[:, OPENING]
    np.testing.assert_allclose(reached, asked[:, OPENING], atol=0.1)
    bumped = learned.answer("bump", weights, before, asked) != weights
    assert [ARKIT_CHANNELS[i] for i in np.flatnonzero(bumped.any(axis=0))] == ["jawOpen"]
    closing = before.copy()
    closing[:, [CONTROL_INDEX[lid] for lid in LIDS]] -= 2.0
    bumped = learned.answer("bump", weights, before, closing, LIDS) != weights
    moved = {ARKIT_CHANNELS[i] for i in np.flatnonzero(bumped.any(axis=0))}
    assert moved == {"eyeBlinkLeft", "eyeBlinkRight"}


# --- from values to a report -----------------------------------------------------------------


def figures_of(values: dict[str, float], figure: str, system: str = FACEEDIT) -> PeopleFigures:
    tally = Tally()
    trackers = {"phone": Tracker.IPHONE, "film": Tracker.FILM, "solve": Tracker.OTHER}
    for source, value in values.items():
        tally.add(figure, system, source, value)
    sources = [
        replace(source_with(take_with(talking(60)), name=name), tracker=tracker)
        for name, tracker in trackers.items()
    ]
    return PeopleFigures(tally, sources)


def test_a_source_counts_once_however_many_values_it_has() -> None:
    figures = figures_of({"phone": 1.0, "film": 2.0, "solve": 9.0}, "asymmetry")
    figures.tally.add("asymmetry", FACEEDIT, "phone", [3.0, NAN, 5.0])
    assert figures.value("asymmetry", FACEEDIT) == 3.0  # of 3, 2 and 9
    assert figures.value("asymmetry", FACEEDIT, Tracker.FILM) == 2.0
    assert np.isnan(figures.value("asymmetry", "ridge"))
    figures.tally.add("smooth_roughness", FACEEDIT, "phone", [0.1, 0.4, 0.2])
    assert figures.value("smooth_roughness", FACEEDIT) == 0.4  # the worst place counts


def test_json_nests_figures_and_has_null_for_what_is_unknown() -> None:
    figures = figures_of({"phone": 0.5, "film": NAN}, "closures.met")
    found = figures.as_json()
    assert found["closures"]["met"] == {FACEEDIT: 0.5}
    trackers = found["people"]["by_tracker"]
    assert trackers["iphone"]["closures"]["met"] == {FACEEDIT: 0.5}
    assert trackers["film"]["closures"]["met"] == {FACEEDIT: None}


def test_goals_say_what_is_reached_and_what_is_not() -> None:
    figures = figures_of({"phone": 0.96, "film": 0.9}, "closures.met")
    (row,) = [line for line in goals_table(figures).splitlines() if "closure met" in line]
    assert [cell.strip() for cell in row.split("|")[2:-1]] == [
        "96 %", "≥ 95 %", "yes", "90 %", "≥ 95 %", "**no**",
    ]  # fmt: skip
    figures = figures_of({"phone": 0.6}, telling_apart.FIGURE)
    figures.tally.add(telling_apart.FIGURE, SPLICE, "phone", 0.55)
    (aim,) = [aim for aim in AIMS if aim.figure == telling_apart.FIGURE]
    assert aim.limit(figures, Tracker.IPHONE) == pytest.approx(0.57)
    assert not aim.reached(figures, Tracker.IPHONE)
    figures.tally.add(telling_apart.FIGURE, SPLICE, "phone", 0.65)
    assert aim.reached(figures, Tracker.IPHONE)


def test_opening_only_has_to_be_below_ridge_and_covariance_too() -> None:
    figures = figures_of({"film": 0.004}, "restoration.opening")
    figures.tally.add("restoration.opening", "ridge", "film", 0.003)
    figures.tally.add("restoration.opening", "covariance", "film", 0.008)
    (aim,) = [aim for aim in AIMS if aim.figure == "restoration.opening"]
    assert aim.limit(figures, Tracker.FILM) == 0.003
    assert not aim.reached(figures, Tracker.FILM)


def test_people_are_measured_the_same_every_time_and_the_references_edit_too(
    tmp_path: Path, systems: Systems
) -> None:
    folder = folder_of_takes(tmp_path / "someone", count=1, seconds=8.0)
    write_livelink(folder / "made_by_us.csv", performance(3.0).weights)
    lost = range(80, 200)
    make_livelink_csv(folder / "with_a_gap.csv", seconds=10.0, rate=30, dropped=lost)
    takes = load_performances([folder])
    first, second = (measure_people(takes, shipped_rig(), lambda _: systems) for _ in range(2))
    found = first.as_json()
    assert found == second.as_json()
    assert found["people"]["synthesised_left_out"] == 1
    assert {"faceedit", "paper", "ridge", "covariance", "bump"} <= set(found["restoration"]["six"])
    filled = found["inpainting"]["restoration"]
    assert {"faceedit", "linear", "hold", "nearest", "splice"} == set(filled)
    assert filled["nearest"] <= filled["splice"]
    assert set(found["inpainting"]["boundary_jump"]) == {*filled, "real"}
    assert "holden" not in found["restoration"]["six"]  # these models have no baseline
    text = people_part(first)
    assert "1 synthesised take was left out" in text
    assert "only one source" in text


# --- places ----------------------------------------------------------------------------------


def test_places_are_apart_and_where_they_may_be() -> None:
    times: Doubles = np.arange(500) / 25.0
    where: Bools = (times > 3.0) & (times < 17.0)
    chosen = pick(np.random.default_rng(0), times, where, 2.0, 5)
    assert 4 <= len(chosen) <= 5
    assert chosen == sorted(chosen)
    assert min(np.diff(chosen)) >= 2.0
    assert 3.0 < chosen[0] < chosen[-1] < 17.0
    lost = times[(times < 9.0) | (times > 11.0)]
    assert not inside(lost, 0.5)[(lost > 8.5) & (lost < 11.5)].any()
    assert inside(lost, 0.5).sum() == len(lost) - 4 * 13
    assert runs(np.array([True, True, False, True])) == [slice(0, 2), slice(3, 4)]
    assert runs(np.zeros(3, bool)) == []


def test_a_take_with_other_weights_keeps_its_channels() -> None:
    clip = Clip(np.zeros((3, 2), np.float32), ("mouthClose", "jawOpen"), np.arange(3) / 25.0, 25.0)
    weights = np.zeros((3, 52), np.float32)
    weights[:, ARKIT_INDEX["jawOpen"]] = 0.5
    weights[:, ARKIT_INDEX["eyeWideLeft"]] = 0.9
    changed = with_weights(take_of(clip), weights)
    np.testing.assert_array_equal(changed.clip.weights, [[0.0, 0.5]] * 3)
    np.testing.assert_array_equal(changed.clip.times, clip.times)
