"""The networks of one region, run by ONNX Runtime."""

from __future__ import annotations

import stat
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np
import onnxruntime as ort

from faceedit_app.core.arrays import Floats
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FileError, reason_of
from faceedit_app.core.fields import FieldError
from faceedit_app.networks.description import KEY, Description, UnusableModel
from faceedit_app.networks.graph import INPUT, LARGEST, read_graph

MEMORY = 256 << 20  # bytes, for all networks of the process; ours take about 10 MB
LONGEST = 1_024  # frames besides the context in the trial run: more than the longest chunk
LARGEST_WEIGHT = 1_000.0  # far above any trained network's


class RegionAnswer:
    """The trained networks of one region, ready to answer.

    Args:
        content: an ONNX file.
        path: its path, for messages.

    Attributes:
        description: what the file says about the networks.
        columns: (C,) the columns of their controls among all controls.

    Raises:
        FileError: it is not a model, is damaged, or cannot be used by this FaceEdit.
    """

    def __init__(self, content: bytes, path: Path) -> None:
        with damage_named(path):
            graph = read_graph(content)
            self.description = about = Description.from_json(graph.texts[KEY], path)
            if (graph.controls, graph.weights) != (len(about.controls), len(about.channels)):
                raise ValueError(f"from {graph.controls} controls to {graph.weights} channels")
            self.columns = [CONTROL_INDEX[control] for control in about.controls]
            self._outputs = graph.outputs
            self._session = session(content)
            self._try_out()

    def __call__(self, curves: Floats, naturalness: float) -> Floats:
        """(T, C) mm at 25 fps -> (T, K) weights, not limited to 0..1.

        Args:
            curves: the description's controls; T is a multiple of its scale.
            naturalness: 0 = the regressor alone, 1 = regressor and autoencoder; ignored if there
                is one network.
        """
        return self.answer(self.run(curves, naturalness), naturalness)

    def run(self, curves: Floats, naturalness: float) -> list[Floats]:
        """Run the networks for `answer`: nearly all of it without Python's lock."""
        wanted = [
            name
            for name, share in (("regressor", 1 - naturalness), ("system", naturalness))
            if share > 0 and name in self._outputs
        ]
        answers: list[Floats] = self._session.run(wanted or ["system"], {INPUT: curves})
        return answers

    def answer(self, found: list[Floats], naturalness: float) -> Floats:
        """(T, K) weights, of what `run` has found."""
        answer = _mixed(found, naturalness)
        if not np.isfinite(answer).all():  # a manipulated model: must not reach a take
            answer = np.nan_to_num(answer, nan=0.0, posinf=LARGEST_WEIGHT, neginf=-LARGEST_WEIGHT)
        return answer

    def _try_out(self) -> None:
        """Run the networks once; raise ValueError if the answer is wrong."""
        about = self.description
        longest = about.scale * -(-(LONGEST + 2 * about.context) // about.scale)
        for frames in (about.scale, longest):
            curves = np.linspace(about.low, about.high, frames, dtype=np.float32)
            answer = _mixed(self.run(curves, 0.5), 0.5)
            if answer.shape != (frames, len(about.channels)):
                raise ValueError(f"{frames} frames are answered by {answer.shape}")
            if not np.abs(answer).max() < LARGEST_WEIGHT:
                raise ValueError("answers that are not weights")


def _mixed(found: list[Floats], naturalness: float) -> Floats:
    """(T, K) between what the regressor and the autoencoder have found, if both have."""
    if len(found) == 1:
        return found[0]
    regressed, believable = found
    with np.errstate(over="ignore", invalid="ignore"):  # the caller checks the result
        return regressed + np.float32(naturalness) * (believable - regressed)


@contextmanager
def damage_named(path: Path) -> Iterator[None]:
    """Name the model's file in any error, also in the runtime's, which have no common class.

    Raises:
        FileError: there was an error.
    """
    try:
        yield
    except FileError:
        raise
    except FieldError as error:
        raise UnusableModel(path, f"is not a FaceEdit model: {error}") from error
    except Exception as error:
        raise UnusableModel(path, "is not a FaceEdit model, or is damaged") from error


def read_region(path: Path | str) -> RegionAnswer:
    """Read a region's networks from their file.

    Raises:
        FileError: it is missing, not a model, damaged, or cannot be used by this FaceEdit.
    """
    path = Path(path)
    return RegionAnswer(read_bytes(path), path)


def read_bytes(path: Path) -> bytes:
    """Read a model's file.

    Raises:
        FileError: it cannot be read, or is too large.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # a pipe may never end
            raise UnusableModel(path, "is not a file")
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        reason = reason_of(error)
        raise UnusableModel(path, f"cannot be read ({reason})") from error
    if len(content) > LARGEST:
        raise UnusableModel(path, "is too large for a FaceEdit model")
    return content


def session(content: bytes) -> ort.InferenceSession:
    """A session with one thread, so that an answer depends on nothing but the curves."""
    _prepare()
    options = ort.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.execution_mode = ort.ExecutionMode.ORT_SEQUENTIAL
    options.log_severity_level = 4  # the exception says what is wrong
    options.add_session_config_entry("session.use_env_allocators", "1")
    opened = ort.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    opened._model_bytes = None  # 1.3 MB, kept for a change of providers
    return opened


@cache
def _prepare() -> None:
    """Limit the memory of all sessions."""
    ort.disable_telemetry_events()  # also where the variable of `core/privacy.py` is not read
    kind = ort.OrtAllocatorType.ORT_ARENA_ALLOCATOR
    memory = ort.OrtMemoryInfo("Cpu", kind, 0, ort.OrtMemType.DEFAULT)
    ort.create_and_register_allocator(memory, ort.OrtArenaCfg({"max_mem": MEMORY}))
