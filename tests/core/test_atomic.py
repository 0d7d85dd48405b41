"""A file is written whole or not at all."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from faceedit_app.core.atomic import keep_backup, remove_leftovers, write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.core.filelock import lock


def test_a_file_is_replaced_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    write_atomically(path, b"first")
    path.chmod(0o640)
    write_atomically(path, b"second")
    assert path.read_bytes() == b"second"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert [p.name for p in tmp_path.iterdir()] == ["take.csv"]


def test_a_link_goes_on_pointing_to_the_file_that_is_written(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    real, link = tmp_path / "real" / "take.csv", tmp_path / "take.csv"
    real.write_bytes(b"old")
    link.symlink_to(real)
    write_atomically(link, b"new")
    assert link.is_symlink()
    assert real.read_bytes() == b"new"


def test_a_failure_leaves_the_old_file_and_says_so_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(b"old")

    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(FileError, match=r"take\.csv: cannot be written \(no space left on device"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["take.csv"]


def test_ctrl_c_leaves_the_old_file_and_nothing_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(b"old")

    def stopped(*_anything: object) -> None:
        raise KeyboardInterrupt

    def stopped_copy(_path: Path, copy: Path) -> None:
        copy.write_bytes(b"o")
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", stopped)
    monkeypatch.setattr("shutil.copy2", stopped_copy)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(path, b"new")
    with pytest.raises(KeyboardInterrupt):
        keep_backup(path)
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["take.csv"]


def test_a_missing_folder_is_reported(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"folder does not exist.*; make the folder") as caught:
        write_atomically(tmp_path / "nowhere" / "take.csv", b"")
    assert "space" not in str(caught.value)


def test_what_a_killed_write_left_is_removed_by_the_next_one(tmp_path: Path) -> None:
    killed = """
import os, signal, sys
from faceedit_app.core.atomic import remove_leftovers, write_atomically
os.fsync = lambda file: os.kill(os.getpid(), signal.SIGKILL)
write_atomically(sys.argv[1], b"x" * 1000)
"""
    path = tmp_path / "take.csv"
    path.write_bytes(b"old")
    subprocess.run([sys.executable, "-c", killed, str(path)], check=False)
    (left,) = tmp_path.glob(".*")
    assert path.read_bytes() == b"old"
    long_ago = time.time() - 60
    os.utime(left, (long_ago, long_ago))
    write_atomically(tmp_path / "other.csv", b"new")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["other.csv", "take.csv"]


def test_a_temporary_file_that_is_being_written_is_left_alone(tmp_path: Path) -> None:
    busy = tmp_path / ".take.csv.abcdefgh.faceedit-new"
    with busy.open("wb") as file:
        lock(file.fileno())
        os.utime(busy, (0, 0))
        remove_leftovers(tmp_path)
        assert busy.exists()
    remove_leftovers(tmp_path)
    assert not busy.exists()


def test_a_name_of_255_bytes_can_be_written(tmp_path: Path) -> None:
    path = tmp_path / ("ä" * 125 + ".json")
    write_atomically(path, b"content")
    assert path.read_bytes() == b"content"


def test_a_name_that_is_not_utf8_is_written_or_refused(tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b"caf\xe9.csv")
    write_atomically(path, b"content")
    assert path.read_bytes() == b"content"
    with pytest.raises(FileError, match="the name is not valid here"):
        write_atomically(tmp_path / "\ud83d.csv", b"content")
    assert len([*tmp_path.iterdir()]) == 1
