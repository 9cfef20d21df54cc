"""Asks the solver, judges every answer, counts, and keeps what failed."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
import numpy.typing as npt

import pdoik
from bench.common.arrays import BoolArray, FloatArray
from bench.ik.soak.cases import KEPT, encode
from bench.ik.soak.judge import ROUNDING, Asked, Judge, Verdicts
from bench.ik.soak.scenes import Scene, draw_scene, four_columns, make_goal, make_options
from bench.ik.soak.trees import draw_robot

Row = dict[str, Any]

SCENES = 5  # of one robot before the next one is drawn
ASKED_AGAIN = 0.001  # share of the answers that other settings are tried on, where there is none
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
    def of(cls, get: Callable[[str], Any], cpu: FloatArray) -> Self:
        """Make it by `get`, which gives each figure of all answers."""
        names = ("q", "success", "status", "time", "intake", "late_evaluations")
        said = {name: get(name) for name in FIELDS}
        return cls(said=said, cpu=cpu, **{name: get(name) for name in names})


def ask(scene: Scene, solver: pdoik.Solver) -> Answers:
    """All of a scene's questions to a solver."""
    if not scene.single:
        targets = {goal.tip: goal.T for goal in scene.goals}
        batch = solver.solve_batch(targets, q0=scene.q0, obstacles=scene.cloud, threads=1)
        intake, cpu = np.zeros(len(batch)), np.full(len(batch), np.nan)  # which it does not tell
        return Answers.of(lambda name: np.asarray(getattr(batch, name, intake)), cpu)
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
    return Answers.of(lambda n: np.array([getattr(r, n) for r in results]), np.array(cpu))


def faults(
    scene: Scene, judge: Judge, answers: Answers, verdicts: Verdicts, asked: Asked
) -> dict[str, BoolArray]:
    """What is wrong with which answers, by FAULTS."""
    q, kinematics = answers.q, judge.kinematics
    start = np.zeros_like(q) if scene.q0 is None else scene.q0
    moved = np.abs(q - kinematics.into_limits(start))
    most = np.inf if scene.max_step is None else scene.max_step + 1e-12
    endless = np.isinf(kinematics.lower)
    of_paper = scene.options.get("method") == "paper"
    return {
        "wrong": answers.success & ~verdicts.solves(asked),
        "limits": ~verdicts.limits_hold,
        "step": (moved > most).any(axis=1),
        "turn": (moved[:, endless] > np.pi + 1e-12).any(axis=1) & (not of_paper),
        "not finite": ~np.isfinite(q).all(axis=1),
        "status": answers.success != (answers.status == "solved"),
        "misreported": misreported(answers.said, verdicts, asked),
    }


def misreported(
    said: Mapping[str, FloatArray], verdicts: Verdicts, asked: Asked, look: float = np.inf
) -> BoolArray:
    """Answers that come with figures, by FIELDS, other than the judge's.

    What was not asked for is not reported; clearance is not measured beyond `look` [m].
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
    q0 = None if scene.q0 is None else scene.q0[only]
    return replace(scene, goals=[goal[only] for goal in scene.goals], q0=q0, single=True)


def missed_by(scene: Scene, robot: pdoik.Robot, judge: Judge, ks: Sequence[int]) -> int:
    """How many of these questions another setting answers, as the judge confirms."""
    patient = {
        **scene.options,
        "max_restarts": PATIENCE * (scene.options["max_restarts"] + 1),
        "max_time": min(PATIENT_TIME, PATIENCE * scene.options["max_time"]),
    }
    others: list[dict[str, Any]] = [{}, {"seed": scene.options["seed"] + 12345}]
    if not scene.has_slack and scene.posture is None and scene.max_step is None:
        others.append({"inner": "lbfgs"})
    solvers = [pdoik.Solver(robot, make_options({**patient, **other})) for other in others]

    def solves(question: Scene, solver: pdoik.Solver) -> bool:
        answers = ask(question, solver)
        verdicts, asked = judged(question, judge, answers)
        return bool(answers.success[0] and verdicts.solves(asked)[0])

    questions = [one_of(scene, int(k)) for k in ks]
    return sum(any(solves(question, solver) for solver in solvers) for question in questions)


def run_scene(
    scene: Scene, robot: pdoik.Robot, judge: Judge, rng: np.random.Generator
) -> tuple[Row, dict[int, list[str]]]:
    """Counts and worst figures of a scene, and which of its answers have which faults."""
    solver = pdoik.Solver(robot, make_options(scene.options))
    clocks = [time.thread_time()]
    answers = ask(scene, solver)
    clocks.append(time.thread_time())
    verdicts, asked = judged(scene, judge, answers)
    found = faults(scene, judge, answers, verdicts, asked)
    clocks.append(time.thread_time())
    ok = answers.success
    sample = rng.random(scene.count) < ASKED_AGAIN
    sample &= scene.options.get("method") != "paper"
    missed = missed_by(scene, robot, judge, list(np.flatnonzero(sample & ~ok)))
    clocks.append(time.thread_time())
    deadline = scene.options["max_time"]
    over = answers.time - answers.intake - deadline
    over_cpu = (answers.cpu - answers.intake - deadline)[~np.isnan(answers.cpu)]
    seconds = np.diff(clocks).tolist()
    row = {
        "goal": "slack" if scene.has_slack else scene.options["goal"],
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
        **verdicts.worst(asked, ok),
        "late_evaluations": int(answers.late_evaluations.max()),
        "overrun": float(over.max()),
        "overrun_cpu": float(over_cpu.max(initial=-np.inf)),
        **dict(zip(("solve_seconds", "judge_seconds", "again_seconds"), seconds, strict=True)),
    }
    bad = np.flatnonzero(np.any(list(found.values()), axis=0)).tolist()
    return row, {k: [name for name in FAULTS if found[name][k]] for k in bad}


KEPT_OF_SCENE = ("options", "goals", "size", "cloud", "q0", "posture", "max_step")


def case_of(scene: Scene, k: int, complaints: Sequence[str]) -> dict[str, Any]:
    """What `replay` needs to ask a scene's k-th question again."""
    only = one_of(scene, k)
    kept = {name: getattr(only, name) for name in KEPT_OF_SCENE}
    return {"kind": "solve", "complaints": list(complaints), "robot": scene.spec, **kept}


def replay(case: Mapping[str, Any]) -> list[str]:
    """Ask again; the faults of the answer."""
    spec = case["robot"]
    robot = spec.make()
    judge = Judge(spec, robot.joint_names)
    scene = Scene(spec=spec, single=True, **{name: case[name] for name in KEPT_OF_SCENE})
    answers = ask(scene, pdoik.Solver(robot, make_options(scene.options)))
    found = faults(scene, judge, answers, *judged(scene, judge, answers))
    return [name for name in FAULTS if found[name][0]]


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """Scenes of one family until the job's number of answers is there."""
    rng = np.random.default_rng([job["seed"], 1, *job["key"]])
    rows: list[Row] = []
    left, kept = job["count"], 0
    while left > 0:
        if len(rows) % SCENES == 0:
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
