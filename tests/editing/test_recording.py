"""Takes recorded from the network, and takes played into it; on loopback only."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from support.faces import talking_clip
from support.rigs import tiny_session
from support.sessions import session_by_rig
from support.takes import make_livelink_csv

from faceedit_app.cli import main
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.editing import recording
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.recording import Recorder
from faceedit_app.editing.streaming import play
from faceedit_app.formats.opening import open_take
from faceedit_app.live.pose import Pose
from faceedit_app.live.protocols import LOOPBACK, Receiver, Sender, find_protocol

CLIP = talking_clip(frames=40, rate=30.0)
LIVELINK, VMC, PHONE = map(find_protocol, ("livelink", "vmc", "ifacialmocap"))


@pytest.fixture
def recorder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Recorder]:
    monkeypatch.setattr(recording, "second_of_day", lambda: 36_000.25)
    recorder = Recorder(tmp_path / "take.csv", LIVELINK, LOOPBACK, 0)
    yield recorder
    recorder.stop()


def until(done: Callable[[], bool]) -> None:
    """Wait for another thread, at most 10 s."""
    tick = threading.Event()
    for _ in range(1000):
        if done():
            return
        tick.wait(0.01)
    raise AssertionError("it did not happen")


def send(recorder: Recorder, *poses: Pose) -> None:
    sender = Sender(LIVELINK, *recorder.address)
    for pose in poses:
        before = recorder.frames
        sender.send(pose)
        if pose.subject != "lost":
            until(lambda before=before: recorder.frames > before)  # type: ignore[misc]
    sender.close()


def poses(begin: float = 43200.0) -> list[Pose]:
    turned = np.linspace(-0.5, 0.5, 9).astype(np.float32)
    return [
        Pose(weights, begin + second, 30.0, "phone", turned)
        for second, weights in zip(CLIP.times.tolist(), CLIP.weights, strict=True)
    ]


def test_a_recording_is_the_take_that_was_sent(recorder: Recorder) -> None:
    send(recorder, *poses())
    assert recorder.stop()
    take = open_take(recorder.path)
    assert take.format == "Live Link Face CSV"
    np.testing.assert_allclose(take.clip.arkit_weights(), CLIP.weights, atol=1e-6)
    np.testing.assert_allclose(take.clip.times, CLIP.times, atol=1e-3)
    assert take.clip.rate == 30
    last = recorder.path.read_text().splitlines()[-1].split(",")
    np.testing.assert_allclose([float(x) for x in last[-9:]], np.linspace(-0.5, 0.5, 9), atol=1e-6)


def test_every_frame_is_in_the_file_as_soon_as_it_arrives(recorder: Recorder) -> None:
    for count, pose in enumerate(poses()[:5], start=1):
        send(recorder, pose)
        assert len(open_take(recorder.path).clip) == count if count > 1 else True


def test_lost_repeated_and_overtaken_packets(recorder: Recorder) -> None:
    sent = poses()
    lost = [*sent[:10], *sent[13:20]]
    send(recorder, *lost)
    late = Sender(LIVELINK, *recorder.address)
    late.send(sent[11])
    late.send(sent[19])
    late.close()
    send(recorder, *sent[20:])
    recorder.stop()
    take = open_take(recorder.path)
    assert len(take.clip) == 37
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(9, 3)]


def test_a_clock_that_jumps_is_not_believed(recorder: Recorder) -> None:
    send(recorder, *poses()[:5], *poses(begin=90.0)[5:10])
    recorder.stop()
    assert recorder.frames == 10
    assert 0 < recorder.seconds < 5
    assert len(open_take(recorder.path, fps=30).clip) == 10


def test_nothing_received_leaves_no_file(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "take.csv", VMC, LOOPBACK, 0)
    stranger = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    stranger.sendto(b"hello", recorder.address)
    until(lambda: recorder.ignored == 1)
    stranger.close()
    assert not recorder.stop()
    assert list(tmp_path.iterdir()) == []


def test_no_file_is_replaced(tmp_path: Path) -> None:
    old = make_livelink_csv(tmp_path / "take.csv")
    before = old.read_bytes()
    with pytest.raises(FileError, match="exists; choose a new name"):
        Recorder(old, LIVELINK, LOOPBACK, 0)
    with pytest.raises(FileError, match="cannot be written"):
        Recorder(tmp_path / "nowhere" / "take.csv", LIVELINK, LOOPBACK, 0)
    assert old.read_bytes() == before


def test_the_phone_is_greeted_and_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    phone = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    phone.bind((LOOPBACK, 0))
    phone.settimeout(10)
    mocap = replace(PHONE, port=phone.getsockname()[1])
    monkeypatch.setattr(recording, "_GREET", 0.01)
    recorder = Recorder(tmp_path / "take.csv", mocap, LOOPBACK, 0, LOOPBACK)
    for _ in range(2):  # greeted again while nothing comes
        greeting, computer = phone.recvfrom(1000)
        assert greeting.startswith(b"iFacialMocap_")
    phone.sendto(b"jawOpen-50|=head#0,0,0,0,0,0|", computer)
    until(lambda: recorder.frames == 1)
    recorder.stop()
    phone.close()
    assert "0.5000000000" in recorder.path.read_text()


def test_a_take_is_played_in_its_own_time() -> None:
    session = tiny_session(frames=20)
    receiver = Receiver(LIVELINK, LOOPBACK, 0)
    sender = Sender(LIVELINK, *receiver.address)
    now, waits = [0.0], []

    def sleep(seconds: float) -> None:
        waits.append(seconds)
        now[0] += seconds

    try:
        assert play(session, sender, clock=lambda: now[0], sleep=sleep) == 20
        received = [receiver.receive() for _ in range(20)]
    finally:
        sender.close()
        receiver.close()
    np.testing.assert_allclose(waits, [1 / 50] * 19)
    weights = np.array([pose.weights for pose in received if pose is not None])
    np.testing.assert_array_equal(weights, session.weights)


class _Receives:
    """In place of a sender, keeps what would be sent."""

    def __init__(self) -> None:
        self.poses: list[Pose] = []

    def send(self, pose: Pose) -> bool:
        self.poses.append(pose)
        return True


def test_frames_that_fill_a_gap_are_played(tmp_path: Path) -> None:
    session = session_by_rig(make_livelink_csv(tmp_path / "take.csv", 2.0, untracked=range(60, 66)))
    session.add(Edit(CONTROL_IDS, Op.FILL, 0.9, 1.2, 0.0))
    receives = _Receives()
    play(session, cast(Sender, receives), clock=lambda: 99.0, sleep=lambda _: None)
    played = np.array([pose.weights for pose in receives.poses])
    assert len(played) == 120
    np.testing.assert_array_equal(played, session.all_frames().weights)


def test_the_command_plays_a_take(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    take = make_livelink_csv(tmp_path / "take.csv", seconds=0.1)
    receiver = Receiver(VMC, LOOPBACK, 0)
    port = str(receiver.address[1])
    try:
        assert main(["live", str(take), "--port", port, "--protocol", "vmc"]) == 0
        assert receiver.receive() is not None
    finally:
        receiver.close()
    assert f"as VMC to 127.0.0.1:{port}" in capfd.readouterr().out
    assert main(["live", str(take), "--protocol", "ifacialmocap"]) == 2
    assert "ifacialmocap: the protocol must be livelink or vmc" in capfd.readouterr().err


def test_the_command_says_when_nothing_came(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "take.csv"
    words = ["record", str(out), "--host", LOOPBACK, "--port", "0", "--seconds", "0.05"]
    assert main(words) == 2
    said = capfd.readouterr()
    assert "Nothing was received" in said.err
    assert "Listening for Live Link Face on 127.0.0.1:" in said.out
    assert not out.exists()
