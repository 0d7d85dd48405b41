"""Colours, icons and small widgets."""

from faceedit_app.ui.look.overrides import make_errors_whole

make_errors_whole()  # all of the window is built upon this package
