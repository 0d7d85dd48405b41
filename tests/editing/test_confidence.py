"""Frames in which the tracker hardly saw the face are problems that can be filled."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support.faces import shipped_rig
from support.takes import make_livelink_csv

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.clip import Clip, Gap
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.confidence import confidence_of
from faceedit_app.editing.help.problems import Kind, Problem, find_problems, problems_of
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.formats import audio2face, csv_take, livelink
from faceedit_app.formats.opening import open_take
from faceedit_app.tracking.film_landmarks import FilmLandmarks
from faceedit_app.tracking.landmark_file import beside, write_landmarks
from faceedit_app.tracking.person import Person
from faceedit_app.tracking.pose import Lens
from faceedit_app.tracking.tracker import Tracked


def tracked_take(folder: Path, confidence: Doubles, seconds: float = 3.0) -> EditSession:
    """A take, and beside it what the tracker kept of its film."""
    take = make_livelink_csv(folder / "take.csv", seconds=seconds)
    count = len(confidence)
    film = FilmLandmarks(
        folder / "take.mp4",
        np.arange(count) / 60.0,
        60.0,
        None,
        (64, 64),
        np.ones((count, 478, 3)),
        np.ones(count),
        np.zeros((count, 478, 3), np.uint8),
    )
    lens = Lens(np.zeros(2), 800.0)
    person = Person(np.zeros((1, 3)), np.zeros(1, np.intp), lens, 0.0, np.ones((2, 2)))
    nothing = np.zeros((count, 52)), np.zeros((count, 3))
    write_landmarks(Tracked(film, *nothing, confidence, person), take)
    return open_session(take, shipped_rig())


def unsure(session: EditSession) -> list[Problem]:
    return [problem for problem in find_problems(session) if problem.kind is Kind.UNSURE]


@pytest.fixture
def frames(tmp_path: Path) -> int:
    return len(open_session(make_livelink_csv(tmp_path / "take.csv", seconds=3.0)).take.clip)


def test_uncertain_frames_are_a_problem_with_a_fill(tmp_path: Path, frames: int) -> None:
    confidence = np.ones(frames)
    confidence[60:70] = 0.7
    confidence[64] = 0.6
    session = tracked_take(tmp_path, confidence)
    (problem,) = unsure(session)
    times = session.take.clip.times
    assert (problem.start, problem.end) == pytest.approx((times[60], times[69]), abs=1e-3)
    assert problem.time == times[64]
    assert "60 % sure" in problem.message
    (fill,) = problem.fix
    assert fill.op is Op.FILL
    session.add(fill)
    assert not unsure(session)
    session.undo()
    assert len(unsure(session)) == 1


def test_what_is_too_long_for_one_fix_says_what_can_be_done(tmp_path: Path, frames: int) -> None:
    confidence = np.ones(2 * frames)
    confidence[10:-10] = 0.6
    (problem,) = unsure(tracked_take(tmp_path, confidence, seconds=6.0))
    assert not problem.fix
    assert "Fill replaces up to 4 s of it at a time" in problem.why_unfixed


def test_gaps_keep_frames_and_confidence_together(tmp_path: Path, frames: int) -> None:
    """The take has no frame where the tracker lost the face."""
    confidence = np.insert(np.ones(frames), 30, np.full(7, 0.2))
    confidence[90] = 0.55
    session = tracked_take(tmp_path, confidence)
    kept = confidence_of(session.take)
    assert kept is not None
    assert np.flatnonzero(kept < 0.8).tolist() == [83]


def test_what_is_uncertain_beside_a_gap_belongs_to_the_gap() -> None:
    weights = np.zeros((40, 52), np.float32)
    times = np.arange(40) / 25.0
    times[20:] += 0.4
    clip = Clip(weights, ARKIT_CHANNELS, times, 25.0, gaps=(Gap(19, 10),))
    confidence = np.ones(40)
    confidence[[18, 19, 20, 35]] = 0.6
    rig = shipped_rig()
    curves = rig.arkit_distances.measure(weights)
    found = problems_of(clip, weights, curves, lost=[19.5], confidence=confidence)
    assert [problem.kind for problem in found] == [Kind.DROPPED, Kind.UNSURE]
    (fill,) = found[0].fix
    assert (times[17], times[20]) < (fill.start, fill.end) < (times[18], times[21])
    assert found[1].start == pytest.approx(times[35])
    assert found[1].fix


def test_a_take_of_another_rate_or_with_a_damaged_file_has_none(
    tmp_path: Path, frames: int
) -> None:
    session = tracked_take(tmp_path, np.full(frames + 5, 0.6))
    assert confidence_of(session.take) is None
    assert not unsure(session)
    beside(session.take.path).write_bytes(b"damaged")
    assert confidence_of(session.take) is None


def test_the_takes_own_column_needs_no_file_beside_it(tmp_path: Path) -> None:
    weights = np.zeros((40, 52), np.float32)
    sure = np.ones(40, np.float32)
    sure[10:15], sure[25:30] = 0.7, 0.0
    clip = Clip(weights, ARKIT_CHANNELS, np.arange(40) / 25.0, 25.0, confidence=sure)
    path = tmp_path / "take.csv"
    path.write_bytes(livelink.write(clip))
    session = open_session(path, shipped_rig())
    (problem,) = unsure(session)  # what is 0 has been filled
    assert problem.start == pytest.approx(10 / 25.0)
    assert problem.end == pytest.approx(14 / 25.0)


@pytest.mark.parametrize("write", [livelink.write, csv_take.write, audio2face.write])
def test_confidence_moves_with_a_retime(tmp_path: Path, write: Callable[[Clip], bytes]) -> None:
    times = np.arange(100) / 25.0
    sure = np.ones(100, np.float32)
    sure[50:55] = 0.6  # at 2.0 to 2.16 s
    clip = Clip(np.zeros((100, 52), np.float32), ARKIT_CHANNELS, times, 25.0, confidence=sure)
    path, out = tmp_path / "take", tmp_path / "out"
    path.write_bytes(write(clip))
    session = open_session(path, shipped_rig())
    later = Edit(CONTROL_IDS, Op.RETIME, 1.0, 3.6, 0.0, pins=((2.0, 2.4), (2.2, 2.6)))
    session.add(later)
    (problem,) = unsure(session)
    assert problem.start == pytest.approx(2.4, abs=0.05)
    session.export(out)
    found = open_take(out).clip.confidence
    assert found is not None
    assert found[60:65].max() < 0.7
    assert found[48:57].min() > 0.9
    before, after = (p.read_bytes().splitlines() for p in (path, out))
    changed = [k for k, pair in enumerate(zip(before, after, strict=True)) if pair[0] != pair[1]]
    first = changed[0] - 24 if write is audio2face.write else 0  # it is the last list there
    assert min(changed) - first >= 24
    assert max(changed) - first < 93
