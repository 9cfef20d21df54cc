"""Words of the drives: gains, force limits and delays."""

from __future__ import annotations

from typing import Any

from .property import Property, Scales, held
from .user_model import UserModel

_WEAKEST = 1e-5  # [N m]


class Kp(Property):
    """Proportional gain of the position actuator."""

    name, unit, ends = "kp", "N m/rad", True
    isaac = "stiffness of the joint's drive"
    gazebo = "<p_gain> of the position controller"

    def read(self, user: UserModel, index: int) -> float:
        gear = _gear(user, index)
        return -float(user.model.actuator_biasprm[user.actuators[index], 1]) * gear**2

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        k, share = user.actuators[index], value / self.read(user, index)
        model.actuator_biasprm[k, 1] = user.model.actuator_biasprm[k, 1] * share
        model.actuator_gainprm[k, 0] = user.model.actuator_gainprm[k, 0] * share

    def step(self, scales: Scales, value: float) -> float:
        return 0.03 * value


class Kv(Property):
    """Damping gain of the position actuator."""

    name, unit = "kv", "N m s/rad"
    isaac = "damping of the joint's drive"
    gazebo = "<d_gain> of the position controller"

    def read(self, user: UserModel, index: int) -> float:
        gear = _gear(user, index)
        return -float(user.model.actuator_biasprm[user.actuators[index], 2]) * gear**2

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        model.actuator_biasprm[user.actuators[index], 2] = -value / _gear(user, index) ** 2

    def step(self, scales: Scales, value: float) -> float:
        return 0.05 * scales.torque / scales.speed

    def feigned(self, user: UserModel, index: int) -> float:
        return Kp().read(user, index) * held(user)


class _Factor(Property):
    """By how much a gain of all joints differs alike: a torque constant, or a unit."""

    unit, place, ends = "", "machine", True

    def read(self, user: UserModel, index: int) -> float:
        return 1.0

    def step(self, scales: Scales, value: float) -> float:
        return 0.03


class KpFactor(_Factor):
    """Of all proportional gains."""

    name = "kp_factor"
    isaac = "stiffness of all joint drives, times this"
    gazebo = "<p_gain> of all position controllers, times this"

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        for k in user.actuators:
            model.actuator_biasprm[k, 1] *= value
            model.actuator_gainprm[k, 0] *= value


class KvFactor(_Factor):
    """Of all damping gains."""

    name = "kv_factor"
    isaac = "damping of all joint drives, times this"
    gazebo = "<d_gain> of all position controllers, times this"

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        for k in user.actuators:
            model.actuator_biasprm[k, 2] *= value

    def feigned(self, user: UserModel, index: int) -> float:
        kp, kv = Kp(), Kv()
        shares = [kp.read(user, k) / max(kv.read(user, k), 1e-9) for k in range(len(user.joints))]
        return min(shares) * held(user)


class ForceLimit(Property):
    """Largest torque of the drive, both ways: `forcerange`, or `actuatorfrcrange` of the joint.

    A limit above what the commands ask for shows nothing, so its value in the user's model is at
    most the largest torque there.
    """

    name, unit, ends, downward = "forcelimit", "N m", True, True
    lowest = 1e-6
    mujoco = "forcerange, or actuatorfrcrange of the joint"
    isaac = "effort limit of the joint"
    gazebo = "<axis><limit><effort>"

    def read(self, user: UserModel, index: int) -> float:
        peak = user.peaks[index] if user.peaks else float("inf")
        return max(min(limit_of(user, index), peak), _WEAKEST)

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        joint, actuator = user.joint_ids[index], user.actuators[index]
        if model.jnt_actfrclimited[joint] or not model.actuator_forcelimited[actuator]:
            model.jnt_actfrclimited[joint] = 1
            model.jnt_actfrcrange[joint] = (-value, value)
        if model.actuator_forcelimited[actuator]:
            at_motor = value / abs(_gear(user, index))
            model.actuator_forcerange[actuator] = (-at_motor, at_motor)

    def step(self, scales: Scales, value: float) -> float:
        return 0.3 * value


def limit_of(user: UserModel, index: int) -> float:
    """Torque at which the user's own model ends a drive [N m]; infinite where it does not."""
    model, found = user.model, [float("inf")]
    joint, actuator = user.joint_ids[index], user.actuators[index]
    if model.jnt_actfrclimited[joint]:
        found += [float(abs(each)) for each in model.jnt_actfrcrange[joint]]
    if model.actuator_forcelimited[actuator]:
        gear = abs(_gear(user, index))
        found += [float(abs(each)) * gear for each in model.actuator_forcerange[actuator]]
    return min(found)


class Delay(Property):
    """Time by which commands act later than in the user's simulator; commands are shifted."""

    name, unit = "delay", "s"
    isaac = "delay of the actuator (DelayedPDActuator)"
    gazebo = "none: hold commands back in the controller"

    def read(self, user: UserModel, index: int) -> float:
        return 0.0

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        """Nothing of the model: `Experiment` shifts the commands."""

    def step(self, scales: Scales, value: float) -> float:
        return 2e-3

    def feigned(self, user: UserModel, index: int) -> float:
        return held(user)


def _gear(user: UserModel, index: int) -> float:
    return float(user.model.actuator_gear[user.actuators[index], 0])
