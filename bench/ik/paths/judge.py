"""What a motion along a path is worth: Pinocchio's kinematics and distances by definition.

Nothing of the library's is asked. A motion is looked at in every row, and between rows, which are
joined by straight lines of joint positions, often enough for contacts to show.
"""

from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.paths.arms import judge_of
from bench.ik.paths.contacts import Contacts
from bench.ik.paths.problem import Problem
from bench.ik.paths.solids import World

SAMPLES = 10  # between two rows, for the way of the tool
FINE = 0.004  # and so far a joint goes at most between two looks at contacts [rad] or [m]
ROUNDING = 1e-9
STATION = 1e-5  # the goals' tolerances [m] and [rad]
WAY_POSITION, WAY_ROTATION = 1e-4, 1.75e-3  # between stations, 0.1 degrees [m], [rad]
DEPTH = 1e-4  # what counts as a contact [m]
MAX_STEP = 0.12  # of a joint from row to row [rad] or [m]
SAID_STEP = np.deg2rad(7.0)  # from station to station


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """Verdict on one motion; errors are the largest [m], [rad]."""

    station_position: float
    station_rotation: float
    way_position: float
    way_rotation: float
    depth: float  # in the world [m]
    own_depth: float  # of links in one another [m]
    beyond_limits: float
    row_step: float
    station_step: float
    length: float  # the sum of |dq|
    covers: bool  # from the first station to the last, never back

    @property
    def faults(self) -> list[str]:
        """What is wrong with it, by name."""
        return [name for name, bound in BOUNDS.items() if getattr(self, name) > bound] + (
            [] if self.covers else ["covers"]
        )

    def row(self) -> dict[str, Any]:
        """For a table of trials."""
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        return values | {"faults": " ".join(self.faults)}


BOUNDS = {
    "station_position": STATION + ROUNDING,
    "station_rotation": STATION + ROUNDING,
    "way_position": WAY_POSITION + ROUNDING,
    "way_rotation": WAY_ROTATION + ROUNDING,
    "depth": DEPTH,
    "own_depth": DEPTH,
    "beyond_limits": ROUNDING,
    "row_step": MAX_STEP + ROUNDING,
}


def judged(problem: Problem, Q: FloatArray, at: FloatArray, *, part: bool = False) -> Verdict:
    """A motion whose rows Q (m, n) are at places of the path, (m,), in stations.

    Args:
        problem: What it is to follow.
        Q: Rows.
        at: Their places.
        part: Whether it need not be all of the path.
    """
    if not len(Q) or not (np.isfinite(Q).all() and np.isfinite(at).all()):
        return _nothing()
    stations = np.arange(np.ceil(at[0]), np.floor(at[-1]) + 1.0)
    at_stations = along(Q, at, stations)
    between = np.linspace(0.0, 1.0, SAMPLES + 1)[:-1]
    places = np.append(at[:-1, None] + between * np.diff(at)[:, None], at[-1])
    way = (Q[:-1, None] + between[:, None] * np.diff(Q, axis=0)[:, None]).reshape(-1, Q.shape[1])
    way = np.concatenate([way, Q[-1:]])
    station = problem.errors(tool_at(problem, at_stations), problem.wanted(stations))
    off = problem.errors(tool_at(problem, way), problem.wanted(places))
    world, own = contacts_between(problem.arm, problem.world, Q)
    all_of = part or bool(at[0] == 0.0 and at[-1] == problem.last)
    return Verdict(
        station_position=float(station[0].max(initial=0.0)),
        station_rotation=float(station[1].max(initial=0.0)),
        way_position=float(off[0].max()),
        way_rotation=float(off[1].max()),
        depth=world,
        own_depth=own,
        beyond_limits=beyond_limits(problem.arm, Q),
        row_step=float(np.abs(np.diff(Q, axis=0)).max(initial=0.0)),
        station_step=float(np.abs(np.diff(at_stations, axis=0)).max(initial=0.0)),
        length=float(np.linalg.norm(np.diff(Q, axis=0), axis=1).sum()),
        covers=all_of and bool((np.diff(at) >= 0.0).all()),
    )


def beyond_limits(arm: str, Q: FloatArray) -> float:
    """Largest excess of a joint beyond its limits, negative inside [rad] or [m]."""
    limits = judge_of(arm).kinematics
    return float(np.maximum(limits.lower - Q, Q - limits.upper).max())


def faults_of_move(
    arm: str, world: World, Q: FloatArray, q_from: FloatArray, q_to: FloatArray
) -> list[str]:
    """What is wrong with a move whose corners, (m, n), are joined by straight lines, by name."""
    in_world, in_itself = contacts_between(arm, world, Q)
    bad = {
        "depth": in_world > DEPTH,
        "own_depth": in_itself > DEPTH,
        "beyond_limits": beyond_limits(arm, Q) > ROUNDING,
        "ends": max(np.abs(Q[0] - q_from).max(), np.abs(Q[-1] - q_to).max()) > ROUNDING,
    }
    return [name for name in bad if bad[name]]


def along(Q: FloatArray, at: FloatArray, places: FloatArray) -> FloatArray:
    """Configurations at places of the path, (B, n), on the straight lines between rows."""
    return np.column_stack([np.interp(places, at, joint) for joint in Q.T])


def tool_at(problem: Problem, Q: FloatArray) -> FloatArray:
    """Poses of the tool in configurations (B, n), (B, 4, 4)."""
    kinematics = judge_of(problem.arm).kinematics
    T = np.tile(np.eye(4), (len(Q), 1, 1))
    tip = problem.robot.tip_links[0]
    T[:, :3, :3], T[:, :3, 3] = kinematics.link(kinematics.place(Q), tip)
    return np.asarray(T @ problem.tool)


def contacts_between(arm: str, world: World, Q: FloatArray) -> tuple[float, float]:
    """How deep the arm is anywhere on straight lines between rows: in the world, in itself [m]."""
    rows = [Q[:1]]
    for one, other in pairwise(Q):
        count = max(1, int(np.ceil(np.abs(other - one).max() / FINE)))
        rows.append(one + np.linspace(0.0, 1.0, count + 1)[1:, None] * (other - one))
    depths = Contacts(judge_of(arm), world).depths(np.concatenate(rows))
    return float(depths[0].max()), float(depths[1].max())


def _nothing() -> Verdict:
    values: dict[str, Any] = {each.name: np.inf for each in fields(Verdict)}
    return Verdict(**{**values, "covers": False})
