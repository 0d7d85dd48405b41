"""No menu command writes over a file that the window has open, whatever the user answers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.character_files import write_glb
from support.speech import said
from support.windows import Bench, add_edit, session_of, trigger

import faceedit_app.ui.commands
from faceedit_app.characters.fitted import open_character
from faceedit_app.core.atomic import OTHER_NAME
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.exporting import Options, choose
from faceedit_app.editing.filming import Shot
from faceedit_app.media.film_writer import film_format
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.dialogs import Changed
from faceedit_app.ui.commands.words import WordCommands

COMMANDS = {  # and the dialog that asks for the file
    "save_as": "save_project",
    "save_edits": "save_edits",
    "save_picture": "save_picture",
    "words": "save_words",
    "export": "export",
    "export_as": "export",
    "export_film": "export",
}


def test_what_the_window_reads_is_never_written_over(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    window, folder = bench.editing(), bench.folder
    add_edit(window)
    session_of(window).say(said(("map", "M AE P")))
    head = write_glb(folder / "head.glb")
    window.document.use_character(open_character(head))
    for name in ("sound.wav", "film.mp4", "said.TextGrid"):
        (folder / name).write_bytes(b"the only one")
    placed = Placement(MediaFile(folder / "sound.wav"), MediaFile(folder / "film.mp4"))
    monkeypatch.setattr(type(window.workspace.media), "placement", placed)
    window.workspace.words_file = folder / "said.TextGrid"
    bench.answers["save_project"] = folder / "mine.faceedit"
    trigger(window, "save_as")
    files = {
        bench.take: "is the open take",
        head: "is the open character",
        folder / "sound.wav": "is the sound of the open take",
        folder / "film.mp4": "is the film of the open take",
        folder / "said.TextGrid": "is where the words of the open take were read",
        folder / "mine.faceedit": "is the open project",
    }
    before = {path: path.read_bytes() for path in files}

    words = WordCommands(window.workspace)
    answers = {
        "export_as": (choose(head), Options()),
        "film": (film_format(Path("a.mp4")), Shot()),
        "overwrite": Changed.CANCEL,
    }
    for question, it in answers.items():
        monkeypatch.setattr(dialogs, f"ask_{question}", lambda *_, it=it: it)
    for command, asked in COMMANDS.items():
        for path, what in files.items():
            if (command, path.suffix) == ("save_as", ".faceedit"):
                continue  # saving it again
            given = iter([path])  # then the user cancels
            monkeypatch.setattr(dialogs, f"ask_{asked}", lambda *_, given=given: next(given, None))
            bench.errors.clear()
            if command == "words":
                words.export()
            else:
                trigger(window, command)
            asks = asked == "export" and path == bench.take  # whether to keep a copy
            assert bench.errors == ([] if asks else [f"{path}: {what}; {OTHER_NAME}"]), command
            assert {path: path.read_bytes() for path in files} == before, (command, path)


def test_every_dialog_that_asks_where_to_write_is_guarded() -> None:
    """A new command that writes a file asks through `places.ask_where`, or checks it itself."""
    folder = Path(faceedit_app.ui.commands.__file__).parent
    asks = re.compile(r"dialogs\.(ask_(?:save_\w+|export|record_name))\(")
    direct = {
        f"{path.name}: {found}"
        for path in folder.glob("*.py")
        for found in asks.findall(path.read_text(encoding="utf-8"))
    }
    # Tracking checks its files before it begins; recordings are always new files.
    checked = {"file.py: ask_save_take", "live.py: ask_record_name", "webcam.py: ask_record_name"}
    assert direct == checked
