"""Try fixes before they are proposed: which of them would make a new problem?

They are tried on a session of their own, so that nothing is shown or kept. Those that are far from
each other are tried together: a take needs a handful of rounds, however many problems it has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.help.problems import Problem, find_problems
from faceedit_app.editing.session import EditSession

Brought = Mapping[Problem, Problem]  # the worst problem that the fix of a problem would make

SLIGHT = 0.25  # of what it mends: a new problem up to this severity is worth the fix
_BESIDE = 0.5  # seconds beside an edit in which its answer, or the search, may differ
_SLICE = 0.02  # seconds of work before it is asked whether to go on
_ROUNDS = 3  # of all harmless fixes together


def is_worth(problem: Problem, brings: Problem) -> bool:
    """Whether a fix is better than none although it makes a new problem: a far smaller one."""
    return brings.severity <= SLIGHT * problem.severity


def trial_of(
    session: EditSession, problems: Sequence[Problem], goes_on: Callable[[], bool] = lambda: True
) -> Callable[[], Brought]:
    """The trial of the fixes for the problems of a session; it may run in another thread.

    Args:
        session: whose present edits, character and engine are used; it is not changed.
        problems: all that were found in it.
        goes_on: asked now and then; once it is false, nothing more is tried.
    """
    take, rig, shown, engine = session.take, session.rig, session.shown_rig, session.engine
    state = session.state

    def trial() -> Brought:
        twin = EditSession(take, rig, engine)
        if shown is not rig:
            twin.use_character(shown)
        twin.live.patience = _SLICE
        twin.begin_with(state)
        return _Trial(twin, problems, goes_on).brought()

    return trial


class _Trial:
    """Tries fixes in rounds.

    Args:
        session: to try them on.
        known: the problems that there are without them.
        goes_on: see `trial_of`.
    """

    def __init__(
        self, session: EditSession, known: Sequence[Problem], goes_on: Callable[[], bool]
    ) -> None:
        self._session, self._known, self._goes_on = session, known, goes_on
        self._brought: dict[Problem, Problem] = {}

    def brought(self) -> Brought:
        """What each fix makes alone, and what those without blame make together."""
        fixable = [problem for problem in self._known if problem.fix]
        for apart in _apart(fixable):
            self._try(apart)
        for _ in range(_ROUNDS):
            before = len(self._brought)
            self._try([problem for problem in fixable if problem not in self._brought])
            if len(self._brought) == before:
                break
        return self._brought

    def _try(self, problems: Sequence[Problem]) -> None:
        """Blame each new problem on the fix that is nearest to it."""
        if not problems:
            return
        session = self._session
        session.preview(*(edit for problem in problems for edit in problem.fix))
        while self._goes_on() and session.live.work(_SLICE):
            pass
        if not self._goes_on():
            return
        for made in find_problems(session):
            if not any(map(made.is_as, self._known)):
                by = min(problems, key=lambda problem: _distance(problem, made.time))
                worst = self._brought.get(by)
                if worst is None or made.severity > worst.severity:
                    self._brought[by] = made


def _distance(problem: Problem, seconds: float) -> float:
    """Seconds between a time and what a fix edits; 0 inside."""
    first, last = _span(problem.fix)
    return max(first - seconds, seconds - last, 0.0)


def _span(fix: Iterable[Edit]) -> tuple[float, float]:
    """The first and the last second of a fix, with falloffs."""
    spans = [edit.span for edit in fix]
    return min(first for first, _ in spans), max(last for _, last in spans)


def _apart(problems: Sequence[Problem]) -> list[list[Problem]]:
    """Problems in rounds: the fixes of one round are far from each other."""
    rounds: list[list[Problem]] = []
    ends: list[float] = []
    for problem in sorted(problems, key=lambda problem: _span(problem.fix)):
        first, last = _span(problem.fix)
        free = (number for number, end in enumerate(ends) if end + 2 * _BESIDE <= first)
        number = next(free, len(rounds))
        if number == len(rounds):
            rounds.append([])
            ends.append(last)
        rounds[number].append(problem)
        ends[number] = last
    return rounds
