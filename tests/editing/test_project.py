"""Project files: what is saved comes back, and the take is found again."""

from __future__ import annotations

import json
import os
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.edits import edits
from support.sessions import session_by_rig
from support.speech import said
from support.takes import make_livelink_csv, make_plain_csv

from faceedit_app.core.errors import FileError
from faceedit_app.core.resources import shipped
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.media import MediaFile
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.files import fingerprint as fingerprint_module
from faceedit_app.editing.files.fingerprint import Fingerprint, fingerprint
from faceedit_app.editing.files.project import (
    Project,
    ViewState,
    Whereabouts,
    locate_take,
    read_project,
    write_project,
)
from faceedit_app.editing.steps import EditState

EDITS = (
    Edit(("mouth_opening",), Op.OFFSET, 2.0, 2.4, 0.2, 8.0, name="Größer"),
    Edit(("left_eyelid", "right_eyelid"), Op.SET, 4.0, 4.1, 0.1, 0.0, 0.2, 0.5, False),
    Edit(("mouth_width",), Op.DRAW, 1.0, 2.0, 0.1, points=((1.0, 3.0), (2.0, 4.0))),
)
VIEW = ViewState(1.5, (0.0, 5.0), (2.0, 2.4), 0.3, {"splitter": [1, 2], "dark": True})


@pytest.fixture
def take(tmp_path: Path) -> Path:
    folder = tmp_path / "shoot" / "takes"
    folder.mkdir(parents=True)
    (folder / "take 1.csv").write_text("a take\n")
    (folder / "take 1.mov").write_text("a film\n")
    return folder / "take 1.csv"


def project_of(take: Path, **changes: Any) -> Project:
    return replace(
        Project(
            take=take,
            fingerprint=fingerprint(take),
            state=EditState(EDITS, Settings(Mode.RESYNTHESIZE, 0.5, 0.25)),
            view=VIEW,
            audio=MediaFile(take.with_suffix(".mov"), -0.25),
            film=MediaFile(take.with_suffix(".mov"), 0.5),
        ),
        **changes,
    )


def test_project_comes_back_as_it_was_saved(take: Path, tmp_path: Path) -> None:
    for path in (take.parent / "p.faceedit", tmp_path / "p.faceedit", tmp_path / "ä b.faceedit"):
        write_project(path, project_of(take))
        assert read_project(path) == project_of(take)


def test_bare_project_comes_back(take: Path, tmp_path: Path) -> None:
    bare = Project(take, fingerprint(take))
    write_project(tmp_path / "p.faceedit", bare)
    assert read_project(tmp_path / "p.faceedit") == bare


@given(st.lists(edits(), max_size=4))
@settings(
    deadline=None,
    derandomize=True,
    max_examples=25,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_any_edits_come_back(tmp_path: Path, some: list[Edit]) -> None:
    project = Project(tmp_path / "take.csv", Fingerprint(1, "0"), EditState(tuple(some)))
    write_project(tmp_path / "p.faceedit", project)
    assert read_project(tmp_path / "p.faceedit") == project


def test_file_is_for_people_too(take: Path, tmp_path: Path) -> None:
    write_project(tmp_path / "p.faceedit", project_of(take))
    text = (tmp_path / "p.faceedit").read_text(encoding="utf-8")
    document = json.loads(text)
    assert document["take"]["path"] == "shoot/takes/take 1.csv"
    assert document["audio"] == {"path": "shoot/takes/take 1.mov", "offset": -0.25}
    assert sum('"op"' in line for line in text.splitlines()) == len(EDITS)
    assert str(tmp_path) not in text


def test_project_and_take_move_together(take: Path, tmp_path: Path) -> None:
    write_project(tmp_path / "shoot" / "p.faceedit", project_of(take))
    shutil.move(tmp_path / "shoot", tmp_path / "elsewhere")
    moved = tmp_path / "elsewhere" / "p.faceedit"
    project = read_project(moved)
    assert project.take == tmp_path / "elsewhere" / "takes" / "take 1.csv"
    assert project.film is not None
    assert project.film.path.exists()
    assert locate_take(project, moved).where is Whereabouts.FOUND


def test_saving_over_a_project_that_cannot_be_written_leaves_it(take: Path, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot be written"):
        write_project(tmp_path / "none" / "p.faceedit", project_of(take))


# --- damaged files -------------------------------------------------------------------------------


def nested(depth: int) -> list[Any]:
    return [nested(depth - 1)] if depth else []


GOOD: dict[str, Any] = {
    "version": 1,
    "take": {"path": "take.csv", "size": 5, "sha256": "00"},
    "edits": [],
}
BAD: dict[str, tuple[Any, str]] = {
    "list": ([], "is not a valid FaceEdit project"),
    "no version": ({}, "version None"),
    "later version": (GOOD | {"version": 2}, "update FaceEdit"),
    "unknown field": (GOOD | {"camera": 1}, 'unknown field "camera"'),
    "no take": ({"version": 1, "edits": []}, '"take" is missing'),
    "take without a path": (GOOD | {"take": {"size": 5, "sha256": ""}}, '"take.path" is missing'),
    "take without a size": (GOOD | {"take": {"path": "x", "sha256": ""}}, '"take.size" is missing'),
    "truth as size": (
        GOOD | {"take": {"path": "x", "size": True, "sha256": ""}},
        '"take.size" is not',
    ),
    "nul in the path": (
        GOOD | {"take": {"path": "x\0", "size": 1, "sha256": ""}},
        '"take.path" is not',
    ),
    "no edits": (GOOD | {"edits": None}, '"edits"'),
    "bad edit": (GOOD | {"edits": [{"control": "nose"}]}, "edit 1: "),
    "edit is a number": (GOOD | {"edits": [3]}, "edit 1: "),
    "bad mode": (GOOD | {"settings": {"mode": "x"}}, '"settings.mode" must be one of'),
    "list as mode": (GOOD | {"settings": {"mode": []}}, '"settings.mode" must be one of'),
    "wild naturalness": (
        GOOD | {"settings": {"naturalness": 7}},
        '"settings.naturalness" must be',
    ),
    "settings are a list": (GOOD | {"settings": []}, '"settings" is not an object'),
    "unknown setting": (GOOD | {"settings": {"x": 1}}, 'unknown field "settings.x"'),
    "view is a text": (GOOD | {"view": "x"}, '"view" is not an object'),
    "playhead is a text": (GOOD | {"view": {"playhead": "x"}}, '"view.playhead" is not a number'),
    "playhead is none": (GOOD | {"view": {"playhead": float("nan")}}, '"view.playhead" must be'),
    "negative falloff": (GOOD | {"view": {"falloff": -1}}, '"view.falloff" must be'),
    "half a selection": (
        GOOD | {"view": {"selection": [1]}},
        '"view.selection" is not a list of pairs',
    ),
    "selection backwards": (GOOD | {"view": {"selection": [2, 1]}}, "ends before it begins"),
    "endless list in ui": (GOOD | {"view": {"ui": {"a": nested(9)}}}, '"view.ui" holds too much'),
    "no number in ui": (GOOD | {"view": {"ui": {"a": [float("nan")]}}}, '"view.ui" holds a number'),
    "no character in ui": (GOOD | {"view": {"ui": {"\ud800": 1}}}, '"view.ui" has a damaged'),
    "no character in a path": (
        GOOD | {"take": {"path": "\ud800", "size": 1, "sha256": ""}},
        "path",
    ),
    "ui is a list": (GOOD | {"view": {"ui": []}}, '"view.ui" is not an object'),
    "audio is a text": (GOOD | {"audio": "x.wav"}, '"audio" is not an object'),
    "film without a path": (GOOD | {"film": {"offset": 1}}, '"film.path" is missing'),
    "offset is a text": (GOOD | {"film": {"path": "x", "offset": "1"}}, '"film.offset" is not'),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_project_is_reported_in_one_line(tmp_path: Path, name: str) -> None:
    document, reason = BAD[name]
    path = tmp_path / "p.faceedit"
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(FileError) as caught:
        read_project(path)
    text = str(caught.value)
    assert reason in text
    assert text.startswith(str(path))
    assert len(text.splitlines()) == 1
    assert "; " in text, "no remedy"


def test_project_cut_off_anywhere_is_reported(take: Path, tmp_path: Path) -> None:
    path = tmp_path / "p.faceedit"
    write_project(path, project_of(take))
    content = path.read_bytes().rstrip()
    for length in range(0, len(content), 7):
        path.write_bytes(content[:length])
        with pytest.raises(FileError):
            read_project(path)


# --- where the take is ---------------------------------------------------------------------------


def saved(take: Path, tmp_path: Path) -> tuple[Project, Path]:
    path = tmp_path / "shoot" / "p.faceedit"
    write_project(path, project_of(take))
    return read_project(path), path


def test_take_in_its_place_is_found(take: Path, tmp_path: Path) -> None:
    project, path = saved(take, tmp_path)
    located = locate_take(project, path)
    assert (located.where, located.path, located.message) == (Whereabouts.FOUND, take, "")


@pytest.mark.parametrize(
    "place",
    ["shoot/take 1.csv", "shoot/takes/new name.csv", "shoot/takes/day 2/take 1.csv", "take 1.csv"],
)
def test_moved_take_is_found_by_its_content(take: Path, tmp_path: Path, place: str) -> None:
    project, path = saved(take, tmp_path)
    (tmp_path / place).parent.mkdir(exist_ok=True)
    take.rename(tmp_path / place)
    (take.parent / "other.csv").write_text("6 bytes")
    located = locate_take(project, path)
    assert (located.where, located.path) == (Whereabouts.MOVED, tmp_path / place)
    assert place.rsplit("/", 1)[-1] in located.message


def test_the_copy_of_the_same_name_is_preferred(take: Path, tmp_path: Path) -> None:
    project, path = saved(take, tmp_path)
    shutil.copy(take, take.with_name("a copy.csv"))
    take.rename(tmp_path / "shoot" / "take 1.csv")
    assert locate_take(project, path).path == tmp_path / "shoot" / "take 1.csv"


def test_changed_take_is_reported_and_the_old_one_offered(take: Path, tmp_path: Path) -> None:
    project, path = saved(take, tmp_path)
    shutil.copy(take, take.with_name("old.csv"))
    take.write_text("another\n")
    located = locate_take(project, path)
    assert (located.where, located.path) == (Whereabouts.CHANGED, take)
    assert located.others == (take.with_name("old.csv"),)
    assert "changed" in located.message
    take.with_name("old.csv").unlink()
    assert locate_take(project, path).others == ()


def test_missing_take_is_reported_and_files_of_its_name_offered(take: Path, tmp_path: Path) -> None:
    project, path = saved(take, tmp_path)
    take.unlink()
    located = locate_take(project, path)
    assert (located.where, located.path, located.others) == (Whereabouts.MISSING, None, ())
    other = tmp_path / "shoot" / "take 1.csv"
    other.write_text("another")
    assert locate_take(project, path).others == (other,)
    assert len(located.message.splitlines()) == 1


def test_a_backup_beside_the_project_is_preferred_to_a_copy_elsewhere(
    take: Path, tmp_path: Path
) -> None:
    project, path = saved(take, tmp_path)
    (tmp_path / "copies").mkdir()
    shutil.copy(take, tmp_path / "copies" / take.name)
    near = take.rename(take.with_name(f"{take.name}.bak"))
    assert locate_take(project, path).path == near


def test_search_ends_where_folders_run_in_circles(take: Path, tmp_path: Path) -> None:
    project, path = saved(take, tmp_path)
    take.unlink()
    (tmp_path / "shoot" / "circle").symlink_to(tmp_path, target_is_directory=True)
    (tmp_path / "shoot" / "gone.csv").symlink_to(tmp_path / "nothing")
    assert locate_take(project, path).where is Whereabouts.MISSING


def test_search_ends_when_its_time_is_over(
    take: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    project, path = saved(take, tmp_path)
    take.rename(tmp_path / "take 1.csv")
    monkeypatch.setattr(fingerprint_module, "SEARCH_SECONDS", -1.0)
    assert locate_take(project, path).where is Whereabouts.MISSING


def test_fingerprint_of_an_open_take_is_that_of_the_file_it_was(tmp_path: Path) -> None:
    paths = [shipped("assets/demo_take.csv")]
    paths.append(make_livelink_csv(tmp_path / "crlf.csv", newline="\r\n", untracked=(3, 4)))
    paths.append(make_plain_csv(tmp_path / "plain.csv"))
    cut = tmp_path / "cut.csv"
    cut.write_bytes(b"\xef\xbb\xbf" + paths[-1].read_bytes().rstrip())
    for path in [*paths, cut]:
        was, session = fingerprint(path), session_by_rig(path)
        if path.parent == tmp_path:
            path.unlink()
        assert session.fingerprint == was


def test_unreadable_take_is_reported(take: Path, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot be read"):
        fingerprint(tmp_path)
    if os.geteuid() != 0:
        project, path = saved(take, tmp_path)
        take.chmod(0)
        assert locate_take(project, path).where is Whereabouts.MISSING


def test_words_are_part_of_a_project(take: Path, tmp_path: Path) -> None:
    words = said(("map", "M AE P"))
    project = project_of(take)
    project = replace(project, state=replace(project.state, words=words))
    path = tmp_path / "scene.faceedit"
    write_project(path, project)
    assert read_project(path).state.words == words
    document = json.loads(path.read_text())
    document["words"]["version"] = 2
    path.write_text(json.dumps(document))
    with pytest.raises(FileError, match="newer FaceEdit"):
        read_project(path)
