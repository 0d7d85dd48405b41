"""Send a take to another program while it plays."""

from __future__ import annotations

import time
from collections.abc import Callable

from faceedit_app.core.arrays import Floats
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.converting import with_filled
from faceedit_app.live.pose import Pose, second_of_day
from faceedit_app.live.protocols import Sender

SUBJECT = "FaceEdit"


def pose_of(weights: Floats, rate: float, rotations: Floats | None = None) -> Pose:
    """The pose of weights (52,), now: receivers expect a clock that only goes forwards.

    Args:
        rotations: (9,) radians, as in `Clip.rotations`; None = the head is straight.
    """
    return Pose(weights, second_of_day(), rate, SUBJECT, rotations)


def play(
    session: EditSession,
    sender: Sender,
    loop: bool = False,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
    follows_head: bool = False,
) -> int:
    """Send every frame at its time, and return how many were sent.

    Rows that lost the face and were filled are frames of the take.

    Args:
        session: the take, with its edits.
        sender: where to.
        loop: begin again at the end, until interrupted.
        clock, sleep: of real time, in seconds.
        follows_head: send how the head and the eyes turn, if the take has it.
    """
    lost, filled = session.take.lost_rows, session.filled_rows()
    clip, sent = with_filled(session.edited_clip(), lost, filled), 0
    weights, turns = clip.arkit_weights(), clip.rotations if follows_head else None
    begin = clock()
    while True:
        for frame, second in enumerate(clip.times.tolist()):
            wait = begin + second - clock()
            if wait > 0:
                sleep(wait)
            rotations = None if turns is None else turns[frame]
            sent += sender.send(pose_of(weights[frame], clip.rate, rotations))
        if not loop:
            return sent
        begin += clip.duration
