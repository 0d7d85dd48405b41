"""The colours of the window. Blue and orange are told apart by colour-blind people too."""

from __future__ import annotations

BACKGROUND = "#1f2227"  # behind everything
PANEL = "#272b31"  # bars, plots, cards
RAISED = "#323840"  # buttons and fields
HOVER = "#3c434d"
BORDER = "#3a4049"
TEXT = "#d7dae0"
MUTED = "#8a9099"  # captions, what is not active
FAINT = "#5c626b"  # disabled
ACCENT = "#56b4e9"  # sky: the lower face, focus, what is switched on
ACCENT_DEEP = "#24597a"  # sky as a filled surface under light text
ORANGE = "#e69f00"  # the eyelids, and things to take note of
