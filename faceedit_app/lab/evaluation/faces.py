"""Before and after: pictures of gestures on the demo take, so that anyone can make them again."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faceedit_app.core.controls import (
    CONTROL_INDEX,
    LIDS,
    LIP_OPENING,
    MOUTH_CORNERS,
    MOUTH_WIDTH,
    control_named,
)
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.lab.evaluation.people.gestures import WILD
from faceedit_app.lab.evaluation.report import make_folder
from faceedit_app.lab.evaluation.tables import markdown_table
from faceedit_app.networks.engine import Engine
from faceedit_app.render.camera import Aim, aimed_camera
from faceedit_app.render.snapshot import snapshot, write_png

HOLD, FALLOFF = 0.4, 0.25  # seconds
SIZE = 300  # pixels
FOLDER = "faces"
_WIDE = 2.0  # mm; eyes that far below their median are not open


@dataclass(frozen=True)
class FaceGesture:
    """One gesture.

    Attributes:
        name: of the picture.
        asked: what the user asks for, in words.
        drags: controls, what is done, and by or to how many mm.
        at_open_mouth: where the mouth is widest open; else where the face rests.
        aim: what the pictures show.
    """

    name: str
    asked: str
    drags: tuple[tuple[tuple[str, ...], Op, float], ...]
    at_open_mouth: bool = False
    aim: Aim = Aim.FRONT

    def edits(self, time: float) -> list[Edit]:
        """The edits around a time."""
        start, end = time - 0.5 * HOLD, time + 0.5 * HOLD
        return [
            Edit(controls, op, start, end, FALLOFF, value) for controls, op, value in self.drags
        ]


def _wild(name: str) -> FaceGesture:
    curves = WILD[name]
    words = "; ".join(f"{_label(controls)} {mm:+g} mm" for controls, mm in curves)
    drags = tuple((controls, Op.OFFSET, mm) for controls, mm in curves)
    return FaceGesture(f"wild: {name}", words, drags)


def _label(controls: tuple[str, ...]) -> str:
    first = control_named(controls[0])
    return (first.together if len(controls) > 1 else first.label).lower()


FACES = (
    FaceGesture("closure", "mouth opening to 0.5 mm", (((LIP_OPENING,), Op.SET, 0.5),), True),
    FaceGesture("smile", "both mouth corners +4 mm", ((MOUTH_CORNERS, Op.OFFSET, 4.0),)),
    FaceGesture("pucker", "mouth width -12 mm", (((MOUTH_WIDTH,), Op.OFFSET, -12.0),)),
    FaceGesture("wink", "left eye opening to 0 mm", (((LIDS[0],), Op.SET, 0.0),), aim=Aim.EYES),
    FaceGesture(
        "half-closed eyes", "both eye openings to 4 mm", ((LIDS, Op.SET, 4.0),), aim=Aim.EYES
    ),
    *map(_wild, WILD),
)


def faces_part(folder: Path, rig: Rig, engine: Engine) -> str:
    """Write the pictures below a folder; returns Markdown that shows them.

    Raises:
        FileError: they cannot be written.
        Unavailable: this computer offers no OpenGL.
    """
    make_folder(folder / FOLDER)
    session = open_session(shipped("assets/demo_take.csv"), rig, engine)
    rows = []
    for face in FACES:
        time = _moment(session, face.at_open_mouth)
        frame = session.take.clip.frame_at(time)
        before = session.rig_weights(frame, tracked=True)
        session.put(face.edits(time))
        session.live.work()
        after = session.rig_weights(frame)
        camera = aimed_camera(rig, face.aim)
        both = [snapshot(rig, weights, SIZE, SIZE, camera) for weights in (before, after)]
        picture = f"{FOLDER}/{face.name.replace(': ', '-').replace(' ', '-')}.png"
        write_png(folder / picture, np.concatenate(both, axis=1))
        touched = [CONTROL_INDEX[c] for controls, _, _ in face.drags for c in controls]
        rows.append(
            [
                face.name,
                face.asked,
                ", ".join(f"{mm:.1f}" for mm in session.tracked[frame, touched]),
                ", ".join(f"{mm:.1f}" for mm in session.achieved[frame, touched]),
                f"![{face.name}]({picture})",
            ]
        )
        session.put(())
    titles = ["gesture", "asked for", "before, mm", "the face, mm", "before and after"]
    return "\n\n".join(
        [
            "# Before and after",
            "Gestures on the demo take, held for 0.4 s, answered as FaceEdit is set when it "
            "starts. The last four ask for what no face can do. Written by "
            "`faceedit experiment faces`.",
            markdown_table(titles, rows),
        ]
    )


def _moment(session: EditSession, at_open_mouth: bool) -> float:
    """Seconds: where the mouth is widest open, or where mouth and lids are at their medians."""
    times, controls = session.take.clip.times, session.tracked.astype(np.float64)
    inside = (times > HOLD + FALLOFF) & (times < times[-1] - HOLD - FALLOFF)
    if at_open_mouth:
        return float(
            times[np.argmax(np.where(inside, controls[:, CONTROL_INDEX[LIP_OPENING]], -1.0))]
        )
    away = np.abs(controls - np.median(controls, axis=0)).sum(axis=1)
    lids = controls[:, [CONTROL_INDEX[lid] for lid in LIDS]]
    is_open = (lids > np.median(lids, axis=0) - _WIDE).all(axis=1)
    return float(times[np.argmin(np.where(inside & is_open, away, np.inf))])
