"""Keeps the value axes of all plots fitting: after each gesture, and still during one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.scale import Interval
from faceedit_app.ui.curves.value_range import LEAST, LEAST_SHARE, fitted, grown, stretched
from faceedit_app.ui.curves.visible_curves import VisibleCurves


class ValueAxes:
    """Chooses the millimetres that plots show, unless the user chose them.

    Args:
        plots: in the order of the curves.
    """

    def __init__(self, plots: Sequence[CurvePlot]) -> None:
        self._plots = plots
        self.curves: VisibleCurves | None = None
        self._resting: tuple[Interval, ...] = ()  # as they were before the gesture

    def fit(self) -> None:
        """Fit all to what is in view: no gesture is in progress."""
        self._resting = ()
        if self.curves is None:
            return
        for index, plot in enumerate(self._plots):
            if not plot.values_chosen:
                height = float(self.curves.high[index] - self.curves.low[index])
                least = LEAST if plot.close_up else LEAST_SHARE * height
                plot.show_values(fitted(*self.curves.extent(index), least))

    def make_room(self) -> None:
        """Extend those that a curve has left."""
        if self.curves is None:
            return
        for index, plot in enumerate(self._plots):
            if not plot.values_chosen:
                plot.show_values(grown(plot.values, *self.curves.extent(index)))

    def follow(self, values: Iterable[tuple[float, float]], held: CurvePlot | None) -> None:
        """Keep in sight what a gesture moves up or down; what stays inside leaves axes still.

        Args:
            values: of each curve at the frame that is changed: asked for, and the face's.
            held: the plot under the hand, which must not lose its curve.
        """
        self._resting = self._resting or tuple(plot.values for plot in self._plots)
        for plot, shown, (asked, face) in zip(self._plots, self._resting, values, strict=True):
            if plot.values_chosen:
                continue
            shown = stretched(shown, asked)
            plot.show_values(shown if plot is held else stretched(shown, face))

    def release(self, plots: Iterable[CurvePlot]) -> None:
        """Fit these again although the user chose what they show."""
        for plot in plots:
            plot.values_chosen = False
        self.fit()

    def toggle_close_up(self, plot: CurvePlot) -> None:
        """Fit an axis as closely as makes sense, or no longer."""
        plot.close_up = not (plot.close_up or plot.values_chosen)
        self.release((plot,))
