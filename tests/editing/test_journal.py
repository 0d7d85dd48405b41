"""The journal: what was done survives whatever ends the program."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from support.speech import said

from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.resources import shipped
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.files import journal as journal_module
from faceedit_app.editing.files.fingerprint import KnownFile, fingerprint
from faceedit_app.editing.files.journal import Journal
from faceedit_app.editing.files.pending import open_elsewhere, pending_journals
from faceedit_app.editing.steps import EditState, Origin

DEMO = shipped("assets/demo_take.csv")


def edit(number: int) -> Edit:
    return Edit(("mouth_opening",), Op.OFFSET, float(number), number + 0.5, 0.2, 1.0)


A, B, C = edit(1), edit(2), edit(3)
DRAWN = Edit(("mouth_width",), Op.DRAW, 1.0, 2.0, 0.1, name="ü", points=((1.0, 3.0), (2.0, 4.0)))
RETIME = Edit(CONTROL_IDS, Op.RETIME, 1.0, 3.0, 0.0, pins=((1.5, 1.4), (2.0, 2.0), (2.0, 2.25)))
WORDS = said(("map", "M AE P"))
STATES = [
    EditState((A,)),
    EditState((A, B)),
    EditState((A, B, C, DRAWN)),
    EditState((A, C, DRAWN)),
    EditState((C, A, DRAWN), Settings(naturalness=0.5)),
    EditState((C, replace(A, strength=0.5), DRAWN), Settings(naturalness=0.5)),
    EditState(()),
    EditState((A, A, A)),
    EditState((A, A), Settings(reach=0.0)),
    EditState(
        (A, A), media=Placement(MediaFile(Path("/ü.wav"), 0.25), MediaFile(Path("/b.mov"), -1.0))
    ),
    EditState((A, B), media=Placement(film=MediaFile(Path("/b.mov"), -1.0))),
    EditState((A, B), media=Placement()),
    EditState((A, B)),
    EditState((A, B), words=WORDS),
    EditState((A,), words=WORDS),
    EditState((A,), words=WORDS.with_edge(0.52, 0.5)),
    EditState((A,)),
    EditState((A, RETIME)),
]


def crash(journal: Journal) -> Path:
    """Leave the file as a crash does: there, and not locked."""
    content = journal.path.read_bytes()
    journal.close()
    journal.path.write_bytes(content)
    return journal.path


@pytest.mark.parametrize("count", range(1, len(STATES) + 1))
def test_last_gesture_comes_back(tmp_path: Path, count: int) -> None:
    began = time.time()
    project = KnownFile(tmp_path / "p.faceedit", fingerprint(DEMO))
    origin = Origin(STATES[-count], 25.0, is_saved=count % 2 == 0)
    journal = Journal(DEMO, project, folder=tmp_path / "new" / "folder", origin=origin)
    for state in STATES[:count]:
        journal.record(state)
    assert journal.note == ""
    crash(journal)
    (pending,) = pending_journals(journal.path.parent)
    assert pending.state == STATES[count - 1]
    assert pending.gestures == count
    assert pending.take == DEMO.absolute()
    assert pending.fingerprint == fingerprint(DEMO)
    assert pending.project == project
    assert pending.origin == origin
    assert began - 1.0 <= pending.when <= time.time() + 1.0  # clocks of files are coarse
    pending.discard()
    assert pending_journals(journal.path.parent) == []


def test_file_cut_off_anywhere_gives_the_last_whole_gesture(tmp_path: Path) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    for state in STATES:
        journal.record(state)
    path = crash(journal)
    content = path.read_bytes()
    ends = [i + 1 for i, byte in enumerate(content) if byte == ord("\n")]
    near_ends = {end + n for end in ends for n in (-2, -1, 0, 1)}
    for length in sorted({*range(0, len(content), 7), *near_ends} - {len(content) + 1}):
        path.write_bytes(content[:length])
        whole = sum(end <= length for end in ends) - 1  # less the head
        pending = pending_journals(tmp_path)
        if whole < 1:
            assert pending == []
        else:
            assert pending[0].state == STATES[whole - 1]


@pytest.mark.parametrize("damage", [b"\0" * 20, b"{}", b'{"step": 3}', b"[1]", b"\xff\xfe", b"7"])
def test_damaged_line_costs_what_follows_and_no_more(tmp_path: Path, damage: bytes) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    for state in STATES:
        journal.record(state)
    path = crash(journal)
    lines = path.read_bytes().split(b"\n")
    path.write_bytes(b"\n".join([*lines[:3], damage, *lines[4:]]))
    assert pending_journals(tmp_path)[0].state == STATES[1]


def test_closed_and_saved_sessions_leave_nothing_to_recover(tmp_path: Path) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    journal.record(STATES[0])
    journal.close()
    journal.close()
    journal.record(STATES[1])  # too late, and no harm
    assert list(tmp_path.iterdir()) == []

    journal = Journal(DEMO, folder=tmp_path)
    journal.record(STATES[2])
    journal.saved(KnownFile(tmp_path / "p.faceedit", None))
    crash(journal)
    assert pending_journals(tmp_path) == []


def test_gestures_after_a_save_are_recovered_whole(tmp_path: Path) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    journal.record(STATES[2])
    project = KnownFile(tmp_path / "p.faceedit", fingerprint(DEMO))
    journal.saved(project, Origin(STATES[2]))
    journal.record(STATES[3])
    path = crash(journal)
    (pending,) = pending_journals(tmp_path)
    assert (pending.state, pending.gestures) == (STATES[3], 1)
    assert pending.project == project
    assert pending.origin == Origin(STATES[2])
    path.write_bytes(path.read_bytes().replace(b'"saved":true', b'"saved":7', 1))
    (damaged,) = pending_journals(tmp_path)
    assert (damaged.state, damaged.origin) == (STATES[3], None)


def test_the_character_that_was_shown_last_is_recovered(tmp_path: Path) -> None:
    first, second = tmp_path / "first.glb", tmp_path / "second.glb"
    journal = Journal(DEMO, folder=tmp_path, character=first)
    for shown, found in ((first, first), (second, second), (None, None), (second, second)):
        journal.showing(shown)
        journal.record(STATES[0])
        content = journal.path.read_bytes()
        copy = tmp_path / "copy" / "crashed.jsonl"
        copy.parent.mkdir(exist_ok=True)
        copy.write_bytes(content)
        assert pending_journals(copy.parent)[0].character == found
    journal.saved()
    journal.record(STATES[1])
    crash(journal)
    (pending,) = pending_journals(tmp_path)
    assert (pending.character, pending.state) == (second, STATES[1])


def test_a_journal_without_gestures_is_swept_away_although_it_names_a_character(
    tmp_path: Path,
) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    journal.showing(tmp_path / "head.glb")
    path = crash(journal)
    os.utime(path, (0, 0))
    assert pending_journals(tmp_path) == []
    assert not path.exists()


def test_running_session_is_left_alone(tmp_path: Path) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    journal.record(STATES[0])
    assert pending_journals(tmp_path) == []
    assert journal.path.exists()
    assert not open_elsewhere(journal, tmp_path)
    link = tmp_path / "link.csv"
    copy = Journal(DEMO.with_name(f"{DEMO.name}.bak2"), folder=tmp_path)
    assert open_elsewhere(journal, tmp_path) == copy.take, "the recording, after an export over it"
    assert open_elsewhere(copy, tmp_path) == DEMO
    copy.close()
    link.symlink_to(DEMO)
    second, other = (Journal(path, folder=tmp_path) for path in (link, tmp_path / "other.csv"))
    assert open_elsewhere(journal, tmp_path)
    assert open_elsewhere(second, tmp_path)
    assert not open_elsewhere(other, tmp_path)
    crash(second)
    assert not open_elsewhere(journal, tmp_path), "only a running session has it open"
    for one in (journal, other):
        one.close()


def test_foreign_files_are_no_journals(tmp_path: Path) -> None:
    assert pending_journals(tmp_path / "none") == []
    for name, text in {"a": "", "b": "x\n", "c": "{}\n", "d": '{"version": 9}\n{}\n'}.items():
        (tmp_path / f"{name}.jsonl").write_text(text)
    (tmp_path / "folder.jsonl").mkdir()
    old = tmp_path / "a.jsonl"
    os.utime(old, (0, 0))
    assert pending_journals(tmp_path) == []
    assert not old.exists(), "an empty one of long ago is swept away"
    assert (tmp_path / "b.jsonl").exists()


def test_folder_that_cannot_be_is_a_note(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    journal = Journal(DEMO, folder=tmp_path / "file" / "journals")
    assert "not being backed up" in journal.note
    assert len(journal.note.splitlines()) == 1
    journal.record(STATES[0])
    journal.saved()
    journal.close()


def test_missing_take_is_no_harm(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "gone.csv", folder=tmp_path)
    journal.record(STATES[0])
    crash(journal)
    assert pending_journals(tmp_path)[0].fingerprint is None


@pytest.mark.parametrize("half", [0, 25])
def test_full_disk_is_a_note_and_all_is_there_once_there_is_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, half: int
) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    journal.record(STATES[0])
    write = os.write

    def full(file: int, content: bytes) -> int:
        if half and len(content) > half:
            return write(file, content[:half])
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", full)
        journal.record(STATES[1])
        assert "no space left" in journal.note
        journal.record(STATES[2])
    journal.record(STATES[3])
    assert journal.note == ""
    journal.record(STATES[4])
    crash(journal)
    assert pending_journals(tmp_path)[0].state == STATES[4]


def test_crash_while_the_disk_is_full_keeps_what_was_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    journal.record(STATES[0])
    with monkeypatch.context() as patch:
        patch.setattr(os, "write", lambda *_: (_ for _ in ()).throw(OSError(errno.EIO, "I/O")))
        journal.record(STATES[1])
    crash(journal)
    assert pending_journals(tmp_path)[0].state == STATES[0]


def test_gesture_among_500_edits_is_written_without_a_wait(tmp_path: Path) -> None:
    edits = tuple(edit(i) for i in range(500))
    journal = Journal(DEMO, folder=tmp_path)
    journal.record(EditState(edits))
    took = []
    for i in range(50):
        edits = (*edits[:i], replace(edits[i], strength=0.5), *edits[i + 1 :])
        began = time.process_time()
        journal.record(EditState(edits))
        took.append(time.process_time() - began)
    assert min(took) < 0.005  # of the processor
    line = journal.path.read_bytes().splitlines()[-1]
    assert len(line) < 400
    crash(journal)
    assert pending_journals(tmp_path)[0].state.edits == edits


# --- a real process and a real kill -9 -----------------------------------------------------------

VICTIM = """
import sys, time
from pathlib import Path
sys.path.insert(0, {tests!r})
from support.sessions import session_by_rig, strengthen
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files.journal import Journal

session = session_by_rig(Path({take!r}))
journal = Journal(session.take.path, folder=Path({folder!r}))
session.stepped.connect(journal.record)
edit = lambda i, mm: Edit(("mouth_opening",), Op.OFFSET, i, i + 0.3, 0.1, mm)
for i in range(6):
    session.preview(edit(i, 1.0))
    session.preview(edit(i, 2.0))
    session.commit()
session.undo()
strengthen(session, 2, 0.5)
mm = 0.0
while True:  # in the middle of a drag
    mm += 0.1
    session.preview(edit(7, mm))
    print("dragging", flush=True)
"""


def test_kill_9_in_the_middle_of_a_drag_keeps_all_finished_gestures(tmp_path: Path) -> None:
    code = VICTIM.format(
        tests=str(Path(__file__).parents[1]), take=str(DEMO), folder=str(tmp_path / "journals")
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        assert process.stdout.readline() == "dragging\n"
        assert pending_journals(tmp_path / "journals") == [], "it still runs"
    finally:
        process.kill()
        process.wait(30)
        process.stdout.close()
    (pending,) = pending_journals(tmp_path / "journals")
    assert [e.start for e in pending.state.edits] == [0, 1, 2, 3, 4]
    assert [e.strength for e in pending.state.edits] == [1, 1, 0.5, 1, 1]
    assert {e.value for e in pending.state.edits} == {2.0}
    assert pending.gestures == 8
    assert pending.fingerprint == fingerprint(DEMO)


def test_journal_is_lines_that_people_can_read(tmp_path: Path) -> None:
    journal = Journal(DEMO, folder=tmp_path)
    journal.record(STATES[0])
    journal.record(STATES[1])
    head, first, second = (json.loads(line) for line in journal.path.read_text().splitlines())
    assert head["take"] == str(DEMO.absolute())
    assert [e["start"] for e in first["edits"]] == [1.0]
    assert (second["at"], second["drop"], len(second["add"])) == (1, 0, 1)
    journal.close()


def test_a_long_journal_is_shortened_and_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(journal_module, "_LONG", 4000)
    journal = Journal(DEMO, folder=tmp_path)
    states = [STATES[number % len(STATES)] for number in range(200)]
    longest = 0
    for number, state in enumerate(states):
        journal.record(state)
        longest = max(longest, journal.path.stat().st_size)
        assert journal.note == ""
        if number % 20 == 0:
            copy = tmp_path / "copy" / "crashed.jsonl"
            copy.parent.mkdir(exist_ok=True)
            copy.write_bytes(journal.path.read_bytes())
            assert pending_journals(copy.parent)[0].state == state
    assert longest < 10_000
    assert pending_journals(tmp_path) == [], "it still runs"
    assert [path.name for path in tmp_path.glob("*.new")] == []
    left = tmp_path / "left.new"
    left.write_bytes(b"")
    os.utime(left, (0, 0))
    assert pending_journals(tmp_path) == []
    assert not left.exists()
    journal.close()
    assert [*tmp_path.glob("*.jsonl")] == []
