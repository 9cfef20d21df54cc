"""Words of the drives: gains and delays."""

from __future__ import annotations

from typing import Any

import mujoco

from .property import EVERY, Property, held
from .user_model import UserModel

UNLIMITED = 1e9  # what no drive gives [N m]


class Kp(Property):
    """Proportional gain of the position actuator."""

    name, unit = "kp", "N m/rad"
    isaac = "stiffness of the joint's drive"
    gazebo = "<p_gain> of the position controller"

    def read(self, user: UserModel, index: int) -> float:
        gear = _gear(user, index)
        return -float(user.model.actuator_biasprm[user.actuators[index], 1]) * gear**2

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        k, share = user.actuators[index], value / self.read(user, index)
        model.actuator_biasprm[k, 1] = user.model.actuator_biasprm[k, 1] * share
        model.actuator_gainprm[k, 0] = user.model.actuator_gainprm[k, 0] * share


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

    def feigned(self, user: UserModel, index: int) -> float:
        return Kp().read(user, index) * held(user)


class KpFactor(Property):
    """Factor by which all proportional gains differ: a unit, or firmware."""

    name, unit, place = "kp_factor", "", "machine"
    isaac = "stiffness of all joint drives, times this"
    gazebo = "<p_gain> of all position controllers, times this"

    def read(self, user: UserModel, index: int) -> float:
        return 1.0

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        for k in user.actuators:
            model.actuator_biasprm[k, 1] *= value
            model.actuator_gainprm[k, 0] *= value


class GainFactor(Property):
    """Factor by which both gains of one drive or of all differ: a torque constant."""

    name, unit = "gain_factor", ""
    mujoco = "kp and kv, times this"
    isaac = "stiffness and damping of the joint's drive, times this"
    gazebo = "<p_gain> and <d_gain> of the position controller, times this"

    def read(self, user: UserModel, index: int) -> float:
        return 1.0

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        for k in user.actuators if index == EVERY else (user.actuators[index],):
            model.actuator_biasprm[k, 1:3] *= value
            model.actuator_gainprm[k, 0] *= value


class Delay(Property):
    """Time by which commands act later than in the user's simulator; commands are shifted."""

    name, unit = "delay", "s"
    isaac = "delay of the actuator (DelayedPDActuator)"
    gazebo = "none: hold commands back in the controller"

    def read(self, user: UserModel, index: int) -> float:
        return 0.0

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        """Nothing of the model: `Experiment` shifts the commands."""

    def feigned(self, user: UserModel, index: int) -> float:
        return held(user)


class Filter(Property):
    """Time constant of what smooths commands, of first order, before the drive follows them."""

    name, unit = "filter", "s"
    mujoco = "timeconst"
    isaac = "none: smooth the commands in the controller"
    gazebo = "none: smooth the commands in the controller"

    def read(self, user: UserModel, index: int) -> float:
        actuator = user.actuators[index]
        if not has_filter(user, actuator):
            return 0.0
        return float(user.model.actuator_dynprm[actuator, 0])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        """A filter of the model's own; elsewhere `Experiment` smooths the commands."""
        actuator = user.actuators[index]
        if has_filter(user, actuator):
            model.actuator_dynprm[actuator, 0] = max(value, 1e-6)

    def feigned(self, user: UserModel, index: int) -> float:
        return held(user)


class ForceLimit(Property):
    """The largest torque of a drive; positions show it where it is reached."""

    name, unit = "force_limit", "N m"
    mujoco = "forcerange"
    isaac = "effort limit of the joint's drive"
    gazebo = "<axis><limit><effort>"

    def read(self, user: UserModel, index: int) -> float:
        actuator, gear = user.actuators[index], abs(_gear(user, index))
        if not user.model.actuator_forcelimited[actuator]:
            return UNLIMITED
        return float(user.model.actuator_forcerange[actuator, 1]) * gear

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        if value >= UNLIMITED:
            return
        actuator, most = user.actuators[index], value / abs(_gear(user, index))
        model.actuator_forcelimited[actuator] = 1
        model.actuator_forcerange[actuator] = -most, most


def has_filter(user: UserModel, actuator: int) -> bool:
    """Whether the model's own actuator smooths its commands."""
    kinds = (int(mujoco.mjtDyn.mjDYN_FILTER), int(mujoco.mjtDyn.mjDYN_FILTEREXACT))
    return int(user.model.actuator_dyntype[actuator]) in kinds


def _gear(user: UserModel, index: int) -> float:
    return float(user.model.actuator_gear[user.actuators[index], 0])
