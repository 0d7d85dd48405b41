"""The command `faceedit bench`."""

from __future__ import annotations

import json
import sys
from typing import Annotated

import typer

from faceedit_app.core.errors import Unavailable


def bench(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="Few repetitions and short takes: a trial run.")
    ] = False,
) -> None:
    """Measure the window on this machine: from the mouse to the picture, playback, start."""
    if getattr(sys, "frozen", False):  # the installed application has no Python to start
        raise Unavailable("bench measures a FaceEdit that was installed with pip; use one")
    from faceedit_app.bench.report import QUICK, Plan, run, text

    found = run(QUICK if quick else Plan(), lambda what: print(f"{what}…", file=sys.stderr))
    print(json.dumps(found, indent=2) if as_json else text(found))
