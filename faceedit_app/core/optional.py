"""Optional parts: said in one line when they are missing, before anything imports them."""

from __future__ import annotations

import sys
from importlib.util import find_spec

from faceedit_app.core.errors import Unavailable


def require(module: str, extra: str) -> None:
    """Make sure that a module of an optional part is installed.

    Args:
        module: its name, such as `torch`.
        extra: the name of the part, as in `pip install "faceedit[extra]"`.

    Raises:
        Unavailable: it is not installed, or left out of the installed application.
    """
    if _present(module):
        return
    remedy = f'pip install "faceedit[{extra}]"'
    if getattr(sys, "frozen", False):
        raise Unavailable(
            f"The installed application leaves {extra} out; "
            f"in a Python 3.11 or newer of your own: {remedy}"
        )
    raise Unavailable(f"This needs {module.partition('.')[0]}, which is not installed; {remedy}")


def _present(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # a package above it is missing
        return False
