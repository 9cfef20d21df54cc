"""Random reachable poses without obstacles: this library and its peers, to 1e-6 m and rad."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pdoik
from bench.common.timings import Block, Row, Solve
from bench.ik.experiment import Advance, Arm, FloatArray, PinocchioJudge, take_turns

TOLERANCE = 1e-6  # [m] and [rad]
MAX_TIME = 0.01  # [s]
PEERS = {"KDL LMA": "libpdoik_peer_kdl_lma.so", "LM on Pinocchio": "libpdoik_peer_pinocchio_lm.so"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A pose and where to start."""

    T_base_tip: FloatArray  # (4, 4)
    q0: FloatArray  # (n,), [rad]


Method = Callable[[Target], Solve]


def compare_with_peers(
    arms: list[Arm], libraries: Path, targets: int, seed: int, advance: Advance
) -> Block:
    """Every method solves the same targets from mid-range, and one judge sees all answers."""
    rows: list[Row] = []
    for index, arm in enumerate(arms):
        rng = np.random.default_rng([seed, index])
        q0 = arm.robot.mid_configuration()
        problems = [
            Target(T_base_tip=arm.robot.fk(arm.random_configuration(rng)), q0=q0)
            for _ in range(targets)
        ]
        judge = PinocchioJudge(arm, TOLERANCE, TOLERANCE)
        methods = {"pdoik": _pdoik(arm, judge)}
        methods |= {name: _peer(arm, libraries / file, judge) for name, file in PEERS.items()}
        solves = take_turns(methods, problems, advance)
        rows += [Row.of(arm.name, name, solves[name]) for name in methods]
    return Block(
        title=f"{targets} reachable poses per arm, {TOLERANCE:g} m and rad, {1e3 * MAX_TIME:g} ms",
        rows=rows,
        notes=[
            "All start mid-range, then at random until solved or out of time; judged by Pinocchio."
        ],
    )


def _pdoik(arm: Arm, judge: PinocchioJudge) -> Method:
    options = pdoik.Options(
        position_tolerance=TOLERANCE,
        rotation_tolerance=TOLERANCE,
        max_time=MAX_TIME,
        max_restarts=1_000_000,  # time is the only limit, as for the peers
    )
    solver = pdoik.Solver(arm.robot, options)

    def solve(target: Target) -> Solve:
        result = solver.solve(target.T_base_tip)  # from mid-range, as q0 is
        return Solve(
            claimed=result.success,
            confirmed=judge(target.T_base_tip, result.q),
            time=result.time,
            iterations=result.iterations,
            restarts=result.restarts,
        )

    return solve


def _peer(arm: Arm, library: Path, judge: PinocchioJudge) -> Method:
    peer = arm.peer(
        library, position_tolerance=TOLERANCE, rotation_tolerance=TOLERANCE, max_time=MAX_TIME
    )

    def solve(target: Target) -> Solve:
        answer = peer.solve(target.T_base_tip, q0=target.q0)
        return Solve(
            claimed=answer.success,
            confirmed=judge(target.T_base_tip, answer.q),
            time=answer.time,
            iterations=answer.iterations,
            restarts=answer.restarts,
        )

    return solve
