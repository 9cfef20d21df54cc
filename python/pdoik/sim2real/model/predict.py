"""The torque that a model with findings needs for a motion."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..effects import CATALOGUE
from ..findings import Finding
from ..motion import (
    Motion,
    Place,
    RigidBody,
    chosen_cutoff,
    columns_of,
    motion_of,
    noise_of,
    thinned,
    zero_phase,
)
from ..simulation import Description, nearest, read_description
from .model import Model


def predict(model: Model, recording: Recording, findings: bool = True) -> FloatArray:
    """Torque of the drives along a recorded motion, as they would report it.

    Inverse dynamics of the smoothed positions, the description's friction, and what every finding
    adds, by the same equations that found it.

    Args:
        model: with a robot.
        recording: of the model's joints; only time and positions are used.
        findings: whether to add them; without, it is the model as it was.

    Returns:
        (T, n) at the recording's samples [N m], [N] for prismatic joints.

    Raises:
        ValueError: the model has no robot, or the recording has other joints.
    """
    n = len(model.joints)
    if recording.q.shape[1] != n:
        raise ValueError(f"recording has {recording.q.shape[1]} joints, the model has {n}")
    motion = _motion(model, recording)
    smooth, sharp = torques_along(model, motion, findings)
    # Accelerations are noisy: what depends on them goes through the diagnosis's own filter.
    tau = zero_phase(smooth, motion.cutoff, motion.period) + sharp
    if len(motion.time) == len(recording.time):
        return tau
    columns = [np.interp(recording.time, motion.time, column) for column in tau.T]
    return np.stack(columns, axis=1)


def torques_along(
    model: Model, motion: Motion, findings: bool = True
) -> tuple[FloatArray, FloatArray]:
    """What the model says of a motion, unfiltered: the smooth part and what jumps; (T, n) each."""
    smooth, sharp = motion.tau.copy(), np.zeros_like(motion.tau)
    if findings:
        smooth += _corrections(model, motion)
        for finding in model.findings:
            kind = sharp if _jumps(finding) else smooth
            kind += torque_of(finding, motion, model.joints)
    return smooth, sharp


def _jumps(finding: Finding) -> bool:
    return finding.effect in CATALOGUE and CATALOGUE[finding.effect].jumps


def torque_of(finding: Finding, motion: Motion, joints: tuple[str, ...]) -> FloatArray:
    """What one finding adds to the torques along a motion, (T, n)."""
    tau = np.zeros_like(motion.tau)
    effect = CATALOGUE.get(finding.effect)
    if effect is None or effect.of_commands or effect.sought == "channels":
        return tau
    shape, beta = effect.coefficients(finding.values, finding.shape)
    for place in places_of(finding, motion.body, joints):
        for (balance, channel), column in columns_of(effect, motion, place, shape).items():
            if balance == "torque":
                tau[:, channel] += column @ beta
    return tau


def places_of(finding: Finding, body: RigidBody | None, joints: tuple[str, ...]) -> list[Place]:
    """Where a finding sits, by index; several places for one that several joints share."""
    effect = CATALOGUE[finding.effect]
    index = tuple(joints.index(nearest(name, joints, "joint")) for name in finding.joints)
    if effect.on == "base":
        return [Place()]
    if effect.together:
        return [Place(joints=index)]
    if index:
        return [Place(joints=(j,), gate=finding.gate) for j in index]
    if body is None:
        return []
    links = [body.links.index(nearest(name, body.links, "link")) for name in finding.links]
    recording = finding.recordings[0] if finding.window and finding.recordings else None
    return [
        Place(link=link, recording=recording, window=finding.window)
        for link in links or [body.last]
    ]


def body_of(model: Model) -> RigidBody:
    """The model's robot for inverse dynamics.

    Raises:
        ValueError: the model has no robot, or one whose base floats.
    """
    model = model.of_fixed_base
    if model.robot is None:
        raise ValueError("the study had no robot description, so no torque can be predicted")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "robot.xml"
        path.write_text(model.robot, encoding="utf-8")
        return RigidBody(path, model.joints, model.rotor_inertia)


def _motion(model: Model, recording: Recording) -> Motion:
    body = body_of(model)
    plain = thinned(replace(recording, tip=None))
    noise = noise_of([plain])
    cutoff = model.cutoff or chosen_cutoff([plain], body, noise)
    cutoff = min(cutoff, 0.4 / plain.period)
    return motion_of(plain, body, None, cutoff, noise, model.tip)


@lru_cache(maxsize=4)
def _described(robot: str) -> Description:
    """The description of a text, cached: it is read for every window of a log."""
    return read_description(robot)


def _corrections(model: Model, motion: Motion) -> FloatArray:
    """Torques of the links' corrected inertial parameters less those of the robot's own."""
    tau = np.zeros_like(motion.tau)
    if not model.rigid_body or model.robot is None or motion.body is None:
        return tau
    described = _described(model.robot)
    own, links = described.inertials, described.links_of(model.joints)
    for name, ten in model.rigid_body.items():
        link = links.index(nearest(name, links, "link"))
        change = ten - own[nearest(name, own, "link")].ten()
        tau += motion.regressor()[:, :, link] @ change
    return tau
