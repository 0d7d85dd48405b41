"""FaceEdit: edit tracked facial animation by dragging eight plain curves.

`faceedit_app.open("take.csv")` opens a take in Python; see docs/python.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from faceedit_app.core.privacy import send_no_telemetry
from faceedit_app.core.threads import use_one_thread

if TYPE_CHECKING:
    from faceedit_app.api import Take, open

__all__ = ["Take", "__version__", "open"]
__version__ = "0.1.0"

send_no_telemetry()
use_one_thread()


def __getattr__(name: str) -> Any:
    """Load the interface for Python when it is asked for, so that the window does not wait."""
    if name in ("Take", "open"):
        from faceedit_app import api

        return getattr(api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
