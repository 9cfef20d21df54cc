"""Where a path is in an arm's workspace, and how many stations it has."""

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.paths.arms import PLACES, judge_of
from bench.ik.paths.contacts import Contacts
from bench.ik.paths.newton import Chain
from bench.ik.paths.problem import Problem
from bench.ik.paths.solids import frame

COUNTS = (100, 200, 200, 200, 300, 500)  # of stations; times are of those with 200
TOOLS = (0.1, 0.18)  # how far the tool's point is before the flange [m]
LOOKS, STARTS, DRAWS = 9, 30, 40


def tool(rng: np.random.Generator) -> FloatArray:
    """A straight one, (4, 4)."""
    return frame([0.0, 0.0, rng.uniform(*TOOLS)])


def facing(rng: np.random.Generator, bearing: float, lean: float) -> FloatArray:
    """A tool's turn, (3, 3): down, or leaning by an angle to where the arm looks."""
    out = Rotation.from_euler("z", bearing) * Rotation.from_euler("y", np.pi - lean)
    return np.asarray((out * Rotation.from_euler("z", rng.uniform(-np.pi, np.pi))).as_matrix())


def somewhere(
    rng: np.random.Generator, arm: str, lean: tuple[float, float] = (0.0, 1.4)
) -> FloatArray:
    """A curve's frame where an arm works, (4, 4)."""
    place = PLACES[arm]
    bearing = rng.uniform(-1.2, 1.2)
    radius, height = rng.uniform(*place.radius), rng.uniform(*place.height)
    at = [radius * np.cos(bearing), radius * np.sin(bearing), height]
    return frame(at, facing(rng, bearing, rng.uniform(*lean)))


def placed(draw: Callable[[], Problem], rng: np.random.Generator) -> Problem:
    """The first of some draws of which each of a few stations can be met, one at a time.

    Whether the path can be followed is another matter. The last draw, if none is such.
    """
    for _ in range(DRAWS):
        problem = draw()
        if is_reached(problem, rng):
            break
    return problem


def is_reached(problem: Problem, rng: np.random.Generator) -> bool:
    """Whether random starts find a clear configuration at each of a few stations."""
    chain, contacts = Chain(problem), Contacts(judge_of(problem.arm), problem.world)
    low, high = np.maximum(chain.lower, -np.pi), np.minimum(chain.upper, np.pi)

    def is_met(T: FloatArray) -> bool:
        for _ in range(STARTS):
            met = chain.meet(rng.uniform(low, high), T, 40, 0.5)
            if met and not any(depth.any() for depth in contacts.depths(met[0][None])):
                return True
        return False

    some = np.linspace(0, len(problem.T) - 1, LOOKS).astype(int)
    return all(is_met(problem.T[k]) for k in some)
