"""A diagnosis with its evidence as a report gets them: an arm with friction and a payload."""

from __future__ import annotations

from typing import Any

import numpy as np

from pdoik.recordings import FloatArray
from pdoik.sim2real import Diagnosis, Equivalent, Estimate, Evidence, Finding, JointFit
from pdoik.sim2real.report import CutoffInfluence, Hypothesis, Replay, ReportData, Traces

JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1")
NOISE = np.array([0.35, 0.40, 0.22, 0.06])  # [N m]
LOADS = np.array([0.0, 38.0, 14.0, 1.5])  # torque of gravity at the horizontal [N m]
LEVEL, VISCOUS, MASS = 2.1, 1.4, 1.3  # [N m], [N m s/rad] at the elbow; [kg] at the tip
DISPLACEMENT_BOUNDS = np.array([0.0, 8.1, 5.0, 1.2])  # [N m/kg] of the payload
CUTOFFS = np.array([4.0, 8.0, 15.0, 30.0])


def coloured(rng: np.random.Generator, shape: tuple[int, int], period: float) -> FloatArray:
    """Noise of unit variance, correlated over some 50 ms."""
    decay = np.exp(-period / 0.05)
    white = rng.normal(size=shape)
    noise = np.empty(shape)
    noise[0] = white[0]
    for k in range(1, len(noise)):
        noise[k] = decay * noise[k - 1] + np.sqrt(1 - decay**2) * white[k]
    return noise


def motion(rng: np.random.Generator, time: FloatArray, n: int) -> tuple[FloatArray, FloatArray]:
    """Sums of three sines per joint: positions and speeds, (T, n) each."""
    frequency = rng.uniform(0.05, 0.3, (3, n))
    size, phase = rng.uniform(0.15, 0.5, (3, n)), rng.uniform(0, 2 * np.pi, (3, n))
    angle = 2 * np.pi * frequency * time[:, None, None] + phase
    q = (size * np.sin(angle)).sum(axis=1)
    dq = (2 * np.pi * frequency * size * np.cos(angle)).sum(axis=1)
    return q, dq


def traces(
    name: str, role: Any, clock: float, seed: int, joints: int = 4, seconds: float = 40.0
) -> Traces:
    rng = np.random.default_rng(seed)
    time = np.arange(0, seconds, 0.008)
    q, dq = motion(rng, time, joints)
    kind = np.arange(joints) % 4
    load = LOADS[kind] * np.cos(q)
    cause = MASS * DISPLACEMENT_BOUNDS[kind] * np.cos(q)
    cause += (kind == 2) * (LEVEL * np.tanh(dq / 0.01) + VISCOUS * dq)
    after = NOISE[kind] * coloured(rng, q.shape, 0.008) + 0.012 * cause
    before = cause + after
    measured = load + before
    return Traces(
        name=name, role=role, time=time, clock=clock + time, q=q, dq=dq, load=load, before=before,
        after=after, measured=measured, predicted_before=load, predicted_after=measured - after,
    )  # fmt: skip


def evidence(**changes: Any) -> ReportData:
    recordings = (
        traces("monday_1.csv", "fit", 0.0, 1),
        traces("monday_2.csv", "fit", 900.0, 2),
        traces("tuesday.csv", "validate", 90000.0, 3),
    )
    before = np.sqrt(np.mean(recordings[2].before ** 2, axis=0))
    after = np.sqrt(np.mean(recordings[2].after ** 2, axis=0))
    hypotheses = [
        Hypothesis(effect="payload", place="wrist_3_link", score=0.62, interval95=(0.55, 0.68),
                   accepted=True),
        Hypothesis(effect="coulomb_friction", place="elbow", score=0.21, interval95=(0.17, 0.25),
                   accepted=True),
        Hypothesis(effect="viscous_friction", place="elbow", score=0.06, interval95=(0.03, 0.09),
                   accepted=True),
        Hypothesis(effect="stribeck_friction", place="elbow", score=0.004,
                   interval95=(-0.012, 0.02), accepted=False,
                   reason="no gain beyond chance; the coefficient came out negative"),
        Hypothesis(effect="torque_gain", place="shoulder_lift", score=0.31,
                   interval95=(0.18, 0.41), accepted=False,
                   reason="payload explains more of the same columns"),
    ]  # fmt: skip
    rng = np.random.default_rng(4)
    for effect in ("rotor_inertia", "torque_offset", "torque_ripple", "command_delay"):
        for joint in JOINTS:
            score = float(rng.normal(-0.02, 0.03))
            interval = (score - 0.05, score + 0.04)
            reason = "no gain on held-out data"
            hypotheses.append(
                Hypothesis(
                    effect=effect,
                    place=joint,
                    score=score,
                    interval95=interval,
                    accepted=False,
                    reason=reason,
                )
            )
    q = recordings[2].q
    error = np.array([0.004, 0.02, 0.015, 0.01])
    replay = Replay(
        recording="tuesday.csv", time=recordings[2].time, recorded=q,
        before=q + error * (np.cos(q) + 0.3 * np.sign(recordings[2].dq)),
        after=q + 0.08 * error * coloured(rng, q.shape, 0.008),
    )  # fmt: skip
    growth = (CUTOFFS / 15)[:, None] ** 0.2
    content: dict[str, Any] = {
        "title": "UR10 in cell 3",
        "joints": JOINTS,
        "units": ("N m",) * 4,
        "noise_floor": NOISE,
        "recordings": recordings,
        "split": "by the study",
        "hypotheses": tuple(hypotheses),
        "replays": (replay,),
        "cutoff": CutoffInfluence(
            frequency=CUTOFFS, before=growth * before, after=growth**2 * after, chosen=15.0
        ),
        "notes": ("Accelerations were differentiated from dq.",),
    }
    return ReportData(**(content | changes))


def diagnosis(data: ReportData, **changes: Any) -> Diagnosis:
    held_out = data.held_out
    joints = {}
    for k, name in enumerate(data.joints):
        before, after = (
            float(np.sqrt(np.mean(np.concatenate([getattr(t, f)[:, k] for t in held_out]) ** 2)))
            for f in ("before", "after")
        )
        joints[name] = JointFit(
            before=before, after=after, noise_floor=float(data.noise_floor[k]), unit="N m",
            data=", ".join(t.name for t in held_out), excited=True,
        )  # fmt: skip
    payload = Finding(
        effect="payload", links=("wrist_3_link",), recordings=("tuesday.csv",),
        joints=("shoulder_lift", "elbow", "wrist_1"),
        regime="everywhere, most where the arm is stretched out",
        statement="The arm carries about 1.30 kg that the model does not know of, 6 cm beyond the"
        " flange: shoulder_lift, elbow and wrist_1 hold it up against gravity.",
        parameters={
            "mass": Estimate(value=1.3021, std=0.021, interval95=(1.262, 1.344), unit="kg"),
            "com_z": Estimate(value=0.0613, std=0.004, interval95=(0.0532, 0.0694), unit="m"),
        },
        equivalents=(Equivalent(effect="link_inertial_error", links=("wrist_3_link",)),),
        decided_by="the same motion with the tool taken off",
        evidence=Evidence(validation_gain=0.624, interval95=(0.553, 0.681), channels=("q", "tau")),
    )  # fmt: skip
    friction = Finding(
        effect="coulomb_friction", joints=("elbow",), recordings=("tuesday.csv",),
        regime="direction reversals of elbow",
        statement="The elbow needs 2.10 N m more than the model says to keep moving, whichever way"
        " it turns and however fast.",
        parameters={"level": Estimate(value=2.104, std=0.038, interval95=(2.031, 2.179),
                                      unit="N m")},
        evidence=Evidence(validation_gain=0.21, interval95=(0.168, 0.254),
                          channels=("q", "dq", "tau")),
    )  # fmt: skip
    viscous = Finding(
        effect="viscous_friction", joints=("elbow",), recordings=("tuesday.csv",),
        regime="fast motion of elbow",
        statement="The elbow's friction grows with speed.",
        parameters={"coefficient": Estimate(value=1.41, std=0.09, interval95=(1.23, 1.58),
                                            unit="N m s/rad")},
        evidence=Evidence(validation_gain=0.063, interval95=(0.034, 0.091),
                          channels=("q", "dq", "tau")),
    )  # fmt: skip
    content: dict[str, Any] = {
        "verdict": "mismatch_explained",
        "findings": (payload, friction, viscous),
        "joints": joints,
        "notes": ("3 gaps of at most 40 ms in monday_2.csv were bridged.",),
    }
    return Diagnosis(**(content | changes))
