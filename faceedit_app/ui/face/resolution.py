"""How pictures are drawn while something moves: smooth where that is fast enough, else rough.

In playback that leaves time for it, rough ones are drawn at twice their size, so that brows, lashes
and hair do not flicker. On slow computers, rough pictures have a lower resolution, so that drags
stay fluent.
"""

from __future__ import annotations

from collections import deque

from faceedit_app.ui.face.face_picture import Size

DRAGGED = 0.003  # seconds that a smooth picture may take while one drags
PLAYED = 0.5  # of the time between two frames that it may take in playback
_TRIES = 3  # smooth pictures, by the fastest of which the next are chosen
_UNHURRIED = 40.0  # frames a second: with more, a slow picture would make the next one late
_BUDGET = 0.035  # seconds that a rough picture may take before its resolution is lowered
_COARSEST = 0.5


class Quality:
    """Chooses between smooth and rough pictures by how long smooth ones took.

    A computer with a graphics card draws smooth ones only. Playback tries a few; if all are too
    slow, pictures are rough until the next rest, so that edges do not flicker. The first few of
    those are doubled; if all are too slow, the others are not.
    """

    def __init__(self) -> None:
        self._patience, self._tries = DRAGGED, False
        self._share = 1.0
        self._recent: deque[float] = deque(maxlen=_TRIES)  # seconds of smooth pictures
        self._doubled: deque[float] = deque(maxlen=_TRIES)  # and of doubled ones

    def play(self, rate: float) -> None:
        """Pictures change `rate` times a second from now on, and nobody waits for them."""
        self._tries = rate <= _UNHURRIED
        self._patience = PLAYED / rate if self._tries else DRAGGED
        if self._tries:
            self.forget()

    def rest(self) -> None:
        """Pictures change as the user drags."""
        self._patience, self._tries = DRAGGED, False

    @property
    def is_smooth(self) -> bool:
        """Whether the next picture is smooth although something moves."""
        if len(self._recent) < _TRIES:
            return self._tries
        return min(self._recent) <= self._patience

    @property
    def is_hurried(self) -> bool:
        """Whether smooth pictures have to be ready for the next frame of playback."""
        return self._tries

    @property
    def is_doubled(self) -> bool:
        """Whether the next picture, if it is rough, is drawn at twice its width and height."""
        if not self._tries or len(self._doubled) < _TRIES:
            return self._tries
        return min(self._doubled) <= self._patience

    def forget(self) -> None:
        """The size has changed: how long a smooth picture takes is not known."""
        self._recent.clear()
        self._doubled.clear()

    def drew(self, seconds: float, smooth: bool, doubled: bool = False) -> None:
        """Learn from a picture that took this long."""
        if smooth:
            self._recent.append(seconds)
        elif doubled:
            self._doubled.append(seconds)
        elif seconds > _BUDGET:
            self._share = max(self._share * 0.8, _COARSEST)
        elif seconds < _BUDGET / 3:
            self._share = min(self._share * 1.1, 1.0)

    def size(self, full: Size, smooth: bool) -> Size:
        """Width and height of a picture, from those on the screen."""
        if smooth:
            return full
        return max(1, round(full[0] * self._share)), max(1, round(full[1] * self._share))
