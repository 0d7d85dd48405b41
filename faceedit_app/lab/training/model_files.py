"""The trained networks of a region to and from their file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.lab.training.architectures import ARCHITECTURES, Architecture
from faceedit_app.lab.training.export import export, parameters
from faceedit_app.networks.description import Description, UnusableModel
from faceedit_app.networks.region import RegionAnswer, read_bytes

# Torch counts batches in every normalisation, and we make no use of it.
_COUNTER = "num_batches_tracked"


@dataclass
class TrainedRegion:
    """The trained networks of one region and what the data said about it."""

    description: Description
    networks: Architecture

    def answering(self) -> RegionAnswer:
        """The networks as the application would use them, without a file."""
        content = export(self.networks, self.description)
        return RegionAnswer(content, Path(f"{self.description.region}.onnx"))


def save_trained(path: Path | str, region: TrainedRegion) -> None:
    """Write a region's networks; the same networks always give the same bytes.

    Raises:
        FileError: it cannot be written.
    """
    write_atomically(path, export(region.networks, region.description))


def load_trained(path: Path | str) -> TrainedRegion:
    """Read a region's networks, ready to be trained further.

    Raises:
        FileError: missing, no model, damaged, of another version or of an unknown architecture.
    """
    path = Path(path)
    content = read_bytes(path)
    description = RegionAnswer(content, path).description
    settings = dict(description.architecture)
    name = settings.pop("name")
    if name not in ARCHITECTURES:
        raise FileError(path, f"has the unknown architecture {name[:40]!r}", "update FaceEdit")
    try:
        networks = ARCHITECTURES[name](
            len(description.controls), len(description.channels), **settings
        )
        state, found = networks.state_dict(), parameters(content)
        wanted = {key for key in state if not key.endswith(_COUNTER)}
        networks.load_state_dict(state | {key: found[key] for key in wanted})
    except (KeyError, RuntimeError, TypeError, ValueError) as error:
        raise UnusableModel(path, f"does not hold the parameters of {name}") from error
    return TrainedRegion(description, networks.eval())
