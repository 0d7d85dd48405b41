"""What `--json` prints for scripts: the keys of `faceedit info --json`, and nothing else."""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.takes import make_livelink_csv

from faceedit_app.editing import recording
from faceedit_app.formats.opening import open_take

EDIT = {"control": "mouth_opening", "op": "offset", "start": 0.8, "end": 1.2, "value": 6.0}
SHARED = {"path", "format", "frames", "rate", "duration_s", "notes"}


def test_convert_says_what_it_wrote(
    take: Path, tmp_path: Path, printed: Callable[..., dict[str, Any]]
) -> None:
    out = tmp_path / "out.json"
    facts = printed("convert", take, out, "--fps", 30)
    assert facts.keys() == SHARED | {"take", "backup", "hints"}
    clip = open_take(out).clip
    assert (facts["path"], facts["take"], facts["backup"]) == (str(out), str(take), None)
    assert (facts["format"], facts["frames"], facts["rate"]) == ("Audio2Face JSON", len(clip), 30)
    assert facts["duration_s"] == pytest.approx(clip.duration, abs=1e-5)
    assert any("HeadYaw" in note for note in facts["notes"])
    assert any("30 fps" in hint for hint in facts["hints"])


def test_info_and_convert_name_alike(
    take: Path, tmp_path: Path, printed: Callable[..., dict[str, Any]]
) -> None:
    facts = printed("convert", take, tmp_path / "out.csv", "--format", "csv")
    info = printed("info", tmp_path / "out.csv")
    assert info.keys() >= SHARED
    assert {key: facts[key] for key in ("path", "frames", "rate")} == {
        key: info[key] for key in ("path", "frames", "rate")
    }


def test_apply_says_what_it_changed_and_could_not(
    take: Path, tmp_path: Path, models: str, printed: Callable[..., dict[str, Any]]
) -> None:
    edits, out = tmp_path / "edits.json", tmp_path / "out.csv"
    edits.write_text(json.dumps({"version": 1, "edits": [EDIT]}))
    facts = printed("apply", take, edits, "-o", out, "--models", models)
    assert facts.keys() == SHARED | {"take", "backup", "edits", "changed_frames"}
    assert (facts["edits"], facts["notes"]) == (1, [])
    assert 0 < facts["changed_frames"] < facts["frames"]
    otherwise = (take, edits, "-o", take, "--overwrite", "--models", models, "--fps", 50)
    again = printed("apply", *otherwise)
    own_times = "it keeps the take's own times, which say 60 fps and not 50 fps"
    assert again["notes"] == [own_times]
    assert Path(again["backup"]).is_file()
    few = tmp_path / "few.csv"
    few.write_text("time,eyeBlinkLeft\n" + "".join(f"{n / 30:.4f},0.1\n" for n in range(60)))
    facts = printed("apply", few, edits, "-o", tmp_path / "few_out.csv", "--models", models)
    assert facts["notes"][0].startswith("edit 1: ")
    assert facts["changed_frames"] == 0


def test_batch_lists_all_takes(
    tmp_path: Path, models: str, printed: Callable[..., dict[str, Any]]
) -> None:
    takes, out = tmp_path / "takes", tmp_path / "out"
    takes.mkdir()
    make_livelink_csv(takes / "a.csv")
    (takes / "b.csv").write_text("jawOpen\n0.1\nmany\n")
    (takes / "c.csv").write_text("no take")
    facts = printed("batch", "none", takes, "-o", out, "--models", models, code=1)
    assert (facts["written"], facts["failed"]) == (1, 1)
    assert [one["name"] for one in facts["skipped"]] == ["c.csv"]
    assert all(Path(report).is_file() for report in facts["reports"])
    good, bad = sorted(facts["takes"], key=lambda one: str(one["name"]))
    assert (good["path"], good["error"]) == (str(out / "a.csv"), None)
    assert good["frames"] == len(open_take(takes / "a.csv").clip)
    assert bad["path"] is None
    assert "b.csv" in bad["error"]


def test_record_says_what_it_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, printed: Callable[..., dict[str, Any]]
) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    arrived = threading.Event()
    write = recording.Recorder._write

    def written(self: recording.Recorder, *given: Any) -> None:
        write(self, *given)
        if self.frames == 3:
            arrived.set()

    def send(event: threading.Event, timeout: float | None) -> bool:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as phone:
            for n in range(3):
                phone.sendto(b"jawOpen-%d|mouthClose-0|=head#1,2,3" % (10 * n), ("127.0.0.1", port))
        return arrived.wait(20)

    monkeypatch.setattr(recording.Recorder, "_write", written)
    out = tmp_path / "take.csv"
    arguments = ("--protocol", "ifacialmocap", "--host", "127.0.0.1", "--port", port)
    monkeypatch.setattr("faceedit_app.command_line.live.wait_for_end", lambda s: send(arrived, s))
    facts = printed("record", out, *arguments, "--seconds", 20)
    assert SHARED | {"packets_ignored"} <= facts.keys()
    assert (facts["path"], facts["frames"], facts["packets_ignored"]) == (str(out), 3, 0)
