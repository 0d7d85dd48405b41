"""The laboratory's attacks: `faceedit fuzz`, `soak` and `kill`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Optional

import typer

from faceedit_app.command_line.ctrl_c import taken_as_request
from faceedit_app.command_line.progress import bar_or_lines
from faceedit_app.core.resources import DEMO_TAKE, shipped
from faceedit_app.core.texts import say

SeedOption = Annotated[int, typer.Option(min=0, help="Same seed: same attack.")]
KeepOption = Annotated[Path, typer.Option("--keep", help="Folder for what goes wrong.")]
LimitOption = Annotated[
    Optional[float],  # noqa: UP045  (typer reads the annotation at run time)
    typer.Option("--minutes", min=0.05, help="Stop after these, though not all is done."),
]


def fuzz(
    samples: Annotated[
        Optional[list[Path]],  # noqa: UP045  (typer reads the annotation at run time)
        typer.Argument(metavar="[FILE]...", help="Valid files to damage as well."),
    ] = None,
    inputs: Annotated[int, typer.Option(min=1, help="Damaged files in all.")] = 10_000,
    seed: SeedOption = 1,
    keep: KeepOption = Path("fuzz-failures"),
    jobs: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(min=1, help="How many processes read; default: one for each processor."),
    ] = None,
    minutes: LimitOption = None,
) -> int:
    """Feed damaged files to every reader: each is read rightly or refused in one line."""
    from faceedit_app.lab.attacks.fuzz import fuzz as attack

    seconds = None if minutes is None else 60.0 * minutes
    with (
        bar_or_lines("Fuzzing", inputs, "inputs") as advance,
        taken_as_request() as is_stopped,
    ):
        found = attack(inputs, seed, keep, samples or (), advance, jobs, seconds, is_stopped)
    return _verdict(seed, found.lines(), len(found.failures))


def soak(
    take: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Argument(help="A take; default: the demo take. It is not changed."),
    ] = None,
    minutes: Annotated[float, typer.Option(min=0.05, help="How long.")] = 10.0,
    seed: SeedOption = 1,
    character: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="A character of yours, shown now and then."),
    ] = None,
    keep: KeepOption = Path("soak-failures"),
) -> int:
    """Use the window at random, without a display, and check what it shows and exports."""
    from faceedit_app.lab.attacks.soak import soak as attack

    path = take if take is not None else shipped(DEMO_TAKE)
    with (
        bar_or_lines("Soaking", 60.0 * minutes, "s") as advance,
        taken_as_request() as is_stopped,
    ):
        found = attack(
            path,
            60.0 * minutes,
            seed,
            advance=advance,
            character=character,
            keep=keep,
            is_stopped=is_stopped,
        )
    return _verdict(seed, found.lines(), len(found.problems))


def kill(
    times: Annotated[int, typer.Option(min=1, help="Kills in all.")] = 100,
    seed: SeedOption = 1,
    jobs: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(min=1, help="How many windows at once; default: one for each processor."),
    ] = None,
    minutes: LimitOption = None,
) -> int:
    """Kill the window at random moments; every finished gesture must be recovered."""
    from faceedit_app.lab.attacks.kill import kill as attack

    seconds = None if minutes is None else 60.0 * minutes
    with (
        bar_or_lines("Killing", times, "windows") as advance,
        taken_as_request() as is_stopped,
    ):
        found = attack(times, seed, advance, jobs, seconds, is_stopped)
    return _verdict(seed, found.lines(), len(found.problems))


def _verdict(seed: int, lines: Sequence[str], failures: int) -> int:
    """Print how an attack went; returns the exit code."""
    say("\n".join(lines))
    if not failures:
        say(f"Nothing is wrong (seed {seed})")
        return 0
    say(f"{failures} wrong (seed {seed})")
    return 1


COMMANDS = (fuzz, soak, kill)
