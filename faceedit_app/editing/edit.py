"""One user action on controls over a time range, and the file that lists them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import CONTROL_IDS

VERSION = 1
# Far beyond any take and any face, and far below where sums stop being numbers.
LARGEST = 1e6
LONGEST_SMOOTH = 10.0  # seconds


class Op(StrEnum):
    """What an edit does to a curve; `Edit.value` is its amount."""

    OFFSET = "offset"  # add `value` mm
    SET = "set"  # go to `value` mm
    SCALE = "scale"  # multiply the distance from the take's median by `value`
    SMOOTH = "smooth"  # zero-phase Gaussian of `value` seconds standard deviation
    RESET = "reset"  # back to the take as tracked; `value` is ignored


@dataclass(frozen=True)
class Edit:
    """A non-destructive change of one or more curves.

    Attributes:
        controls: ids of the curves that change.
        op: what is done.
        start, end: seconds; the full change holds from start to end.
        falloff: seconds over which the change fades in before start and out after end.
        value: the amount, see `Op`.
    """

    controls: tuple[str, ...]
    op: Op
    start: float
    end: float
    falloff: float
    value: float = 0.0

    def __post_init__(self) -> None:
        if unknown := [c for c in self.controls if c not in CONTROL_IDS]:
            raise ValueError(f"unknown control {unknown[0]!r}")
        if not self.controls:
            raise ValueError("it names no control")
        if len(set(self.controls)) < len(self.controls):
            raise ValueError("it names a control twice")
        numbers = (self.start, self.end, self.falloff, self.value)
        if not all(math.isfinite(number) and abs(number) <= LARGEST for number in numbers):
            raise ValueError(f"its numbers must lie between -{LARGEST:.0f} and {LARGEST:.0f}")
        if self.end < self.start:
            raise ValueError("its end lies before its start")
        if self.falloff < 0:
            raise ValueError("its falloff is negative")
        if self.op in (Op.SCALE, Op.SMOOTH) and self.value < 0:
            raise ValueError(f"a {self.op} needs a value of at least 0")
        if self.op is Op.SMOOTH and self.value > LONGEST_SMOOTH:
            raise ValueError(f"a smooth needs a value of at most {LONGEST_SMOOTH:.0f} seconds")

    @property
    def reach(self) -> tuple[float, float]:
        """First and last second at which the edit changes what was asked for."""
        return self.start - self.falloff, self.end + self.falloff

    def mask(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """How much of the edit applies at `times` (T,): 1 in the hold, cosine falloff, 0."""
        outside = np.maximum(np.maximum(self.start - times, times - self.end), 0.0)
        # Half a nanosecond of slack keeps a frame that stands on the edge on the inside.
        if self.falloff < 1e-9:
            return (outside <= 5e-10).astype(np.float64)
        inside = np.clip(1.0 - outside / self.falloff, 0.0, 1.0)
        return 0.5 - 0.5 * np.cos(np.pi * inside)


def to_json(edit: Edit) -> dict[str, Any]:
    """The edit as it stands in an edits file."""
    named: dict[str, Any] = (
        {"control": edit.controls[0]} if len(edit.controls) == 1 else {"controls": [*edit.controls]}
    )
    return named | {
        "op": edit.op.value,
        "start": edit.start,
        "end": edit.end,
        "falloff": edit.falloff,
        "value": edit.value,
    }


def from_json(entry: Mapping[str, Any]) -> Edit:
    """Read one entry of an edits file.

    Raises:
        ValueError: what is wrong with it, as a phrase.
    """
    known = {"control", "controls", "op", "start", "end", "falloff", "value"}
    if extra := set(entry) - known:
        raise ValueError(f"it has an unknown field {sorted(extra)[0]!r}")
    names = entry.get("controls", [entry.get("control")])
    if (
        {"control", "controls"} <= set(entry)
        or not isinstance(names, list)
        or not all(isinstance(name, str) for name in names)
    ):
        raise ValueError('it needs "control" (a name) or "controls" (a list of names)')
    try:
        op = Op(str(entry.get("op")))
    except ValueError:
        raise ValueError(f'its "op" must be one of {", ".join(Op)}') from None
    numbers = {"falloff": 0.0, "value": 0.0} | {
        k: entry[k] for k in ("start", "end", "falloff", "value") if k in entry
    }
    required = {"start", "end"} | (set() if op is Op.RESET else {"value"})
    for name in sorted(required - set(entry)):
        raise ValueError(f'it lacks "{name}"')
    for name, number in numbers.items():
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise ValueError(f'its "{name}" is not a number')
    # Whole numbers have no largest; one that no float holds is as bad as infinity.
    floats = {k: float(min(max(v, -1e300), 1e300)) for k, v in numbers.items()}
    return Edit(tuple(names), op, **floats)


def write_edits(path: Path | str, edits: Iterable[Edit]) -> None:
    """Save edits as a readable JSON file, one edit a line."""
    lines = ",\n    ".join(json.dumps(to_json(edit)) for edit in edits)
    text = f'{{\n  "version": {VERSION},\n  "edits": [\n    {lines}\n  ]\n}}\n'
    write_atomically(path, text.encode())


def read_edits(path: Path | str) -> tuple[Edit, ...]:
    """Read an edits file.

    Raises:
        FileError: it cannot be read, is no edits file, or an edit in it is not usable.
    """
    path = Path(path)
    try:
        document = json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise FileError(
            path, f"cannot be read ({(error.strerror or '').lower()})", "check the path"
        ) from error
    except json.JSONDecodeError as error:
        raise FileError(
            path, f"is not JSON ({error.msg})", "save the edits again", error.lineno
        ) from error
    except (ValueError, RecursionError) as error:  # no UTF-8, or numbers or lists without end
        raise FileError(path, "is no edits file", "choose an edits file (JSON)") from error
    if not isinstance(document, dict) or not isinstance(document.get("edits"), list):
        raise FileError(path, 'has no list of "edits"', "choose an edits file saved by FaceEdit")
    if document.get("version") != VERSION:
        raise FileError(
            path,
            f"has version {document.get('version')!r}, this FaceEdit reads version {VERSION}",
            "update FaceEdit",
        )
    edits = []
    for number, entry in enumerate(document["edits"], start=1):
        try:
            if not isinstance(entry, dict):
                raise ValueError("it is not an object")
            edits.append(from_json(entry))
        except ValueError as error:
            raise FileError(path, f"edit {number}: {error}", "correct that edit") from error
    return tuple(edits)
