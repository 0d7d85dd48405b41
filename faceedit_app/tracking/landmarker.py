"""Find landmarks of a face in a picture, by MediaPipe's networks run by LiteRT.

Two of the three networks in `face_landmarker.task` (Google, Apache-2.0) are used: one finds faces,
the other the 478 landmarks in a square around a face (Kartynnik et al., "Real-time facial surface
geometry from monocular video on mobile GPUs", 2019; the irises: Ablavatski et al., 2020).
"""

from __future__ import annotations

import contextlib
import math
import os
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from faceedit_app.core.arrays import Doubles, Pixels
from faceedit_app.core.errors import FileError
from faceedit_app.core.optional import require
from faceedit_app.core.resources import shipped

TASK = "models/tracker/face_landmarker.task"
LANDMARKS = 478
SURE = 0.5  # confidence below which a picture is a gap
_DETECTOR, _LANDMARKER = "face_detector.tflite", "face_landmarks_detector.tflite"
_LARGEST = 64 << 20  # bytes of one network
_SEEN = 0.5  # least probability of a face
_SMALL, _LARGE = 128, 256  # pixels of the networks' input
_MARGIN = 2.0  # of the detector's box
_AROUND = 1.5  # of the box around landmarks
_SAME = 0.4  # share of a face's size within which two detections are the same face
OUTER_EYES = 33, 263


@dataclass(frozen=True)
class Square:
    """A turned square of a picture: its middle and side in pixels, its angle in radians."""

    x: float
    y: float
    size: float
    angle: float

    @classmethod
    def around(cls, points: Doubles) -> Square:
        """A square around landmarks (478, 2 or 3), level with the eyes."""
        right, left = (points[number, :2] for number in OUTER_EYES)
        angle = math.atan2(left[1] - right[1], left[0] - right[0])
        turn = _rotation(-angle)
        upright = points[:, :2] @ turn.T
        low, high = upright.min(axis=0), upright.max(axis=0)
        x, y = turn.T @ ((low + high) / 2)
        return cls(float(x), float(y), float((high - low).max() * _AROUND), angle)

    def distance_to(self, x: float, y: float) -> float:
        """Pixels from its middle."""
        return math.hypot(self.x - x, self.y - y)


@dataclass(frozen=True)
class FaceLandmarks:
    """Landmarks in one picture.

    Attributes:
        points: (478, 3) pixels of the picture; the third is the depth in the same unit, smaller is
            nearer, and much less exact than the others.
        probability: 0..1 that this is a face.
    """

    points: Doubles
    probability: float


class FaceLandmarker:
    """Finds the landmarks of faces.

    Args:
        task: the file `face_landmarker.task`; None = the one that ships with FaceEdit.
        threads: for the networks.

    Raises:
        Unavailable: LiteRT is not installed.
        FileError: the file is missing or something else.
    """

    def __init__(self, task: Path | None = None, threads: int = 1) -> None:
        require("ai_edge_litert", extra="", package="ai-edge-litert")
        task = task or shipped(TASK)
        try:
            if task.exists() and not task.is_file():  # a pipe may never end
                raise ValueError(task)
            with zipfile.ZipFile(task) as archive:
                networks = [_member(archive, name) for name in (_DETECTOR, _LANDMARKER)]
        except (OSError, KeyError, ValueError, zipfile.BadZipFile) as error:
            raise FileError(task, "is not a face_landmarker.task", "download it again") from error
        self._detector, self._landmarker = (Network(content, threads) for content in networks)
        self._anchors = _anchors()

    def find(self, picture: Pixels) -> Doubles | None:
        """(478, 2) pixels of the largest face in a (H, W, 3) RGB picture; None if there is none."""
        image = Image.fromarray(picture[..., :3])
        squares = self.faces(image)
        if not squares:
            return None
        face = self.landmarks(image, squares[0])
        if face is not None:  # the second pass uses the square found by the first
            face = self.landmarks(image, Square.around(face.points))
        return face.points[:, :2] if face is not None else None

    def faces(self, image: Image.Image, view: Square | None = None) -> list[Square]:
        """Squares around the faces of an RGB picture, the largest first.

        Args:
            view: the upright part of it to look at; None = all. Faces below about a tenth of that
                are not found.
        """
        width, height = image.size
        view = view or Square(width / 2, height / 2, max(width, height), 0.0)
        side = view.size
        cut = _cut(image, view, _SMALL) / 127.5 - 1.0
        boxes, scores = self._detector(cut[None])
        if boxes.shape[-1] == 1:
            boxes, scores = scores, boxes
        likely = _sigmoid(scores[0, :, 0].astype(np.float64))
        corner = np.array([view.x - side / 2, view.y - side / 2])
        found: list[Square] = []
        for k in np.argsort(-likely, kind="stable"):
            if likely[k] < _SEEN:
                break
            box = boxes[0, k].astype(np.float64) / _SMALL
            x, y = ((box[:2] + self._anchors[k]) * side + corner).tolist()
            right, left = box[4:8].reshape(2, 2) + self._anchors[k]
            angle = math.atan2(left[1] - right[1], left[0] - right[0])
            square = Square(x, y, float(max(box[2:4]) * side * _MARGIN), angle)
            if all(square.distance_to(o.x, o.y) > _SAME * o.size for o in found):
                found.append(square)
        return sorted(found, key=lambda square: -square.size)

    def landmarks(self, image: Image.Image, square: Square) -> FaceLandmarks | None:
        """The landmarks in a square of an RGB picture, or None if it shows no face."""
        outputs = self._landmarker(_cut(image, square, _LARGE)[None] / 255.0)
        points = next(o for o in outputs if o.size == 3 * LANDMARKS).reshape(LANDMARKS, 3)
        probability = float(_sigmoid(next(o.ravel() for o in outputs if o.size == 1))[0])
        if probability < _SEEN:
            return None
        local = points.astype(np.float64) / _LARGE
        local[:, :2] -= 0.5
        local *= square.size
        local[:, :2] = local[:, :2] @ _rotation(square.angle).T + (square.x, square.y)
        return FaceLandmarks(local, probability)


class Network:
    """One LiteRT network."""

    def __init__(self, content: bytes, threads: int) -> None:
        from ai_edge_litert.interpreter import Interpreter

        with _silence():
            self._interpreter = Interpreter(model_content=content, num_threads=threads)
            self._interpreter.allocate_tensors()
        self._input = self._interpreter.get_input_details()[0]["index"]
        self._outputs = [output["index"] for output in self._interpreter.get_output_details()]

    def __call__(self, values: Any) -> list[Any]:
        self._interpreter.set_tensor(self._input, values.astype(np.float32))
        self._interpreter.invoke()
        return [self._interpreter.get_tensor(index) for index in self._outputs]


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Hold back what LiteRT says about itself on standard error, which nothing else turns off."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError, ValueError):  # there may be no standard error
            sys.stderr.flush()
            kept = os.dup(2)
            stack.callback(os.close, kept)
            nowhere = stack.enter_context(open(os.devnull, "wb"))
            os.dup2(nowhere.fileno(), 2)
            stack.callback(os.dup2, kept, 2)
        yield


def _member(archive: zipfile.ZipFile, name: str) -> bytes:
    if archive.getinfo(name).file_size > _LARGEST:
        raise ValueError(name)
    return archive.read(name)


def _anchors() -> Doubles:
    """(896, 2) centres of the detector's cells, 0..1."""
    rows = []
    for cells, repeats in ((16, 2), (8, 6)):
        middle = (np.arange(cells) + 0.5) / cells
        grid = np.stack(np.meshgrid(middle, middle), axis=-1).reshape(-1, 2)
        rows.append(np.repeat(grid, repeats, axis=0))
    return np.concatenate(rows)


def _sigmoid(values: Any) -> Any:
    return 1.0 / (1.0 + np.exp(-np.clip(values, -80.0, 80.0)))


def _rotation(angle: float) -> Doubles:
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]])


def _cut(image: Image.Image, square: Square, pixels: int) -> Any:
    """A turned square of a picture, (pixels, pixels, 3) float32; black outside."""
    cosine, sine = (f(square.angle) * square.size / pixels for f in (math.cos, math.sin))
    half = pixels / 2
    shift_x = square.x - cosine * half + sine * half
    shift_y = square.y - sine * half - cosine * half
    matrix = np.array((cosine, -sine, shift_x, sine, cosine, shift_y))
    shrink = max(1, int(square.size / pixels / 1.5))  # a large face would alias
    if shrink > 1:
        image, matrix = image.reduce(shrink), matrix / shrink
    cut = image.transform(
        (pixels, pixels), Image.Transform.AFFINE, tuple(matrix), Image.Resampling.BILINEAR
    )
    return np.asarray(cut, np.float32)
