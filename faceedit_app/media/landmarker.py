"""Find landmarks of a face in a picture, by MediaPipe's networks run by LiteRT.

Two of the three networks in `face_landmarker.task` (Google, Apache-2.0; users download it) are
used: one finds the face, the other its 478 landmarks in a square around it.
"""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from faceedit_app.core.arrays import Doubles, Pixels
from faceedit_app.core.errors import FileError
from faceedit_app.core.optional import require

LANDMARKS = 478
_DETECTOR, _LANDMARKER = "face_detector.tflite", "face_landmarks_detector.tflite"
_LARGEST = 64 << 20  # bytes of one network
_SEEN = 0.5  # least probability of a face
_SMALL, _LARGE = 128, 256  # pixels of the networks' input
_MARGIN = 2.0  # of the detector's box


class FaceLandmarker:
    """Finds the landmarks of a face.

    Args:
        task: the file `face_landmarker.task`.

    Raises:
        Unavailable: LiteRT is not installed.
        FileError: the file is missing or something else.
    """

    def __init__(self, task: Path) -> None:
        require("ai_edge_litert", extra="scans")
        try:
            if task.exists() and not task.is_file():  # a pipe may never end
                raise ValueError(task)
            with zipfile.ZipFile(task) as archive:
                networks = [_member(archive, name) for name in (_DETECTOR, _LANDMARKER)]
        except (OSError, KeyError, ValueError, zipfile.BadZipFile) as error:
            raise FileError(task, "is not a face_landmarker.task", "download it again") from error
        self._detector, self._landmarker = (_Network(content) for content in networks)
        self._anchors = _anchors()

    def find(self, picture: Pixels) -> Doubles | None:
        """(478, 2) pixels of a (H, W, 3) RGB picture; None if there is no face."""
        image = Image.fromarray(picture[..., :3])
        square = self._face(image)
        if square is None:
            return None
        for _ in range(2):  # the second pass uses the square found by the first
            x, y, size, angle = square
            cut = _cut(image, x, y, size, angle, _LARGE) / 255.0
            outputs = self._landmarker(cut[None])
            points = next(o for o in outputs if o.size == 3 * LANDMARKS).reshape(LANDMARKS, 3)
            likelihood = next(float(o.ravel()[0]) for o in outputs if o.size == 1)
            if 1.0 / (1.0 + np.exp(-likelihood)) < _SEEN:
                return None
            local = (points[:, :2].astype(np.float64) / _LARGE - 0.5) * size
            cosine, sine = np.cos(angle), np.sin(angle)
            turn = np.array([[cosine, sine], [-sine, cosine]])
            placed: Doubles = local @ turn + (x, y)
            square = _square(placed)
        return placed

    def _face(self, image: Image.Image) -> tuple[float, float, float, float] | None:
        """Centre, size and angle of a square around the most likely face, or None."""
        width, height = image.size
        side = max(width, height)
        cut = _cut(image, width / 2, height / 2, side, 0.0, _SMALL) / 127.5 - 1.0
        boxes, scores = self._detector(cut[None])
        if boxes.shape[-1] == 1:
            boxes, scores = scores, boxes
        best = int(scores[0, :, 0].argmax())
        if 1.0 / (1.0 + np.exp(-float(np.clip(scores[0, best, 0], -80, 80)))) < _SEEN:
            return None
        box = boxes[0, best].astype(np.float64) / _SMALL
        corner = np.array([width / 2 - side / 2, height / 2 - side / 2])
        centre = (box[:2] + self._anchors[best]) * side + corner
        right, left = box[4:8].reshape(2, 2) + self._anchors[best]
        angle = float(np.arctan2(left[1] - right[1], left[0] - right[0]))
        return float(centre[0]), float(centre[1]), float(max(box[2:4]) * side * _MARGIN), angle


class _Network:
    """One LiteRT network."""

    def __init__(self, content: bytes) -> None:
        from ai_edge_litert.interpreter import Interpreter

        self._interpreter = Interpreter(model_content=content, num_threads=1)
        self._interpreter.allocate_tensors()
        self._input = self._interpreter.get_input_details()[0]["index"]
        self._outputs = [output["index"] for output in self._interpreter.get_output_details()]

    def __call__(self, values: Any) -> list[Any]:
        self._interpreter.set_tensor(self._input, values.astype(np.float32))
        self._interpreter.invoke()
        return [self._interpreter.get_tensor(index) for index in self._outputs]


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


def _square(points: Doubles) -> tuple[float, float, float, float]:
    """A square around landmarks, level with the eyes."""
    eyes = points[263] - points[33]
    angle = float(np.arctan2(eyes[1], eyes[0]))
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    upright = points @ turn
    low, high = upright.min(axis=0), upright.max(axis=0)
    x, y = turn @ ((low + high) / 2)
    return float(x), float(y), float((high - low).max() * 1.5), angle


def _cut(image: Image.Image, x: float, y: float, size: float, angle: float, pixels: int) -> Any:
    """A turned square of a picture, (pixels, pixels, 3) float32; black outside."""
    cosine, sine = np.cos(angle) * size / pixels, np.sin(angle) * size / pixels
    half = pixels / 2
    shift_x = x - cosine * half + sine * half
    shift_y = y - sine * half - cosine * half
    matrix = np.array((cosine, -sine, shift_x, sine, cosine, shift_y))
    shrink = max(1, int(size / pixels / 1.5))  # a large face would alias
    if shrink > 1:
        image, matrix = image.reduce(shrink), matrix / shrink
    cut = image.transform(
        (pixels, pixels), Image.Transform.AFFINE, tuple(matrix), Image.Resampling.BILINEAR
    )
    return np.asarray(cut, np.float32)
