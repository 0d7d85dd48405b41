"""Every dialog that the application can open, opened as it opens them."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, Qt, QTimer
from PySide6.QtWidgets import QApplication, QDialog
from shiboken6 import isValid

from faceedit_app.characters.fitted import open_character
from faceedit_app.editing.files.pending import Pending
from faceedit_app.editing.steps import EditState
from faceedit_app.media.webcam import Webcam
from faceedit_app.ui.character.checklist import CharacterChecklist
from faceedit_app.ui.character.scan_dialog import ScanDialog
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.live import counting_box
from faceedit_app.ui.commands.writing import progress_dialog
from faceedit_app.ui.media.tracking_dialog import TrackingDialog
from faceedit_app.ui.media.webcam_dialog import WebcamDialog
from faceedit_app.ui.start.window import MainWindow
from support.character_files import write_glb
from support.faces import shipped_rig
from support.windows import session_of, trigger

Open = Callable[[MainWindow, Path], object]
# `Bench` answers the questions in place of the user: kept here before it does.
_ASK: dict[str, Callable[..., Any]] = {
    name: value
    for name, value in vars(dialogs).items()
    if name.startswith(("ask_", "show_")) and callable(value)
}


def _asked(name: str, *arguments: object) -> Open:
    return lambda window, _folder: _ASK[name](window, *arguments)


def _in_folder(name: str, file: str = "") -> Open:
    return lambda window, folder: _ASK[name](window, folder / file)


def _chosen(command: str, selected: bool = False) -> Open:
    def choose(window: MainWindow, _folder: Path) -> None:
        if selected:
            window.timeline.select((1.0, 2.0))
        trigger(window, command)

    return choose


def _export_as(window: MainWindow, folder: Path) -> None:
    _ASK["ask_export_as"](window, session_of(window).take, folder / "head.glb")


def _recover(window: MainWindow, folder: Path) -> None:
    pending = Pending(folder / "journal", folder / "take.csv", None, None, EditState(), 3, 0.0)
    _ASK["ask_recover"](window, pending)


def _take_of_project(window: MainWindow, folder: Path) -> None:
    message = "The take of talk.faceedit is not there any more."
    _ASK["ask_take_of_project"](window, message, [folder / "a.csv", folder / "b.csv"], folder)


def _checklist(window: MainWindow, folder: Path) -> CharacterChecklist:
    dialog = CharacterChecklist(window)
    dialog.show_character(
        open_character(write_glb(folder / "head.glb")), is_changed=True, is_drawn=True
    )
    dialog.show()
    return dialog


def _kept_open(dialog: QDialog) -> QDialog:
    dialog.show()
    return dialog


def _progress(window: MainWindow, _folder: Path) -> QDialog:
    """As while a film is exported, or a longer take written."""
    dialog = progress_dialog(window, "Export film", "Filming talk.mp4…")
    dialog.setMaximum(100)
    dialog.setValue(40)
    return _kept_open(dialog)


def _phone(window: MainWindow, _folder: Path) -> QDialog:
    """As while a phone is recorded."""
    box = counting_box(window)
    box.setText("Recording talk.csv: 120 frames")
    box.setInformativeText("2.0 s")
    return _kept_open(box)


DIALOGS: dict[str, Open] = {
    "ask_rate": _asked("ask_rate", "take.csv has no column with times.", 64, 60.0),
    "ask_open": _in_folder("ask_open"),
    "ask_export": _in_folder("ask_export", "take_edited.csv"),
    "ask_export_as": _export_as,
    "ask_film": _asked("ask_film", 60.0, True, True),
    "ask_live": _asked("ask_live"),
    "ask_record": _asked("ask_record"),
    "ask_record_name": _in_folder("ask_record_name", "recording.csv"),
    "ask_stop_writing": _asked("ask_stop_writing", ["talk.mp4", "talk_shorter.csv"]),
    "show_exported": _asked("show_exported", Path("talk.glb"), ["Blender: File > Import > glTF"]),
    "ask_overwrite": _asked("ask_overwrite", Path("take.csv"), "is the open take"),
    "ask_save_project": _in_folder("ask_save_project", "take.faceedit"),
    "ask_take_of_project": _take_of_project,
    "ask_recover": _recover,
    "ask_save_edits": _in_folder("ask_save_edits", "take_edits.json"),
    "ask_load_edits": _in_folder("ask_load_edits"),
    "ask_media": _in_folder("ask_media"),
    "ask_words": _in_folder("ask_words"),
    "ask_match": _in_folder("ask_match"),
    "ask_save_words": _in_folder("ask_save_words", "take.srt"),
    "ask_character": _in_folder("ask_character"),
    "ask_scan": _in_folder("ask_scan"),
    "ask_save_character": _in_folder("ask_save_character", "head.glb"),
    "ask_take_or_character": _asked("ask_take_or_character", "head.glb"),
    "ask_film_to_track": _in_folder("ask_film_to_track"),
    "ask_save_take": _in_folder("ask_save_take", "film.csv"),
    "ask_save_side_by_side": _in_folder("ask_save_side_by_side", "film.mp4"),
    "ask_save_picture": _in_folder("ask_save_picture", "face.png"),
    "ask_preset_name": _asked("ask_preset_name", "Mine"),
    "ask_delete_preset": _asked("ask_delete_preset", "Mine"),
    "ask_unsaved": _asked("ask_unsaved", "Your edits to take.csv are not saved", "They are lost"),
    "ask_unsaved_map": _asked("ask_unsaved_map", "head.glb"),
    "ask_changed": _asked("ask_changed", Path("take.csv")),
    "show_error": _asked("show_error", "take.csv: is empty; choose another"),
    "SliderDialog": _chosen("expression"),
    "LevelsDialog": _chosen("levels"),
    "RetimeDialog": _chosen("stretch_time", selected=True),
    "RetimeDialog of a pause": _chosen("insert_pause"),
    "SpliceDialog": _chosen("cut_shorter", selected=True),
    "SpliceDialog that lengthens": _chosen("insert_longer"),
    "WordsDialog": _chosen("words", selected=True),
    "shortcuts": _chosen("shortcuts"),
    "about": _chosen("about"),
    "CharacterChecklist": _checklist,
    "ScanDialog": lambda window, folder: _kept_open(
        ScanDialog(window, folder / "scan.ply", shipped_rig())
    ),
    "TrackingDialog": lambda window, folder: _kept_open(
        TrackingDialog(window, folder / "film.mp4")
    ),
    "WebcamDialog": lambda window, folder: _kept_open(
        WebcamDialog(window, [Webcam("Desk", "a"), Webcam("Window", "b")], folder / "me.mp4")
    ),
    "progress": _progress,
    "phone": _phone,
}


def questions() -> set[str]:
    """The names of all questions and messages in `ui/commands/dialogs.py`."""
    return set(_ASK)


def look_at(
    window: MainWindow, folder: Path, name: str, look: Callable[[QDialog], None]
) -> type[QDialog]:
    """Open a dialog, do something with it, and close it; returns its class.

    Args:
        folder: where files may be written.
        name: in `DIALOGS`.
        look: what to do while it is open.
    """
    seen: list[QDialog] = []
    kinds: list[type[QDialog]] = []

    def visit(dialog: QDialog) -> None:
        seen.append(dialog)
        kinds.append(type(dialog))
        try:
            look(dialog)
        finally:
            dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose, on=False)
            dialog.reject()
            dialog.close()

    def during() -> None:
        dialog = QApplication.activeModalWidget()
        if isinstance(dialog, QDialog):
            visit(dialog)

    waiting = QTimer(window, singleShot=True, interval=0)
    waiting.timeout.connect(during)
    waiting.start()  # a question holds the program until it is answered
    DIALOGS[name](window, folder)
    waiting.stop()
    if name in _ASK and seen:
        # Answered: the window must not keep it for the rest of its life.
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        assert not isValid(seen[0]), f"{name} leaves its dialog behind"
        return kinds[0]
    if not seen:
        visit(_newest())
    with suppress(RuntimeError):  # gone already
        seen[0].deleteLater()
    return kinds[0]


def _newest() -> QDialog:
    shown = [w for w in QApplication.topLevelWidgets() if isinstance(w, QDialog) and w.isVisible()]
    assert shown, "no dialog is open"
    return shown[-1]
