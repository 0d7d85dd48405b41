"""The progress of a command, as a bar on standard error."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from faceedit_app.core.texts import say

_EVERY = 60.0  # seconds between two lines


@contextmanager
def bar(title: str, total: float | None = None) -> Iterator[Callable[..., None]]:
    """Show a bar while a command works; it goes when the work is done.

    If standard error is no terminal, nothing is shown.

    Args:
        title: what is being worked on.
        total: how much there is to do; None = not known yet.

    Yields:
        What to call with how much is done, and with how much there is to do if that is not known.
    """
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as shown:
        task = shown.add_task(title, total=total)

        def advance(done: float, of: float | None = total) -> None:
            shown.update(task, completed=done, total=of)

        yield advance


@contextmanager
def bar_or_lines(
    title: str, total: float, unit: str, every: float = _EVERY
) -> Iterator[Callable[[float], None]]:
    """Show a bar while a command works for long; if standard error is no terminal, a line at times.

    Args:
        title: what is being done.
        total: how much there is to do.
        unit: of that.
        every: seconds between two lines.

    Yields:
        What to call, often, with how much is done.
    """
    last = time.monotonic()
    with bar(title, total) as shown:

        def advance(done: float) -> None:
            nonlocal last
            shown(done)
            if time.monotonic() - last >= every and not sys.stderr.isatty():
                last = time.monotonic()
                say(f"{title}: {done:,.0f} of {total:,.0f} {unit}", to=sys.stderr)

        yield advance
