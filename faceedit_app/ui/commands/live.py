"""Live preview and Record from phone, for the File menu."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, QTimer, Signal
from PySide6.QtWidgets import QMessageBox, QWidget

from faceedit_app.core.errors import FaceEditError
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.state.gap_frames import values_at, weights_at

if TYPE_CHECKING:
    from faceedit_app.editing.recording import Recorder
    from faceedit_app.live.protocols import Sender

_BEAT_MS = 100  # receivers drop a face that is silent for long
_COUNT_MS = 200


class LivePreview(QObject):
    """Sends the face on screen to another program, while it is edited, scrubbed and played.

    Signals:
        changed(str): where it is sent; empty if it is off.
    """

    changed = Signal(str)

    def __init__(self, workspace: Workspace) -> None:
        super().__init__(workspace)
        self._workspace = workspace
        self._sender: Sender | None = None
        self._beat = QTimer(self, interval=_BEAT_MS)
        self._beat.timeout.connect(self.send)
        workspace.timeline.playhead_moved.connect(self.send)
        workspace.document.previewed.connect(self.send)
        workspace.document.changed.connect(self.send)

    @property
    def is_on(self) -> bool:
        """Whether the face is sent."""
        return self._sender is not None

    def toggle(self) -> None:
        """Ask where to send the face, and start; or stop."""
        if self.is_on:
            self.stop()
            self._workspace.message.emit("Live preview is off")
            return
        chosen = dialogs.ask_live(self._workspace.window)
        if chosen is not None:
            protocol, host, port = chosen
            from faceedit_app.live.protocols import Sender

            try:
                self._sender = Sender(protocol, host, port)
            except FaceEditError as error:
                dialogs.show_error(self._workspace.window, error)
                return
            self._beat.start()
            self.send()
            self.changed.emit(f"Live: {protocol.name} to {host}:{port}")

    def stop(self) -> None:
        """Stop sending."""
        self._beat.stop()
        if self._sender is not None:
            self._sender.close()
            self._sender = None
            self.changed.emit("")

    def send(self) -> None:
        """Send the face on screen."""
        session, page = self._workspace.session, self._workspace.page
        if self._sender is None or session is None:
            return
        from faceedit_app.editing.streaming import pose_of

        clip, line = session.take.clip, self._workspace.timeline
        weights, turns = weights_at(session, line), session.rotations
        if page is not None and page.face.shows_tracked:
            weights, turns = values_at(session.tracked_weights, line), clip.rotations
        follows = page is not None and page.face.follows_head
        rotations = values_at(turns, line) if follows and turns is not None else None
        self._sender.send(pose_of(weights, clip.rate, rotations))


class PhoneRecording(QObject):
    """Records a take, shows how it grows, and opens it."""

    def __init__(self, workspace: Workspace, open_take: Callable[[Path], None]) -> None:
        super().__init__(workspace)
        self._workspace, self._open_take = workspace, open_take
        self._recorder: Recorder | None = None
        self._box: QMessageBox | None = None
        self._tick = QTimer(self, interval=_COUNT_MS)
        self._tick.timeout.connect(self._show_count)

    @property
    def is_on(self) -> bool:
        """Whether a take is being recorded."""
        return self._recorder is not None

    def start(self) -> None:
        """Ask what to record, and where to write it; then record."""
        if self.is_on:
            return
        window = self._workspace.window
        chosen = dialogs.ask_record(window)
        if chosen is None:
            return
        protocol, phone, port = chosen
        folder = self._workspace.preferences.folder("take")
        path = dialogs.ask_record_name(window, folder / "recording.csv")
        if path is None:
            return
        from faceedit_app.editing.recording import Recorder

        try:
            self._recorder = Recorder(path, protocol, port=port, phone=phone)
        except FaceEditError as error:
            dialogs.show_error(window, error)
            return
        box = counting_box(window)
        box.finished.connect(self.finish)
        self._box = box
        self._show_count()
        self._tick.start()
        box.open()

    def _show_count(self) -> None:
        recorder, box = self._recorder, self._box
        if recorder is None or box is None:
            return
        if recorder.error is not None:
            box.accept()
        elif recorder.frames:
            box.setText(f"Recording {recorder.path.name}: {recorder.frames} frames")
            box.setInformativeText(f"{recorder.seconds:.1f} s")
        else:
            box.setText(f"Waiting on port {recorder.address[1]}…")
            ignored = recorder.ignored
            box.setInformativeText(
                f"{ignored} packets of another protocol were ignored" if ignored else ""
            )

    def finish(self) -> None:
        """Stop recording, and open the take."""
        self._tick.stop()
        recorder, self._recorder = self._recorder, None
        box, self._box = self._box, None
        if box is not None:
            box.deleteLater()
        if recorder is None:
            return
        has_frames = recorder.stop()
        if recorder.error is not None:
            dialogs.show_error(self._workspace.window, recorder.error)
        if has_frames:
            self._workspace.message.emit(f"Recorded {recorder.path}")  # it may not be opened
            self._open_take(recorder.path)
        elif recorder.error is None:
            self._workspace.message.emit("Nothing was received, so no take was written")

    def stop(self) -> None:
        """Stop recording as the window closes; what was received is in the file."""
        if self._recorder is not None:
            self._tick.stop()
            self._recorder.stop()
            self._recorder = None


def counting_box(parent: QWidget) -> QMessageBox:
    """A window that says how long a recording is, with Stop."""
    box = QMessageBox(QMessageBox.Icon.NoIcon, "Record from phone", "", parent=parent)
    box.setTextFormat(Qt.TextFormat.PlainText)  # a name may look like a tag
    box.setEscapeButton(box.addButton("&Stop", QMessageBox.ButtonRole.AcceptRole))
    return box
