"""Record a take from the network, into a Live Link Face CSV that is whole at every moment."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from pathlib import Path

from faceedit_app.core.atomic import not_written
from faceedit_app.core.errors import FileError
from faceedit_app.formats.livelink import frame_line, header_line
from faceedit_app.live.pose import Pose, second_of_day
from faceedit_app.live.protocols import EVERYWHERE, Protocol, Receiver

_DAY = 24 * 3600.0
_GREET = 3.0  # seconds without a face after which the phone is greeted again
_JUMP = 2.0  # seconds by which the sender's clock may differ from ours before ours is used
_SHORTEST = 1e-3  # seconds between two frames


class Recorder:
    """Receives in a thread, and writes each frame at once: a crash loses none.

    Args:
        path: the file to write, which must be new.
        protocol: what is received.
        host, port: where to listen; None = the protocol's port.
        phone: the address of the phone, for protocols in which it must be asked.

    Attributes:
        frames: how many were written.
        ignored: how many datagrams were not of the protocol.
        error: why the recording ended by itself; None if it did not.

    Raises:
        FileError: the file exists or cannot be written.
        FaceEditError: FaceEdit cannot listen on the port.
    """

    def __init__(
        self,
        path: Path,
        protocol: Protocol,
        host: str = EVERYWHERE,
        port: int | None = None,
        phone: str = "",
    ) -> None:
        self.path, self.frames, self.seconds = path, 0, 0.0
        self.error: FileError | None = None
        self._receiver = Receiver(protocol, host, port, phone)
        try:
            self._file = path.open("x", encoding="ascii", newline="")
        except FileExistsError as error:
            self._receiver.close()
            raise FileError(path, "exists", "choose a new name for the recording") from error
        except OSError as error:
            self._receiver.close()
            raise not_written(self.path, error) from error
        self._stop = threading.Event()
        self._begin: float | None = None  # second of the day of the first frame
        self._sent: float | None = None  # the last frame's time by the sender's clock
        self._arrived = 0.0  # and by ours
        self._second = 0.0
        self._thread = threading.Thread(target=self._work, name="recorder", daemon=True)
        self._thread.start()

    @property
    def address(self) -> tuple[str, int]:
        """Host and port on which it listens."""
        return self._receiver.address

    @property
    def ignored(self) -> int:
        """How many datagrams were none of the protocol's."""
        return self._receiver.ignored

    def stop(self) -> bool:
        """End the recording; False if there was no frame, and so there is no file."""
        self._stop.set()
        self._thread.join()
        self._receiver.close()
        self._close()
        if not self.frames:
            with suppress(OSError):
                self.path.unlink()
        return bool(self.frames)

    def _work(self) -> None:
        heard = time.monotonic()
        try:
            self._file.write(header_line())
            while not self._stop.is_set():
                pose = self._receiver.receive()
                now = time.monotonic()
                if pose is not None:
                    heard = now
                    self._write(pose, now)
                elif now - heard > _GREET:
                    heard = now
                    self._receiver.greet()
        except OSError as error:
            self.error = not_written(self.path, error)

    def _write(self, pose: Pose, now: float) -> None:
        if self._begin is None:
            self._begin = second_of_day()
            step = 0.0
        else:
            step = now - self._arrived
            if pose.seconds is not None and self._sent is not None:
                by_sender = pose.seconds - self._sent
                if -_JUMP < by_sender <= 0:  # repeated, or overtaken on the way
                    return
                if abs(by_sender - step) < _JUMP:  # else its clock was set
                    step = by_sender
            step = max(step, _SHORTEST)
        self._sent, self._arrived = pose.seconds, now
        self._second += step
        self.seconds = self._second
        line = frame_line((self._begin + self._second) % _DAY, pose.weights, pose.rotations)
        self._file.write(line)
        self._file.flush()
        self.frames += 1

    def _close(self) -> None:
        try:
            self._file.close()
        except OSError as error:
            self.error = not_written(self.path, error)
