"""What solvers are asked, in words that each of them can translate, and what they answer."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Protocol

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.goals.peers.body import Body
from bench.ik.goals.world import POSITION

STARTS = 21  # the first and 20 more
STARTS_OF_HANDS = 101  # so that time is what ends them
MAX_TIME = 1.0  # of a solve [s]
MAX_TIME_OF_ALL = 10.0  # of one that looks through 64 goals [s]
_ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Region:
    """Where a link is to be: at T, or up to slack along and about its axes."""

    tip: str
    T: FloatArray  # in the frame of `relative_to`, (4, 4)
    relative_to: str | None = None  # a link, or None for the base
    lower: Sequence[float] = _ZERO  # of its place in T [m]
    upper: Sequence[float] = _ZERO
    turn: Sequence[float] = _ZERO  # components of the rotation vector, at most [rad]
    tilt: float | None = None  # instead: z at most this far from T's, any turn about it [rad]
    look: FloatArray | None = None  # instead of all else: z through this point, (3,) [m]
    tolerance: float = POSITION  # [m], [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a solver says; whether it is right is for a judge."""

    q: FloatArray  # (n,), as the robot's joint_names
    claimed: bool  # in its own opinion it is solved, and in time
    time: float  # [s]
    index: int = 0  # of several goals, the one that is met


class Peer(Protocol):
    """A solver of one body; making it and its scene is not part of any time."""

    name: str

    def solve(self, regions: Sequence[Region], starts: FloatArray) -> Answer:
        """Solve from starts (K, n) in turn, until one ends in all regions."""
        ...

    def any_of(self, regions: Sequence[Region], starts: FloatArray) -> Answer:
        """In any one of the regions."""
        ...

    def nearest(self, T: FloatArray, tip: str, starts: FloatArray) -> Answer:
        """The answer at the place of T and as near to its orientation as can be."""
        ...


Maker = Callable[[Body], Peer]
Search = Callable[[FloatArray], tuple[FloatArray, bool]]


def from_starts(search: Search, starts: FloatArray, max_time: float = MAX_TIME) -> Answer:
    """Searches from starts in turn, until one is claimed or time is up."""
    began = perf_counter()
    for start in starts:
        q, claimed = search(start)
        time = perf_counter() - began
        if claimed or time >= max_time:
            break
    return Answer(q=q, claimed=claimed and time < max_time, time=time)


def among(
    searches: Sequence[Search], starts: FloatArray, max_time: float = MAX_TIME_OF_ALL
) -> Answer:
    """Searches for goals in turn, all from one start before all from the next."""
    began = perf_counter()
    for start in starts:
        for index, search in enumerate(searches):
            q, claimed = search(start)
            time = perf_counter() - began
            if claimed or time >= max_time:
                return Answer(q=q, claimed=claimed and time < max_time, time=time, index=index)
    return Answer(q=q, claimed=False, time=time)


def least_of(
    search: Callable[[FloatArray], tuple[FloatArray, float]],
    starts: FloatArray,
    max_time: float = MAX_TIME,
) -> Answer:
    """The best end of searches, which tell its cost: infinite if it does not hold."""
    began, least, best = perf_counter(), np.inf, starts[0]
    for start in starts:
        q, cost = search(start)
        if cost < least:
            least, best = cost, q
        if perf_counter() - began >= max_time:
            break
    return Answer(q=best, claimed=bool(np.isfinite(least)), time=perf_counter() - began)


def by_distance(regions: Sequence[Region], at: FloatArray) -> list[int]:
    """Regions' places in their order from a pose; a radian counts as 0.3 m."""

    def distance(region: Region) -> float:
        turned = np.arccos(np.clip((np.trace(at[:3, :3].T @ region.T[:3, :3]) - 1) / 2, -1, 1))
        return float(np.linalg.norm(at[:3, 3] - region.T[:3, 3]) + 0.3 * turned)

    return sorted(range(len(regions)), key=lambda k: distance(regions[k]))
