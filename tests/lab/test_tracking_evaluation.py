"""Tracking is measured on films whose weights are known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.face_films import speaking
from support.faces import shipped_rig
from support.tracker import needs_tracker

from faceedit_app.command_line import laboratory
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIP_OPENING, MOUTH_WIDTH
from faceedit_app.core.errors import FaceEditError
from faceedit_app.formats import livelink
from faceedit_app.lab.evaluation.metrics import ShutCounts, shut_counts
from faceedit_app.lab.evaluation.rendered_films import Conditions, Truth, kept_open
from faceedit_app.lab.evaluation.tracking import (
    FULL,
    METHODS,
    TrackingFigures,
    as_json,
    evaluate_tracking,
    lag,
    table,
)


@pytest.mark.parametrize("late", [-1.5, 0.0, 0.7])
def test_the_lag_of_a_curve_is_found(late: float) -> None:
    at = np.arange(80.0)
    assert lag(np.sin((at - late) / 4.0), np.sin(at / 4.0)) == pytest.approx(late, abs=0.1)


def test_a_mouth_that_is_kept_open_moves_and_never_shuts() -> None:
    truth = Truth(speaking(40), np.arange(40) / 25.0)
    opening = CONTROL_INDEX[LIP_OPENING]
    before, after = (
        shipped_rig().arkit_distances.measure(one.weights)[:, opening]
        for one in (truth, kept_open(truth))
    )
    assert before.min() < 2.0
    assert after.min() > 4.0
    assert np.corrcoef(before, after)[0, 1] > 0.99


def test_films_without_a_closure_have_no_rates() -> None:
    zeros = (0.0,) * len(CONTROL_IDS)
    none = float("nan")
    nothing, some = (none, none, none), (1.0, 0.1, 0.0)
    shut = (nothing, some, nothing, some)
    one = TrackingFigures("A", "B", FULL, zeros, zeros, *shut, 0.0, 0.0, 0.0, none, some)
    cells = ["– / – (–)", "– / – (–)", "1.00 / 0.10 (0.00)", "1.00 / 0.10 (0.00)"]
    assert f"| {' | '.join(cells)} |" in table([one])
    assert table([one]).endswith("| – | 1.00 / 0.10 (0.00) |")
    (facts,) = as_json([one])
    assert facts["lips"] == facts["lip_events"] == [None, None, None]
    assert facts["lids"] == facts["near_lips"] == [1.0, 0.1, 0.0]
    assert facts["open_taken"] is None


def test_closures_are_counted_by_frames_and_by_events() -> None:
    """One is kept, one is lost, one is near, one is far, and one is only long."""
    truth = np.array([5, 1, 1, 5, 5, 1, 5, 5, 2.2, 5, 5, 5, 5, 1, 5, 5])
    found = np.array([5, 5, 1, 5, 5, 4, 5, 5, 1.8, 5, 5, 1, 5, 1, 1, 5])
    frames, events = shut_counts(found, truth, 2.0, 0.5)
    assert frames == ShutCounts(actual=4, kept=2, made_up=3, far=2)
    assert events == ShutCounts(actual=3, kept=2, made_up=2, far=1)
    assert (frames + frames).rates == frames.rates == (0.5, 0.75, 0.5)
    assert np.isnan(shut_counts(found, truth + 9.0, 2.0, 0.5)[1].rates).all()


def test_an_unknown_film_is_refused_with_the_known_ones() -> None:
    with pytest.raises(FaceEditError, match=r"--film planar: .*plain, turned by 20°"):
        laboratory.evaluate_tracking([], films=["planar"])


@needs_tracker
def test_our_fit_is_better_than_the_networks_weights(tmp_path: Path) -> None:
    clip = Clip(speaking(24), ARKIT_CHANNELS, np.arange(24) / 25.0, 25.0)
    (tmp_path / "take.csv").write_bytes(livelink.write(clip))
    figures = evaluate_tracking([tmp_path / "take.csv"], 0.96, [Conditions("small", size=320)])
    assert [one.method for one in figures] == list(METHODS)
    true, network, _, full = figures
    assert max(true.error) == true.open_taken == 0.0
    assert full.method == FULL
    assert np.mean(full.error[-2:]) < np.mean(network.error[-2:])
    assert abs(full.lag) < 0.5
    assert full.lost == 0.0
    assert table(figures).count("\n") == 5


@needs_tracker
def test_another_character_is_measured_on_its_own_face(tmp_path: Path) -> None:
    clip = Clip(speaking(20), ARKIT_CHANNELS, np.arange(20) / 25.0, 25.0)
    (tmp_path / "take.csv").write_bytes(livelink.write(clip))
    own = shipped_rig()
    wide = replace(own, name="Wide", neutral=own.neutral * np.array([1.06, 1.0, 1.0], np.float32))
    small = [Conditions("small", size=320, noise=0.0)]
    figures = evaluate_tracking([tmp_path / "take.csv"], 0.8, small, characters=[own, wide])
    assert [one.character for one in figures[:: len(METHODS)]] == [own.name, "Wide"]
    width = CONTROL_INDEX[MOUTH_WIDTH]
    ours, theirs = figures[3], figures[7]
    # The landmarks are scaled to FaceEdit's face: a wider mouth is the person's own.
    assert theirs.error[width] > ours.error[width]
    assert theirs.moved[width] < 1.0
