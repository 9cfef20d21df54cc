"""An H1 on both feet at 0.8 ms whose hand is asked for more than there may be: does it go on?"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import BoolArray, FloatArray
from bench.ik.lines import Line, jobs_of, share
from bench.ik.safety.least import ROTATION_WEIGHT
from bench.ik.safety.world import PERIOD, SOLE, h1_stance
from bench.ik.soak.hulls import capsules, segment_distance
from bench.ik.soak.judge import Asked, Goals, Judge, beyond_polygon
from bench.ik.soak.scenes import make_options
from bench.ik.soak.solves import Row

SIZES = (1, 6)  # goals
STEPS = 600  # for each
BUDGET = 8e-4  # of a step [s]
FAR = 0.5  # a hand's goal along each axis, at most [m]
LOOK = 0.02  # contacts farther away do not count [m]
DIFFERENCE = 1e-6  # of joints [rad]
STANDS = 5.1e-5  # how far a foot that stands may be off [m]
WORTH = 1e-3  # of what is left: what a step could gain and did not
FOOT, HAND = "right_ankle_link", "left_elbow_link"


jobs = jobs_of


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """Steps towards one goal."""
    spec, asked, bent = h1_stance()
    robot = spec.make()
    judge = Judge(spec, robot.joint_names)
    solver = pdoik.Solver(robot, make_options({**asked, "max_time": 0.5}))
    R, p = judge.kinematics.link(judge.kinematics.place(np.zeros((1, len(bent)))), FOOT)
    foot = np.eye(4)
    foot[:3, :3], foot[:3, 3] = R[0], p[0]
    stand = solver.solve({FOOT: foot}, q0=bent, posture=bent).q
    elbow = judge.kinematics.link(judge.kinematics.place(stand[None]), HAND)[1][0]
    rng = np.random.default_rng([job["seed"], 14, job["index"]])
    hand = np.eye(4)
    hand[:3, 3] = elbow + rng.uniform(-FAR, FAR, 3)
    Q, struck = walk(solver, stand, foot, hand)
    standing, _ = walk(solver, stand, pdoik.Goal(foot, stands=True), hand)
    at = judge.kinematics.link(judge.kinematics.place(standing), FOOT)[1]
    row = verdict(judge, Q, struck, foot, hand, job["index"])
    return [{**row, "standing_off": float(np.linalg.norm(at - foot[:3, 3], axis=1).max())}]


def walk(
    solver: pdoik.Solver, start: FloatArray, foot: Any, hand: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Configurations of all steps, the start first, and which steps were struck."""
    tracker = pdoik.Tracker(solver, PERIOD, max_time=BUDGET)
    tracker.reset(start)
    goals: dict[str, Any] = {FOOT: foot, HAND: pdoik.Goal(hand[:3, 3], type="position")}
    Q, struck = [start], []
    for _ in range(STEPS):
        step = tracker.step(goals)
        Q.append(step.q.copy())
        struck.append(step.tracking == "deadline_struck")
    return np.array(Q), np.array(struck)


def verdict(
    judge: Judge, Q: FloatArray, struck: BoolArray, foot: FloatArray, hand: FloatArray, index: int
) -> Row:
    """Row of steps from Q[k] to Q[k + 1]: those that stay short of the goals, and their gain."""
    _, options, _ = h1_stance()
    asked = Asked.of(options)
    goals = [
        Goals(tip=FOOT, T=np.broadcast_to(foot, (len(Q), 4, 4))),
        Goals(tip=HAND, T=np.broadcast_to(hand, (len(Q), 4, 4)), type="position"),
    ]
    verdicts = judge(goals, Q, asked)
    feet = judge(goals[:1], Q, asked)
    short = ~verdicts.solves(asked)[1:]
    moves = (np.diff(Q, axis=0) != 0.0).any(axis=1)
    still = np.flatnonzero(short & ~moves)
    bound = PERIOD * judge.kinematics.velocity
    gains = {}
    for k in still:  # the same place has the same gain
        if Q[k].tobytes() not in gains:
            gains[Q[k].tobytes()] = gain(judge, Q[k], foot, hand, bound)
    worth = np.array([gains[Q[k].tobytes()] for k in still])
    return {
        "index": index,
        "n": len(Q) - 1,
        "short": int(short.sum()),
        "moves": int((short & moves).sum()),
        "could": int((worth > WORTH).sum()),
        "could_unstruck": int((worth[~struck[still]] > WORTH).sum()),
        "struck": int(struck.sum()),
        "gain": float(worth.max(initial=0.0)),
        "left": float(verdicts.position_error[-1]),
        "foot_off": float(feet.position_error.max()),
        "outside": float(verdicts.balance_violation.max()),
        "self_distance": float(verdicts.self_distance.min()),
        "rest": Q[-1].tolist(),
        "hand": hand[:3, 3].tolist(),
    }


def gain(
    judge: Judge, q: FloatArray, foot: FloatArray, hand: FloatArray, bound: FloatArray
) -> float:
    """Share of the goals' cost that one step could take off, by its linear model at most."""
    n = len(q)
    there = _model(judge, np.vstack([q, q + DIFFERENCE * np.eye(n)]), foot, hand)
    errors, gaps = (each[0] for each in there)
    J, G = ((each[1:] - each[0]).T / DIFFERENCE for each in there)
    some = gaps < LOOK
    room, G = np.maximum(gaps[some], 0.0), G[some]
    low = np.maximum(judge.kinematics.lower - q, -bound)
    high = np.minimum(judge.kinematics.upper - q, bound)
    scale = 1.0 / (errors @ errors)
    kept: Any = {"type": "ineq", "fun": lambda d: G @ d + room, "jac": lambda _: G}
    found: Any = minimize(
        lambda d: float(scale * np.sum((J @ d + errors) ** 2)),
        np.zeros(n),
        jac=lambda d: 2 * scale * J.T @ (J @ d + errors),
        bounds=list(zip(low, high, strict=True)),
        constraints=kept,
        method="SLSQP",
        options={"maxiter": 300, "ftol": 1e-9},
    )
    broken = float(np.minimum(G @ found.x + room, 0.0).min(initial=0.0))
    return float(1.0 - found.fun) if broken > -1e-7 else 0.0


def _model(
    judge: Judge, Q: FloatArray, foot: FloatArray, hand: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Errors of the goals, (B, 9), and what must not become negative, (B, C)."""
    placed = judge.kinematics.place(Q, com=True)
    assert placed.com is not None
    R, p = judge.kinematics.link(placed, FOOT)
    turn = Rotation.from_matrix(foot[:3, :3].T @ R).as_rotvec()
    reached = judge.kinematics.link(placed, HAND)[1]
    errors = np.hstack([p - foot[:3, 3], ROTATION_WEIGHT * turn, reached - hand[:3, 3]])
    a, b, radii = capsules(*judge.hulls(placed), judge.A, judge.swept)
    i, j = judge.pairs.T
    own = segment_distance(a[:, i], b[:, i], a[:, j], b[:, j]) - radii[:, i] - radii[:, j]
    _, options, _ = h1_stance()
    corners = []
    for link in (FOOT, "left_ankle_link"):
        R, p = judge.kinematics.link(placed, link)
        corners += [p + R @ np.array(corner) for corner in SOLE]
    beyond = beyond_polygon(np.stack(corners, axis=1), placed.com, np.array([0.0, 0.0, 1.0]))
    inside = -(beyond + options["balance"]["support_margin"])
    return errors, np.hstack([own, inside[:, None]])


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of all steps short of their goals."""
    short, could = int(trials.short.sum()), int(trials.could.sum())
    unstruck = int(trials.could_unstruck.sum())
    moves = int(trials.moves.sum())
    return [
        Line(
            what="H1 on both feet at 0.8 ms, goals unreached: steps that move or cannot",
            asked="1",
            measured=f"{share(short - could, short)} ({moves:,} move, {short - moves - could:,} "
            f"cannot); of the others {could - unstruck} struck",
            cases=f"{short:,} of {int(trials.n.sum()):,} steps, {len(trials)} goals",
            failures=could,
        ),
        Line(
            what="... its foot off its goal, its centre of mass outside, at most",
            asked="none, 0 mm",
            measured=f"{1e3 * trials.foot_off.max():.2f} mm, {1e3 * trials.outside.max():.3f} mm",
            cases=f"{len(trials)} goals",
            failures=int((trials.outside > 1e-6).sum()),
        ),
        Line(
            what="... the foot off its goal where that `stands`, at most",
            asked="0.05 mm",
            measured=f"{1e3 * trials.standing_off.max():.3f} mm",
            cases=f"{len(trials)} goals",
            failures=int((trials.standing_off > STANDS).sum()),
        ),
    ]
