"""The colours of the window. Colour-blind people can distinguish blue and orange."""

from __future__ import annotations

BACKGROUND = "#1f2227"  # behind everything
PANEL = "#272b31"  # bars, plots, cards
RAISED = "#323840"  # buttons and fields
HOVER = "#3c434d"
BORDER = "#3a4049"
TEXT = "#d7dae0"
MUTED = "#8a9099"  # captions, inactive things
FAINT = "#5c626b"  # disabled
ACCENT = "#56b4e9"  # sky: the lower face, focus, things switched on
ACCENT_DEEP = "#24597a"  # sky as a filled surface under light text
ORANGE = "#e69f00"  # the eyelids, and warnings
