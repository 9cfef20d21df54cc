"""A report that leaves something open: a plane arm whose elbow rubs, moved slowly once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import yaml

from pdoik.sim2real import Diagnosis, Equivalent, Estimate, Finding, Model, load_study
from pdoik.sim2real.motion import RigidBody
from studies import JOINTS, URDF

LEVEL = 1.5  # of the elbow's friction [N m]
ROTORS = (0.05, 0.02)
EFFORT, SPEED = (60.0, 30.0), 3.0
PERIOD = 0.01


def write_study(folder: Path, urdf: str = URDF, width: float = 0.0) -> Path:
    """study.yaml, arm.urdf and a log of 10 s to learn from, another one to judge.

    `width` is the way over which the friction builds up after a reversal [rad].
    """
    (folder / "arm.urdf").write_text(urdf.format(mass=1))
    body = RigidBody(folder / "arm.urdf", JOINTS, np.array(ROTORS))
    time = PERIOD * np.arange(1000)
    for k, name in enumerate(("slow.csv", "judge.csv")):
        phase = 0.3 * time[:, None] + np.array([0.0, 0.7]) + k
        q = np.array([0.3, -0.4]) + 0.12 * np.sin(phase)
        dq, ddq = 0.036 * np.cos(phase), -0.0108 * np.sin(phase)
        tau = body.dynamics(q, dq, ddq).tau
        tau[:, 1] += LEVEL * (np.sign(dq[:, 1]) if width == 0.0 else bristles(q[:, 1], width))
        tau = tau + 0.02 * np.random.default_rng(k).standard_normal(tau.shape)
        columns = {"time": time}
        columns |= {f"q.{joint}": q[:, j] for j, joint in enumerate(JOINTS)}
        columns |= {f"tau.{joint}": tau[:, j] for j, joint in enumerate(JOINTS)}
        pd.DataFrame(columns).to_csv(folder / name, index=False)
    study = {
        "robot": "arm.urdf",
        "joints": list(JOINTS),
        "recordings": [
            {"file": "slow.csv", "role": "fit"},
            {"file": "judge.csv", "role": "validate"},
        ],
        "rotor_inertia": list(ROTORS),
    }
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(study))
    return path


def bristles(q: np.ndarray, width: float) -> np.ndarray:
    """Dahl's friction along positions (T,), of level 1."""
    z, states = 0.0, []
    for step in np.diff(q, prepend=q[0]):
        z = np.sign(step) + (z - np.sign(step)) * np.exp(-abs(step) / width)
        states.append(z)
    return np.array(states)


def friction(*equivalents: str, confidence: float = 0.95) -> Finding:
    """That the elbow rubs, or one of these."""
    level = Estimate(value=LEVEL, std=0.05, interval95=(1.4, 1.6), unit="N m")
    return Finding(
        effect="coulomb_friction",
        joints=("elbow",),
        parameters={"level": level},
        shape=(0.0,),
        confidence=confidence,
        equivalents=tuple(Equivalent(effect=each, joints=("elbow",)) for each in equivalents),
    )


def one_way(viscous: float, *equivalents: str) -> Finding:
    """That the elbow rubs more one way than the other, or one of these."""
    more = Estimate(value=0.3, std=0.01, interval95=(0.28, 0.32), unit="N m")
    ends = viscous - 0.02, viscous + 0.02
    quick = Estimate(value=viscous, std=0.01, interval95=ends, unit="N m s/rad")
    return Finding(
        effect="asymmetric_friction",
        joints=("elbow",),
        parameters={"level_difference": more, "viscous_difference": quick},
        shape=(0.02,),
        confidence=0.95,
        equivalents=tuple(Equivalent(effect=each, joints=("elbow",)) for each in equivalents),
    )


def push() -> Finding:
    """Something that happened once."""
    force = Estimate(value=5.0, std=1.0, interval95=(3.0, 7.0), unit="N")
    return Finding(
        effect="external_contact",
        links=("fore",),
        recordings=("slow.csv",),
        window=(2.0, 3.0),
        parameters={f"force_{axis}": force for axis in "xyz"},
        confidence=0.8,
    )


def write_report(folder: Path, study: Path, *findings: Finding) -> Path:
    """diagnosis.json and model.json of a study, with these findings."""
    report = folder / "report"
    report.mkdir()
    diagnosis = Diagnosis(verdict="mismatch_explained", findings=findings, joints={})
    (report / "diagnosis.json").write_text(diagnosis.to_json())
    Model.of_study(load_study(study), findings, cutoff=20.0).save(report)
    return report
