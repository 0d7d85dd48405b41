"""The colours of the window. Colour-blind people can distinguish blue and orange.

Every text has a contrast of 4.5:1 or more with what is behind it (`tests/ui/test_contrast.py` and
`test_every_dialog.py`).
"""

from __future__ import annotations

BACKGROUND = "#1f2227"  # behind everything
PANEL = "#272b31"  # bars, plots, cards
RAISED = "#323840"  # buttons and fields
HOVER = "#3c434d"
BORDER = "#3a4049"
TEXT = "#d7dae0"
LABEL = "#b4b9c2"  # names of the curves
MUTED = "#a3a9b2"  # captions, inactive things
DISABLED = "#8d939c"  # text of disabled things
FAINT = "#5c626b"  # icons and lines of disabled things, never text
ACCENT = "#56b4e9"  # sky: the lower face, focus, things switched on
ACCENT_DEEP = "#1e4c69"  # sky as a filled surface under light text
ACCENT_HOVER = "#28597a"  # the same under the pointer
ORANGE = "#e69f00"  # the eyelids, and warnings
