"""Whoever writes a file where one of another kind is, keeps a copy of that."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import random_rig
from support.speech import said
from support.takes import make_livelink_csv

from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.characters.map_file import CharacterMap, write_map
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.exporting import choose, export_take
from faceedit_app.editing.files.edits_file import write_edits
from faceedit_app.editing.files.fingerprint import Fingerprint
from faceedit_app.editing.files.project import Project, write_project
from faceedit_app.editing.steps import EditState
from faceedit_app.formats.opening import open_take
from faceedit_app.media.film_writer import film_format, writing
from faceedit_app.render.snapshot import write_png
from faceedit_app.words.files import write_words

EDIT = Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, 6.0)
OTHER = b"the only recording of the day"


def export(path: Path) -> Path | None:
    take = open_take(make_livelink_csv(path.parent / "source.csv", seconds=0.5))
    return export_take(take, take.clip, path, choose(path)).backup


def film(path: Path) -> Path | None:
    with writing(path, film_format(path), (64, 64), 25.0, None) as out:
        out.add(np.zeros((64, 64, 3), np.uint8))
    return out.backup


WRITERS: dict[str, tuple[str, Callable[[Path], Path | None]]] = {
    "project": (
        "a.faceedit",
        lambda path: write_project(path, Project(path, Fingerprint(1, "0"), EditState())),
    ),
    "edits": ("a.json", lambda path: write_edits(path, [EDIT])),
    "picture": ("a.png", lambda path: write_png(path, np.zeros((2, 2, 3), np.uint8))),
    "TextGrid": ("a.TextGrid", lambda path: write_words(path, said(("map", "M AE P")), 2.0)),
    "subtitles": ("a.srt", lambda path: write_words(path, said(("map", "M AE P")), 2.0)),
    "words": ("a.json", lambda path: write_words(path, said(("map", "M AE P")), 2.0)),
    "map": ("a.glb.map.json", lambda path: write_map(path, CharacterMap())),
    "character": ("a.glb", lambda path: write_rig(path, random_rig(4))),
    "film": ("a.mp4", film),
    "take": ("a.csv", export),
    "animation": ("a.glb", export),
    "scene": ("a.usda", export),
}


@pytest.mark.parametrize(("name", "write"), WRITERS.values(), ids=WRITERS)
def test_a_copy_is_kept_of_a_file_of_another_kind_only_and_its_name_returned(
    tmp_path: Path, name: str, write: Callable[[Path], Path | None]
) -> None:
    path = tmp_path / name
    backup = path.with_name(f"{name}.bak")
    path.write_bytes(OTHER)
    assert write(path) == backup
    assert backup.read_bytes() == OTHER
    backup.unlink()
    assert write(path) is None
    path.write_bytes(b"")  # which holds nothing to keep
    assert write(path) is None
    assert not backup.exists()


def test_a_list_of_edits_is_no_project_and_the_other_way_round(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    project = Project(path, Fingerprint(1, "0"), replace(EditState(), edits=(EDIT,)))
    write_edits(path, [EDIT])
    assert write_project(path, project) == tmp_path / "a.json.bak"
    assert write_edits(path, [EDIT]) == tmp_path / "a.json.bak2"
