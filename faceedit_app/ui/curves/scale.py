"""From a plot's pixels to seconds and millimetres, and back."""

from __future__ import annotations

from dataclasses import dataclass

Interval = tuple[float, float]


@dataclass(frozen=True)
class Scale:
    """How a plot's pixels map to seconds and millimetres; y points down on the screen.

    Attributes:
        width, height: pixels.
        view: first and last visible second.
        values: lowest and highest visible millimetre.
    """

    width: float
    height: float
    view: Interval
    values: Interval

    @property
    def seconds_per_pixel(self) -> float:
        """Seconds per pixel."""
        return (self.view[1] - self.view[0]) / max(self.width, 1.0)

    @property
    def mm_per_pixel(self) -> float:
        """Millimetres per pixel."""
        return (self.values[1] - self.values[0]) / max(self.height, 1.0)

    def time_at(self, x: float) -> float:
        """Seconds at a pixel."""
        return self.view[0] + x * self.seconds_per_pixel

    def x_of(self, seconds: float) -> float:
        """Pixel of a time."""
        return (seconds - self.view[0]) / self.seconds_per_pixel

    def value_at(self, y: float) -> float:
        """Millimetres at a pixel."""
        return self.values[1] - y * self.mm_per_pixel

    def y_of(self, value: float) -> float:
        """Pixel of a value."""
        return (self.values[1] - value) / self.mm_per_pixel
