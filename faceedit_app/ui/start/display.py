"""Checks for a display before Qt is started, because Qt would end the process without one."""

from __future__ import annotations

import os
import socket
import sys
from pathlib import Path

from faceedit_app.core import on_disk


def has_display() -> bool:
    """Whether there is a display, or Qt is set to run without one."""
    platform = os.environ.get("QT_QPA_PLATFORM", "")
    if sys.platform in ("win32", "darwin") or (
        platform and not platform.startswith(("xcb", "wayland"))
    ):
        return True
    return _wayland_answers() or _x11_answers()


def _wayland_answers() -> bool:
    name = os.environ.get("WAYLAND_DISPLAY")
    folder = Path(os.environ.get("XDG_RUNTIME_DIR", "/run"))
    return bool(name) and on_disk.exists(folder / str(name))


def _x11_answers() -> bool:
    """Connect to the X server that DISPLAY (`[host]:number[.screen]`) names."""
    host, colon, rest = os.environ.get("DISPLAY", "").rpartition(":")
    number = rest.partition(".")[0]
    if not colon or not number.isdigit():
        return False
    try:
        if host in ("", "unix") or host.startswith("/"):
            with socket.socket(socket.AF_UNIX) as connection:
                connection.connect(f"/tmp/.X11-unix/X{number}")
        else:
            socket.create_connection((host, 6000 + int(number)), timeout=2).close()
    except OSError:
        return False
    return True
