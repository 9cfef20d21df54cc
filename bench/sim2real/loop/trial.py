"""One world: record, diagnose from the folder alone, feed forward, run on other paths.

Recorded are paths among the obstacles, each with an excitation of the empty cell behind it.
"""

import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path as Folder
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from bench.sim2real.concealed.build import study_of, world_of
from bench.sim2real.concealed.draft import Draft
from bench.sim2real.concealed.logger import Take
from bench.sim2real.concealed.reference import Dynamics
from bench.sim2real.concealed.world import Run, World
from bench.sim2real.frame.arm import Array, urdf
from bench.sim2real.frame.motion import STEP, Motion, Style, recording_motion, smoothstep
from bench.sim2real.frame.study_files import write_study
from bench.sim2real.loop.cell import Clearance, random_cell
from bench.sim2real.loop.feed_forward import commands
from bench.sim2real.loop.hidden import HIDDEN, MODEL_ERROR, WITH_TIP
from bench.sim2real.loop.machine import (
    Outcome,
    believed_robot,
    clean_world,
    machine,
    outcome,
    robot_of,
)
from bench.sim2real.loop.path import HOME, REST, Path, random_path
from pdoik import sim2real
from pdoik.sim2real import Diagnosis, Model

EXCITATIONS = (("sines", "reversals"), ("moves", "sines"), ("reversals", "moves"))
ROLES = ("fit", "fit", "validate")
SECONDS = 16.0  # of an excitation
CALM = 0.8  # rad/s, of moves from one part to the next
LOGGED = ["q", "dq", "q_des", "dq_des", "tau", "tau_cmd"]


def recorded_motion(
    draft: Draft, path: Motion, index: int, seconds: float, rng: np.random.Generator
) -> Motion:
    """A path, then an excitation of the empty cell."""
    kinds, pace = EXCITATIONS[index], (0.8, 0.9, 1.0)[index]
    excitation = recording_motion(draft.arm, rng, kinds, seconds, pace, Style())
    return Motion.of(np.concatenate([path.q, _move(path.q[-1], excitation.q[0]), excitation.q]))


def _move(start: Array, end: Array) -> Array:
    duration = max(1.0, 1.9 * float(np.max(np.abs(end - start))) / CALM)
    s = smoothstep(np.arange(round(duration / STEP)) / round(duration / STEP))
    return np.asarray(start + s[:, None] * (end - start))


def write_commissioning(
    folder: Folder, draft: Draft, world: World, motions: list[Motion], seed: int, *, tip: bool
) -> None:
    """Run the motions on the true machine under PD control and write a study of what it logs."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng([seed, 11])
    for index, motion in enumerate(motions):
        take = Take.of(Run(world, motion, index, rng))
        take.write(folder / f"rec{index + 1}.csv", LOGGED, rng, tip=tip)
    study = study_of(replace(draft, roles=list(ROLES)), np.arange(draft.arm.n))
    write_study(folder, urdf(draft.believed), study)


LEGS = 4
WAYS = ("pd", "given", "diagnosed", "floor")
"""PD and gravity compensation alone; fed forward the given model; the diagnosed one; nothing
concealed and the true model fed forward."""


class Experiment:
    """A machine with something concealed, its cell, and paths."""

    def __init__(self, seed: int, effect: str) -> None:
        self.seed, self.effect = seed, effect
        self.draft = machine(seed, MODEL_ERROR.get(effect, 0.0))
        self.robot = believed_robot(self.draft)
        self.cell = random_cell(self.robot, HOME, self._stream(1))
        self.hidden = HIDDEN[effect](self.draft, self._stream(2)) if effect else ()
        self.world = world_of(self.draft, self.hidden)
        self.clearance = Clearance(self.robot.occupancy, self.cell)

    def _stream(self, purpose: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, purpose])

    def test_paths(self, count: int) -> list[Path]:
        rng = self._stream(3)
        return [random_path(self.robot, self.cell, LEGS, rng) for _ in range(count)]

    def record(self, folder: Folder, seconds: float = SECONDS) -> None:
        """The commissioning study, with an excitation of so many seconds in each recording."""
        rng, motions = self._stream(4), []
        for index in range(3):
            path = random_path(self.robot, self.cell, LEGS, rng)
            motion = path.motion(self.robot, self.cell)
            motions.append(recorded_motion(self.draft, motion, index, seconds, rng))
        tip = self.effect in WITH_TIP
        write_commissioning(folder, self.draft, self.world, motions, self.seed, tip=tip)

    def follow(self, world: World, motion: Motion) -> Outcome:
        """What the true machine does with commands."""
        return outcome(Run(world, motion, 0, self._stream(5)), self.clearance)

    def ways(self, found: Model, path: Path) -> dict[str, tuple[Outcome, float]]:
        """The four ways of following a path, and how far off the solutions themselves are [m]."""
        plan = path.motion(self.robot, self.cell)
        try:
            there = path.motion(corrected_robot(found), self.cell)
        except ValueError:  # a robot so wrongly corrected that it cannot go there: go as given
            there = plan
        given = replace(found, findings=(), rigid_body={})
        true = replace(given, robot=urdf(self.draft.arm))
        clean = clean_world(self.draft)
        before, after = self.reach(path, plan), self.reach(path, there)
        return {
            "pd": (self.follow(self.world, plan), before),
            "given": (self.follow(self.world, commands(given, plan)), before),
            "diagnosed": (self.follow(self.world, commands(found, there)), after),
            "floor": (self.follow(clean, commands(true, plan)), np.nan),
        }

    def reach(self, path: Path, motion: Motion) -> float:
        """Largest distance of the true tip, standing at the solutions, from the targets [m]."""
        rows = slice(0, None, 50)
        q = np.array([self.world.joints_of_motors(row) for row in motion.q[rows]])
        true = Dynamics(self.world.arm, self.draft.armature).tips(q)[0]
        return float(np.linalg.norm(true - path.targets()[rows], axis=1).max())


def corrected_robot(model: Model) -> pdoik.Robot:
    """The improved URDF in the solver: joints placed as found."""
    return robot_of(sim2real.export_urdf(model).text)


def diagnosed(folder: Folder) -> tuple[Diagnosis, Model]:
    """Diagnosis and model by the tool alone, from the folder alone."""
    examination = sim2real.examine(folder / "study.yaml")
    return examination.diagnosis, sim2real.model_of(examination)


def run_world(job: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Rows of one world, one per test path and way: job has seed, effect, paths."""
    experiment = Experiment(job["seed"], job["effect"])
    with tempfile.TemporaryDirectory(prefix="pdoik-loop-") as folder:
        experiment.record(Folder(folder))
        begin = time.perf_counter()
        diagnosis, model = diagnosed(Folder(folder))
        seconds = time.perf_counter() - begin
    rows = []
    for index, path in enumerate(experiment.test_paths(job["paths"])):
        for way, (each, reach) in experiment.ways(model, path).items():
            rows.append(
                {
                    "effect": job["effect"],
                    "seed": job["seed"],
                    "path": index,
                    "way": way,
                    **judged(experiment, path, each),
                    "reach": reach,
                    "seconds": seconds,
                    "hidden": hidden_in_words(experiment),
                    "said": said(diagnosis),
                }
            )
    return rows


def tip_errors(experiment: Experiment, path: Path, each: Outcome) -> Array:
    """Distance of the true tip from where it shall be, from when it sets out, (K,) [m]."""
    period = experiment.draft.control.period
    error = np.linalg.norm(each.tip - path.targets()[:: round(period / STEP)], axis=1)
    return np.asarray(error[round(REST / period) :])


def judged(experiment: Experiment, path: Path, each: Outcome) -> dict[str, Any]:
    """Errors and clearance of one run; the error every 20 ms for pictures."""
    error = tip_errors(experiment, path, each)
    every = round(0.02 / experiment.draft.control.period)
    return {
        "rms": float(np.sqrt(np.mean(error**2))),
        "largest": float(error.max()),
        "clearance": float(each.clearance.min()),
        "error": error[::every].tolist(),
    }


def hidden_in_words(experiment: Experiment) -> str:
    """Effects, places and figures of the truth."""
    parts = []
    for effect in experiment.hidden:
        joints = ",".join(f"joint{j + 1}" for j in effect.joints(experiment.draft.ref))
        figures = effect.parameters() | {
            k: v for b in effect.beside().values() for k, v in b.items()
        }
        values = ", ".join(f"{name} {value:.3g}" for name, value in figures.items() if value)
        parts.append(f"{effect.id} {joints} {values}".replace("  ", " "))
    return "; ".join(parts)


def said(diagnosis: Diagnosis) -> str:
    parts = []
    for finding in diagnosis.findings:
        where = ",".join(finding.joints + finding.links)
        values = ", ".join(f"{name} {value:.3g}" for name, value in finding.values.items())
        parts.append(f"{finding.effect} {finding.variant} {where} {values}".replace("  ", " "))
    return "; ".join(parts) or diagnosis.verdict


Array = npt.NDArray[np.float64]
