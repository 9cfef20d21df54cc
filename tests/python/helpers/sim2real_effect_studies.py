"""Studies of a small arm whose torques are written down by the test, not by pdoik's simulator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pdoik.sim2real import Diagnosis, Study
from pdoik.sim2real.motion import RigidBody
from sim2real_motions import write_arm
from sim2real_recordings import even_recording

JOINTS = ("j1", "j2", "j3")
PERIOD = 0.004
ROTORS = np.array([0.06, 0.05, 0.03])
NOISE = 0.02  # [N m]


@dataclass(frozen=True)
class Course:
    """A motion and the body that makes it; arrays are (T, 3)."""

    body: RigidBody
    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray

    @property
    def tau(self) -> np.ndarray:
        """What the model needs for it, rotors included."""
        return self.body.dynamics(self.q, self.dq, self.ddq).tau

    @property
    def load(self) -> np.ndarray:
        """The same beyond the gears."""
        return self.tau - ROTORS * self.ddq


def study(folder: Path, torque: Callable[[Course], np.ndarray], seconds: float = 30.0) -> Study:
    """Two recordings of which only positions and torques are known, the second held out."""
    robot = write_arm(folder, 3)
    body = RigidBody(robot, JOINTS, ROTORS)
    recordings = []
    for k, role in enumerate(("fit", "validate")):
        time = PERIOD * np.arange(round(seconds / PERIOD))
        course = Course(body, *(_motion(time + 41.0 * k, order) for order in range(3)))
        noise = NOISE * np.random.default_rng(k).standard_normal(course.q.shape)
        run = even_recording(time, role=role, q=course.q, tau=torque(course) + noise)  # type: ignore[arg-type]
        recordings.append(replace(run, name=f"{role}.csv"))
    return Study(
        folder=folder,
        robot=robot,
        joints=JOINTS,
        recordings=tuple(recordings),
        split="by the test",
        rotor_inertia=ROTORS,
    )


def rubbing(course: Course) -> np.ndarray:
    """With plain Coulomb and viscous friction in every joint."""
    return course.tau + 1.2 * np.sign(course.dq) + 0.8 * course.dq


def named(diagnosis: Diagnosis, effect: str) -> list[tuple[str, ...]]:
    """The joints of an effect's findings."""
    return [each.joints for each in diagnosis.findings if each.effect == effect]


def _motion(time: np.ndarray, order: int) -> np.ndarray:
    """Slow and quick by turns, or its derivatives, (T, 3)."""
    result = np.full((len(time), 3), 0.3 if order == 0 else 0.0)
    for k in range(3):
        for amplitude, frequency, phase in ((0.8, 0.11, 0.4), (0.3, 0.29, 1.1), (0.08, 0.71, 2.0)):
            omega = 2 * np.pi * frequency * (1 + 0.17 * k)
            turn = omega * time + phase * (k + 1) + order * np.pi / 2
            result[:, k] += amplitude * omega**order * np.sin(turn)
    return result
