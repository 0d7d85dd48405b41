"""What an attack and the processes that read its files say to each other."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

READ, REFUSED = "read", "refused"
UNDAMAGED = -1  # the number of an input that is a valid file as it was made


@dataclass(frozen=True)
class Job:
    """What the processes of an attack have in common.

    Attributes:
        seed: the same seed makes the same inputs.
        keep: the folder for inputs that a reader did not cope with.
        samples: further valid files.
    """

    seed: int
    keep: Path
    samples: tuple[Path, ...] = ()

    def kept(self, path: Path, number: int, reader: str) -> Path:
        """A copy of an input that a reader did not cope with."""
        self.keep.mkdir(parents=True, exist_ok=True)
        name = f"fuzz_{self.seed}_{number}_{reader.replace(' ', '_')}{path.suffix}"
        shutil.copy(path, self.keep / name)
        return self.keep / name


@dataclass(frozen=True)
class Result:
    """What became of an input.

    Attributes:
        number: of the input; the same seed and number make it again.
        reader: what was read.
        outcome: `READ`, `REFUSED`, or what went wrong, one line.
        path: a copy of the input, if something went wrong.
    """

    number: int
    reader: str
    outcome: str
    path: Path | None = None

    @property
    def is_damaged(self) -> bool:
        """Whether the input was a damaged file, not a valid one as it was made."""
        return self.number != UNDAMAGED
