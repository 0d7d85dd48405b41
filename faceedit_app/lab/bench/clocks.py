"""Measuring: repetitions, and where the time of one goes."""

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
class Times:
    """Milliseconds of some repetitions."""

    all: Sequence[float]

    @property
    def median(self) -> float:
        """The middle one."""
        return float(np.median(self.all))

    @property
    def p95(self) -> float:
        """All but one in twenty are shorter."""
        return float(np.percentile(self.all, 95))

    @property
    def best(self) -> float:
        """What the machine can do when it is left alone."""
        return float(np.min(self.all))

    def summary(self) -> dict[str, float]:
        """As it stands in the report."""
        return {"median": self.median, "p95": self.p95, "best": self.best}


def repeat(work: Callable[[], object], times: int, warm_up: int = 10) -> Times:
    """Do something often enough to know how long it takes."""
    for _ in range(warm_up):
        work()
    return Times([_timed(work) for _ in range(times)])


def _timed(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - began)


@dataclass
class Stages:
    """Adds up where time goes; what a stage calls in another stage counts there alone."""

    seconds: dict[str, float] = field(default_factory=dict)
    _stack: list[str] = field(default_factory=list)
    _since: float = 0.0

    def wrap(self, stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, with its time on the stage's account."""

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
        """Book the time since the last turn."""
        now = time.perf_counter()
        if self._stack:
            stage = self._stack[-1]
            self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self._since
        self._since = now

    @contextmanager
    def watching(self, *accounts: tuple[str, Any, str]) -> Iterator[None]:
        """Measure for a while; each account is a stage, an owner and the name of its function."""
        with ExitStack() as stack:
            for stage, owner, name in accounts:
                wrapped = self.wrap(stage, getattr(owner, name))
                stack.enter_context(patch.object(owner, name, wrapped))
            yield
