"""`faceedit`: opens the window, or runs a command (`command_line`)."""

from __future__ import annotations

import errno
import sys
from pathlib import Path

from faceedit_app.core import on_disk
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.texts import say
from faceedit_app.ui.start import display

USAGE_ERROR = 2
STOPPED = 130
_CHARACTER = "--character"
DEMO_OUTPUT = Path("out") / "demo"


def main(arguments: list[str] | None = None) -> int:
    """Run FaceEdit; returns the exit code: 0, 2 after one line on standard error, 130 at Ctrl+C."""
    given = sys.argv[1:] if arguments is None else arguments
    if "--multiprocessing-fork" in sys.argv:  # the installed application, as a process of a batch
        import multiprocessing

        multiprocessing.freeze_support()
    try:
        if _is_command(given):
            from faceedit_app.command_line.app import run_command

            return run_command(given)
        return _open_window(given)
    except FaceEditError as error:
        say(f"faceedit: {error.for_command}", to=sys.stderr)
        return USAGE_ERROR
    except OSError as error:  # such a name cannot even be looked for
        if error.errno != errno.ENAMETOOLONG:
            raise
        from faceedit_app.core.atomic import not_written

        say(f"faceedit: {not_written(error.filename, error).for_command}", to=sys.stderr)
        return USAGE_ERROR
    except KeyboardInterrupt:
        say("faceedit: stopped", to=sys.stderr)
        return STOPPED


def _is_command(given: list[str]) -> bool:
    """Whether this is anything but `faceedit [TAKE.csv | --demo] [--character HEAD.glb]`.

    A take that exists wins over a command of the same name. Decided without the command-line
    library, which would delay the window by a tenth of a second.
    """
    if len(given) >= 2 and given[-2] == _CHARACTER:
        given = given[:-2]
    if not given or given == ["--demo"]:
        return False
    return not (len(given) == 1 and (Path(given[0]).suffix or on_disk.exists(Path(given[0]))))


def _open_window(given: list[str]) -> int:
    character = None
    if len(given) >= 2 and given[-2] == _CHARACTER:
        character, given = Path(given[-1]), given[:-2]
    demo = given == ["--demo"]
    take = Path(given[0]) if given and not demo else None
    if display.has_display():
        from faceedit_app.ui.start.app import run

        return run(take, demo, character)
    if not demo:
        raise FaceEditError(
            "there is no display for a window; use faceedit apply, render or info, "
            "or faceedit --demo"
        )
    from faceedit_app.ui.start.headless import run_headless

    say("There is no display: editing the demo take without a window. Written:")
    for path in run_headless(DEMO_OUTPUT):
        say(f"  {path}")
    return 0
