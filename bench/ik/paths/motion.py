"""Moves of a Panda in rooms of seven kinds: from one clear configuration to another."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from time import process_time
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.common.intervals import duration
from bench.ik.lines import Line, jobs_of, share
from bench.ik.paths.arms import robot_of
from bench.ik.paths.judge import contacts_between, faults_of_move
from bench.ik.paths.rooms import ROOMS
from bench.ik.paths.solids import World, frame
from bench.ik.soak.solves import Row

SIZES = (1, 10)  # jobs of each kind
MOVES = 10  # each
ARM, HAND = "panda", 0.1  # [m]
READY = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
MAX_TIME, PATIENT = 1.0, 20.0  # [s]
ASKED = 0.005  # the median [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """A move from one clear configuration to another."""

    key: str
    world: World
    q_from: FloatArray
    q_to: FloatArray


jobs = partial(jobs_of, kind=ROOMS)


def draw(kind: str, index: int, seed: int) -> Move:
    """One move: to one task of a room, from another or from where arms stand at rest."""
    rng = np.random.default_rng([seed, 6, list(ROOMS).index(kind), index])
    solver = pdoik.Solver(robot_of(ARM), pdoik.Options(max_time=0.1))
    while True:
        room = ROOMS[kind](rng)
        world = World(solids=room.solids)
        tasks = list(rng.permutation(np.array(room.tasks)))
        q_to = _at(solver, tasks[0], world, rng)
        if rng.random() < 0.5:
            q_from = _clear(READY + rng.uniform(-0.1, 0.1, 7), world)
        else:
            q_from = _at(solver, tasks[-1], world, rng)
        if q_from is not None and q_to is not None:
            key = f"motion:{kind}:{index}:{seed}"
            return Move(key=key, world=world, q_from=q_from, q_to=q_to)


def _at(
    solver: pdoik.Solver, T: FloatArray, world: World, rng: np.random.Generator
) -> FloatArray | None:
    robot = robot_of(ARM)
    q0 = rng.uniform(robot.lower, robot.upper)
    found = solver.solve(T, q0, world.given(), T_tip_tool=frame([0.0, 0.0, HAND]))
    return _clear(np.asarray(found.q), world) if found.success else None


def _clear(q: FloatArray, world: World) -> FloatArray | None:
    return None if any(contacts_between(ARM, world, np.array([q, q]))) else q


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """Some moves, one after the other."""
    first = job["index"] * MOVES
    moves = [draw(job["kind"], first + k, job["seed"]) for k in range(MOVES)]
    solver: Any = pdoik.Solver(robot_of(ARM))
    rows: list[Row] = []
    for move in moves:
        given = move.world.given()
        if not rows:  # what is made once
            solver.plan_motion(move.q_from, None, move.q_to, given, max_time=MAX_TIME)
        began = process_time()
        motion = solver.plan_motion(move.q_from, None, move.q_to, given, max_time=MAX_TIME)
        took = process_time() - began
        row: Row = {
            "key": move.key,
            "kind": job["kind"],
            "status": motion.status,
            "reason": motion.reason,
            "solved": motion.success,
            "time": motion.time,
            "processor": took,
            "checks": motion.checks,
            "said_length": motion.length,
            "straight": float(np.linalg.norm(move.q_to - move.q_from)),
            "corners": len(motion.q),
            "possible": motion.success,
            **judged(move, np.asarray(motion.q) if motion.success else None),
        }
        if not motion.success:
            again = solver.plan_motion(move.q_from, None, move.q_to, given, max_time=PATIENT)
            row["possible"] = again.success and not judged(move, np.asarray(again.q))["wrong"]
        rows.append(row)
    return rows


def judged(move: Move, Q: FloatArray | None) -> Row:
    """What is wrong with a move, corner by corner and between."""
    if Q is None:
        return {"wrong": False, "faults": "", "length": np.nan}
    faults = faults_of_move(ARM, move.world, Q, move.q_from, move.q_to)
    length = float(np.linalg.norm(np.diff(Q, axis=0), axis=1).sum())
    return {"wrong": bool(faults), "faults": " ".join(faults), "length": length}


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of each kind, and of all."""
    groups = [(str(kind), some) for kind, some in trials.groupby("kind", sort=False)]
    return [_line(kind, some) for kind, some in [*groups, ("all", trials)]]


def _line(kind: str, some: pd.DataFrame) -> Line:
    good = some[some.solved]
    late = int((~some.solved & some.possible).sum())
    return Line(
        what=f"{kind}: solved in {MAX_TIME:g} s; wrong anywhere; median, 95 %; length",
        asked=f"0.990; 0; median {duration(ASKED)}",
        measured=f"{share(some.solved, len(some))} ({late} more in {PATIENT:g} s); "
        f"{int(some.wrong.sum())}; {duration(some.time.median())}, "
        f"{duration(some.time.quantile(0.95))}, on the processor "
        f"{duration(some.processor.median())}; {good.length.median():.2f} rad "
        f"({(good.length / good.straight).median():.2f} of the straight line)",
        cases=f"{len(some):,}",
        failures=int(some.wrong.sum() + (~some.solved & some.possible).sum()),
    )
