"""Pairs of students whose code is more alike than that of independent solutions, and their clusters."""

from collections import Counter, defaultdict
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from course_lib.arrays import Floats

MIN_SHARED = 50.0  # runs in common, rare ones counting fully: about eight lines
SHARE = 0.6  # limit in a small class: what part of the shorter solution two have in common
SHARES = (0.4, 0.85)  # least and most of the limit in a larger one
MIN_LINES = 8  # of own code, when all of it is the same letter by letter
FEW = 4  # a run that at most so many solutions have counts fully ...
COMMON = 0.1  # ... or at most this part of the class
CLASS = 10  # from so many different solutions on, the limit follows the class
SPREADS = 6.0  # that a pair must be above the median of the class
CHUNK = 4096  # columns of a matrix

Own = TypeVar("Own", bound=Hashable)


@dataclass(frozen=True)
class Pair:
    """Two students, and what part of the shorter solution they have in common, from 0 to 1."""

    one: str
    other: str
    share: float


@dataclass(frozen=True)
class Cluster:
    """Students whose code is alike, with the pairs that join them, the most alike first."""

    students: tuple[str, ...]
    pairs: tuple[Pair, ...]


@dataclass(frozen=True)
class Comparison:
    """The clusters of a class, and from which share on two solutions are in one."""

    clusters: tuple[Cluster, ...]
    limit: float
    median: float | None  # share of two solutions of the class; None if they are too few to tell


def compare(runs: Mapping[str, frozenset[int]], lines: Mapping[str, tuple[str, ...]]) -> Comparison:
    """Compare all solutions with each other.

    A run counts less the more solutions have it, as many find it by themselves; equal solutions count as
    one there, so that a copy does not look common because it was copied often.

    Args:
        runs: Of each student, without what was handed out.
        lines: Of each student, without what was handed out, sorted: small solutions that are letter by
            letter the same are few runs.
    """
    groups = _equal(runs)
    shared = _shared_weights(list(groups))
    names = [members[0] for members in groups.values()]
    amount = np.diag(shared)
    share = shared / np.maximum(np.minimum(amount, amount[:, None]), 1e-9)
    limit, median = _limit(share)
    above, beside = np.nonzero(np.triu((share >= limit) & (shared >= MIN_SHARED), 1))
    pairs = [Pair(names[a], names[b], float(share[a, b])) for a, b in zip(above, beside, strict=True)]
    for weight, members in zip(amount, groups.values(), strict=True):
        if weight >= MIN_SHARED:
            pairs += _joined(members)
    for own, members in _equal(lines).items():
        if len(own) >= MIN_LINES:
            pairs += _joined(members)
    return Comparison(_clusters(pairs), limit, median)


def _equal(solutions: Mapping[str, Own]) -> dict[Own, list[str]]:
    """Return the students of each different solution."""
    groups = defaultdict[Own, list[str]](list)
    for student, own in solutions.items():
        groups[own].append(student)
    return groups


def _joined(students: Sequence[str]) -> list[Pair]:
    """Return pairs that join students of equal solutions."""
    return [Pair(students[0], other, 1.0) for other in students[1:]]


def _shared_weights(solutions: Sequence[frozenset[int]]) -> Floats:
    """Return the weight of the runs that each two solutions share; in the diagonal of all runs of one."""
    number = Counter(run for own in solutions for run in own)
    full = max(FEW, COMMON * len(solutions))
    weights = {run: min(1.0, full / count) for run, count in number.items()}
    columns = {run: column for column, run in enumerate(run for run, count in number.items() if count > 1)}
    shared = np.zeros((len(solutions), len(solutions)))
    for start in range(0, len(columns), CHUNK):
        has = np.zeros((len(solutions), CHUNK))
        for row, own in enumerate(solutions):
            for run in own:
                if start <= columns.get(run, -1) < start + CHUNK:
                    has[row, columns[run] - start] = weights[run] ** 0.5
        shared += has @ has.T
    np.fill_diagonal(shared, [sum(weights[run] for run in own) for own in solutions])
    return shared


def _limit(share: Floats) -> tuple[float, float | None]:
    """Return the share from which on two solutions are alike, and the median of the class."""
    if len(share) < CLASS:
        return SHARE, None
    pairs = share[np.triu_indices(len(share), 1)]
    median = float(np.median(pairs))
    spread = 1.4826 * float(np.median(np.abs(pairs - median)))  # the standard deviation of a normal one
    return float(np.clip(median + SPREADS * spread, *SHARES)), median


def _clusters(pairs: Sequence[Pair]) -> tuple[Cluster, ...]:
    """Return the students that pairs join, each with the strongest pairs that suffice for that."""
    cluster_of: dict[str, set[str]] = {}
    kept = list[Pair]()
    for pair in sorted(pairs, key=lambda pair: (-pair.share, pair.one, pair.other)):
        one, other = (cluster_of.setdefault(name, {name}) for name in (pair.one, pair.other))
        if one is not other:
            one |= other
            cluster_of |= dict.fromkeys(other, one)
            kept.append(pair)
    clusters = {id(members): members for members in cluster_of.values()}.values()
    made = [
        Cluster(tuple(sorted(members)), tuple(pair for pair in kept if pair.one in members))
        for members in clusters
    ]
    return tuple(sorted(made, key=lambda cluster: (-cluster.pairs[0].share, cluster.students)))
