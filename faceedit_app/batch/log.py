"""The log of a batch: what is done, so that nothing is done twice."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import MISSING, asdict, fields, replace
from pathlib import Path
from typing import Any

from faceedit_app.batch.tasks import LOG, Outcome, Task, sha256_of
from faceedit_app.core import on_disk
from faceedit_app.core.errors import FileError, reason_of
from faceedit_app.core.fields import parse

_LARGEST = 1e9  # of the numbers in the log; NaN and infinity are damage
# What the values of an outcome may be, by their defaults.
_KINDS: dict[type, tuple[type, ...]] = {
    str: (str,),
    int: (int,),
    float: (float, int),
    tuple: (tuple,),
}


class Log:
    """The outcomes so far, in the output folder."""

    def __init__(self, folder: Path) -> None:
        """Raises FileError: the folder or its log cannot be written."""
        self.path = folder / LOG
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = self.path.open("a+", encoding="utf-8", errors="replace")
        except OSError as error:
            reason = reason_of(error)
            raise FileError(folder, f"cannot be written ({reason})", "choose another") from error

    def outcomes(self) -> dict[str, Outcome]:
        """The last outcome of each take, by name; a line cut off by a crash is left out."""
        return {outcome.name: outcome for outcome in self._all()}

    def written(self) -> set[tuple[str, str]]:
        """All files that were ever written, see `Outcome.written`, each with its SHA-256."""
        return {(one.written, one.made) for one in self._all() if one.written and one.made}

    def _all(self) -> Iterator[Outcome]:
        self._file.seek(0)
        for line in self._file:
            with suppress(ValueError):
                yield _outcome(line)

    def add(self, outcome: Outcome) -> None:
        """Add an outcome."""
        self._file.write("\n" * self._is_cut() + json.dumps(asdict(outcome)) + "\n")
        self._file.flush()

    def _is_cut(self) -> bool:
        """Whether the last line was cut off."""
        with self.path.open("rb") as file:
            end = file.seek(0, 2)
            if end:
                file.seek(end - 1)
            return end > 0 and file.read() != b"\n"

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _outcome(line: str) -> Outcome:
    """The outcome on a line.

    Raises:
        ValueError: it holds none.
    """
    entry = parse(line)
    kinds: dict[str, tuple[type, ...]] = {
        one.name: (str,) if one.default is MISSING else _KINDS[type(one.default)]
        for one in fields(Outcome)
    }
    if not (isinstance(entry, dict) and "name" in entry and entry.keys() <= kinds.keys()):
        raise ValueError("it is no outcome")
    values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in entry.items()}
    curves = [number for v in values.values() if isinstance(v, tuple) for number in v]
    numbers = [*curves, *(v for v in values.values() if isinstance(v, int | float))]
    if not (
        all(isinstance(value, kinds[name]) for name, value in values.items())
        and all(isinstance(number, int | float) and abs(number) < _LARGEST for number in numbers)
    ):
        raise ValueError("a value is of another kind")
    return Outcome(**values)


def to_do(tasks: Iterable[Task], log: Log) -> list[Task]:
    """The tasks without a good outcome for the same source and the same recipe.

    Results are looked at: one that somebody removed or changed since is made again.
    """
    done, ours = log.outcomes(), log.written()
    left = []
    for task in tasks:
        outcome, digest = done.get(task.name), task.recipe.digest
        there = sha256_of(task.output) if on_disk.is_file(task.output) else None
        again = ""
        if (
            outcome is not None
            and not outcome.error
            and outcome.digest == digest
            and outcome.sha256 == sha256_of(task.source)
        ):
            if there is not None and there == outcome.made:
                continue
            again = _since(outcome, there)
        left.append(replace(task, is_ours=(task.result, there) in ours, again=again))
    return left


def _since(outcome: Outcome, there: str | None) -> str:
    """Why a result is made again: what happened to it since it was written."""
    if there is None:
        return "was removed"
    return "was changed" if outcome.made else ""  # an older log does not say what was written
