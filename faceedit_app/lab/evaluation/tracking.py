"""How exactly films are tracked: on films of characters, rendered from takes.

Three methods are compared: the weights of MediaPipe's own network, our fit of each picture by
itself, and our fit over time. Beside them are the weights that the film was rendered with: on
another character than the shipped one they show other distances, so that even they are off.
"""

from __future__ import annotations

import math
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.controls import (
    CONTROL_IDS,
    CONTROL_INDEX,
    LIDS,
    LIP_OPENING,
    MAIN_CONTROLS,
)
from faceedit_app.core.names import canonical_channel
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.opening import shipped_rig
from faceedit_app.lab.evaluation.kept_films import KeptFilms
from faceedit_app.lab.evaluation.metrics import ShutCounts, shut_counts
from faceedit_app.lab.evaluation.rendered_films import (
    CONDITIONS,
    Conditions,
    Truth,
    kept_open,
    render_film,
    truth_of,
)
from faceedit_app.tracking.face_model import FaceModel
from faceedit_app.tracking.film_landmarks import FilmLandmarks, read_landmarks
from faceedit_app.tracking.fit import FitSettings
from faceedit_app.tracking.landmarker import TASK, FaceLandmarker, Network
from faceedit_app.tracking.tracker import fit_landmarks

TRUE, NETWORK, EACH, FULL = "true weights", "network", "each picture", "over time"
METHODS = (TRUE, NETWORK, EACH, FULL)
_SHUT = 2.0  # mm between lips or lids that count as shut
_TOUCHING = 3.0  # mm between lips that hardly open; at rest, our character's are 1.3 mm apart
_NEAR = 0.5  # mm above that; what is measured is not more exact
_FARTHEST_LAG = 4  # frames
_FINE = 20  # steps in a frame when the lag is measured
_STILL = 0.25  # mm per frame; slower lips are at rest

# The landmarks that MediaPipe's blendshape network takes, in its order (mediapipe, Apache-2.0:
# face_blendshapes_graph.cc, kLandmarksSubsetIdxs).
# fmt: off
_SUBSET = (
    0, 1, 4, 5, 6, 7, 8, 10, 13, 14, 17, 21, 33, 37, 39, 40, 46, 52, 53, 54, 55, 58, 61, 63, 65, 66,
    67, 70, 78, 80, 81, 82, 84, 87, 88, 91, 93, 95, 103, 105, 107, 109, 127, 132, 133, 136, 144,
    145, 146, 148, 149, 150, 152, 153, 154, 155, 157, 158, 159, 160, 161, 162, 163, 168, 172, 173,
    176, 178, 181, 185, 191, 195, 197, 234, 246, 249, 251, 263, 267, 269, 270, 276, 282, 283, 284,
    285, 288, 291, 293, 295, 296, 297, 300, 308, 310, 311, 312, 314, 317, 318, 321, 323, 324, 332,
    334, 336, 338, 356, 361, 362, 365, 373, 374, 375, 377, 378, 379, 380, 381, 382, 384, 385, 386,
    387, 388, 389, 390, 397, 398, 400, 402, 405, 409, 415, 454, 466, 468, 469, 470, 471, 472, 473,
    474, 475, 476, 477,
)
_NETWORK_CHANNELS = (
    "_neutral", "browDownLeft", "browDownRight", "browInnerUp", "browOuterUpLeft",
    "browOuterUpRight", "cheekPuff", "cheekSquintLeft", "cheekSquintRight", "eyeBlinkLeft",
    "eyeBlinkRight", "eyeLookDownLeft", "eyeLookDownRight", "eyeLookInLeft", "eyeLookInRight",
    "eyeLookOutLeft", "eyeLookOutRight", "eyeLookUpLeft", "eyeLookUpRight", "eyeSquintLeft",
    "eyeSquintRight", "eyeWideLeft", "eyeWideRight", "jawForward", "jawLeft", "jawOpen", "jawRight",
    "mouthClose", "mouthDimpleLeft", "mouthDimpleRight", "mouthFrownLeft", "mouthFrownRight",
    "mouthFunnel", "mouthLeft", "mouthLowerDownLeft", "mouthLowerDownRight", "mouthPressLeft",
    "mouthPressRight", "mouthPucker", "mouthRight", "mouthRollLower", "mouthRollUpper",
    "mouthShrugLower", "mouthShrugUpper", "mouthSmileLeft", "mouthSmileRight", "mouthStretchLeft",
    "mouthStretchRight", "mouthUpperUpLeft", "mouthUpperUpRight", "noseSneerLeft", "noseSneerRight",
)
# fmt: on


Rates = tuple[float, float, float]


@dataclass(frozen=True)
class TrackingFigures:
    """How one method does under one kind of conditions, over all takes.

    Attributes:
        character, conditions, method: their names.
        error: (C,) mm, median absolute error of each control, as measured on the character itself.
        moved: (C,) mm, the same without the constant part of each film, which is the person's rest.
        lips, lids: of frames in which they are shut, TPR, FPR, and FPR beside those nearly so, see
            `ShutCounts.rates`; NaN if none is.
        lip_events, lid_events: the same of the times that they shut.
        lag: frames by which the mouth's opening is late.
        jitter: how much more the lips shake at rest than in truth, mm per frame².
        lost: share of the pictures that are gaps.
        open_taken: share of the frames with open lips that count as shut.
        near_lips: as `lips`, of lips that are nearer than 3 mm.
    """

    character: str
    conditions: str
    method: str
    error: tuple[float, ...]
    moved: tuple[float, ...]
    lips: Rates
    lids: Rates
    lip_events: Rates
    lid_events: Rates
    lag: float
    jitter: float
    lost: float
    open_taken: float
    near_lips: Rates


def evaluate_tracking(
    takes: Sequence[Path],
    seconds: float = 6.0,
    conditions: Sequence[Conditions] = CONDITIONS,
    progress: Callable[[int, int], None] = lambda done, of: None,
    characters: Sequence[Rig] = (),
    keep: Path | None = None,
) -> list[TrackingFigures]:
    """Render films of takes, track them, and compare.

    Args:
        takes: the takes.
        seconds: of each, the liveliest stretch.
        conditions: how the films are taken.
        progress: films done, and films in all.
        characters: who plays the takes; none = the shipped one.
        keep: a folder for what was seen in the films, which is then not rendered again.

    Raises:
        FileError: a take cannot be read, or `keep` not written.
        Unavailable: OpenGL, an encoder or LiteRT is missing.
    """
    rig, kept = shipped_rig(), KeptFilms(keep)
    model, landmarker, network = FaceModel.of(rig), FaceLandmarker(threads=2), BlendshapeNetwork()
    films = [(actor, how) for actor in characters or (rig,) for how in conditions]
    figures = []
    for number, (actor, how) in enumerate(films):
        found: dict[str, list[tuple[Floats, Floats, float]]] = {method: [] for method in METHODS}
        for index, take in enumerate(takes):
            truth = truth_of(take, seconds, how.rate, rig)
            truth = kept_open(truth) if how.is_ajar else truth
            make = partial(_film, actor, truth, how, landmarker)
            film = kept.of(actor, truth, how, make)
            shown = actor.arkit_distances.measure(truth.weights)
            found[TRUE].append((rig.arkit_distances.measure(truth.weights), shown, 0.0))
            for method, weights, lost in _tracked(film, model, network):
                found[method].append((rig.arkit_distances.measure(weights), shown, lost))
            progress(number * len(takes) + index + 1, len(films) * len(takes))
        figures += [_figures(actor.name, how.name, method, found[method]) for method in METHODS]
    return figures


class BlendshapeNetwork:
    """MediaPipe's network that gives weights from landmarks; we only compare with it."""

    def __init__(self) -> None:
        with zipfile.ZipFile(shipped(TASK)) as archive:
            self._network = Network(archive.read("face_blendshapes.tflite"), 1)

    def weights(self, points: Doubles) -> Floats:
        """(T, 52) in ARKit's order from landmarks (T, 478, 3), pixels; 0 where there are none."""
        weights = np.zeros((len(points), len(ARKIT_INDEX)), np.float32)
        columns = [
            (row, ARKIT_INDEX[channel])
            for row, name in enumerate(_NETWORK_CHANNELS)
            if (channel := canonical_channel(name)) is not None
        ]
        theirs, ours = zip(*columns, strict=True)
        for frame in np.flatnonzero(np.isfinite(points[:, 0, 0])):
            answer = self._network(points[frame, list(_SUBSET), :2][None])[0].ravel()
            weights[frame, list(ours)] = answer[list(theirs)]
        return weights


def _film(rig: Rig, truth: Truth, how: Conditions, landmarker: FaceLandmarker) -> FilmLandmarks:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        render_film(path, rig, truth, how)
        return read_landmarks(path, landmarker)


def _tracked(
    film: FilmLandmarks, model: FaceModel, network: BlendshapeNetwork
) -> list[tuple[str, Floats, float]]:
    """Each method's name, weights (T, 52), and the share of lost pictures."""
    each = fit_landmarks(film, model, FitSettings(smoothness=0.0))
    full = fit_landmarks(film, model)
    return [
        (NETWORK, network.weights(film.points), float((film.probabilities == 0).mean())),
        (EACH, each.weights.astype(np.float32), float((~each.sure).mean())),
        (FULL, full.weights.astype(np.float32), float((~full.sure).mean())),
    ]


def _figures(
    character: str, conditions: str, method: str, films: Sequence[tuple[Floats, Floats, float]]
) -> TrackingFigures:
    away = [found - truth for found, truth, _ in films]
    error = np.median(np.abs(np.concatenate(away)), axis=0)
    moved = np.median(np.abs(np.concatenate([a - np.median(a, axis=0) for a in away])), axis=0)
    found = np.concatenate([film[0] for film in films]).astype(np.float64)
    truth = np.concatenate([film[1] for film in films]).astype(np.float64)
    opening = CONTROL_INDEX[LIP_OPENING]
    lips, lip_events = _shut(films, [opening])
    near_lips, _ = _shut(films, [opening], _TOUCHING)
    is_open = truth[:, opening] >= _SHUT
    lids, lid_events = _shut(films, [CONTROL_INDEX[lid] for lid in LIDS])
    return TrackingFigures(
        character,
        conditions,
        method,
        tuple(error.tolist()),
        tuple(moved.tolist()),
        lips,
        lids,
        lip_events,
        lid_events,
        float(np.mean([lag(f[:, opening], t[:, opening]) for f, t, _ in films])),
        _jitter(found[:, opening], truth[:, opening]),
        float(np.mean([lost for _, _, lost in films])),
        float((found[is_open, opening] < _SHUT).mean()) if is_open.any() else float("nan"),
        near_lips,
    )


def _shut(
    films: Sequence[tuple[Floats, Floats, float]], columns: Sequence[int], below: float = _SHUT
) -> tuple[Rates, Rates]:
    """The rates of frames and of events in which lips or lids are nearer than `below` mm."""
    frames = events = ShutCounts(0, 0, 0, 0)
    for found, truth, _ in films:
        for column in columns:
            mine, theirs = (x[:, column].astype(np.float64) for x in (found, truth))
            some, runs = shut_counts(mine, theirs, below, _NEAR)
            frames, events = frames + some, events + runs
    return frames.rates, events.rates


def lag(found: Doubles | Floats, truth: Doubles | Floats) -> float:
    """Frames by which `found` (T,) is late, from the best correlation within a few frames."""
    count = len(truth)
    if count < 4 * _FARTHEST_LAG:
        return 0.0
    middle = np.arange(_FARTHEST_LAG, count - _FARTHEST_LAG)
    shifts = np.arange(-_FARTHEST_LAG * _FINE, _FARTHEST_LAG * _FINE + 1) / _FINE
    fits = []
    for shift in shifts:
        shifted = np.interp(middle + shift, np.arange(count), found)
        fits.append(np.corrcoef(shifted, truth[middle])[0, 1] if np.ptp(shifted) > 0 else -1.0)
    return float(shifts[int(np.argmax(fits))])


def _jitter(found: Doubles, truth: Doubles) -> float:
    """How much more `found` (T,) shakes than `truth` where the truth is at rest."""
    still = np.abs(np.diff(truth)) < _STILL
    rest = still[1:] & still[:-1]
    if not rest.any():
        return float("nan")
    mine, theirs = (float(np.diff(x, n=2)[rest].std()) for x in (found, truth))
    return mine - theirs


def table(figures: Sequence[TrackingFigures]) -> str:
    """The figures as a Markdown table."""
    opening, lids = CONTROL_INDEX[LIP_OPENING], [CONTROL_INDEX[lid] for lid in LIDS]
    main = [CONTROL_INDEX[control] for control in MAIN_CONTROLS]
    others = [i for i in main if i not in (opening, *lids)]
    rows = [
        "| character | film | method | lips, mm | lips from rest | lids | lids from rest | others "
        "| others from rest | lips shut TPR / FPR (far) | by event | lids shut TPR / FPR (far) "
        "| by event | lag | jitter | lost | open lips taken for shut "
        "| lips within 3 mm TPR / FPR (far) |",
        "|" + "---|" * 18,
    ]
    for one in figures:
        error, moved = np.array(one.error), np.array(one.moved)
        errors = [
            f"{values[columns].mean():.2f}"
            for columns in ([opening], lids, others)
            for values in (error, moved)
        ]
        cells = [
            one.character,
            one.conditions,
            one.method,
            *errors,
            *map(_rates, (one.lips, one.lip_events, one.lids, one.lid_events)),
            f"{one.lag:+.2f}",
            f"{one.jitter:.2f}",
            f"{one.lost:.0%}",
            "–" if math.isnan(one.open_taken) else f"{one.open_taken:.1%}",
            _rates(one.near_lips),
        ]
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def _rates(rates: Rates) -> str:
    """TPR / FPR, and the FPR beside frames that are nearly shut; dashes if nothing is ever shut."""
    tpr, fpr, far = ("–" if math.isnan(rate) else f"{rate:.2f}" for rate in rates)
    return f"{tpr} / {fpr} ({far})"


def as_json(figures: Sequence[TrackingFigures]) -> list[dict[str, Any]]:
    """The figures, with the controls by name."""
    out = []
    for one in figures:
        facts = asdict(one)
        for key in ("error", "moved"):
            facts[key] = dict(zip(CONTROL_IDS, facts[key], strict=True))
        for key in ("lips", "lids", "lip_events", "lid_events", "near_lips"):  # JSON has no NaN
            facts[key] = [None if math.isnan(rate) else rate for rate in facts[key]]
        if math.isnan(one.open_taken):
            facts["open_taken"] = None
        out.append(facts)
    return out
