"""Studies in memory of small arms with causes that are known, torques by Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.spatial.transform import Rotation

from pdoik.sim2real import Diagnosis, Finding, Study, diagnose
from pdoik.sim2real.motion import Place
from pdoik.sim2real.regression import TermKey
from pdoik.sim2real.study import Setup
from sim2real_motions import wave, write_arm
from sim2real_recordings import even_recording

PERIOD, NOISE, RIGHT = 0.005, 0.03, 0.01
RUBS = np.array([1.0, 0.6, 0.3])  # [N m]
Cause = Callable[[int, np.ndarray, np.ndarray], np.ndarray]  # of recording, q and dq


def study(
    folder: Path,
    cause: Cause | None = None,
    n: int = 2,
    *,
    runs: int = 3,
    held: int = 0,
    noise: float = 1.0,
    slow: float = 1.0,
    seconds: float = 16.0,
    tilt: Sequence[float] = (0.0, 0.0),
    days: Sequence[str] = (),
) -> Study:
    """An arm by Pinocchio with torques that its description does not tell of."""
    robot = write_arm(folder, n)
    model = pin.buildModelFromUrdf(str(robot))
    model.gravity.linear = Rotation.from_euler("XY", tilt).inv().apply([0.0, 0.0, -9.80665])
    data, recordings = model.createData(), []
    for k in range(runs):
        rng = np.random.default_rng(k)
        time = PERIOD * np.arange(round(seconds / PERIOD))
        q, dq, ddq = (slow * wave(time + 37.0 * k, n, order) for order in range(3))
        tau = np.array([pin.rnea(model, data, *each) for each in zip(q, dq, ddq, strict=True)])
        tau = tau if cause is None else tau + cause(k, q, dq)
        q, dq, tau = (
            each + noise * size * rng.standard_normal(q.shape)
            for each, size in ((q, 1e-5), (dq, 1e-3), (tau, NOISE))
        )
        role = "fit" if k < runs - held else "validate"
        made = even_recording(time, role=role, q=q, dq=dq, tau=tau)
        recordings.append(replace(made, name=f"run{k}.csv"))
    return Study(
        folder=folder,
        robot=robot,
        joints=tuple(f"j{k + 1}" for k in range(n)),
        recordings=tuple(recordings),
        split="by the test",
        setups={f"run{k}.csv": Setup(session=day) for k, day in enumerate(days)},
    )


def rubbing(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """Dry friction of every joint."""
    return RUBS[: q.shape[1]] * np.tanh(dq / 1e-3)


def several(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """Friction everywhere, at the first joint more near rest, a spring at the second one."""
    more = np.tanh(dq[:, 0] / 1e-3) * np.exp(-((dq[:, 0] / 0.3) ** 2))
    spring = 4.0 * np.maximum(q[:, 1] - 0.5, 0.0)
    return rubbing(k, q, dq) + np.stack([more, spring], axis=1)


SEVERAL: set[TermKey] = {
    ("position_dependent_spring", Place(joints=(1,))),
    ("stribeck_friction", Place(joints=(0,))),
}
"""Of these, what is anomalous."""


def few_steps() -> Callable[..., None]:
    """What a search tells its steps to, and which ends one that goes on for ever."""
    steps = iter(range(60))

    def tell(*said: object) -> None:
        assert next(steps, None) is not None, f"the search does not end: {said}"

    return tell


def told(study: Study) -> Diagnosis:
    """The diagnosis of a search that ends."""
    return diagnose(study, tell=few_steps())


def named(findings: Sequence[Finding]) -> set[tuple[str, tuple[str, ...]]]:
    """Effects and joints."""
    return {(each.effect, each.joints) for each in findings}
