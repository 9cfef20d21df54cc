"""Asks the solver, judges every answer, counts, and keeps what failed."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from bench.common.arrays import BoolArray
from bench.ik.soak.cases import KEPT, encode
from bench.ik.soak.judge import ROUNDING, Asked, Judge, Verdicts
from bench.ik.soak.robots import FloatArray, RobotSpec
from bench.ik.soak.scenes import Scene, draw_scene, four_columns, make_goal, make_options
from bench.ik.soak.trees import draw_robot

Row = dict[str, Any]

SCENES = 5  # of one robot before the next one is drawn
ASKED_AGAIN = 0.001  # share of the answers that other settings are tried on, where there is none
UNTOLD = -1  # of a core that does not count its evaluations after the deadline
PATIENCE = 20  # times the budget
PATIENT_TIME = 0.5  # at most [s]
FIELDS = ("position_error", "rotation_error", "clearance", "self_distance", "balance_violation")
FAULTS = ("wrong", "limits", "step", "turn", "not finite", "status", "misreported")


@dataclass(frozen=True, slots=True, kw_only=True)
class Answers:
    """What the solver said, each (B,) but q (B, n)."""

    q: FloatArray
    success: BoolArray
    status: npt.NDArray[np.str_]
    said: dict[str, FloatArray]  # by FIELDS
    time: FloatArray  # [s]
    intake: FloatArray  # of the cloud [s]
    late_evaluations: FloatArray
    cpu: FloatArray  # of the thread around the call, NaN in a batch [s]

    @classmethod
    def of_batch(cls, batch: pdoik.BatchResult) -> Answers:
        """From a batch."""
        nothing = np.zeros(len(batch))
        return cls(
            q=np.asarray(batch.q),
            success=batch.success,
            status=batch.status,
            said={name: getattr(batch, name) for name in FIELDS},
            time=batch.time,
            intake=getattr(batch, "intake", nothing),
            late_evaluations=getattr(batch, "late_evaluations", nothing + UNTOLD),
            cpu=nothing * np.nan,
        )

    @classmethod
    def of_results(cls, results: Sequence[pdoik.Result], cpu: Sequence[float]) -> Answers:
        """From single solves."""
        return cls(
            q=np.array([result.q for result in results]),
            success=np.array([result.success for result in results]),
            status=np.array([result.status for result in results]),
            said={name: np.array([getattr(r, name) for r in results]) for name in FIELDS},
            time=np.array([result.time for result in results]),
            intake=np.array([getattr(result, "intake", 0.0) for result in results]),
            late_evaluations=np.array([getattr(r, "late_evaluations", UNTOLD) for r in results]),
            cpu=np.array(cpu),
        )


def ask(scene: Scene, solver: pdoik.Solver) -> Answers:
    """All of a scene's questions to a solver."""
    if not scene.single:
        targets = {goal.tip: goal.T for goal in scene.goals}
        batch = solver.solve_batch(targets, q0=scene.q0, obstacles=scene.cloud, threads=1)
        return Answers.of_batch(batch)
    results, cpu = [], []
    for k in range(scene.count):
        goals = {goal.tip: make_goal(goal, goal.T[k]) for goal in scene.goals}
        q0 = None if scene.q0 is None else scene.q0[k]
        begun = time.thread_time()
        result = solver.solve(
            goals, q0=q0, obstacles=scene.cloud, posture=scene.posture, max_step=scene.max_step
        )
        cpu.append(time.thread_time() - begun)
        results.append(result)
    return Answers.of_results(results, cpu)


def faults(
    scene: Scene, judge: Judge, answers: Answers, verdicts: Verdicts, asked: Asked
) -> dict[str, BoolArray]:
    """What is wrong with which answers, by FAULTS."""
    q, kinematics = answers.q, judge.kinematics
    wrong = answers.success & ~verdicts.solves(asked)
    found = {
        "wrong": wrong,
        "limits": ~verdicts.limits_hold,
        "not finite": ~np.isfinite(q).all(axis=1),
        "status": answers.success != (answers.status == "solved"),
    }
    start = np.zeros_like(q) if scene.q0 is None else scene.q0
    moved = np.abs(q - kinematics.into_limits(start))
    found["step"] = np.zeros(len(q), dtype=bool)
    if scene.max_step is not None:
        found["step"] = (moved > scene.max_step + 1e-12).any(axis=1)
    endless = np.isinf(kinematics.lower)
    of_paper = scene.options.get("method") == "paper"
    found["turn"] = (moved[:, endless] > np.pi + 1e-12).any(axis=1) & (not of_paper)
    found["misreported"] = misreported(answers.said, verdicts, asked)
    return found


def misreported(
    said: Mapping[str, FloatArray], verdicts: Verdicts, asked: Asked, look: float = np.inf
) -> BoolArray:
    """Answers that come with figures other than the judge's.

    Args:
        said: By FIELDS.
        verdicts: The judge's figures.
        asked: What was asked for: what was not is not reported.
        look: Clearance that is not measured beyond [m].
    """
    bad = np.zeros(len(verdicts.clearance), dtype=bool)
    for name in FIELDS:
        theirs, ours = said[name], getattr(verdicts, name)
        if name == "clearance":
            theirs, ours = np.minimum(theirs, look), np.minimum(ours, look)
        skip = (theirs == ours) | ~np.isfinite(ours) & ~np.isfinite(theirs)
        if name == "rotation_error":
            skip |= verdicts.ambiguous
        if name in ("clearance", "self_distance"):
            skip |= verdicts.hollow
        if name == "self_distance" and not asked.self_collision:
            continue
        if name == "balance_violation":
            ours = np.maximum(ours, 0.0)
        with np.errstate(invalid="ignore"):
            bad |= ~skip & ~(np.abs(theirs - ours) <= ROUNDING * (1.0 + np.abs(ours)))
    return bad


def judged(scene: Scene, judge: Judge, answers: Answers) -> tuple[Verdicts, Asked]:
    """The judge's figures and what they are measured by."""
    asked = Asked.of(scene.options)
    return judge(scene.goals, answers.q, asked, four_columns(scene.cloud)), asked


def one_of(scene: Scene, k: int) -> Scene:
    """The scene with its k-th question alone, asked by itself."""
    only = slice(k, k + 1)
    return replace(
        scene,
        goals=[goal[only] for goal in scene.goals],
        q0=None if scene.q0 is None else scene.q0[only],
        single=True,
    )


def missed_by(scene: Scene, robot: pdoik.Robot, judge: Judge, ks: Sequence[int]) -> int:
    """How many of these questions another setting answers, as the judge confirms."""
    restarts = PATIENCE * (scene.options["max_restarts"] + 1)
    patient = {
        "max_restarts": restarts,
        "max_time": min(PATIENT_TIME, PATIENCE * scene.options["max_time"]),
    }
    others: list[dict[str, Any]] = [{}, {"seed": scene.options["seed"] + 12345}]
    if not has_slack(scene) and scene.posture is None and scene.max_step is None:
        others.append({"inner": "lbfgs"})
    solvers = [
        pdoik.Solver(robot, make_options({**scene.options, **patient, **other})) for other in others
    ]
    missed = 0
    for k in ks:
        question = one_of(scene, int(k))
        for solver in solvers:
            answers = ask(question, solver)
            verdicts, asked = judged(question, judge, answers)
            if answers.success[0] and verdicts.solves(asked)[0]:
                missed += 1
                break
    return missed


def run_scene(
    scene: Scene, robot: pdoik.Robot, judge: Judge, rng: np.random.Generator
) -> tuple[Row, dict[int, list[str]]]:
    """Counts and worst figures of a scene, and which of its answers have which faults."""
    solver = pdoik.Solver(robot, make_options(scene.options))
    begun = time.thread_time()
    answers = ask(scene, solver)
    solved_in = time.thread_time() - begun
    verdicts, asked = judged(scene, judge, answers)
    found = faults(scene, judge, answers, verdicts, asked)
    judged_in = time.thread_time() - begun - solved_in
    ok = answers.success
    sample = rng.random(scene.count) < ASKED_AGAIN
    if scene.options.get("method") == "paper":
        sample[:] = False
    missed = missed_by(scene, robot, judge, list(np.flatnonzero(sample & ~ok)))
    excess = {
        f"excess_{name}": float(values[ok].max(initial=-np.inf))
        for name, values in verdicts.excess(asked).items()
    }
    deadline = scene.options["max_time"]
    over = answers.time - answers.intake - deadline
    over_cpu = (answers.cpu - answers.intake - deadline)[~np.isnan(answers.cpu)]
    row = {
        "goal": "slack" if has_slack(scene) else scene.options["goal"],
        "cloud": scene.size,
        "self_collision": asked.self_collision,
        "balance": asked.balance is not None,
        "single": scene.single,
        "struck": deadline < 0.1,
        "n": scene.count,
        "solved": int(ok.sum()),
        "none_found": int((~ok).sum()),
        "sampled": int(sample.sum()),
        "missed": missed,
        **{name: int(found[name].sum()) for name in FAULTS},
        **excess,
        "late_evaluations": int(answers.late_evaluations.max(initial=UNTOLD)),
        "overrun": float(over.max(initial=-np.inf)),
        "overrun_cpu": float(over_cpu.max(initial=-np.inf)),
        "solve_seconds": solved_in,
        "judge_seconds": judged_in,
        "again_seconds": time.thread_time() - begun - solved_in - judged_in,
    }
    bad: dict[int, list[str]] = {}
    for name in FAULTS:
        for k in np.flatnonzero(found[name]):
            bad.setdefault(int(k), []).append(name)
    return row, bad


def has_slack(scene: Scene) -> bool:
    """Whether any goal leaves some room."""
    return any(any(goal.position_slack) or any(goal.rotation_slack) for goal in scene.goals)


def case_of(scene: Scene, k: int, complaints: Sequence[str]) -> dict[str, Any]:
    """What `replay` needs to ask a scene's k-th question again."""
    only = one_of(scene, k)
    return {
        "kind": "solve",
        "complaints": list(complaints),
        "robot": scene.spec,
        "options": scene.options,
        "goals": only.goals,
        "size": scene.size,
        "cloud": scene.cloud,
        "q0": only.q0,
        "posture": scene.posture,
        "max_step": scene.max_step,
    }


def replay(case: Mapping[str, Any]) -> list[str]:
    """Ask again; the faults of the answer."""
    spec: RobotSpec = case["robot"]
    robot = spec.make()
    judge = Judge(spec, robot.joint_names)
    rest = {name: case[name] for name in ("options", "goals", "size", "cloud", "q0", "posture")}
    scene = Scene(spec=spec, **rest, max_step=case["max_step"], single=True)
    answers = ask(scene, pdoik.Solver(robot, make_options(scene.options)))
    verdicts, asked = judged(scene, judge, answers)
    found = faults(scene, judge, answers, verdicts, asked)
    return [name for name in FAULTS if found[name][0]]


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """Scenes of one family until the job's number of answers is there."""
    rng = np.random.default_rng([job["seed"], 1, *job["key"]])
    rows: list[Row] = []
    left, kept = job["count"], 0
    robot, judge = None, None
    while left > 0:
        if len(rows) % SCENES == 0 or robot is None or judge is None:
            spec = draw_robot(job["family"], rng)
            robot = spec.make()
            judge = Judge(spec, robot.joint_names)
        scene = draw_scene(judge, rng, left)
        row, bad = run_scene(scene, robot, judge, rng)
        cases = {
            f"solve-{job['name']}-{len(rows):04d}-{k:04d}": case_of(scene, k, complaints)
            for k, complaints in list(bad.items())[: KEPT - kept]
        }
        kept += len(cases)
        text = json.dumps(encode(cases)) if cases else ""
        rows.append({"family": job["family"], "scene": len(rows), **row, "cases": text})
        left -= scene.count
    return rows
