"""The questions themselves, answered as a user would."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import (
    QApplication,
    QDialog,
    QFileDialog,
    QMainWindow,
    QMessageBox,
    QWidget,
)
from pytestqt.qtbot import QtBot

from faceedit_app.core.atomic import keep_backup
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files.fingerprint import KnownFile
from faceedit_app.editing.files.pending import Pending
from faceedit_app.editing.steps import EditState
from faceedit_app.ui.commands import dialogs


@pytest.fixture
def parent(qtbot: QtBot) -> QWidget:
    widget = QWidget()
    qtbot.addWidget(widget)
    return widget


def when_asked(act: Callable[[QDialog], None]) -> None:
    """Do something with the dialog that opens next."""

    def look() -> None:
        dialog = QApplication.activeModalWidget()
        if isinstance(dialog, QDialog):
            act(dialog)
        else:
            QTimer.singleShot(10, look)

    QTimer.singleShot(0, look)


@pytest.mark.parametrize(
    ("label", "answer"),
    [
        ("Export…", dialogs.Unsaved.EXPORT),
        ("Save project…", dialogs.Unsaved.SAVE),
        ("Discard", dialogs.Unsaved.DISCARD),
        ("Cancel", dialogs.Unsaved.CANCEL),
    ],
)
def test_each_answer_about_unsaved_edits(
    parent: QWidget, label: str, answer: dialogs.Unsaved
) -> None:
    def press(dialog: QDialog) -> None:
        assert isinstance(dialog, QMessageBox)
        assert "take.csv" in dialog.text()
        buttons = {button.text().replace("&", ""): button for button in dialog.buttons()}
        buttons[label].click()

    when_asked(press)
    assert dialogs.ask_unsaved(parent, "take.csv") is answer


def test_an_exported_file_is_explained_in_a_block_for_each_program(parent: QWidget) -> None:
    program = "Blender: File > Import > glTF 2.0."
    lines = ["left out because they are not channels: a, b", "jawOpen has no shape", program]
    dialogs.show_exported(parent, Path("talk.glb"), lines)
    (box,) = parent.findChildren(QMessageBox)
    assert box.informativeText().split("\n\n") == [
        "Left out because they are not channels: a, b.",
        "jawOpen has no shape.",
        program,
    ]
    box.close()


def test_saving_has_dots_only_if_it_asks_for_a_name(parent: QWidget) -> None:
    labels: list[str] = []

    def read(dialog: QDialog) -> None:
        assert isinstance(dialog, QMessageBox)
        labels.append(dialog.buttons()[0].text())
        dialog.reject()

    for asks in (True, False):
        when_asked(read)
        dialogs.ask_unsaved(parent, "take.csv", asks=asks)
    assert labels == ["&Save project…", "&Save project"]


def test_an_export_is_offered_only_for_what_it_would_hold(parent: QWidget) -> None:
    labels: list[list[str]] = []

    def read(dialog: QDialog) -> None:
        assert isinstance(dialog, QMessageBox)
        labels.append([button.text().replace("&", "") for button in dialog.buttons()])
        dialog.reject()

    for exports in (True, False):
        when_asked(read)
        dialogs.ask_unsaved(parent, "take.csv", exports=exports)
    assert ["Export…" in each for each in labels] == [True, False]
    assert all("Discard" in each for each in labels)


def test_escape_is_cancel(parent: QWidget) -> None:
    when_asked(lambda dialog: dialog.reject())
    assert dialogs.ask_unsaved(parent, "take.csv") is dialogs.Unsaved.CANCEL


def test_an_error_is_shown_as_it_is(parent: QWidget) -> None:
    seen: list[str] = []

    def read(dialog: QDialog) -> None:
        assert isinstance(dialog, QMessageBox)
        seen.append(dialog.text())
        dialog.accept()

    when_asked(read)
    dialogs.show_error(parent, "<b>.csv: is empty; choose another")
    assert seen == ["<b>.csv: is empty; choose another"]


def test_the_suggested_name_is_taken_and_its_ending_added(parent: QWidget, tmp_path: Path) -> None:
    def accept(dialog: QDialog) -> None:
        assert isinstance(dialog, QFileDialog)
        assert dialog.selectedFiles() == [str(tmp_path / "take_edited.csv")]
        dialog.selectFile(str(tmp_path / "mine"))
        dialog.accept()

    when_asked(accept)
    assert dialogs.ask_export(parent, tmp_path / "take_edited.csv") == tmp_path / "mine.csv"
    when_asked(lambda dialog: dialog.reject())
    assert dialogs.ask_save_edits(parent, tmp_path / "take_edits.json") is None


@pytest.mark.parametrize(
    ("typed", "written"),
    [
        ("smile v1.2", "smile v1.2.csv"),
        ("smile.final", "smile.final.csv"),
        ("smile.CSV", "smile.CSV"),
        ("smile.txt", "smile.txt"),
    ],
)
def test_what_follows_a_dot_is_no_ending_unless_it_is_known(
    typed: str, written: str, parent: QWidget, tmp_path: Path
) -> None:
    def accept(dialog: QDialog) -> None:
        assert isinstance(dialog, QFileDialog)
        dialog.selectFile(str(tmp_path / typed))
        dialog.accept()

    when_asked(accept)
    assert dialogs.ask_export(parent, tmp_path / "take_edited.csv") == tmp_path / written


def test_a_project_or_picture_named_like_another_file_gets_its_own_ending(
    parent: QWidget, tmp_path: Path
) -> None:
    def accept(dialog: QDialog) -> None:
        assert isinstance(dialog, QFileDialog)
        dialog.selectFile(str(tmp_path / "take.csv"))
        dialog.accept()

    asks = ((dialogs.ask_save_project, ".faceedit"), (dialogs.ask_save_picture, ".png"))
    for ask, ending in asks:
        when_asked(accept)
        assert ask(parent, tmp_path / f"take{ending}") == tmp_path / f"take.csv{ending}"


def test_the_ending_that_is_added_replaces_no_file_without_a_question(
    parent: QWidget, tmp_path: Path
) -> None:
    (tmp_path / "smile 1.2.csv").write_text("mine", encoding="utf-8")

    def accept(dialog: QDialog) -> None:
        assert isinstance(dialog, QFileDialog)
        when_asked(refuse)
        dialog.selectFile(str(tmp_path / "smile 1.2"))
        dialog.accept()

    def refuse(box: QDialog) -> None:
        assert isinstance(box, QMessageBox)
        assert "smile 1.2.csv exists" in box.text()
        when_asked(lambda dialog: dialog.reject())
        box.reject()

    when_asked(accept)
    assert dialogs.ask_export(parent, tmp_path / "take_edited.csv") is None


@pytest.mark.parametrize(
    ("edits", "words"),
    [(0, "recovered. "), (1, "recovered: 1 edit. "), (2, "recovered: 2 edits. ")],
)
def test_recovery_counts_edits_however_many_gestures_made_them(
    parent: QWidget, tmp_path: Path, edits: int, words: str
) -> None:
    said: list[str] = []

    def read(dialog: QDialog) -> None:
        assert isinstance(dialog, QMessageBox)
        said.extend((dialog.text(), dialog.informativeText()))
        dialog.reject()

    made = Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, 6.0)
    take, state = tmp_path / "take.csv", EditState((made,) * edits)
    when_asked(read)
    pending = Pending(tmp_path / "journal", take, None, None, state, 31, 0.0)
    assert dialogs.ask_recover(parent, pending) is dialogs.Recover.LATER
    assert words in said[1]
    assert said[0].endswith("editing take.csv.")
    project = KnownFile(tmp_path / "scene.faceedit", None)
    when_asked(read)
    dialogs.ask_recover(parent, replace(pending, project=project))
    assert said[2].endswith("editing take.csv in scene.faceedit.")


def test_a_question_names_the_copy_that_will_be_made(parent: QWidget, tmp_path: Path) -> None:
    said: list[str] = []

    def read(dialog: QDialog) -> None:
        assert isinstance(dialog, QMessageBox)
        said.append(dialog.informativeText())
        dialog.reject()

    path = tmp_path / "scene.faceedit"
    path.write_bytes(b"now")
    for before, name in ((b"", ".bak"), (b"now", ".bak"), (b"then", ".bak2")):
        if before:
            path.with_name("scene.faceedit.bak").write_bytes(before)
        when_asked(read)
        assert dialogs.ask_changed(parent, path) is dialogs.Changed.CANCEL
        assert said[-1].endswith(f" kept as scene.faceedit{name}.")
        assert keep_backup(path).name == f"scene.faceedit{name}"
        path.with_name("scene.faceedit.bak").unlink()


@pytest.mark.parametrize(
    ("said", "left"), [("Exporting a.csv…", ""), ("Saved a.csv", "Saved a.csv")]
)
def test_what_ended_in_an_error_is_no_longer_announced(qtbot: QtBot, said: str, left: str) -> None:
    window = QMainWindow()
    qtbot.addWidget(window)
    window.statusBar().showMessage(said)
    seen: list[str] = []

    def look(box: QDialog) -> None:
        seen.append(window.statusBar().currentMessage())
        box.reject()

    when_asked(look)
    dialogs.show_error(window, "a.csv: the disk is full; choose another")
    assert seen == [left]
