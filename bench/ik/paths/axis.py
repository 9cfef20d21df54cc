"""A free tool axis among obstacles: the work, a table, posts; half of them as points."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.lines import Line
from bench.ik.paths.arms import ARMS, PLACES, by_arm
from bench.ik.paths.curves import CURVES, stations
from bench.ik.paths.placing import COUNTS, placed, somewhere, tool
from bench.ik.paths.problem import Problem
from bench.ik.paths.runs import run_or_refer, solved, stepped, timed, worst
from bench.ik.paths.solids import Solid, World, box, cylinder, frame
from bench.ik.soak.solves import Row

SIZES = (1, 8)  # of each curve and arm
jobs = by_arm
ASKED = (0.060, 0.300)  # median and 95 % [s]
STANDOFF = 0.004  # of the tool's point from the work [m]
TABLE = -0.03  # its height, under the base [m]
SPACING = 0.015  # of points [m]
NEAR = 0.15  # posts are no nearer to stations, and the base [m]


def draw(arm: str, curve: str, index: int, seed: int) -> Problem:
    """One problem."""
    rng = np.random.default_rng([seed, 2, ARMS.index(arm), list(CURVES).index(curve), index])
    count, as_points, as_region = int(rng.choice(COUNTS)), index % 2 == 1, bool(rng.integers(2))
    spun = rng.random() < 0.25

    def anywhere() -> Problem:
        at = somewhere(rng, arm, lean=(0.0, 0.9))
        T = stations(CURVES[curve](rng, PLACES[arm].size), count)
        work = replace(_work(curve, T), T=at @ _work(curve, T).T)
        T = at @ T
        world = World(solids=[_table(), work, *_posts(rng, T)])
        return Problem(
            key=f"axis:{arm}:{curve}:{index}:{seed}",
            arm=arm,
            T=T @ _spins(rng, count) if spun else T,
            tool=tool(rng),
            free=True,
            as_region=as_region,
            world=world.as_points(SPACING, rng) if as_points else world,
        )

    return placed(anywhere, rng)


def _work(curve: str, T: FloatArray) -> Solid:
    """What the tool goes along, in the curve's frame."""
    P = T[:, :3, 3]
    if curve == "pipe":  # about the centre of the arc, where the tools' axes meet
        middle = P[len(P) // 2]
        edge, turn = P[0], Rotation.from_matrix(T[0, :3, :3]).magnitude()
        radius = abs(edge[0] - middle[0]) / max(np.sin(turn), 1e-6) - STANDOFF
        R = Rotation.from_euler("x", 90, degrees=True).as_matrix()
        return cylinder(radius, 0.4, [0.0, 0.0, radius + STANDOFF], R)
    low, high = P.min(axis=0), P.max(axis=0)
    if curve == "box":
        size = np.array([high[0] - low[0] + 0.02, 0.2, high[2] - low[2] + 0.02])
        corner = np.array([high[0] - STANDOFF, 0.0, low[2] + STANDOFF])
        return box(size, corner + size * [-0.5, 0.0, 0.5])
    size = np.array([*(high - low)[:2] + 0.06, 0.03])
    return box(size, [*(0.5 * (low + high))[:2], high[2] + STANDOFF + 0.015])


def _table() -> Solid:
    return Solid(kind="half_space", T=frame([0.0, 0.0, TABLE]))


def _posts(rng: np.random.Generator, T: FloatArray) -> list[Solid]:
    """One to four, square or round, some of them beams overhead."""
    found: list[Solid] = []
    count = int(rng.integers(1, 5))
    while len(found) < count:
        bearing, radius = rng.uniform(-1.8, 1.8), rng.uniform(0.3, 0.9)
        at = np.array([radius * np.cos(bearing), radius * np.sin(bearing), 0.0])
        length, thick = rng.uniform(0.3, 1.0), rng.uniform(0.03, 0.08)
        at[2] = TABLE + 0.5 * length
        R = np.eye(3)
        if rng.random() < 0.2:
            at[2] = rng.uniform(0.8, 1.1)
            R = Rotation.from_euler("yz", [np.pi / 2, rng.uniform(0, np.pi)]).as_matrix()
        one = (
            box([thick, thick, length], at, R)
            if rng.random() < 0.5
            else cylinder(0.5 * thick, length, at, R)
        )
        if one.distance(T[:, :3, 3]).min() > NEAR:
            found.append(one)
    return found


def _spins(rng: np.random.Generator, count: int) -> FloatArray:
    """Turns about the tool's axis, which say nothing where that turn is free, (count, 4, 4)."""
    T = np.tile(np.eye(4), (count, 1, 1))
    T[:, :3, :3] = Rotation.from_rotvec(
        rng.uniform(-np.pi, np.pi, count)[:, None] * [0.0, 0.0, 1.0]
    ).as_matrix()
    return T


def _is_spun(problem: Problem) -> bool:
    """Whether stations are turned about the tool's axis for no reason."""
    x = problem.T[:, :3, 0]
    return bool((np.einsum("bi,bi->b", x[1:], x[:-1]) < 0.0).any())


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One of each curve."""
    problems = [draw(job["arm"], curve, job["index"], job["seed"]) for curve in CURVES]
    problems[0].ask()  # what is made once
    return [
        run_or_refer(problem, job["seed"])
        | {"curve": curve, "points": len(problem.world.points), "region": problem.as_region}
        | {"spun": _is_spun(problem)}
        for curve, problem in zip(CURVES, problems, strict=True)
    ]


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of all, of solids and of points."""
    found = [
        solved(trials, "free axis among obstacles"),
        timed(trials, "free axis among obstacles", ASKED),
        stepped(trials, "free axis among obstacles"),
        worst(trials, "free axis among obstacles"),
    ]
    kinds = {
        "solids": trials.points == 0,
        "points": trials.points > 0,
        "stations turned about the free axis at random": trials.spun,
    }
    for kind, which in kinds.items():
        some = trials[which]
        if len(some):
            found += [solved(some, f"... {kind}"), timed(some, f"... {kind}", ASKED)]
    return found
