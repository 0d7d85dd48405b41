"""A recording is never replaced by mistake, and never without a copy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from support.sessions import session_by_networks
from support.takes import make_livelink_csv

from faceedit_app.core.atomic import keep_backup
from faceedit_app.core.errors import FileError
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files.originals import why_keep
from faceedit_app.editing.files.project import Project, Whereabouts, locate_take, write_project
from faceedit_app.editing.session import EditSession

EDIT = Edit(("mouth_opening",), Op.OFFSET, 0.5, 1.0, 0.1, 5.0)


@pytest.fixture
def take(tmp_path: Path) -> Path:
    (tmp_path / "takes").mkdir()
    return make_livelink_csv(tmp_path / "takes" / "take.csv")


@pytest.fixture
def session(take: Path) -> EditSession:
    session = session_by_networks(take)
    session.add(EDIT)
    return session


def save_project(session: EditSession, path: Path) -> None:
    write_project(path, Project(session.take.path, session.fingerprint, session.state))


def test_the_open_take_is_not_replaced(session: EditSession, take: Path) -> None:
    before = take.read_bytes()
    link = take.with_name("link.csv")
    link.symlink_to(take)
    for name in (take, link, take.parent / "." / "take.csv"):
        with pytest.raises(FileError, match=r"is the recording itself; choose another name$"):
            session.export(name)
    assert take.read_bytes() == before


def test_overwriting_the_open_take_keeps_a_copy(session: EditSession, take: Path) -> None:
    before = take.read_bytes()
    assert session.export(take, overwrite=True) == take.with_name("take.csv.bak")
    assert take.read_bytes() != before
    assert take.with_name("take.csv.bak").read_bytes() == before


def test_the_take_of_a_project_is_not_replaced(session: EditSession, take: Path) -> None:
    save_project(session, take.with_name("scene.faceedit"))
    take.with_name("broken.faceedit").write_text("{")
    other = session_by_networks(make_livelink_csv(take.with_name("other.csv"), seconds=1))
    with pytest.raises(FileError, match=r"is the recording of the project scene\.faceedit"):
        other.export(take)
    other.export(take, overwrite=True)
    assert take.with_name("take.csv.bak").exists()


def test_projects_elsewhere_are_looked_into_if_they_are_known(
    session: EditSession, take: Path, tmp_path: Path
) -> None:
    (tmp_path / "projects").mkdir()
    project = tmp_path / "projects" / "scene.faceedit"
    save_project(session, project)
    other = tmp_path / "other.csv"
    assert why_keep(take, other) == ""
    assert "scene.faceedit" in why_keep(take, other, [project])


def test_other_files_are_replaced_without_a_copy(session: EditSession, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    assert session.export(out) is None
    session.add(replace(EDIT, value=2.0))
    assert session.export(out) is None  # an earlier export
    assert [path.name for path in tmp_path.glob("*.bak*")] == []


def test_a_project_finds_the_recording_that_was_overwritten(
    session: EditSession, take: Path
) -> None:
    project = Project(take, session.fingerprint, session.state)
    session.export(take, overwrite=True)
    located = locate_take(project, take.with_name("scene.faceedit"))
    assert located.where is Whereabouts.CHANGED
    assert located.others == (take.with_name("take.csv.bak"),)


def test_an_earlier_copy_is_never_replaced(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    for content in ("one", "two", "two", "three"):
        path.write_text(content)
        keep_backup(path)
    kept = {p.name: p.read_text() for p in tmp_path.iterdir() if p != path}
    assert kept == {"take.csv.bak": "one", "take.csv.bak2": "two", "take.csv.bak3": "three"}


def test_nothing_is_replaced_if_the_copy_fails(
    session: EditSession, take: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = take.read_bytes()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("shutil.copy2", full)
    with pytest.raises(FileError, match=r"take\.csv\.bak: cannot be written \(no space left"):
        session.export(take, overwrite=True)
    assert take.read_bytes() == before
