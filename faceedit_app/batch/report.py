"""The report of a batch: a table for programs (CSV), and a page for people (HTML, small curves)."""

from __future__ import annotations

import csv
import html
import io
from collections.abc import Sequence
from pathlib import Path

from faceedit_app.batch.tasks import REPORT, Outcome, Skipped
from faceedit_app.core.atomic import said_of, write_atomically
from faceedit_app.formats.timing import counted

_COLUMNS = (
    "take",
    "result",
    "written",
    "frames",
    "changed",
    "seconds",
    "problems",
    "left",
    "error",
    "backup",
)
_WIDTH, _HEIGHT = 240, 36  # pixels of a small curve
_STYLE = """
body { font: 14px system-ui, sans-serif; margin: 2em; color: #222; background: #fff }
table { border-collapse: collapse } th, td { padding: 4px 12px; text-align: left }
tr { border-bottom: 1px solid #ddd } td.n { text-align: right } .bad { color: #b00020 }
svg { display: block } .old { stroke: #999 } .new { stroke: #0072b2 }
polyline { fill: none; stroke-width: 1.2 }
"""


def write_reports(
    folder: Path, outcomes: Sequence[Outcome], skipped: Sequence[Skipped] = ()
) -> tuple[Path, Path]:
    """Write `faceedit_report.csv` and `faceedit_report.html` into a folder, and return their paths.

    Args:
        outcomes: of the takes.
        skipped: files that are no takes.

    Raises:
        FileError: they cannot be written.
    """
    table, page = folder / f"{REPORT}.csv", folder / f"{REPORT}.html"
    write_atomically(table, _table(outcomes, skipped).encode())
    write_atomically(page, _page(outcomes, skipped).encode())
    return table, page


def summary(outcomes: Sequence[Outcome], skipped: Sequence[Skipped] = ()) -> str:
    """One line: how many takes went well, how many did not, and how many files are none."""
    failed = sum(1 for outcome in outcomes if outcome.error)
    fixed = sum(max(outcome.problems - outcome.left, 0) for outcome in outcomes)
    new = sum(max(outcome.left - outcome.problems, 0) for outcome in outcomes)
    takes = f"{counted(len(outcomes), 'take')}: {len(outcomes) - failed} written, {failed} failed"
    written = f"{takes}; {counted(fixed, 'problem')} fixed"
    written += f", {new} new" if new else ""
    return f"{written}; {counted(len(skipped), 'other file')} skipped" if skipped else written


def _table(outcomes: Sequence[Outcome], skipped: Sequence[Skipped]) -> str:
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(_COLUMNS)
    for one in outcomes:
        result = "failed" if one.error else "written"
        numbers = (one.frames, one.changed, one.seconds, one.problems, one.left)
        out.writerow([one.name, result, one.written, *numbers, one.error, one.backup])
    for other in skipped:
        out.writerow([other.name, "skipped", "", *[""] * 5, other.reason, ""])
    return text.getvalue()


def _page(outcomes: Sequence[Outcome], skipped: Sequence[Skipped]) -> str:
    rows = "\n".join([*map(_row, outcomes), *map(_skipped_row, skipped)])
    return f"""<!doctype html>
<html lang="en"><meta charset="utf-8"><title>FaceEdit batch</title><style>{_STYLE}</style>
<h1>FaceEdit batch</h1>
<p>{html.escape(summary(outcomes, skipped))}. Curves: opening of the mouth,
<svg width="24" height="8" style="display:inline"><polyline class="old" points="0,4 24,4"/></svg>
as tracked and
<svg width="24" height="8" style="display:inline"><polyline class="new" points="0,4 24,4"/></svg>
edited.</p>
<table>
<tr><th>take<th>mouth opening<th>seconds<th>frames changed<th>problems before<th>left<th>result</tr>
{rows}
</table>
</html>
"""


def _row(one: Outcome) -> str:
    name = html.escape(one.name)
    if one.error:
        return f'<tr><td>{name}<td colspan="5"><td class="bad">{html.escape(one.error)}</tr>'
    return (
        f'<tr><td>{name}<td>{_curves(one)}<td class="n">{one.seconds:.1f}'
        f'<td class="n">{one.changed} of {one.frames}<td class="n">{one.problems}'
        f'<td class="n">{one.left}<td>{html.escape(one.written + _remarks(one))}</tr>'
    )


def _remarks(one: Outcome) -> str:
    return said_of(one.backup) + (f"; {one.note}" if one.note else "")


def _skipped_row(one: Skipped) -> str:
    name, reason = html.escape(one.name), html.escape(one.reason)
    return f'<tr><td>{name}<td colspan="5"><td>skipped: {reason}</tr>'


def _curves(one: Outcome) -> str:
    values = [*one.tracked, *one.edited] or [0.0]
    low, high = min(values), max(max(values), min(values) + 1.0)

    def line(kind: str, curve: Sequence[float]) -> str:
        step = (_WIDTH - 2) / max(len(curve) - 1, 1)
        places = " ".join(
            f"{1 + k * step:.1f},{1 + (high - mm) / (high - low) * (_HEIGHT - 2):.1f}"
            for k, mm in enumerate(curve)
        )
        return f'<polyline class="{kind}" points="{places}"/>'

    size = f'width="{_WIDTH}" height="{_HEIGHT}"'
    return f"<svg {size}>{line('old', one.tracked)}{line('new', one.edited)}</svg>"
