"""The progress of a command, as a bar on standard error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


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
