"""What of the curves is drawn: every frame of few, the peaks of many."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QApplication
from support.leaky import leaky_rig, speech
from support.rigs import tiny_session
from support.sessions import session_by_rig

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.lines import Stroke
from faceedit_app.ui.curves.visible_curves import Polyline, VisibleCurves, run_of, visible_rows

OPENING = CONTROL_INDEX["mouth_opening"]
COLUMNS = 600


def nudge(at: float, value: float = 3.0) -> Edit:
    return Edit(("mouth_opening",), Op.OFFSET, at, at, 0.1, value)


def test_few_frames_are_all_drawn_with_one_beyond_each_edge() -> None:
    session = tiny_session()
    assert visible_rows(session.take.clip.times, 2.0, 3.0) == slice(99, 152)
    curves = VisibleCurves(session)
    curves.look((2.0, 3.0), COLUMNS)
    face = curves.lines(OPENING).face
    assert np.array_equal(face.x, session.take.clip.times[99:152])
    assert np.array_equal(face.y, session.achieved[99:152, OPENING])
    assert face.joined is None
    assert not face.thinned


@pytest.mark.parametrize("frames", [4_000, 36_000])
def test_peaks_survive_thinning(frames: int) -> None:
    session = tiny_session(frames)
    session.add(nudge(30.0, 40.0), nudge(60.0, -40.0))
    curves = VisibleCurves(session)
    curves.look((0.0, session.take.clip.duration), COLUMNS)
    face = curves.lines(OPENING).face
    assert face.thinned
    assert len(face.x) <= 3 * COLUMNS
    assert face.y.max() == session.achieved[:, OPENING].max()
    assert face.y.min() == session.achieved[:, OPENING].min()
    assert (np.diff(face.x) >= 0).all()


def test_panning_does_not_make_peaks_flicker() -> None:
    session = tiny_session(36_000)
    curves = VisibleCurves(session)
    drawn = []
    for start in (100.0, 100.3):
        curves.look((start, start + 400.0), COLUMNS)
        line = curves.lines(OPENING).face
        drawn.append({*zip(line.x.tolist(), line.y.tolist(), strict=True)})
    assert len(drawn[0] & drawn[1]) >= len(drawn[0]) - 6


@pytest.mark.parametrize("view", [(0.0, 4.0), (0.0, 100.0), (0.0, 720.0)])
def test_a_change_is_drawn_as_if_all_were_read_again(view: tuple[float, float]) -> None:
    session = tiny_session(36_000)
    curves = VisibleCurves(session)
    curves.look(view, COLUMNS)
    for edit in (nudge(2.0), nudge(50.0, -2.0), nudge(700.0)):
        session.add(edit)
        curves.refresh()
    session.undo()
    curves.refresh()
    afresh = VisibleCurves(session)
    afresh.look(view, COLUMNS)
    for control in range(len(CONTROL_INDEX)):
        assert curves.extent(control) == afresh.extent(control)
        ours, theirs = curves.lines(control), afresh.lines(control)
        assert_alike(ours.tracked, theirs.tracked)
        assert_alike(ours.face, theirs.face)
        assert_alike(ours.asked, theirs.asked)


def test_only_what_differs_is_drawn_and_it_joins_its_neighbours() -> None:
    x, y = np.arange(20.0), np.zeros(20)
    shown = np.isin(x, [4, 5, 6, 7, 11, 12, 13])
    line = run_of(x, y, shown, False)
    assert line.x.tolist() == [4, 5, 6, 7, 11, 12, 13]
    assert line.joined is not None
    assert line.joined.tolist() == [True, True, True, False, True, True, False]
    assert run_of(x, y, np.ones(20, bool), False).joined is None
    assert len(run_of(x, y, np.zeros(20, bool), False).x) == 0


def test_a_short_difference_is_seen_in_a_long_take() -> None:
    session = tiny_session(36_000)
    curves = VisibleCurves(session)
    curves.look((0.0, 720.0), COLUMNS)
    assert len(curves.lines(OPENING).asked.x) == 0
    session.add(nudge(400.0))
    curves.refresh()
    asked = curves.lines(OPENING).asked
    assert 2 <= len(asked.x) < 20
    assert abs(asked.x - 400.0).min() < 2.0


def assert_alike(ours: Polyline, theirs: Polyline) -> None:
    np.testing.assert_array_equal(ours.x, theirs.x)
    np.testing.assert_array_equal(ours.y, theirs.y)
    np.testing.assert_array_equal(ours.joined, theirs.joined)
    assert ours.thinned is theirs.thinned


def test_a_line_that_is_drawn_as_before_stays_the_same() -> None:
    session = tiny_session()
    curves = VisibleCurves(session)
    curves.look((0.0, 4.0), COLUMNS)
    before = curves.lines(OPENING)
    curves.refresh()
    again = curves.lines(OPENING)
    assert again.face is before.face
    assert again.tracked is before.tracked
    assert again.asked is before.asked
    session.add(nudge(2.0))
    curves.refresh()
    first = curves.lines(OPENING)
    session.preview_replace(0, nudge(2.0, 2.98))
    curves.refresh()
    second = curves.lines(OPENING)
    assert second.face is not first.face
    assert second.asked is not first.asked
    assert second.tracked is first.tracked, "as tracked, where the face differs from it"
    curves.look((0.0, 3.0), COLUMNS)
    assert len(curves.lines(OPENING).face.x) < len(first.face.x)


def test_changes_that_are_long_past_are_all_of_the_take() -> None:
    session = tiny_session(1_000)
    live = session.live
    session.add(nudge(2.0))
    count, [rows] = live.changes(0)
    assert rows[0] <= 100 < rows[1]
    assert live.changes(count) == (count, [])
    for _ in range(600):
        session.undo()
        session.redo()
    assert live.changes(count)[1] == [(0, 1_000)]


def test_what_lies_between_two_changes_is_not_read_again() -> None:
    session = tiny_session(36_000)
    session.add(nudge(2.0), nudge(700.0), nudge(10.0))
    _, [early, late] = session.live.changes(0)
    assert early[0] <= 100 < early[1] < 2_000
    assert late[0] <= 35_000 < late[1]
    assert late[0] > 33_000


def test_the_character_s_line_shows_only_where_it_is_open_wider() -> None:
    clip = Clip(speech(), ARKIT_CHANNELS, np.arange(120) / 30.0, 30.0)
    session = session_by_rig(clip)
    curves = VisibleCurves(session)
    curves.look((0.0, clip.duration), 900)
    opening = CONTROL_INDEX[LIP_OPENING]
    assert len(curves.lines(opening).character.x) == 0
    session.use_character(leaky_rig())
    curves.refresh()
    line, face = curves.lines(opening).character, session.achieved[:, opening]
    assert face.max() < line.y.max() <= curves.extent(opening)[1], "the axis has room for it"
    assert len(line.x) > 0
    above = line.y - np.interp(line.x, clip.times, face)
    assert above.max() > 1.0
    assert np.median(above) > 0.5
    assert len(curves.lines(CONTROL_INDEX["mouth_width"]).character.x) == 0
    curves.look((0.0, clip.duration), 9)
    assert len(curves.lines(opening).character.x) == 0


@pytest.mark.parametrize("thinned", [False, True])
def test_a_line_is_as_wide_on_every_screen(qapp: QApplication, thinned: bool) -> None:
    stroke = Stroke(style.face_pen("#ffffff"))
    stroke.show_line(Polyline(np.array([0.0, 40.0]), np.full(2, 10.0), None, thinned))
    widths = []
    for ratio in (1, 2, 3):
        image = QImage(40 * ratio, 20 * ratio, QImage.Format.Format_RGB32)
        image.setDevicePixelRatio(ratio)
        image.fill(0)
        with QPainter(image) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            stroke.draw(painter, ratio)
        light = [image.pixelColor(20 * ratio, y).redF() for y in range(20 * ratio)]
        widths.append(sum(light) / ratio)
    assert max(widths) < 1.35 * min(widths), widths
