"""The curves panel: eight plots on one time axis, and editing them by dragging.

`CurvesPanel` is all that the window needs. Inside, from plain to Qt:
`polyline`, `axes` and `gestures` are pure functions and small frozen objects that know no Qt;
`style` and `paint` say what things look like; `plot`, `header`, `ruler` and `legend` are the
widgets, which only translate events; `interaction` turns gestures into edits of the session.
"""

from faceedit_app.ui.curves.panel import CurvesPanel

__all__ = ["CurvesPanel"]
