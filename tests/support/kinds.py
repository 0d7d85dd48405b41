"""A small take in each kind of file that people bring, all at 30 frames a second."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Doubles
from faceedit_app.formats.metahuman import CONTROLS
from support import recordings
from support.takes import speech_like

FRAMES, RATE = 90, 30.0
FACE: Doubles = np.asarray(
    np.round(speech_like(FRAMES, RATE, ARKIT_CHANNELS).astype(np.float64), 3), np.float64
)

Named = dict[str, float]


@dataclass(frozen=True)
class Kind:
    """A kind of file.

    Attributes:
        ending: of its name.
        content: what is in it.
        says: part of a remark that it gets; "" if nothing is unusual.
        asks: whether it does not say its rate.
        step: the smallest change of a weight that it can hold.
    """

    ending: str
    content: Callable[[Path], bytes]
    says: str = ""
    asks: bool = False
    step: float = 1e-4

    def make(self, folder: Path) -> Path:
        """Write the file."""
        path = folder / f"kind{self.ending}"
        path.write_bytes(self.content(path))
        return path


def rows() -> list[Named]:
    """The weights of each frame, by name."""
    return [dict(zip(ARKIT_CHANNELS, row, strict=True)) for row in FACE.tolist()]


def table(
    sep: str = ",", decimal: str = ".", scale: float = 1.0, digits: int = 3, timed: bool = True
) -> str:
    """A CSV with a row a frame."""
    lines = [sep.join([*(["time_s"] if timed else []), *ARKIT_CHANNELS])]
    for n, row in enumerate(FACE):
        cells = [f"{n / RATE:.4f}"] * timed + [f"{scale * value:.{digits}f}" for value in row]
        lines.append(sep.join(cells).replace(".", decimal))
    return "\n".join(lines) + "\n"


def metahuman() -> str:
    """A CSV with the control curves of a MetaHuman."""
    owners = [(control, k) for k, name in enumerate(ARKIT_CHANNELS) for control in CONTROLS[name]]
    lines = [",".join(["time", *(f"CTRL_expressions_{control}" for control, _ in owners)])]
    for n, row in enumerate(FACE):
        lines.append(",".join([f"{n / RATE:.4f}", *(f"{row[k]:.3f}" for _, k in owners)]))
    return "\n".join(lines) + "\n"


def long_table() -> str:
    """A CSV with a line for each weight."""
    lines = [
        f"{n / RATE:.4f},{name},{value}"
        for n, row in enumerate(rows())
        for name, value in row.items()
    ]
    return "\n".join(["time,channel,value", *lines]) + "\n"


def stream() -> str:
    """What iFacialMocap sends."""
    return "".join(
        "|".join(f"{name}-{100 * value:.0f}" for name, value in row.items()) + "|=head#1,2,3|\n"
        for row in rows()
    )


def usda() -> str:
    """An animation in USD text."""
    names = ", ".join(f'"{name}"' for name in ARKIT_CHANNELS)
    samples = ",\n".join(f"{n}: {list(row.values())}" for n, row in enumerate(rows()))
    return f"""#usda 1.0
(
    timeCodesPerSecond = {RATE:g}
)
def SkelAnimation "Animation"
{{
    uniform token[] blendShapes = [{names}]
    float[] blendShapeWeights.timeSamples = {{
{samples}
    }}
}}
"""


def vtube_studio() -> str:
    """What VTube Studio's application on the phone sends, a line a frame."""
    return "\n".join(
        json.dumps(
            {
                "Timestamp": 1_650_000_000_000 + round(1000 * n / RATE),
                "FaceFound": True,
                "BlendShapes": [{"k": name, "v": value} for name, value in row.items()],
            }
        )
        for n, row in enumerate(rows())
    )


def frames() -> list[Any]:
    """JSON with a list of frames."""
    return [{"time": n / RATE, "face": row} for n, row in enumerate(rows())]


def texts() -> list[Any]:
    """The same, with texts for the numbers."""
    return [
        {"time": f"{n / RATE:.4f}", "face": {name: str(value) for name, value in row.items()}}
        for n, row in enumerate(rows())
    ]


def series() -> dict[str, Any]:
    """JSON with a list per channel."""
    return {"fps": RATE, "curves": dict(zip(ARKIT_CHANNELS, FACE.T.tolist(), strict=True))}


KINDS = {
    "UTF-16": Kind(".csv", lambda _: table("\t").encode("utf-16")),
    "decimal commas": Kind(".csv", lambda _: table(";", ",").encode()),
    "percent": Kind(".csv", lambda _: table(scale=100, digits=1).encode(), "0 to 100"),
    "bytes": Kind(".csv", lambda _: table(scale=255, digits=0).encode(), "0 to 255", step=1 / 255),
    "thousandths": Kind(
        ".csv", lambda _: table(scale=1000, digits=0).encode(), "0 to 1000", step=1e-3
    ),
    "without times": Kind(".csv", lambda _: table(timed=False).encode(), asks=True),
    "MetaHuman": Kind(".csv", lambda _: metahuman().encode(), "approximation"),
    "a line for each weight": Kind(".csv", lambda _: long_table().encode()),
    "iFacialMocap": Kind(".txt", lambda _: stream().encode(), "0 to 100", asks=True, step=0.01),
    "USD": Kind(".usda", lambda _: usda().encode()),
    "GLB": Kind(
        ".glb", lambda path: recordings.glb(path, FACE.astype(np.float64), RATE).read_bytes()
    ),
    "JSON frames": Kind(".json", lambda _: json.dumps(frames()).encode()),
    "JSON per channel": Kind(".json", lambda _: json.dumps(series(), indent=1).encode()),
    "JSON of texts": Kind(".json", lambda _: json.dumps(texts()).encode()),
    "VTube Studio": Kind(".jsonl", lambda _: vtube_studio().encode(), "milliseconds"),
}
