"""The resolution of rough pictures: on slow computers it is lowered, so that drags stay smooth."""

from __future__ import annotations

from faceedit_app.ui.face.face_picture import Size

_BUDGET = 0.035  # seconds that a rough picture may take before its resolution is lowered
_COARSEST = 0.5


class RoughResolution:
    """The share of the full resolution that rough pictures have."""

    def __init__(self) -> None:
        self._share = 1.0

    def adapt(self, seconds: float) -> None:
        """Lower or raise it, after a rough picture took this long."""
        if seconds > _BUDGET:
            self._share = max(self._share * 0.8, _COARSEST)
        elif seconds < _BUDGET / 3:
            self._share = min(self._share * 1.1, 1.0)

    def size(self, full: Size) -> Size:
        """Width and height of a rough picture, from those of a smooth one."""
        return max(1, round(full[0] * self._share)), max(1, round(full[1] * self._share))
