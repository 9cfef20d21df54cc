"""What a world is asked to be: kinds of faults by turns, robots and pairs drawn by the seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.sim2real.frame.streams import stream
from bench.sim2real.machines.kinds import NAMED, OUTSIDE

ROBOTS = ("panda", "ur10", "iiwa14", *(f"random{n}" for n in range(2, 8)))


def spec_of(seed: int) -> WorldSpec:
    """The world of a seed: of ten, six with a named fault, two outside, one with two, one none."""
    rng = np.random.default_rng([seed, 4711])
    robot = str(rng.choice(ROBOTS))
    named, outside = list(NAMED), list(OUTSIDE)
    turn = seed % 10
    if turn == 9:
        faults: tuple[str, ...] = ()
    elif turn == 8:
        faults = tuple(str(each) for each in rng.choice(named, 2, replace=False))
    elif turn in (3, 6):
        faults = (outside[(2 * (seed // 10) + (turn == 6)) % len(outside)],)
    else:
        k = 6 * (seed // 10) + (0, 1, 2, 4, 5, 7).index(turn)
        faults = (named[k % len(named)],)
    return WorldSpec(seed=seed, faults=faults, robot=robot)


FIRST_PROOF_SEED = 2_000_000  # development uses seeds below 100 000


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldSpec:
    """A study to be made; the same spec gives the same bytes."""

    seed: int
    faults: tuple[str, ...] = ()  # of kinds.KINDS
    robot: str = "panda"

    def __post_init__(self) -> None:
        object.__setattr__(self, "faults", tuple(self.faults))  # a list, of JSON

    def stream(self, purpose: str) -> np.random.Generator:
        return stream(self.seed, purpose)
