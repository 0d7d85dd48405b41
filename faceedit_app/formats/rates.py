"""The usual frame rates, and which of them a measured one is."""

from __future__ import annotations

from collections.abc import Iterable

SET_RATE = "Take > Frame rate, or the option fps"  # where the user gives it
_ELSE = f"; if it has another frame rate, set that: {SET_RATE}"
COMMON_RATES = (24.0, 25.0, 30000 / 1001, 30.0, 48.0, 50.0, 60000 / 1001, 60.0, 90.0, 120.0)
RATES = (10, 12, 15, 20, 24, 25, 30, 48, 50, 60, 90, 100, 120, 240)
_BROADCAST_RATES = tuple(rate * 1000 / 1001 for rate in (12, 15, 24, 30, 48, 60, 120))
# 29.97 and 30 are 0.1 % apart: the lower rate is chosen only if it is clearly nearer.
_BROADCAST_TOLERANCE = 0.0003
_ROUNDED = 0.0045  # the rounding error of a broadcast rate with two decimals
# Cameras drift from their nominal rate; Live Link Face at "60" was measured at 59.9.
_DRIFT = 0.005


def nominal_rate(measured: float, uncertainty: float) -> float | None:
    """The standard rate that fits a measured one, or None.

    Args:
        measured: frames per second.
        uncertainty: the relative error of the measurement.
    """
    if uncertainty <= _BROADCAST_TOLERANCE:
        for rate in _BROADCAST_RATES:
            if abs(measured / rate - 1) <= _BROADCAST_TOLERANCE:
                return rate
    nearest = min(RATES, key=lambda rate: abs(measured / rate - 1))
    if abs(measured / nearest - 1) <= max(_DRIFT, min(uncertainty, 0.05)):
        return float(nearest)
    return None


def exact_rate(rate: float) -> float:
    """The broadcast rate that a rounded one stands for (23.976, 29.97, 59.94), else the rate."""
    return next((exact for exact in _BROADCAST_RATES if abs(rate - exact) < _ROUNDED), rate)


def unsure(note: str) -> str:
    """A note about a frame rate that the file leaves open, with what to do if it is wrong."""
    return note + _ELSE


def sure_notes(notes: Iterable[str]) -> tuple[str, ...]:
    """The notes that still hold if the user gives the frame rate."""
    return tuple(note for note in notes if not note.endswith(SET_RATE))
