"""What commands print with `--json`: the keys are those of `faceedit info --json`.

docs/formats.md describes them. Progress and warnings go to standard error.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faceedit_app.core.atomic import said_of
from faceedit_app.core.texts import say

if TYPE_CHECKING:
    from faceedit_app.batch.tasks import Outcome, Skipped
    from faceedit_app.core.clip import Clip


def say_json(facts: object) -> None:
    """Print facts."""
    say(json.dumps(facts, indent=2))


def say_kept(path: Path, *backups: Path | None) -> None:
    """Say which copies of files that were there before were kept, if any."""
    if any(backups):
        names = (None if backup is None else str(backup) for backup in backups)
        say(f"{path}: {said_of(*names).removeprefix('; ')}", to=sys.stderr)


def written_facts(
    path: Path,
    take: Path,
    form: str,
    clip: Clip,
    notes: Sequence[str],
    backup: Path | None = None,
) -> dict[str, Any]:
    """Facts about a take that was written.

    Args:
        path: the file.
        take: the take that it was made from.
        form: the name of its format.
        clip: as it was written.
        notes: what it does not hold.
        backup: the copy of the file that it replaced, if that was a recording or of another kind.
    """
    return {
        "path": str(path),
        "take": str(take),
        "format": form,
        "frames": len(clip),
        "rate": round(clip.rate, 6),
        "duration_s": round(clip.duration, 6),
        "backup": None if backup is None else str(backup),
        "notes": list(notes),
    }


def batch_facts(
    output: Path,
    outcomes: Sequence[Outcome],
    pages: Sequence[Path],
    skipped: Sequence[Skipped] = (),
) -> dict[str, Any]:
    """Facts about the takes of a batch.

    Args:
        output: the folder with the results.
        outcomes: of the takes.
        pages: the reports.
        skipped: files that are no takes.
    """
    return {
        "written": sum(1 for one in outcomes if not one.error),
        "failed": sum(1 for one in outcomes if one.error),
        "reports": [str(page) for page in pages],
        "skipped": [{"name": other.name, "reason": other.reason} for other in skipped],
        "takes": [
            {
                "name": one.name,
                "path": str(output / one.written) if one.written and not one.error else None,
                "error": one.error or None,
                "backup": str(output / one.backup) if one.backup else None,
                "made_again": one.again or None,
                "note": one.note or None,
                "frames": one.frames,
                "changed_frames": one.changed,
                "duration_s": one.seconds,
                "problems": one.problems,
                "problems_left": one.left,
            }
            for one in outcomes
        ],
    }
