"""What the curves that were not asked for do while others are edited.

Opening a mouth draws its corners in and lowers the lip; a face whose width is held while its jaw
drops is not one that anybody makes. So the networks are not asked for the tracked values of the
other curves but for the most probable ones (the mean of a Gaussian, conditioned on the change of
the curves that were asked for), under the covariance of the take's own curves. A request far beyond
what the take does is divided: its first part moves the others as in the take, and the rest as in
other performances, where mouths have opened so far.

The other side of a face is held, and so is what can touch: a wink does not close the other eye, and
a smile does not part closed lips. A lip that is raised or lowered moves nothing else: in a take it
often goes with a smile or a pucker, and that is not what such an edit asks for.

Where one edit begins inside another, its curves are given little by little, so that nothing jumps.
"""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Indices

# Added variance, mm²: keeps nearly redundant curves apart.
JITTER = 0.01
# mm added to each curve's standard deviation: a curve that hardly moves says little.
LEAST_SPREAD = 0.3
# Standard deviations of a curve up to which a change of it draws the others as in the take: a jaw
# that drops as far as it can does not narrow the mouth in proportion.
FARTHEST = 2.0
# Weight of other performances in the covariance, in frames at 25 fps.
PRIOR_FRAMES = 50.0


class Expectation:
    """The curves of one region.

    Args:
        curves: (T, C) mm: the take at 25 fps.
        prior: (C, C) mm², their covariance in other performances.
        mirror: (C,) the position of each curve's mirror image.
        held: (C,) curves that change only if they are asked for.
        alone: (C,) curves that move no other if only such are asked for; None = there are none.

    Attributes:
        mean, spread: (C,) mm, of the curves.
        low, high: (C,) mm, their range.
        mirror, held: (C,) as above.
    """

    def __init__(
        self,
        curves: Doubles,
        prior: Doubles,
        mirror: Indices,
        held: Bools,
        alone: Bools | None = None,
    ) -> None:
        self.mean = curves.mean(axis=0)
        self.spread = curves.std(axis=0) + LEAST_SPREAD
        self.low, self.high = curves.min(axis=0), curves.max(axis=0)
        centred = curves - self.mean
        covariance = centred.T @ centred + PRIOR_FRAMES * prior
        covariance = covariance / (len(curves) + PRIOR_FRAMES)
        self._covariance = 0.5 * (covariance + covariance[np.ix_(mirror, mirror)])
        self._most = FARTHEST * np.sqrt(np.diag(self._covariance) + JITTER)
        self.mirror, self.held = mirror, held
        self._alone = np.zeros_like(held) if alone is None else alone
        size = len(self._covariance)
        self._precision = np.linalg.inv(self._covariance + JITTER * np.eye(size))
        self._others = 0.5 * (prior + prior[np.ix_(mirror, mirror)])
        self._gains: dict[bytes, Doubles] = {}
        self._further: dict[bytes, Doubles] = {}

    def fill(self, change: Doubles, given: Bools) -> Doubles:
        """The change (N, C), mm, with that of the other curves filled in.

        Args:
            change: (N, C) mm, from the tracked curves to what is asked for.
            given: (N, C) the curves whose change is given, see `given`.
        """
        if (given == given[:1]).all():  # nearly always: one edit, in its own span
            return self._filled(change, given[0])
        filled = change.copy()
        numbers = given @ (1 << np.arange(given.shape[1]))
        for number in np.unique(numbers):
            rows = np.flatnonzero(numbers == number)
            filled[rows] = self._filled(change[rows], given[rows[0]])
        return filled

    def given(self, change: Doubles, asked: Bools) -> Bools:
        """(N, C) the curves whose change is given, and is not filled in.

        Args:
            change: (N, C) mm, from the tracked curves to what is asked for.
            asked: (N, C) whether the edits ask for this curve.
        """
        return self._held_with(asked | (change != 0))

    def _held_with(self, asked: Bools) -> Bools:
        """(N, C) the curves that are given where some are asked for."""
        some = asked.any(axis=1, keepdims=True)
        alone = some & ~(asked & ~self._alone).any(axis=1, keepdims=True)
        given: Bools = asked | asked[:, self.mirror] | (some & self.held) | alone
        return given

    def expected(self, change: Doubles, firm: Doubles) -> Doubles:
        """The change (N, C), mm, with that of curves that are not, or not firmly, given.

        Curves that are given firmly come first; each softer one then takes its share (a Choquet
        integral over the sets of given curves), which makes the result continuous in `firm`.

        Args:
            change: (N, C) mm, from the tracked curves to what is asked for.
            firm: (N, C) in 0..1, how firmly each is given; 1 for the firmest of each frame.
        """
        expected = self.fill(change, self._held_with(firm > 0))
        rows = np.flatnonzero(((firm > 0) & (firm < 1)).any(axis=1))
        if not len(rows):
            return expected
        change, firm = change[rows], firm[rows]
        levels = -np.sort(-firm, axis=1)
        shares = levels - np.append(levels[:, 1:], np.zeros((len(rows), 1)), axis=1)
        total = np.zeros_like(change)
        for level, share in zip(levels.T[:, :, None], shares.T[:, :, None], strict=True):
            if share.any():
                total += share * self.fill(change, self._held_with((firm >= level) & (level > 0)))
        expected[rows] = total
        return expected

    def _filled(self, change: Doubles, known: Bools) -> Doubles:
        """The change with that of the curves that are not known filled in from the others."""
        if not known.any() or known.all():
            return change
        filled, given = change.copy(order="K"), change[:, known]
        added = given @ self.gain(known)
        within = (self._most[known] / np.maximum(np.abs(given), 1e-9)).min(axis=1)
        beyond = np.flatnonzero(within < 1.0)
        if len(beyond):
            others = given[beyond] @ self._gain_of_others(known)
            added[beyond] = others + within[beyond, None] * (added[beyond] - others)
        filled[:, ~known] = added
        return filled

    def distance(self, change: Doubles) -> Doubles:
        """(N,) the length of changes (N, C), mm, in standard deviations of the take's curves."""
        square: Doubles = ((change @ self._precision) * change).sum(axis=1)
        return np.sqrt(square)

    def gain(self, known: Bools) -> Doubles:
        """(known, others) the mean change of the other curves for each mm of the known ones."""
        key = known.tobytes()
        if key not in self._gains:
            self._gains[key] = _gain(self._covariance, known)
        return self._gains[key]

    def _gain_of_others(self, known: Bools) -> Doubles:
        """The same in other performances."""
        key = known.tobytes()
        if key not in self._further:
            self._further[key] = _gain(self._others, known)
        return self._further[key]


def _gain(covariance: Doubles, known: Bools) -> Doubles:
    """(known, others) the mean of the other curves for each mm of the known ones."""
    variance = covariance[np.ix_(known, known)] + JITTER * np.eye(known.sum())
    gain = np.linalg.solve(variance, covariance[np.ix_(known, ~known)])
    return np.asarray(gain, np.float64)
