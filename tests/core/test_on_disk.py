"""What is on the disk, at paths that may be anything."""

from __future__ import annotations

from pathlib import Path

import pytest

from faceedit_app.core import on_disk


def test_files_and_folders_are_told_apart(tmp_path: Path) -> None:
    (tmp_path / "take.csv").write_text("")
    assert on_disk.exists(tmp_path / "take.csv")
    assert on_disk.is_file(tmp_path / "take.csv")
    assert not on_disk.is_folder(tmp_path / "take.csv")
    assert on_disk.is_folder(tmp_path)
    assert not on_disk.is_file(tmp_path)


@pytest.mark.parametrize("name", ["a" * 5000, "a/" * 5000, "a\0b", "\ud800", "x/../" * 3000])
def test_there_is_nothing_at_a_path_that_cannot_be(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    assert not on_disk.exists(path)
    assert not on_disk.is_file(path)
    assert not on_disk.is_folder(path)
