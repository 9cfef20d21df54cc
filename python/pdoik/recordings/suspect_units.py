"""Units that a recording's numbers can hardly be in: asked about, never guessed."""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.ndimage import uniform_filter1d

from pdoik.descriptions import RobotDescription, RobotFacts

from .check_recording import moves
from .recording import FloatArray, Recording
from .suspected_unit import SuspectedUnitError
from .units import Units

_TURNS = 4 * pi  # a joint of an arm hardly turns farther [rad]
_BEYOND = 0.35  # past a limit, more than an encoder's zero explains [rad]
_AGREES = 0.15  # relative: how near to a unit's factor a ratio must be
_TORQUE = 5000.0  # more than any robot's joint bears [N m]
_LENGTH = 30.0  # farther than a tip gets from its base [m]
_TOO_MUCH = 30.0  # times the torque that gravity asks for
_SMOOTH = 0.05  # [s]


def check_units(
    recording: Recording, joints: tuple[str, ...], units: Units, robot: RobotDescription | None
) -> None:
    """Ask about channels whose numbers look like degrees, rpm, mN m or mm.

    A channel whose unit somebody names is believed.

    Raises:
        SuspectedUnitError: with the unit suspected, why, and the line that settles it.
    """
    facts = None if robot is None else robot.facts
    turning = [facts is None or facts.joints[joint].type != "prismatic" for joint in joints]
    if not units.settles("q"):
        _positions(recording, joints, turning, facts)
    if recording.dq is not None and not (units.settles("dq") and units.settles("q")):
        _speeds(recording, recording.dq, np.array(turning), units)
    if recording.q_des is not None and not (units.settles("q") or units.settles("q_des")):
        _commands(recording, recording.q_des, np.array(turning))
    if recording.tau is not None and not units.settles("tau"):
        _torques(recording, recording.tau, joints, robot)
    if recording.tip is not None and not units.settles("tip"):
        far = float(np.nanmax(np.abs(recording.tip[:, :3])))
        if far > _LENGTH:
            _ask(recording, "tip", "mm", "m", f"the tip is up to {far:.4g} m from the base")


def _positions(
    recording: Recording, joints: tuple[str, ...], turning: list[bool], facts: RobotFacts | None
) -> None:
    """Degrees: beyond the model's limits in rad, within them in degrees; or many turns."""
    for k, joint in enumerate(joints):
        if not turning[k]:
            continue
        low, high = np.percentile(recording.q[:, k], (1, 99))
        if facts is not None and facts.joints[joint].type == "continuous":
            continue
        if facts is not None and np.isfinite(facts.joints[joint].upper):
            lower, upper = facts.joints[joint].lower, facts.joints[joint].upper
            over = max(lower - low, high - upper)
            small_enough = max(lower - low * pi / 180, high * pi / 180 - upper) < _BEYOND
            if over > max(_BEYOND, 0.5 * (upper - lower)) and small_enough:
                why = f"q.{joint} goes from {low:.4g} to {high:.4g}, the robot's limits are"
                _ask(recording, "q", "deg", "rad", f"{why} {lower:.4g} to {upper:.4g} rad")
        elif max(-low, high) > _TURNS:
            why = f"q.{joint} goes from {low:.4g} to {high:.4g}, which in rad is"
            _ask(recording, "q", "deg", "rad", f"{why} {max(-low, high) / (2 * pi):.2g} turns")


def _speeds(recording: Recording, dq: FloatArray, turning: np.ndarray, units: Units) -> None:
    """The ratio of the recorded speed to the position's derivative distinguishes their units."""
    width = max(3, round(_SMOOTH / recording.period))
    use = moves(recording) & turning & np.isfinite(dq).all(axis=0)
    rate = uniform_filter1d(np.gradient(recording.q, recording.period, axis=0), width, axis=0)
    ratio = _ratio(rate[:, use], uniform_filter1d(dq[:, use], width, axis=0))
    if ratio is None:
        return
    why = f"dq is {ratio:.3g} times the rate of change of q"
    for unit, factor in (("deg/s", 180 / pi), ("rpm", 30 / pi)):
        if _near(ratio, factor) and not units.settles("dq"):
            _ask(recording, "dq", unit, "rad/s", why)
    if _near(ratio, pi / 180) and not units.settles("q"):
        _ask(recording, "q", "deg", "rad", why)


def _commands(recording: Recording, q_des: FloatArray, turning: np.ndarray) -> None:
    use = moves(recording) & turning & np.isfinite(q_des).all(axis=0)
    ratio = _ratio(recording.q[:, use], q_des[:, use])
    if ratio is not None and _near(ratio, 180 / pi):
        _ask(recording, "q_des", "deg", "rad", f"q_des is {ratio:.3g} times q")
    if ratio is not None and _near(ratio, pi / 180):
        _ask(recording, "q", "deg", "rad", f"q_des is {ratio:.3g} times q")


def _torques(
    recording: Recording, tau: FloatArray, joints: tuple[str, ...], robot: RobotDescription | None
) -> None:
    """Many times what gravity asks for or the model's limit allows, or more than robots have."""
    size = np.nanpercentile(np.abs(tau[:, ~np.isnan(tau).all(axis=0)]), 95, axis=0)
    names = [joint for k, joint in enumerate(joints) if not np.isnan(tau[:, k]).all()]
    if robot is not None:
        rows = np.linspace(0, len(tau) - 1, min(len(tau), 200)).astype(int)
        gravity = robot.gravity_torque(joints, recording.q[rows])
        _against_gravity(recording, np.nan_to_num(tau[rows]), gravity, joints)
        for joint, came in zip(names, size, strict=True):
            limit = robot.facts.joints[joint].effort
            if limit is not None and came > _TOO_MUCH * limit:
                why = f"tau.{joint} reaches {came:.4g}, the robot's limit is {limit:.4g} N m"
                _ask(recording, "tau", "mN.m" if came > 100 * limit else "N.cm", "N.m", why)
    for joint, came in zip(names, size, strict=True):
        if came > _TORQUE:
            _ask(recording, "tau", "mN.m", "N.m", f"tau.{joint} reaches {came:.4g}")


def _against_gravity(
    recording: Recording, tau: FloatArray, gravity: FloatArray, joints: tuple[str, ...]
) -> None:
    """Compares the torque of the joint that bears most with what the model says it bears."""
    loads = np.where(tau.any(axis=0), np.linalg.norm(gravity, axis=0), 0.0)
    k = int(np.argmax(loads))
    if loads[k] < 0.01 * np.sqrt(len(tau)):
        return
    times = abs(float(tau[:, k] @ gravity[:, k])) / float(loads[k] ** 2)
    alike = times * float(loads[k]) / float(np.linalg.norm(tau[:, k]))
    if times > _TOO_MUCH and alike > 0.5:  # friction may be far above gravity, but is not like it
        why = f"tau.{joints[k]} is {times:.3g} times what gravity asks for in the model"
        _ask(recording, "tau", "mN.m" if times > 300 else "N.cm", "N.m", why)


def _ratio(of: FloatArray, to: FloatArray) -> float | None:
    """The factor by which `to` follows the changes of `of`, the median joint; None if none."""
    of, to = of - of.mean(axis=0), to - to.mean(axis=0)
    norms = np.sqrt(np.sum(of**2, axis=0)), np.sqrt(np.sum(to**2, axis=0))
    there = (norms[0] > 0) & (norms[1] > 0)
    if not there.any():
        return None
    alike = np.sum(of * to, axis=0)[there] / (norms[0][there] * norms[1][there])
    good = np.abs(alike) > 0.7
    if not good.any():
        return None
    return float(np.median((norms[1][there] / norms[0][there])[good]))


def _near(ratio: float, factor: float) -> bool:
    return abs(ratio / factor - 1) < _AGREES


def _ask(recording: Recording, channel: str, suspected: str, expected: str, why: str) -> None:
    raise SuspectedUnitError(
        f"{recording.name}: is '{channel}' in {suspected}? Expected {expected}, but {why}. Say"
        f" which it is: 'units: {{{channel}: {suspected}}}' or"
        f" 'units: {{{channel}: {expected}}}'",
        channel,
        suspected,
        why,
    )
