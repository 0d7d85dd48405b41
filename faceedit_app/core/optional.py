"""Optional dependencies: check that they are installed before they are imported."""

from __future__ import annotations

import sys
from importlib.util import find_spec

from faceedit_app.core.errors import Unavailable


def require(module: str, extra: str, package: str = "") -> None:
    """Check that an optional module is installed.

    Args:
        module: its name, such as `torch`.
        extra: the extra that installs it, as in `pip install "faceedit[extra]"`.
        package: the package that installs it, if FaceEdit needs it without an extra: some systems
            have no build of it.

    Raises:
        Unavailable: it is not installed, or not part of the installed application.
    """
    if _present(module):
        return
    remedy = f"pip install {package}" if package else f'pip install "faceedit[{extra}]"'
    if extra and getattr(sys, "frozen", False):
        raise Unavailable(
            f"The installed application leaves {extra} out; "
            f"install FaceEdit in Python 3.11 or newer: {remedy}"
        )
    raise Unavailable(f"This needs {module.partition('.')[0]}, which is not installed; {remedy}")


def _present(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # a parent package is missing
        return False
