"""Measuring: repetitions, and the time of their stages."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import wraps
from typing import Any
from unittest.mock import patch

import numpy as np


@dataclass(frozen=True)
class Timings:
    """Milliseconds of repetitions."""

    all: Sequence[float]

    @property
    def median(self) -> float:
        """The median."""
        return float(np.median(self.all))

    @property
    def p95(self) -> float:
        """The 95th percentile."""
        return float(np.percentile(self.all, 95))

    @property
    def best(self) -> float:
        """The shortest, undisturbed by other work on the machine."""
        return float(np.min(self.all))

    def summary(self) -> dict[str, float]:
        """Values for the report."""
        return {"median": self.median, "p95": self.p95, "best": self.best}


def repeat(work: Callable[[], object], times: int, warm_up: int = 10) -> Timings:
    """Repeat something, after a warm-up, and time it."""
    for _ in range(warm_up):
        work()
    return Timings([_timed(work) for _ in range(times)])


def _timed(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - began)


@dataclass
class Stages:
    """Adds up the time of stages; a nested stage's time counts only for that stage."""

    seconds: dict[str, float] = field(default_factory=dict)
    _stack: list[str] = field(default_factory=list)
    _since: float = 0.0

    def wrap(self, stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, timed for the stage."""

        @wraps(function)
        def measured(*args: Any, **named: Any) -> Any:
            self._turn()
            self._stack.append(stage)
            try:
                return function(*args, **named)
            finally:
                self._turn()
                self._stack.pop()

        return measured

    def _turn(self) -> None:
        """Add the time since the last turn to the current stage."""
        now = time.perf_counter()
        if self._stack:
            stage = self._stack[-1]
            self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self._since
        self._since = now

    @contextmanager
    def watching(self, *accounts: tuple[str, Any, str]) -> Iterator[None]:
        """Measure in a `with` block; an account is a stage, an object and its function's name."""
        with ExitStack() as stack:
            for stage, owner, name in accounts:
                wrapped = self.wrap(stage, getattr(owner, name))
                stack.enter_context(patch.object(owner, name, wrapped))
            yield
