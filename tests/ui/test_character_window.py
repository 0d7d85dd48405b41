"""The user's character in the window: opened, checked, corrected, closed on, remembered."""

from __future__ import annotations

import json
import threading
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox
from support.character_files import write_glb, write_objs
from support.waiting import run_events, wait_for_background
from support.windows import Bench, add_edit, drop, editor_of, session_of, trigger

from faceedit_app.characters.fitted import FittedCharacter, fit
from faceedit_app.characters.map_file import map_path
from faceedit_app.characters.registry import read_character
from faceedit_app.characters.scenes import SCENES, scene_content
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.ui.character.checklist import CharacterChecklist
from faceedit_app.ui.character.points_overlay import PointsOverlay
from faceedit_app.ui.character.shape_table import LIMIT, MULTIPLIER, NO_SHAPE, SHAPE
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start import window as start_window
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state import loading


@pytest.fixture
def head(tmp_path: Path) -> Path:
    return write_glb(tmp_path / "head.glb")


def open_character(
    bench: Bench, window: MainWindow, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Open a character from the menu."""
    monkeypatch.setattr(dialogs, "ask_character", lambda *_: path)
    trigger(window, "open_character")
    bench.qtbot.waitUntil(lambda: window.document.character is not None)


def checklist_of(window: MainWindow) -> CharacterChecklist:
    found = window.findChild(CharacterChecklist)
    assert isinstance(found, CharacterChecklist)
    return found


def overlay_of(window: MainWindow) -> PointsOverlay:
    found = window.findChild(PointsOverlay)
    assert isinstance(found, PointsOverlay)
    return found


def test_a_character_is_shown_with_its_checklist_and_ours_comes_back(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    drawn = len(bench.renderers)
    open_character(bench, window, head, monkeypatch)
    session = session_of(window)
    assert session.shown_rig.name == "head"
    assert len(bench.renderers) == drawn + 1
    checklist = checklist_of(window)
    assert checklist.isVisible()
    assert f"of {len(ARKIT_CHANNELS)} channels have a shape" in checklist.summary
    header = checklist.table.horizontalHeader()
    for column in range(header.count()):
        assert header.sectionSize(column) >= header.sectionSizeHint(column), "a name is cut"
    assert editor_of(window).face.mapToGlobal(QPoint(0, 0)).x() >= min(
        checklist.frameGeometry().right(), checklist.screen().availableGeometry().left() + 760
    ), "the face whose points are dragged is not covered, if the screen has room"
    assert window.actions_["own_character"].isEnabled()
    trigger(window, "own_character")
    assert session.shown_rig is session.rig
    assert not checklist.isVisible()
    assert not window.actions_["own_character"].isEnabled()


def test_the_checklist_waits_until_the_first_steps_are_read(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    hints = editor_of(window).hints
    trigger(window, "first_steps")
    open_character(bench, window, head, monkeypatch)
    assert window.findChild(CharacterChecklist) is None
    assert hints.isVisible()
    hints.skip_button.click()
    assert checklist_of(window).isVisible()
    trigger(window, "first_steps")
    assert not checklist_of(window).isVisible()
    hints.skip_button.click()
    assert checklist_of(window).isVisible()


def test_the_checklist_says_how_to_see_a_character_that_was_opened_alone(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.window()
    open_character(bench, window, head, monkeypatch)
    checklist = checklist_of(window)
    assert checklist.hint.startswith("Open a take to see the character")
    window.commands.file.open(bench.take)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert checklist.hint.startswith("The control points are shown on the face")
    assert overlay_of(window).isVisible()


def test_a_character_that_cannot_be_read_leaves_the_old_one(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    window = bench.editing()
    open_character(bench, window, head, monkeypatch)
    bad = tmp_path / "bad.glb"
    bad.write_bytes(b"glTF and nothing more")
    window.commands.file.character.open(bad)
    bench.qtbot.waitUntil(lambda: bool(bench.errors))
    assert "bad.glb" in bench.errors[0]
    assert session_of(window).shown_rig.name == "head"


def test_opening_a_character_changes_no_frame_that_no_edit_touches(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    session = session_of(window)
    before = session.weights.copy()
    open_character(bench, window, head, monkeypatch)
    np.testing.assert_array_equal(session.weights, before)
    assert not window.isWindowModified()


def test_closing_on_the_character_is_a_step_that_undo_takes_back(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    assert not window.actions_["close_on_character"].isEnabled()
    open_character(bench, window, head, monkeypatch)
    assert window.actions_["close_on_character"].isChecked()
    trigger(window, "close_on_character")
    assert not session_of(window).settings.closes
    assert not window.actions_["close_on_character"].isChecked()
    window.document.undo()
    assert session_of(window).settings.closes


def test_another_shape_is_chosen_in_the_table_and_saved_beside_the_character(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    open_character(bench, window, head, monkeypatch)
    checklist = checklist_of(window)
    assert not checklist.save.isEnabled()
    model = checklist.table.model()
    row = next(r for r in range(model.rowCount()) if model.index(r, 0).data() == "jawOpen")
    first = window.document.character
    checklist.table.edit(model.index(row, SHAPE))
    box = checklist.table.findChild(QComboBox)
    assert isinstance(box, QComboBox)
    assert box.currentText() == "jawOpen"
    bench.qtbot.waitUntil(box.view().isVisible)
    box.view().setCurrentIndex(box.model().index(box.findText("mouthFunnel"), 0))
    QTest.keyClick(box.view(), Qt.Key.Key_Return)
    bench.qtbot.waitUntil(lambda: window.document.character is not first)
    assert window.document.character is not None
    assert window.document.character.match.matched["jawOpen"] == ("mouthFunnel",)
    assert checklist.save.isEnabled()
    QTest.mouseClick(checklist.save, Qt.MouseButton.LeftButton)
    stored = json.loads(map_path(head).read_text(encoding="utf-8"))
    assert stored["channels"] == {"jawOpen": ["mouthFunnel"]}
    assert not checklist.save.isEnabled()


def test_the_strength_of_a_channel_is_set_in_the_table_shown_and_saved(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    open_character(bench, window, head, monkeypatch)
    checklist, session = checklist_of(window), session_of(window)
    before, weights = session.rig_weights(20), session.weights.copy()
    model = checklist.table.model()
    row = next(r for r in range(model.rowCount()) if model.index(r, 0).data() == "jawOpen")
    assert model.index(row, MULTIPLIER).data() == "1.00"
    assert model.flags(model.index(row, MULTIPLIER)) & Qt.ItemFlag.ItemIsEditable
    model.setData(model.index(row, MULTIPLIER), 0.5)
    model.setData(model.index(row, LIMIT), 2.0)  # beyond the range: no limit
    jaw = session.shown_rig.channel_index["jawOpen"]
    assert session.rig_weights(20)[jaw] == pytest.approx(before[jaw] / 2)
    np.testing.assert_array_equal(session.weights, weights)  # the take is as it was
    assert model.index(row, MULTIPLIER).data() == "0.50"
    QTest.mouseClick(checklist.save, Qt.MouseButton.LeftButton)
    stored = json.loads(map_path(head).read_text(encoding="utf-8"))
    assert stored["strength"] == {"jawOpen": {"multiplier": 0.5, "offset": 0.0, "limit": 1.0}}
    trigger(window, "own_character")
    open_character(bench, window, head, monkeypatch)
    assert session.shown_rig.levels.by_channel == {"jawOpen": (0.5, 0.0, 1.0)}


def test_choices_that_leave_no_face_are_refused(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    open_character(bench, window, head, monkeypatch)
    model = checklist_of(window).table.model()
    monkeypatch.setattr("faceedit_app.characters.fitted._FEWEST", len(ARKIT_CHANNELS))
    row = next(r for r in range(model.rowCount()) if model.index(r, 0).data() == "jawOpen")
    character = window.document.character
    model.setData(model.index(row, SHAPE), NO_SHAPE)
    bench.qtbot.waitUntil(lambda: bool(bench.errors))
    assert "head.glb" in bench.errors[0]
    assert window.document.character is character


def test_a_point_is_dragged_to_another_vertex(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    open_character(bench, window, head, monkeypatch)
    overlay = overlay_of(window)
    bench.qtbot.waitUntil(lambda: overlay.isVisible())
    assert window.editor is not None
    window.editor.face.viewport.grab()
    first = window.document.character
    assert first is not None
    start = overlay.place("chin").toPoint()
    stop = start - QPoint(0, 14)
    QTest.mousePress(overlay, Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(overlay, stop)
    QTest.mouseRelease(overlay, Qt.MouseButton.LeftButton, pos=stop)
    bench.qtbot.waitUntil(lambda: window.document.character is not first)
    assert window.document.character is not None
    assert set(window.document.character.mapping.points) == {"chin"}
    assert window.document.character.points["chin"] != first.points["chin"]
    bench.answers["unsaved_map"] = dialogs.Unsaved.CANCEL
    assert not window.close(), "what was chosen is not lost without a question"
    bench.answers["unsaved_map"] = dialogs.Unsaved.CANCEL
    trigger(window, "own_character")
    assert overlay.isVisible()
    bench.answers["unsaved_map"] = dialogs.Unsaved.SAVE
    trigger(window, "own_character")
    assert not overlay.isVisible()
    assert "chin" in json.loads(map_path(head).read_text(encoding="utf-8"))["points"]
    assert window.close(), "it is saved"


def test_recovery_and_projects_remember_the_character_and_projects_find_it_when_moved(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    window = bench.editing()
    open_character(bench, window, head, monkeypatch)
    add_edit(window)
    project = tmp_path / "work" / "scene.faceedit"
    project.parent.mkdir()
    bench.answers["save_project"] = project
    trigger(window, "save")
    add_edit(window)
    (crashed,) = (bench.folder / "journals").glob("*.jsonl")
    content = crashed.read_bytes()
    window.document.session = None
    assert window.close()
    crashed.write_bytes(content)
    monkeypatch.setattr(dialogs, "ask_recover", lambda *_: dialogs.Recover.RECOVER)
    again, said = bench.window(start=False), list[str]()
    again.workspace.message.connect(said.append)
    again.start()
    bench.qtbot.waitUntil(lambda: again.document.character is not None)
    assert len(session_of(again).edits) == 2, "recovered"
    assert said[0].endswith(": 2 edits; a single Undo goes back to scene.faceedit")
    trigger(again, "undo")
    assert len(session_of(again).edits) == 1, "that of the project"
    assert not again.isWindowModified()
    trigger(again, "redo")
    trigger(again, "save")
    assert '"head.glb"' in project.read_text(encoding="utf-8").replace("../", "")
    elsewhere = tmp_path / "moved" / "renamed.glb"
    elsewhere.parent.mkdir()
    head.rename(elsewhere)
    again.commands.file.open_if_saved(project)

    def is_elsewhere() -> bool:
        character = again.document.character
        return character is not None and character.character.path == elsewhere

    bench.qtbot.waitUntil(is_elsewhere)
    assert again.document.character is not None
    assert session_of(again).shown_rig is again.document.character.rig
    elsewhere.unlink()
    bench.qtbot.waitUntil(lambda: not again.workspace.opener.is_reading)
    again.commands.file.open_if_saved(project)
    bench.qtbot.waitUntil(lambda: again.document.character is None)


def test_dropped_characters_open_and_files_that_are_both_are_asked_about(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    drop(window, write_objs(tmp_path / "face"))
    bench.qtbot.waitUntil(lambda: window.document.character is not None)
    assert session_of(window).shown_rig.name == "face"
    asked: list[str] = []

    def answer(_parent: object, name: str) -> dialogs.OpenAs:
        asked.append(name)
        return dialogs.OpenAs.CANCEL

    monkeypatch.setattr(dialogs, "ask_take_or_character", answer)
    monkeypatch.setattr("faceedit_app.formats.registry.is_take", lambda _path: True)
    drop(window, write_glb(tmp_path / "both.glb"))
    wait_for_background(window.workspace.background)
    assert asked == ["both.glb"]
    assert session_of(window).shown_rig.name == "face"


def test_recent_characters_are_listed(
    bench: Bench, head: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    open_character(bench, window, head, monkeypatch)
    menu = window.actions_.submenu("recent_characters")
    menu.aboutToShow.emit()
    assert [action.text() for action in menu.actions()] == ["head.glb"]


def test_a_head_without_an_animation_is_opened_as_the_character(bench: Bench, head: Path) -> None:
    window = bench.editing()
    take = session_of(window).take
    window.commands.file.open(head)
    bench.qtbot.waitUntil(lambda: window.document.character is not None)
    assert session_of(window).take is take


def test_the_face_of_a_take_can_be_shown_as_the_character(
    bench: Bench, head: Path, tmp_path: Path
) -> None:
    clip = Clip(np.full((30, 1), 0.2, np.float32), ("jawOpen",), np.arange(30) / 30, 30.0)
    animated = tmp_path / "animated.glb"
    animated.write_bytes(scene_content(SCENES[0], clip, fit(read_character(head)), "take"))
    window = bench.editing()
    window.commands.file.open(animated)
    bench.qtbot.waitUntil(lambda: session_of(window).take.path == animated)
    banner = window.banner
    assert "It also has a face" in banner.text.text()
    assert window.document.character is None
    banner.button.click()
    bench.qtbot.waitUntil(lambda: window.document.character is not None)
    assert session_of(window).shown_rig.name == "animated"
    assert "It also has a face" not in banner.text.text()


@pytest.mark.parametrize("instead", ["another", "ours"])
def test_while_a_large_head_is_read_the_take_stays_and_the_last_choice_counts(
    instead: str, bench: Bench, head: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate, load = threading.Event(), loading.load_own_character

    def slowly(path: Path) -> FittedCharacter:
        assert path != head or gate.wait(30)
        return load(path)

    monkeypatch.setattr(loading, "load_own_character", slowly)
    monkeypatch.setattr(start_window, "_SLOW_MS", 0)
    window = bench.editing()
    monkeypatch.setattr(dialogs, "ask_character", lambda *_: head)
    trigger(window, "open_character")
    run_events()
    assert editor_of(window).isVisible()
    assert "head.glb" in window.status.currentMessage()
    if instead == "ours":
        assert window.actions_["own_character"].isEnabled()
        trigger(window, "own_character")
    else:
        open_character(bench, window, write_glb(tmp_path / "small.glb"), monkeypatch)
    assert "head.glb" not in window.status.currentMessage()
    gate.set()
    wait_for_background(window.workspace.background)
    shown = window.document.character
    assert (shown and shown.character.path.name) == (None if instead == "ours" else "small.glb")
    assert session_of(window).shown_rig.name != "head"
