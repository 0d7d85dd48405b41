"""The curves panel: a pyqtgraph plot for each control on one time axis, edited by dragging.

`CurvesPanel` is all that the window uses. Inside, from pure functions to Qt:
`scale`, `value_range`, `ticks`, `gestures`, `tools`, `edges` and `visible_curves` are pure
functions and small objects that know no Qt; `time_view`, `axes`, `lines` and `marks` are small
subclasses of pyqtgraph's items; `plot`, `ruler`, `range_bar`, `header` and `legend` are the
widgets, which only translate events; `interaction` turns gestures into edits of the session.
"""

from faceedit_app.ui.curves.panel import CurvesPanel

__all__ = ["CurvesPanel"]
