"""Commands that make a model's tip follow a path: what the model says goes into what is sent.

All of it goes through the controller's own input: a torque T more is a commanded position T / kp
further on, which to a PD law is the same. The model is what `pdoik diagnose` wrote, nothing else.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio
from scipy.ndimage import gaussian_filter1d

from bench.sim2real.frame.arm import Array
from bench.sim2real.frame.motion import STEP, Motion, smoothstep
from pdoik import sim2real
from pdoik.sim2real import Finding, Model, Recording

BEGIN = 0.4  # in which an arm at rest gets from nothing to the first torque [s]
CROSSING = 0.03  # in which a play is crossed, as a Gaussian's width [s]
LOADED = 0.03  # of a joint's largest load, below which a play's flank is left as it was
GEARS = ("backlash", "joint_elasticity")
CUTOFF = 20.0  # of the prediction: a commanded motion has no noise [Hz]
OF_LINKS = ("payload", "link_inertial_error", "gravity_direction", "position_dependent_spring")
"""Effects beyond the gears."""
TORQUE_CHANNEL = ("torque_gain", "torque_offset")


def commands(model: Model, motion: Motion) -> Motion:
    """What to send so that the links move as `motion` says.

    1. Gears: motors go ahead of the links by what springs give and play lets go.
    2. Torque that the model needs for that, by `sim2real.predict`.
    3. Drives: what lags or comes late is asked for earlier.
    4. Less what the controller does on its own, as a shift of the commanded positions.
    5. Commands that act late are sent earlier.
    """
    motors = _geared(model, motion)
    torque = _early_torque(model, _driven(model, needed(model, motion, motors)))
    control = model.controller
    assert control is not None  # the study names it
    own = still_torque(model, motors.q) if control.gravity_compensation else 0.0
    start = smoothstep(motion.time / BEGIN)[:, None]
    shifted = motion.q + start * (motors.q - motion.q + (torque - own) / control.kp)
    q, dq = shifted.copy(), motors.dq.copy()
    time = motion.time
    for k, late in enumerate(_sum(model, "command_delay", "delay", "position")):
        q[:, k] = np.interp(time + late, time, shifted[:, k])
        dq[:, k] = np.interp(time + late, time, motors.dq[:, k])
    for k, late in enumerate(_sum(model, "actuator_lag", "time_constant", "position")):
        q[:, k] += late * np.gradient(q[:, k], STEP)
    return Motion(q=q, dq=dq, ddq=motors.ddq)


def needed(model: Model, links: Motion, motors: Motion) -> Array:
    """Torque of the drives for a motion, (K, n) [N m]; what only a sensor says is left out.

    Behind gears that give, links move as they shall and rotors otherwise.
    """
    felt = tuple(
        f for f in model.findings if f.variant not in ("report", "drive") and f.effect not in GEARS
    )
    torque = predicted(replace(model, findings=felt), links)
    rotor = 0.0 if model.rotor_inertia is None else model.rotor_inertia
    return np.asarray(torque + rotor * (motors.ddq - links.ddq))


def predicted(model: Model, motion: Motion) -> Array:
    """`sim2real.predict` for a commanded motion, which has no noise to be filtered."""
    recording = Recording(
        name="commands",
        role="fit",
        start=0.0,
        time=motion.time,
        q=motion.q,
        valid=np.ones(len(motion.q), bool),
        raw_period=STEP,
        jitter=0.0,
    )
    return np.asarray(sim2real.predict(replace(model, cutoff=CUTOFF), recording))


def still_torque(model: Model, q: Array) -> Array:
    """What the controller's own model gives to hold the arm, (K, n) [N m]."""
    arm = pinocchio.buildModelFromXML(model.robot)
    data = arm.createData()
    order = [arm.joints[arm.getJointId(joint)].idx_q for joint in model.joints]
    result, full = np.empty_like(q), np.zeros(arm.nq)
    for row, each in enumerate(q):
        full[order] = each
        result[row] = pinocchio.computeGeneralizedGravity(arm, data, full)[order]
    return result


def _of(model: Model, *effects: str) -> list[Finding]:
    return [finding for finding in model.findings if finding.effect in effects]


def _indices(model: Model, finding: Finding) -> Sequence[int]:
    """The joints a finding is of; all where it names none."""
    return [model.joints.index(j) for j in finding.joints] or range(len(model.joints))


def _sum(model: Model, effect: str, parameter: str, variant: str) -> Array:
    """A parameter of each joint, over the findings of one variant, (n,)."""
    total = np.zeros(len(model.joints))
    for finding in _of(model, effect):
        if (finding.variant or "position") == variant:
            total[list(_indices(model, finding))] += finding.values[parameter]
    return total


def _geared(model: Model, motion: Motion) -> Motion:
    """The motors' motion for one of the links."""
    loose = _of(model, *GEARS)
    if not loose:
        return motion
    of_links = tuple(f for f in model.findings if f.effect in OF_LINKS)
    load = predicted(replace(model, findings=of_links, rotor_inertia=None), motion)
    q = motion.q.copy()
    for finding in loose:
        for k in _indices(model, finding):
            if finding.effect == "joint_elasticity":
                stiffness, damping = (finding.values[p] for p in ("stiffness", "damping"))
                give = load[:, k] / stiffness
                q[:, k] += give - damping / stiffness * np.gradient(give, STEP)
            else:
                side = gaussian_filter1d(flank(load[:, k]), CROSSING / STEP, mode="nearest")
                q[:, k] += 0.5 * finding.values["gap"] * side
    return Motion.of(q)


def flank(load: Array) -> Array:
    """The side of a play that a load (K,) presses, -1 or 1; without load, the one it did last."""
    pressed = np.abs(load) > LOADED * np.max(np.abs(load))
    last = np.maximum.accumulate(np.where(pressed, np.arange(len(load)), 0))
    last[last == 0] = np.argmax(pressed)  # before the first load: where that will press
    return np.sign(load[last])


def _driven(model: Model, torque: Array) -> Array:
    """What to ask drives for that exert something else than they are asked for."""
    torque = torque.copy()
    for finding in _of(model, *TORQUE_CHANNEL):
        if finding.variant == "drive":
            for k in _indices(model, finding):
                torque[:, k] -= finding.values.get("offset", 0.0)
                torque[:, k] /= finding.values.get("gain", 1.0)
    return torque


def _early_torque(model: Model, torque: Array) -> Array:
    """What to ask for that comes late, or lags."""
    time = STEP * np.arange(len(torque))
    result = torque.copy()
    for k, late in enumerate(_sum(model, "command_delay", "delay", "torque")):
        result[:, k] = np.interp(time + late, time, torque[:, k])
    for k, late in enumerate(_sum(model, "actuator_lag", "time_constant", "torque")):
        smooth = gaussian_filter1d(result[:, k], 5.0, mode="nearest")
        result[:, k] += late * np.gradient(smooth, STEP)
    return result
