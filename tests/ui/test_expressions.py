"""Expressions with pictures of the face: drawn for its character, applied by a click."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from support.character_files import write_glb
from support.faces import random_engine
from support.waiting import run_events
from support.windows import Bench, session_of

from faceedit_app.characters.fitted import fit
from faceedit_app.characters.registry import read_character
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.help.poses import has_pose, pose_of
from faceedit_app.editing.help.presets import shipped_presets
from faceedit_app.render import Aim
from faceedit_app.ui.page.expressions import PICTURE, Expressions, aim_of
from faceedit_app.ui.start.window import MainWindow

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    window = bench.editing()
    assert window.editor is not None
    window.editor.lists.setCurrentWidget(window.editor.expressions)
    return window


def palette_of(window: MainWindow) -> Expressions:
    assert window.editor is not None
    return window.editor.expressions


def test_each_expression_has_a_picture_of_the_face(bench: Bench, window: MainWindow) -> None:
    palette = palette_of(window)
    for width, height in ((1440, 876), (1280, 696)):  # 24 more with a title bar
        window.resize(width, height)
        run_events()
        seen, buttons = palette.viewport().height(), palette.buttons.values()
        assert all(button.geometry().bottom() < seen for button in buttons), "names"
        assert palette.verticalScrollBar().maximum() == 0
    assert set(palette.buttons) >= {"smile", "sad_mouth", "pucker", "widen", "blink"}
    assert "calm_down" not in palette.buttons, "it does nothing to a face at rest"
    bench.qtbot.waitUntil(lambda: palette.is_drawn)
    drawn = [size for size, _, _ in bench.renderers[0].calls if size == PICTURE]
    assert len(drawn) == len(palette.buttons)
    before = len(bench.renderers[0].calls)
    window.document.use_engine(random_engine())
    bench.qtbot.waitUntil(lambda: palette.is_drawn)
    assert len(bench.renderers[0].calls) >= before + len(palette.buttons), "the networks' faces"


def test_a_character_that_arrives_while_pictures_are_drawn_is_in_all_of_them(
    bench: Bench, window: MainWindow, tmp_path: Path
) -> None:
    palette = palette_of(window)
    bench.qtbot.waitUntil(lambda: palette_of(window).is_drawn)
    window.document.use_engine(random_engine())  # its pictures are waited for
    assert not palette.is_drawn
    window.document.use_character(fit(read_character(write_glb(tmp_path / "head.glb"))))
    bench.qtbot.waitUntil(lambda: palette.is_drawn)
    theirs = [size for size, _, _ in bench.renderers[-1].calls if size == PICTURE]
    assert len(theirs) == len(palette.buttons)


def test_the_viewport_keeps_its_size_and_picture(bench: Bench, window: MainWindow) -> None:
    bench.qtbot.waitUntil(lambda: palette_of(window).is_drawn)
    assert window.editor is not None
    viewport = window.editor.face.viewport
    viewport.redraw()
    bench.qtbot.waitUntil(lambda: bench.renderers[0].size == (viewport.width(), viewport.height()))


def test_a_click_applies_it_once_and_a_double_click_too(window: MainWindow) -> None:
    session, smile = session_of(window), palette_of(window).buttons["smile"]
    window.timeline.select((1.0, 2.0))
    QTest.mouseClick(smile, LEFT)
    QTest.mouseDClick(smile, LEFT)
    (edit,) = session.edits
    assert (edit.name, edit.start, edit.end) == ("Smile", 1.0, 2.0)
    assert window.status.currentMessage().endswith("; set its strength under Edits")


def test_the_tab_says_where_a_click_acts(window: MainWindow) -> None:
    palette, session, line = palette_of(window), session_of(window), window.timeline
    assert palette.where.isVisible()
    assert palette.where.geometry().bottom() < palette.viewport().geometry().top()
    line.go_to_time(1.5)
    assert palette.where.text().startswith("Smile and Sad mouth act on the whole take, the others")
    assert "at the playhead" in palette.where.text()
    for name in ("smile", "pucker"):
        palette.buttons[name].click()
    smile, pucker = session.edits
    assert (smile.start, smile.end) == (0.0, session.take.clip.times[-1])
    assert pucker.start < 1.5 < pucker.end < pucker.start + 1.0
    assert "whole take" in palette.where.text(), "not in the range of the new edit"
    window.actions_["deselect"].trigger()
    line.select((1.0, 2.0))
    assert palette.where.text() == "A click acts in the selection, 1.000 to 2.000 s"
    window.actions_["unit_frames"].trigger()
    assert palette.where.text() == "A click acts in the selection, frames 61 to 121"
    palette.buttons["widen"].click()
    assert (session.edits[-1].start, session.edits[-1].end) == (1.0, 2.0)
    line.leave_edit()
    line.select(None)
    assert palette.where.text().startswith("Smile and Sad mouth")


def test_a_picture_shows_the_part_of_the_face_that_moves() -> None:
    aims = {preset.id: aim_of(preset) for preset in shipped_presets() if has_pose(preset)}
    assert aims["sad_mouth"] is Aim.MOUTH
    assert aims["open_eyes"] is aims["anger"] is Aim.EYES
    assert aims["surprise"] is Aim.FRONT


def test_a_pose_is_what_the_preset_does_to_a_face_at_rest(window: MainWindow) -> None:
    session = session_of(window)
    presets = {preset.id: preset for preset in shipped_presets() if has_pose(preset)}
    rest = session.rig.controls(np.zeros((1, len(session.rig.channels)), np.float32))[0]

    def change(name: str, control: str) -> float:
        pose = pose_of(presets[name], session, None)[None]
        column = CONTROL_INDEX[control]
        return float(session.rig.controls(pose)[0, column] - rest[column])

    assert change("smile", "left_corner") > 0.5
    assert change("pucker", "mouth_width") < -1.0
    assert change("widen", "mouth_width") > 1.0
    assert change("blink", "left_eyelid") < -3.0
    assert session.edits == ()
