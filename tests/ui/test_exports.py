"""File > Export as: the dialog, and what is written."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtWidgets import QProgressDialog, QPushButton
from pytestqt.qtbot import QtBot
from support import recordings
from support.character_files import write_glb
from support.takes import make_livelink_csv
from support.windows import Bench, add_edit, trigger

from faceedit_app.characters.fitted import open_character
from faceedit_app.editing import exporting, filming, splicing
from faceedit_app.editing.exporting import Options, choose, out_formats
from faceedit_app.editing.filming import FilmView, Shot
from faceedit_app.formats.opening import open_take
from faceedit_app.media.container import Abandoned
from faceedit_app.media.film import Film
from faceedit_app.media.film_writer import FilmFormat, film_format
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.dialogs import Changed
from faceedit_app.ui.edits.splice_dialog import SpliceDialog
from faceedit_app.ui.page.export_dialog import ExportDialog
from faceedit_app.ui.page.film_dialog import FilmDialog
from faceedit_app.ui.start.window import MainWindow


@pytest.fixture
def dialog(qtbot: QtBot, tmp_path: Path) -> ExportDialog:
    take = open_take(make_livelink_csv(tmp_path / "take.csv"))
    dialog = ExportDialog(None, take, tmp_path / "head.glb")
    qtbot.addWidget(dialog)
    return dialog


def choose_format(dialog: ExportDialog, key: str) -> None:
    keys = []
    for index in range(dialog.format.count()):
        dialog.format.setCurrentIndex(index)
        keys.append(dialog.chosen.key)
        if keys[-1] == key:
            return
    raise AssertionError(f"{key} is not offered: {keys}")


def test_the_dialog_begins_with_the_layout_and_rate_of_the_take(dialog: ExportDialog) -> None:
    assert dialog.chosen.key == "livelink"
    assert dialog.options == Options()
    assert "Same as the take" in dialog.format.currentText()
    assert dialog.chosen.is_own
    assert dialog.format.count() == len(out_formats()) + 1
    choose_format(dialog, "csv")
    assert not dialog.chosen.is_own


def test_the_dialog_says_which_character_plays_the_take(dialog: ExportDialog) -> None:
    choose_format(dialog, "csv")
    assert not dialog.character.isEnabled()
    assert not dialog.compact.isEnabled()
    choose_format(dialog, "glb")
    assert dialog.character.isEnabled()
    assert dialog.character.text() == "head.glb"
    dialog.compact.click()
    assert dialog.options == Options(compact=True)


def test_the_dialog_says_what_to_do_at_the_chosen_rate(dialog: ExportDialog) -> None:
    choose_format(dialog, "glb")
    assert "60 fps" in dialog.hints.text()
    dialog.rate.setCurrentText("24 fps")
    assert "24 fps" in dialog.hints.text()
    assert dialog.options.rate == 24


def test_a_layout_that_cannot_be_made_keeps_its_rate(qtbot: QtBot, tmp_path: Path) -> None:
    path = tmp_path / "take.txt"
    path.write_text(recordings.facecap(recordings.face(60)))
    dialog = ExportDialog(None, open_take(path))
    qtbot.addWidget(dialog)
    dialog.rate.setCurrentText("24 fps")
    assert not dialog.rate.isEnabled()
    assert dialog.options == Options()
    choose_format(dialog, "csv")
    assert dialog.rate.isEnabled()
    assert dialog.options.rate == 24


def test_what_is_on_screen_is_exported_as_a_character(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    out = bench.folder / "talk.glb"
    bench.answers |= {"export_as": (choose(out), Options()), "export": out}
    trigger(window, "export_as")
    bench.qtbot.waitUntil(lambda: bool(bench.exported))
    session = window.document.session
    assert session is not None
    np.testing.assert_array_equal(open_take(out).clip.arkit_weights(), session.weights)
    assert window.isWindowModified()
    path, lines = bench.exported[0]
    assert path == out
    assert any(line.startswith("Blender: ") for line in lines)
    assert not bench.errors


def test_the_window_says_where_in_its_menus_the_head_is_made_to_turn(bench: Bench) -> None:
    window = bench.editing()
    out = bench.folder / "talk.glb"
    bench.answers["export"] = out
    trigger(window, "export")
    bench.qtbot.waitUntil(lambda: bool(bench.exported), timeout=20_000)
    said = " ".join(bench.exported[0][1])
    assert "the head is straight; View > Follow the head turns it as recorded" in said
    assert "--" not in said


def test_an_ending_of_another_format_means_that_format(bench: Bench) -> None:
    window = bench.editing()
    out = bench.folder / "talk.glb"
    bench.answers["export"] = out
    trigger(window, "export")
    bench.qtbot.waitUntil(lambda: bool(bench.exported), timeout=20_000)
    assert open_take(out).format == "GLB animation"


def test_the_character_on_screen_plays_the_take(bench: Bench) -> None:
    window = bench.editing()
    head = open_character(write_glb(bench.folder / "head.glb", lambda name: f"Face_{name}"))
    window.document.use_character(head)
    out = bench.folder / "talk.fbx"
    bench.answers |= {"export_as": (choose(out), Options()), "export": out}
    trigger(window, "export_as")
    bench.qtbot.waitUntil(lambda: bool(bench.exported), timeout=20_000)
    assert b"Face_jawOpen" in out.read_bytes()


def test_the_recording_is_kept_when_it_is_replaced(bench: Bench) -> None:
    before = bench.take.read_bytes()
    window = bench.editing()
    form = choose(Path("x.csv"), "csv")
    bench.answers |= {"export_as": (form, Options(rate=30.0)), "export": bench.take}
    bench.answers["overwrite"] = Changed.REPLACE
    trigger(window, "export_as")
    bench.qtbot.waitUntil(lambda: bool(bench.exported))
    assert bench.take.with_name("take.csv.bak").read_bytes() == before
    assert open_take(bench.take).clip.rate == 30


# --- films ---------------------------------------------------------------------------------------

MP4 = film_format(Path("x.mp4"))


def film(bench: Bench, window: MainWindow, path: Path, shot: Shot, form: FilmFormat = MP4) -> None:
    bench.answers |= {"film": (form, shot), "export": path}
    trigger(window, "export_film")


def test_the_film_dialog_offers_what_the_take_has(qtbot: QtBot) -> None:
    plain, full = FilmDialog(None, 60.0, False, False), FilmDialog(None, 60.0, True, True)
    qtbot.addWidget(plain)
    qtbot.addWidget(full)
    assert [plain.view.itemData(i) for i in range(plain.view.count())] == [
        FilmView.FACE,
        FilmView.BOTH,
    ]
    assert full.view.itemData(2) == FilmView.FILM
    assert not plain.shot.has_sound
    assert full.shot.has_sound
    full.view.setCurrentIndex(1)
    full.picture_size.setCurrentText("960 × 480")
    assert full.shot == Shot(FilmView.BOTH, (960, 480), form="mp4")


def test_the_take_is_filmed_as_it_is_on_screen(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    path = bench.folder / "face.mp4"
    path.write_text("my only recording")
    film(bench, window, path, Shot(size=(64, 64), rate=10.0))
    bench.qtbot.waitUntil(lambda: "Exported" in window.status.currentMessage(), timeout=20_000)
    assert f"{path} (H.264" in window.status.currentMessage()
    assert "; the file that was there is now face.mp4.bak" in window.status.currentMessage()
    assert len(Film(path)) == 30
    assert not window.commands.file.is_filming
    assert not bench.errors


def test_a_film_can_be_cancelled(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    gate, film_take = threading.Event(), filming.film_take

    def waits(*arguments: Any) -> object:
        gate.wait(20)
        return film_take(*arguments)

    monkeypatch.setattr(filming, "film_take", waits)
    window = bench.editing()
    path = bench.folder / "face.mp4"
    film(bench, window, path, Shot(size=(64, 64)))
    assert not window.actions_["export_film"].isEnabled(), "one film at a time"
    dialog = window.findChild(QProgressDialog)
    assert isinstance(dialog, QProgressDialog)
    button = dialog.findChild(QPushButton)
    assert isinstance(button, QPushButton)
    button.click()
    gate.set()
    bench.qtbot.waitUntil(
        lambda: "Film cancelled" in window.status.currentMessage(), timeout=20_000
    )
    assert not path.exists()
    assert not window.commands.file.is_filming
    assert window.actions_["export_film"].isEnabled()


@pytest.mark.parametrize("kind", ["film", "character", "longer take"])
def test_closing_asks_about_what_is_being_written(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    gate, asked = threading.Event(), list[list[str]]()

    def waits(*arguments: object) -> None:
        gate.wait(20)

    def answer(_window: object, names: list[str]) -> bool:
        asked.append(names)
        return len(asked) == 2

    monkeypatch.setattr(filming, "film_take", waits)
    monkeypatch.setattr(exporting, "export_take", waits)
    monkeypatch.setattr(splicing, "write_spliced", waits)
    monkeypatch.setattr(dialogs, "ask_stop_writing", answer)
    window = bench.editing()
    out = bench.answers["export"] = bench.folder / "talk.xyz"
    match kind:
        case "film":
            film(bench, window, out, Shot(size=(64, 64)))
        case "character":
            bench.answers["export_as"] = choose(Path("x.glb")), Options()
            trigger(window, "export_as")
        case _:
            trigger(window, "insert_longer")
            (dialog,) = window.findChildren(SpliceDialog)
            dialog.write.click()
    assert not window.close()
    assert window.close()
    assert asked == [["talk.xyz"], ["talk.xyz"]]
    gate.set()


def test_an_export_that_is_given_up_writes_nothing(tmp_path: Path) -> None:
    take = open_take(make_livelink_csv(tmp_path / "take.csv", seconds=0.5))
    for name in ("out.glb", "out.csv"):
        form = choose(Path(name))
        with pytest.raises(Abandoned):
            exporting.export_take(take, take.clip, tmp_path / name, form, stopped=lambda: True)
    assert [path.name for path in tmp_path.iterdir()] == ["take.csv"]


def test_a_film_that_cannot_be_written_is_reported(bench: Bench) -> None:
    window = bench.editing()
    film(bench, window, bench.folder / "nowhere" / "face.mp4", Shot(size=(64, 64)))
    bench.qtbot.waitUntil(lambda: bool(bench.errors), timeout=20_000)
    assert "cannot be written" in bench.errors[0]
    assert not window.commands.file.is_filming
