"""Fits the value axes of all plots after each gesture, and keeps them still during one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.scale import Interval
from faceedit_app.ui.curves.value_range import LEAST, LEAST_SHARE, fitted, grown, stretched
from faceedit_app.ui.curves.visible_curves import VisibleCurves


class ValueAxes:
    """Chooses the range of millimetres of each plot, unless the user did.

    Args:
        plots: in curve order.
    """

    def __init__(self, plots: Sequence[CurvePlot]) -> None:
        self._plots = plots
        self.curves: VisibleCurves | None = None
        self._resting: tuple[Interval, ...] = ()  # ranges before the gesture

    def fit(self) -> None:
        """Fit all axes to what is in view; call it when no gesture is in progress."""
        self._resting = ()
        if self.curves is None:
            return
        for index, plot in enumerate(self._plots):
            if self.curves.has(index) and not plot.values_chosen:
                height = float(self.curves.high[index] - self.curves.low[index])
                least = LEAST if plot.close_up else LEAST_SHARE * height
                plot.show_values(fitted(*self.curves.extent(index), least))

    def make_room(self) -> None:
        """Extend the axes that a curve has left."""
        if self.curves is None:
            return
        for index, plot in enumerate(self._plots):
            if self.curves.has(index) and not plot.values_chosen:
                plot.show_values(grown(plot.values, *self.curves.extent(index)))

    def follow(self, values: Iterable[tuple[float, float]], held: CurvePlot | None) -> None:
        """Keep in sight what a gesture moves; axes that already include it stay still.

        Args:
            values: asked for and the face's, of each curve at the frame being changed.
            held: the plot being dragged, which must not lose its curve.
        """
        if self.curves is None:
            return
        self._resting = self._resting or tuple(plot.values for plot in self._plots)
        rows = zip(self._plots, self._resting, values, strict=True)
        for index, (plot, shown, (asked, face)) in enumerate(rows):
            if plot.values_chosen or not self.curves.has(index):
                continue
            shown = stretched(shown, self.curves.bounded(index, asked))
            plot.show_values(shown if plot is held else stretched(shown, face))

    def release(self, plots: Iterable[CurvePlot]) -> None:
        """Fit these plots again, although the user chose their range."""
        for plot in plots:
            plot.values_chosen = False
        self.fit()

    def toggle_close_up(self, plot: CurvePlot) -> None:
        """Switch the enlargement of small movements."""
        plot.close_up = not (plot.close_up or plot.values_chosen)
        self.release((plot,))
