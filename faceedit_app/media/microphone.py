"""Sound from the microphone, in time with the pictures of a webcam."""

from __future__ import annotations

import queue
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Floats
from faceedit_app.core.errors import Unavailable
from faceedit_app.media.output import sound_library

_RATE = 48_000  # samples a second
_SLACK = 0.1  # seconds by which the clocks of sound and pictures may differ before it is mended


class Microphone:
    """The system's microphone. It listens at once, so that no word is lost while it starts.

    Attributes:
        rate: samples a second.

    Raises:
        Unavailable: there is no microphone, or it may not be used.
    """

    def __init__(self) -> None:
        device = sound_library()
        self.rate = _RATE
        self._heard: queue.SimpleQueue[tuple[float, Floats]] = queue.SimpleQueue()
        self._began = 0.0
        self._next = 0  # the sample after the last block
        try:
            self._stream = device.InputStream(
                samplerate=_RATE, channels=1, dtype="float32", callback=self._hear
            )
            self._stream.start()
        except (device.PortAudioError, ValueError) as error:
            raise Unavailable(
                f"No microphone can be used ({str(error).splitlines()[0]})"
            ) from error

    def begin(self) -> None:
        """What is heard from now on belongs to the film."""
        self._began = time.monotonic()

    def blocks(self) -> Iterator[tuple[int, Floats]]:
        """What was heard since the last call: each block's first sample in the film, and (n,).

        They follow each other from the film's first sample; what was lost is silence.
        """
        while True:
            try:
                at, samples = self._heard.get_nowait()
            except queue.Empty:
                return
            late = round((at - self._began) * self.rate) - self._next
            if late < 0 and self._next == 0:  # it was heard before the first picture
                samples = samples[-late:]
            elif late > (_SLACK * self.rate if self._next else 0):
                samples = np.concatenate([np.zeros(late, np.float32), samples])
            if len(samples):
                start, self._next = self._next, self._next + len(samples)
                yield start, samples

    def close(self) -> None:
        """Let go of the microphone; what was heard can still be fetched."""
        self._stream.close()

    def _hear(self, samples: Floats, count: int, times: Any, status: object) -> None:
        """Called in the device's thread with (count, 1) samples."""
        late = float(times.currentTime - times.inputBufferAdcTime)
        late = late if 0.0 <= late < 1.0 else count / self.rate  # some systems do not tell
        self._heard.put((time.monotonic() - late, np.array(samples[:, 0])))
