"""Line charts as SVG text: small, sharp at any size, the same bytes for the same numbers.

A plotting library would weigh more than the training; Markdown shows SVG as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
"""Okabe and Ito's colours, which people with any colour vision can distinguish."""

WIDTH, HEIGHT = 640, 300
LEFT, RIGHT, TOP, BOTTOM = 58, 14, 30, 44
LEGEND_ROW = 16
_FLOOR = HEIGHT - BOTTOM  # pixels from the top, where the horizontal axis lies


@dataclass(frozen=True)
class Line:
    """One line of a chart.

    Attributes:
        name: in the legend.
        xs, ys: of equal length; the line breaks where a value is not finite.
        color: as in SVG; the next of `COLORS` if empty.
        dashed: drawn in dashes.
    """

    name: str
    xs: Sequence[float]
    ys: Sequence[float]
    color: str = ""
    dashed: bool = False


def chart(
    title: str,
    x_label: str,
    y_label: str,
    lines: Sequence[Line],
    y_from: float | None = None,
    y_to: float | None = None,
    log_y: bool = False,
) -> str:
    """A chart with axes, round tick values and a legend, as an SVG document.

    Args:
        y_from, y_to: ends of the value axis; those of the data if None.
        log_y: logarithmic value axis; values that are not above 0 are left out.
    """
    drawn = [(line, line.color or COLORS[i % len(COLORS)]) for i, line in enumerate(lines)]
    xs = _finite([x for line in lines for x in line.xs])
    ys = _finite([y for line in lines for y in line.ys if not log_y or y > 0])
    y0, y1 = _span(np.log10(ys) if log_y else ys, y_from, y_to)
    room = 0.04 * (y1 - y0)
    ends = y0 - room * (y_from is None), y1 + room * (y_to is None)
    area = _Area(_span(xs, None, None), ends, log_y)
    height = HEIGHT + -(-len(drawn) // 3) * LEGEND_ROW
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        f'width="{WIDTH}" height="{height}" font-family="sans-serif" font-size="11">',
        f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
        f'<text x="{LEFT}" y="18" font-size="13" font-weight="bold">{escape(title)}</text>',
        *_axes(area, x_label, y_label),
    ]
    for line, color in drawn:
        path = _path(line, area.x, area.y, log_y)
        if path:
            out.append(
                f'<path d="{path}" fill="none" stroke="{color}" stroke-width="1.6"{_dashes(line)}/>'
            )
    return "\n".join([*out, *_legend(drawn), "</svg>\n"])


@dataclass(frozen=True)
class _Area:
    """Where values lie on a chart.

    Attributes:
        xs, ys: the ends of the axes; those of a logarithmic value axis are logarithms.
        log_y: whether it is one.
    """

    xs: tuple[float, float]
    ys: tuple[float, float]
    log_y: bool

    def x(self, value: float) -> float:
        """Pixels from the left."""
        low, high = self.xs
        return LEFT + (value - low) / (high - low) * (WIDTH - LEFT - RIGHT)

    def y(self, value: float) -> float:
        """Pixels from the top; values beyond the ends lie on them."""
        low, high = self.ys
        level = np.clip(np.log10(value) if self.log_y else value, low, high)
        return float(_FLOOR - (level - low) / (high - low) * (_FLOOR - TOP))


def _axes(area: _Area, x_label: str, y_label: str) -> list[str]:
    out = []
    for tick in _ticks(*area.xs):
        x = area.x(tick)
        out.append(f'<path d="M{x:.1f} {TOP}V{_FLOOR}" stroke="#e8e8e8"/>')
        out.append(f'<text x="{x:.1f}" y="{_FLOOR + 15}" text-anchor="middle">{tick:g}</text>')
    for tick in _ticks(*area.ys):
        value = 10.0**tick if area.log_y else tick
        y = area.y(value)
        out.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#e8e8e8"/>')
        out.append(f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{value:.3g}</text>')
    out.append(f'<path d="M{LEFT} {TOP}V{_FLOOR}H{WIDTH - RIGHT}" fill="none" stroke="#888888"/>')
    out.append(
        f'<text x="{(LEFT + WIDTH - RIGHT) / 2:.0f}" y="{_FLOOR + 32}" '
        f'text-anchor="middle">{escape(x_label)}</text>'
    )
    out.append(
        f'<text transform="translate(14 {(TOP + _FLOOR) / 2:.0f}) rotate(-90)" '
        f'text-anchor="middle">{escape(y_label)}</text>'
    )
    return out


def _legend(drawn: Sequence[tuple[Line, str]]) -> list[str]:
    out = []
    for i, (line, color) in enumerate(drawn):
        x, y = LEFT + (i % 3) * 190, HEIGHT + (i // 3) * LEGEND_ROW
        out.append(f'<path d="M{x} {y}h18" stroke="{color}" stroke-width="2"{_dashes(line)}/>')
        out.append(f'<text x="{x + 23}" y="{y + 4}">{escape(line.name)}</text>')
    return out


def _dashes(line: Line) -> str:
    return ' stroke-dasharray="5 3"' if line.dashed else ""


def _finite(values: Sequence[float]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    array = np.asarray(values, np.float64)
    return array[np.isfinite(array)]


def _span(
    values: np.ndarray[tuple[int], np.dtype[np.float64]], low: float | None, high: float | None
) -> tuple[float, float]:
    least, most = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    first, last = least if low is None else low, most if high is None else high
    return (first, last) if last > first else (first - 0.5, first + 0.5)


def _ticks(low: float, high: float) -> list[float]:
    """Four to nine round values from low to high."""
    step = 10.0 ** np.floor(np.log10((high - low) / 4))
    step *= next(f for f in (1, 2, 5, 10) if (high - low) / (step * f) <= 8)
    first = int(np.ceil(low / step - 1e-9))
    last = int(np.floor(high / step + 1e-9))
    return [round(i * step, 12) for i in range(first, last + 1)]


def _path(
    line: Line, to_x: Callable[[float], float], to_y: Callable[[float], float], log_y: bool
) -> str:
    parts, pen = [], "M"
    for x, y in zip(line.xs, line.ys, strict=True):
        if not (np.isfinite(x) and np.isfinite(y)) or (log_y and y <= 0):
            pen = "M"
            continue
        parts.append(f"{pen}{to_x(x):.1f} {to_y(y):.1f}")
        pen = "L"
    return "".join(parts)
