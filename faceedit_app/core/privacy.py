"""Nothing is sent to anybody, unless the user asks for it.

From version 1.32 on, ONNX Runtime collects data about its use on Linux as well. When it is
imported, it writes an identifier of the machine into the home folder.
"""

from __future__ import annotations

import os


def send_no_telemetry() -> None:
    """Turn off the telemetry of every package that has one, in this process and those it starts.

    Called when the package is imported, before any other package is.
    """
    os.environ["ORT_DISABLE_TELEMETRY"] = "1"
