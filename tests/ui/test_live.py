"""Live preview and recording in the real window; on loopback only."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from PySide6.QtWidgets import QMessageBox
from pytestqt.qtbot import QtBot
from support.waiting import run_events
from support.windows import Bench, add_edit, trigger

from faceedit_app.editing import recording
from faceedit_app.formats.opening import open_take
from faceedit_app.live.pose import Pose
from faceedit_app.live.protocols import LOOPBACK, Receiver, Sender, find_protocol
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.page.live_dialog import LiveDialog, RecordDialog
from faceedit_app.ui.start.window import MainWindow

LIVELINK = find_protocol("livelink")


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    receiver = Receiver(LIVELINK, LOOPBACK, 0)
    yield receiver
    receiver.close()


def last_pose(receiver: Receiver) -> Pose:
    """The pose that was sent last."""
    pose = receiver.receive()
    assert pose is not None
    receiver._socket.setblocking(False)
    while (later := receiver.receive()) is not None:
        pose = later
    receiver._socket.settimeout(0.5)
    return pose


def switch_on(bench: Bench, window: MainWindow, receiver: Receiver) -> None:
    bench.answers["live"] = (LIVELINK, *receiver.address)
    trigger(window, "live")


def test_the_face_on_screen_is_sent(bench: Bench, receiver: Receiver) -> None:
    window = bench.editing()
    session = window.document.session
    assert session is not None
    switch_on(bench, window, receiver)
    host, port = receiver.address
    assert window.status.live.text() == f"Live: Live Link Face to {host}:{port}"
    assert window.actions_["live"].isChecked()
    window.timeline.go_to_time(float(session.take.clip.times[90]))
    np.testing.assert_array_equal(last_pose(receiver).weights, session.weights[90])
    add_edit(window)
    edited = last_pose(receiver).weights
    np.testing.assert_array_equal(edited, session.weights[90])
    window.commands.view.glance(True)
    tracked = session.take.clip.arkit_weights()[90]
    bench.qtbot.waitUntil(lambda: np.array_equal(last_pose(receiver).weights, tracked))
    trigger(window, "live")
    assert window.status.live.text() == ""
    assert not window.actions_["live"].isChecked()


def test_the_head_is_sent_as_the_view_shows_it(bench: Bench, receiver: Receiver) -> None:
    window = bench.editing()
    session = window.document.session
    assert session is not None
    assert session.rotations is not None
    switch_on(bench, window, receiver)
    window.timeline.go_to_time(float(session.take.clip.times[90]))
    straight = last_pose(receiver).rotations
    assert straight is not None
    assert not straight.any()
    trigger(window, "follow_head")
    window.timeline.go_to_time(float(session.take.clip.times[91]))
    np.testing.assert_array_equal(last_pose(receiver).rotations, session.rotations[91])


def test_nothing_is_sent_until_it_is_asked_for(bench: Bench, receiver: Receiver) -> None:
    window = bench.editing()
    window.timeline.go_to_time(0.8)
    assert not window.commands.file.live.is_on
    switch_on(bench, window, receiver)
    assert window.close()
    assert not window.commands.file.live.is_on


def test_a_wrong_address_is_reported(bench: Bench) -> None:
    window = bench.editing()
    bench.answers["live"] = (LIVELINK, "no such host", 1)
    trigger(window, "live")
    assert "is not an address" in bench.errors[0]
    assert not window.actions_["live"].isChecked()


@pytest.mark.parametrize("has_edits", [False, True])
def test_a_recorded_take_is_opened_unless_edits_are_kept(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, has_edits: bool
) -> None:
    monkeypatch.setattr(recording.Recorder.__init__, "__defaults__", (LOOPBACK, None, ""))
    window = bench.editing() if has_edits else bench.window()
    if has_edits:
        add_edit(window)
        bench.answers["unsaved"] = dialogs.Unsaved.CANCEL
    path = bench.folder / "mine.csv"
    free = Receiver(LIVELINK, LOOPBACK, 0)
    port = free.address[1]
    free.close()
    bench.answers |= {"record": (LIVELINK, "", port), "record_name": path}
    trigger(window, "record")
    box = window.findChild(QMessageBox)
    assert isinstance(box, QMessageBox)
    assert box.text() == f"Waiting on port {port}…"
    sender = Sender(LIVELINK, LOOPBACK, port)
    weights = np.full(52, 0.25, np.float32)
    for frame in range(20):
        sender.send(Pose(weights, 10 + frame / 60))
    sender.close()
    bench.qtbot.waitUntil(lambda: "20 frames" in box.text())
    box.accept()
    assert window.status.currentMessage() == f"Recorded {path}" or not has_edits
    if not has_edits:
        bench.qtbot.waitUntil(lambda: window.document.path == path)
    assert window.document.path == (bench.take if has_edits else path)
    np.testing.assert_array_equal(open_take(path).clip.arkit_weights(), np.tile(weights, (20, 1)))


def test_the_dialogs_say_where(qtbot: QtBot) -> None:
    live, record = LiveDialog(None), RecordDialog(None)
    qtbot.addWidget(live)
    qtbot.addWidget(record)
    assert live.chosen == (LIVELINK, LOOPBACK, 11111)
    live.protocol_choice.setCurrentIndex(1)
    assert live.chosen[2] == 39539
    assert "VSeeFace" in live.hint.text()
    assert not record.form.isRowVisible(record.address)
    record.protocol_choice.setCurrentIndex(2)
    assert record.form.isRowVisible(record.address)
    assert "This computer's address is" in record.hint.text()


@pytest.mark.parametrize("kind", [LiveDialog, RecordDialog])
def test_no_line_of_a_hint_is_cut(
    qtbot: QtBot, kind: type[LiveDialog] | type[RecordDialog]
) -> None:
    dialog = kind(None)
    qtbot.addWidget(dialog)
    with qtbot.waitExposed(dialog):
        dialog.show()
    for width in (dialog.width(), dialog.minimumWidth(), 800):
        for row in range(dialog.protocol_choice.count()):
            dialog.protocol_choice.setCurrentIndex(row)
            dialog.resize(width, 10)
            run_events()
            room = dialog.hint.height()
            assert room >= dialog.hint.heightForWidth(dialog.hint.width()), (width, row)
