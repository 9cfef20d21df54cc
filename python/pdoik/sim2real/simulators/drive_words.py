"""Words of the drives: gains and delays."""

from __future__ import annotations

from typing import Any

from .property import EVERY, Gain, Property, Scales, held
from .user_model import UserModel


class Kp(Gain):
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

    def step(self, scales: Scales, value: float) -> float:
        return -0.03 * value


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


class KpFactor(Gain):
    """By how much all proportional gains differ alike: a unit, or firmware."""

    name, unit, place = "kp_factor", "", "machine"
    isaac = "stiffness of all joint drives, times this"
    gazebo = "<p_gain> of all position controllers, times this"

    def read(self, user: UserModel, index: int) -> float:
        return 1.0

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        for k in user.actuators:
            model.actuator_biasprm[k, 1] *= value
            model.actuator_gainprm[k, 0] *= value

    def step(self, scales: Scales, value: float) -> float:
        return -0.03 * value


class GainFactor(Gain):
    """By how much a drive's gains differ alike, of all drives or one: a torque constant."""

    name, unit, turns = "gain_factor", "", ("kp", "kv")
    mujoco = "kp and kv, times this"
    isaac = "stiffness and damping of the joint's drive, times this"
    gazebo = "<p_gain> and <d_gain> of the position controller, times this"

    def read(self, user: UserModel, index: int) -> float:
        return 1.0

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        for k in user.actuators if index == EVERY else (user.actuators[index],):
            model.actuator_biasprm[k, 1:3] *= value
            model.actuator_gainprm[k, 0] *= value

    def step(self, scales: Scales, value: float) -> float:
        return -0.03 * value


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
