"""What `faceedit info` says about a take."""

from __future__ import annotations

from typing import Any

from faceedit_app.core.regions import MODELLED_CHANNELS
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import counted, format_rate, format_time

_GAPS_SHOWN = 10
_CARRIED_SHOWN = 100


def summarize(take: Take) -> dict[str, Any]:
    """Facts about a take as JSON values; times in seconds, frames from 0."""
    clip = take.clip
    codes = clip.timecodes
    return {
        "path": str(take.path),
        "format": take.format,
        "frames": len(clip),
        "rate": round(clip.rate, 6),
        "duration_s": round(clip.duration, 6),
        "start_timecode": codes[0] if codes else None,
        "end_timecode": codes[-1] if codes else None,
        "channels": list(clip.channels),
        "missing_channels": [name for name in MODELLED_CHANNELS if name not in clip.channels],
        "carried_columns": list(take.carried),
        "gaps": [
            {
                "frame": gap.frame,
                "time_s": round(float(clip.times[gap.frame]), 6),
                "timecode": codes[gap.frame] if codes else None,
                "missing": gap.missing,
            }
            for gap in clip.gaps
        ],
        "values": {"min": float(clip.weights.min()), "max": float(clip.weights.max())},
        "notes": list(take.notes),
    }


def summary_text(summary: dict[str, Any]) -> str:
    """A summary as readable lines."""
    facts = [
        ("format", summary["format"]),
        ("frames", f"{summary['frames']} at {format_rate(summary['rate'])}"),
        ("duration", format_time(summary["duration_s"])),
    ]
    if summary["start_timecode"]:
        facts.append(("timecode", f"{summary['start_timecode']} to {summary['end_timecode']}"))
    values = summary["values"]
    facts += [
        ("channels", _channels_text(summary)),
        ("values", f"{values['min']:.3f} to {values['max']:.3f}"),
        ("carried", _carried_text(summary["carried_columns"])),
        ("gaps", _gaps_text(summary["gaps"])),
    ]
    facts += [("note", note) for note in summary["notes"]]
    return "\n".join([summary["path"], *(f"  {name:9} {text}" for name, text in facts)])


def _channels_text(summary: dict[str, Any]) -> str:
    text = f"{len(summary['channels'])} of ARKit's 52"
    missing = summary["missing_channels"]
    return f"{text}; edits cannot move {', '.join(missing)}" if missing else text


def _carried_text(names: list[str]) -> str:
    more = len(names) - _CARRIED_SHOWN
    text = ", ".join(names[:_CARRIED_SHOWN]) or "nothing else"
    return f"{text} and {more} more" if more > 0 else text


def _gaps_text(gaps: list[dict[str, Any]]) -> str:
    if not gaps:
        return "none"
    texts = [
        f"{counted(gap['missing'], 'frame')} after {format_time(gap['time_s'])}"
        for gap in gaps[:_GAPS_SHOWN]
    ]
    more = len(gaps) - len(texts)
    return ", ".join(texts) + (f" and {more} more" if more else "")
