"""The completion network of a region: what curves that were not asked for do in an edit.

It is a file of its own in the folder `completion` of a model, which may lack it: requests are then
completed by the most probable change alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, Fields, parse, to_text
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.networks.description import KEY, UnusableModel
from faceedit_app.networks.graph import INPUT, read_graph
from faceedit_app.networks.made_for import MadeFor
from faceedit_app.networks.region import damage_named, read_bytes, session

FOLDER = "completion"
"""Below a folder of models: the completion networks, one file a region that has one."""
VERSION = 1
FEATURES = 5  # of each control, see `editing.solving.completing`
LARGEST = 100.0  # standard deviations, far above what a trained network answers
_LONGEST_NAME, _LARGEST_SCALE = 40, 64


@dataclass(frozen=True)
class CompletionDescription:
    """The description of a completion network in its file.

    Attributes:
        region: `Region.id`.
        controls: ids of the region's C own controls.
        made_for: the character that the controls were measured on.
        architecture: its settings.
        scale: input lengths must be a multiple of this.
    """

    region: str
    controls: tuple[str, ...]
    made_for: MadeFor
    architecture: dict[str, Any]
    scale: int

    def to_json(self) -> str:
        """The description as JSON text."""
        return to_text(
            {
                "completion": VERSION,
                "region": self.region,
                "controls": self.controls,
                "made_for": self.made_for.to_json(),
                "architecture": self.architecture,
                "rate": GRID_RATE,
                "scale": self.scale,
            }
        )

    @classmethod
    def from_json(cls, text: str, path: Path) -> CompletionDescription:
        """Parse the text from a file.

        Raises:
            FileError: this FaceEdit cannot use the network.
            ValueError: the text is not from `to_json`; a `FieldError` names the field.
        """
        entry = Fields(parse(text))
        if (version := entry.whole("completion")) != VERSION:
            raise FileError(path, f"has version {version}, not {VERSION}", "update FaceEdit")
        if (rate := entry.number("rate")) != GRID_RATE:
            raise UnusableModel(path, f"answers {rate:g} frames a second, not {GRID_RATE:g}")
        controls = entry.texts("controls")
        if not controls or not set(controls) <= set(CONTROL_IDS):
            raise FieldError('"controls" names no control, or an unknown one')
        return cls(
            region=entry.text("region", longest=_LONGEST_NAME),
            controls=controls,
            made_for=MadeFor.from_json(entry.fields("made_for"), controls),
            architecture=entry.plain("architecture"),
            scale=entry.whole("scale", 1, _LARGEST_SCALE),
        )


class CompletionNetwork:
    """A trained completion network, ready to answer.

    Args:
        content: an ONNX file.
        path: its path, for messages.

    Attributes:
        description: what the file says about it.

    Raises:
        FileError: it is not a completion network, is damaged, or cannot be used by this FaceEdit.
    """

    def __init__(self, content: bytes, path: Path) -> None:
        with damage_named(path):
            graph = read_graph(content)
            self.description = about = CompletionDescription.from_json(graph.texts[KEY], path)
            count = len(about.controls)
            if (graph.controls, graph.weights) != (FEATURES * count, 1 + count):
                raise ValueError(f"from {graph.controls} features to {graph.weights} answers")
            self._session = session(content)
            self(np.zeros((3 * about.scale - 1, FEATURES * count)))

    def __call__(self, features: Doubles) -> tuple[Doubles, Doubles]:
        """What curves that were not asked for do.

        Args:
            features: (T, 5 C) see `editing.solving.completing.ask`; T any length.

        Returns:
            (T,) in 0..1, how far the take gives way to what is around the edit, and (T, C) by how
            much further, in standard deviations of the take's curves.
        """
        length, width = features.shape
        padded = np.zeros((length + -length % self.description.scale, width), np.float32)
        padded[:length] = features
        answer = self._session.run(["system"], {INPUT: padded})[0][:length].astype(np.float64)
        # The answer of a manipulated file must not reach a take.
        if not np.abs(answer).max(initial=0.0) < LARGEST:
            answer = np.nan_to_num(answer, nan=0.0).clip(-LARGEST, LARGEST)
        return answer[:, 0].clip(0.0, 1.0), answer[:, 1:]


def read_completion(path: Path) -> CompletionNetwork:
    """Read a completion network from its file.

    Raises:
        FileError: it is missing, not a model, damaged, or cannot be used by this FaceEdit.
    """
    return CompletionNetwork(read_bytes(path), path)
