"""Edits are never applied twice, dropped silently, or answered by half of the program."""

from __future__ import annotations

import threading
import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from support.faces import random_engine
from support.windows import Bench, add_edit, session_of, trigger

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files import journal
from faceedit_app.editing.files.journal import Journal
from faceedit_app.editing.files.pending import pending_journals
from faceedit_app.editing.files.project import read_project
from faceedit_app.editing.history import EDITS, RATE
from faceedit_app.editing.steps import EditState
from faceedit_app.formats.opening import open_take
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.dialogs import Changed, Recover
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state import loading

WIDER = Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, 6.0)


class Crash:
    """Crashes and what the next start is asked.

    Attributes:
        asked: the messages of the question which take to use.
        answer: the take that the user shows; None cancels.
    """

    def __init__(self, bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
        self.bench = bench
        # No other test's folder beside this one has the same take.
        content = bench.take.read_bytes()
        assert b"RightEyeRoll" in content
        name = uuid.uuid4().hex.encode()
        bench.take.write_bytes(content.replace(b"RightEyeRoll", name))
        self.asked: list[str] = []
        self.answer: Path | None = None
        monkeypatch.setattr(dialogs, "ask_recover", lambda *_: Recover.RECOVER)
        monkeypatch.setattr(dialogs, "ask_take_of_project", self._ask)

    def _ask(self, _parent: object, message: str, likely: Sequence[Path], _in: Path) -> Path | None:
        self.asked.append(message)
        return self.answer

    def kill(self, window: MainWindow) -> None:
        """End a window as kill -9 would: its journal stays."""
        (path,) = self.folder.glob("*.jsonl")
        content = path.read_bytes()
        window.document.session = None
        window.close()
        path.write_bytes(content)

    @property
    def folder(self) -> Path:
        return self.bench.folder / "journals"

    def start_again(self) -> MainWindow:
        """The next start, once recovery is over."""
        window = self.bench.window()
        self.bench.qtbot.waitUntil(
            lambda: bool(self.asked) or window.document.session is not None, timeout=15_000
        )
        return window


@pytest.fixture
def crash(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> Crash:
    return Crash(bench, monkeypatch)


def exported_over_then_edited(bench: Bench) -> MainWindow:
    """A window whose edits were exported over their take, and then one more edit."""
    window = bench.editing()
    add_edit(window)
    bench.answers |= {"export": bench.take, "overwrite": Changed.REPLACE}
    trigger(window, "export")
    add_edit(window, -2.0)
    return window


def lose_backup(bench: Bench) -> None:
    """Delete the copy of the take that the export made."""
    bench.take.with_name("take.csv.bak").unlink()


def test_edits_that_were_exported_over_their_take_are_not_applied_to_it_again(
    bench: Bench, crash: Crash
) -> None:
    crash.kill(exported_over_then_edited(bench))
    lose_backup(bench)
    window = crash.start_again()
    assert "already holds these edits" in crash.asked[0]
    assert window.document.session is None
    assert len(pending_journals(crash.folder)) == 1, "they can still be recovered"


def test_the_take_from_before_an_export_over_it_is_found_beside_it(
    bench: Bench, crash: Crash
) -> None:
    window = exported_over_then_edited(bench)
    shown = session_of(window).weights.copy()
    crash.kill(window)
    window = crash.start_again()
    assert not crash.asked
    assert window.document.path == bench.take.with_name("take.csv.bak")
    assert "take.csv.bak, the take without the edits, is open" in window.banner.text.text()
    assert (session_of(window).weights == shown).all()


def test_a_project_is_not_applied_to_an_export_of_its_own(bench: Bench, crash: Crash) -> None:
    window = exported_over_then_edited(bench)
    project = bench.answers["save_project"] = bench.folder / "scene.faceedit"
    trigger(window, "save")
    window.close()
    lose_backup(bench)
    window = bench.window()
    window.commands.file.open_if_saved(project)
    bench.qtbot.waitUntil(lambda: bool(crash.asked or bench.errors), timeout=15_000)
    assert not bench.errors
    assert "already holds these edits" in crash.asked[0]
    assert window.document.session is None


def test_a_project_whose_recording_was_overwritten_opens_without_anything_to_save(
    bench: Bench,
) -> None:
    window = exported_over_then_edited(bench)
    project = bench.answers["save_project"] = bench.folder / "scene.faceedit"
    trigger(window, "save")
    assert window.close()
    window = bench.window()
    window.commands.file.open_if_saved(project)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert window.document.path == bench.take.with_name("take.csv.bak")
    assert "take.csv.bak, the take without the edits, is open" in window.banner.text.text()
    assert not window.isWindowModified()
    add_edit(window)
    assert window.isWindowModified()
    trigger(window, "undo")
    assert not window.isWindowModified()
    assert window.close(), "opening is no edit to ask about"


def test_a_take_that_was_renamed_after_a_crash_is_found_by_its_content(
    bench: Bench, crash: Crash, qtlog: Any
) -> None:
    window = bench.editing()
    add_edit(window)
    crash.kill(window)
    renamed = bench.take.rename(bench.folder / "anna_07.csv")
    window = crash.start_again()
    assert window.document.path == renamed
    assert len(session_of(window).edits) == 1
    assert window.isWindowModified()
    assert not [line for line in qtlog.records if "setWindowModified" in line.message]


def test_the_user_can_show_where_a_take_is_after_a_crash(
    bench: Bench, crash: Crash, tmp_path_factory: pytest.TempPathFactory
) -> None:
    window = bench.editing()
    add_edit(window)
    crash.kill(window)
    crash.answer = bench.take.rename(tmp_path_factory.mktemp("elsewhere") / "take.csv")
    window = crash.start_again()
    bench.qtbot.waitUntil(lambda: window.document.session is not None, timeout=15_000)
    assert "is missing; show where" in crash.asked[0]
    assert window.document.path == crash.answer
    assert len(pending_journals(crash.folder)) == 0


def test_edits_that_were_recovered_before_another_crash_are_offered_once(
    bench: Bench, tmp_path: Path
) -> None:
    contents = []
    for _ in range(2):
        recording = Journal(bench.take, folder=tmp_path / "j")
        recording.record(EditState((WIDER,)))
        contents.append(recording.path.read_bytes())
        recording.close()
    for number, content in enumerate(contents):
        (tmp_path / "j" / f"{number}.jsonl").write_bytes(content)
    assert len(pending_journals(tmp_path / "j")) == 1
    assert len([*(tmp_path / "j").iterdir()]) == 1


@pytest.mark.parametrize("answer", [Changed.REPLACE, Changed.CANCEL, Changed.ELSEWHERE])
def test_a_project_that_another_window_saved_is_not_replaced_silently(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, answer: Changed
) -> None:
    asked: list[str] = []

    def ask(_parent: object, changed: Path) -> Changed:
        asked.append(changed.name)
        return answer

    monkeypatch.setattr(dialogs, "ask_changed", ask)
    first = bench.editing()
    add_edit(first)
    path = bench.answers["save_project"] = bench.folder / "scene.faceedit"
    trigger(first, "save")
    second = bench.window()
    second.commands.file.open_if_saved(path)
    bench.qtbot.waitUntil(lambda: second.document.session is not None, timeout=15_000)
    add_edit(second, 3.0)
    trigger(second, "save")
    assert not asked
    of_second = path.read_bytes()
    add_edit(first, -1.0)
    if answer is Changed.ELSEWHERE:
        bench.answers["save_project"] = bench.folder / "mine.faceedit"
    trigger(first, "save")
    assert asked == ["scene.faceedit"]
    assert (path.read_bytes() == of_second) is (answer is not Changed.REPLACE)
    assert first.isWindowModified() is (answer is Changed.CANCEL)
    trigger(first, "save")
    assert len(asked) == (2 if answer is Changed.CANCEL else 1)


def test_a_project_replaced_from_another_window_is_kept_and_its_own_window_asks(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, bool]] = []

    def ask(_parent: object, message: str, _more: str, **buttons: bool) -> dialogs.Unsaved:
        asked.append((message, buttons["asks"]))
        return dialogs.Unsaved.CANCEL if len(asked) < 3 else dialogs.Unsaved.SAVE

    monkeypatch.setattr(dialogs, "ask_unsaved", ask)
    first, second = bench.editing(), bench.editing()
    path = bench.answers["save_project"] = bench.folder / "scene.faceedit"
    add_edit(second, 3.0)
    trigger(second, "save")
    of_second = path.read_bytes()
    add_edit(first)
    bench.answers["save_project"] = path
    trigger(first, "save")
    assert "the file that was there is now scene.faceedit.bak" in first.status.currentMessage()
    assert path.with_name("scene.faceedit.bak").read_bytes() == of_second
    trigger(first, "save")
    assert len([*bench.folder.glob("*.bak*")]) == 1, "its own needs no copy"
    assert not second.close()
    assert asked[0][0].startswith("scene.faceedit does not hold your work on take.csv any more")
    path.write_bytes(of_second.replace(b'"playhead": 0', b'"playhead": 1'))
    assert second.document.was_changed(path)
    assert not second.document.loses_by_closing, "only the view is another"
    path.unlink()
    add_edit(second, 1.0)
    assert not second.close()
    assert second.close()
    assert [asks for _, asks in asked] == [True, False, False]
    assert len(read_project(path).state.edits) == 2, "saved again where it was"


def test_a_second_window_on_the_take_says_so(bench: Bench) -> None:
    first, second = bench.editing(), bench.editing()
    assert "also open in another window" not in first.banner.text.text()
    assert "take.csv is also open in another window" in second.banner.text.text()


@pytest.mark.parametrize("answer", Changed)
def test_a_take_that_another_program_changed_is_not_replaced_silently(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, answer: Changed
) -> None:
    reasons: list[str] = []
    other = bench.folder / "other.csv"

    def ask(_parent: object, _path: Path, reason: str) -> Changed:
        reasons.append(reason)
        bench.answers["export"] = other  # if another name is asked for
        return answer

    monkeypatch.setattr(dialogs, "ask_overwrite", ask)
    window = bench.editing()
    add_edit(window)
    changed = bench.take.read_bytes().replace(b"12:00:00", b"12:00:01")
    bench.take.write_bytes(changed)
    bench.answers["export"] = bench.take
    trigger(window, "export")
    assert reasons == ["has been changed by another program since it was opened"]
    is_replaced = answer is Changed.REPLACE
    kept = bench.take.with_name("take.csv.bak") if is_replaced else bench.take
    assert kept.read_bytes() == changed
    assert other.exists() is (answer is Changed.ELSEWHERE)


def test_an_export_waits_for_the_networks(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    loaded = threading.Event()

    def load(_rig: object) -> object:
        assert loaded.wait(15)
        return random_engine()

    monkeypatch.setattr(loading, "load_engine", load)
    window = bench.window(start=False)
    window.start(bench.take)
    bench.qtbot.waitUntil(lambda: window.document.session is not None, timeout=15_000)
    add_edit(window)
    early = bench.answers["export"] = bench.folder / "early.csv"
    window.workspace.message.connect(lambda _text: loaded.set())
    trigger(window, "export")
    assert session_of(window).has_engine
    late = bench.answers["export"] = bench.folder / "late.csv"
    trigger(window, "export")
    assert early.read_bytes() == late.read_bytes()
    assert (open_take(early).clip.weights != open_take(bench.take).clip.weights).any()


def test_a_start_survives_any_journal(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = bench.folder / "journals"
    folder.mkdir()
    monkeypatch.setattr(journal, "journal_folder", lambda: folder)
    for number, content in enumerate(
        [b"[" * 100_000 + b"\n", b"[]\n{}\n", b'{"version":1,"take":7}\n', b"\xff\n", b"1e999\n"]
    ):
        (folder / f"{number}.jsonl").write_bytes(content + b'{"step":1}\n')
    window = bench.editing()
    assert window.document.session is not None


def test_a_preview_of_an_open_dialog_is_not_exported(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    exported = bench.answers["export"] = bench.folder / "exported.csv"
    trigger(window, "export")
    wanted = exported.read_bytes()
    window.document.preview(WIDER)  # as the slider of a dialog does
    bench.answers["export"] = exported
    trigger(window, "export")
    assert exported.read_bytes() == wanted
    assert not session_of(window).is_previewing


@pytest.mark.parametrize("edits", [0, 1])
def test_a_frame_rate_survives_a_crash_and_a_single_undo_takes_all_back(
    edits: int, bench: Bench, crash: Crash, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    if edits:
        add_edit(window)
    monkeypatch.setattr(dialogs, "ask_rate", lambda *_: 50.0)
    trigger(window, "frame_rate")
    crash.kill(window)
    window = crash.start_again()
    assert session_of(window).take.clip.rate == 50
    session = session_of(window)
    assert session.unsaved == (EDITS, RATE)[1 - edits :]
    trigger(window, "undo")
    assert session_of(window).take.clip.rate == 60
    assert session_of(window).is_saved
    assert not session_of(window).can_undo
    assert "Undo" not in window.status.currentMessage()
    trigger(window, "redo")
    assert session_of(window).take.clip.rate == 50
    assert session_of(window).state == session.state


@pytest.mark.parametrize("way", ["a crash", "another frame rate"])
def test_the_project_of_another_window_is_asked_about_after(
    way: str, bench: Bench, crash: Crash, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What brings the take back into the window still knows how the project was read."""
    asked: list[str] = []

    def ask(_parent: object, changed: Path) -> Changed:
        asked.append(changed.name)
        return Changed.CANCEL

    monkeypatch.setattr(dialogs, "ask_changed", ask)
    window = bench.editing()
    add_edit(window)
    path = bench.answers["save_project"] = bench.folder / "scene.faceedit"
    trigger(window, "save")
    add_edit(window, 3.0)
    if way == "a crash":
        crash.kill(window)
    of_other = path.read_bytes().replace(b'"value": 6.0', b'"value": 5.0')
    path.write_bytes(of_other)
    if way == "a crash":
        window = crash.start_again()
        bench.qtbot.waitUntil(lambda: window.document.session is not None, timeout=15_000)
    else:
        before = session_of(window)
        monkeypatch.setattr(dialogs, "ask_rate", lambda *_: 50.0)
        trigger(window, "frame_rate")
        bench.qtbot.waitUntil(lambda: session_of(window) is not before, timeout=15_000)
    assert window.document.project == path
    trigger(window, "save")
    assert asked == ["scene.faceedit"]
    assert path.read_bytes() == of_other
