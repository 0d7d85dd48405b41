"""Arguments and options that several commands of `faceedit` have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Optional

import typer

from faceedit_app.core.errors import FileError

# typer reads annotations at run time, so they stay in the old form.
TakeArgument = Annotated[Path, typer.Argument(help="A take, such as a Live Link Face CSV.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON.")]
FpsOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option("--fps", help="Frames per second, if the take does not give them."),
]
TakeFpsOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option("--take-fps", help="Frames per second of a take that does not give them."),
]
EditsOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("--edits", help="Edits (JSON) to apply first."),
]
CharacterOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("--character", help="Your character: GLB, VRM, FBX or OBJ with blendshapes."),
]
ModelsOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("--models", help="Folder of models; default: those that ship with FaceEdit."),
]
OverwriteOption = Annotated[
    bool,
    typer.Option("--overwrite", help="Allow replacing a recording; it is kept as NAME.bak."),
]
FollowHeadOption = Annotated[
    bool,
    typer.Option("--follow-head", help="Turn the head as it was recorded; it is straight if not."),
]


def check_csv(path: Path) -> None:
    """Check the name of a new take that is always a Live Link Face CSV.

    Raises:
        FileError: it does not end like one.
    """
    if path.suffix.lower() != ".csv":
        problem = "would be a Live Link Face CSV, but does not end in .csv"
        raise FileError(path, problem, "choose a name that does; faceedit convert writes others")
