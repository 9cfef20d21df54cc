"""Properties that a simulator has words for, one class each, registered in `PROPERTIES`.

A property reads its value off a compiled model, writes another into a copy, and says its unit,
its lowest value and what it is called elsewhere. Everything else asks the registry.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from .user_model import UserModel

Place = Literal["joint", "link", "machine"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scales:
    """Typical sizes at one joint under the recorded commands, which units are made of."""

    torque: float  # root mean square of the drive's [N m]
    speed: float  # [rad/s]
    acceleration: float  # [rad/s^2]
    travel: float  # of the position about its mean [rad]
    mass: float  # of the link and all after it [kg]


class Property:
    """One word of a simulator. `index` is a place in the study's joints, -1 of the machine."""

    name: ClassVar[str]
    unit: ClassVar[str]
    place: ClassVar[Place] = "joint"
    lowest: ClassVar[float] = 0.0
    ends: ClassVar[bool] = False  # whether nothing real has its lowest value
    isaac: ClassVar[str]  # what Isaac Sim and Isaac Lab call it
    gazebo: ClassVar[str]  # SDF's element

    def read(self, user: UserModel, index: int) -> float:
        """Its value in the user's model."""
        raise NotImplementedError

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        """Put a value into a copy of the user's model."""
        raise NotImplementedError

    def step(self, scales: Scales, value: float) -> float:
        """A change that shows, and is still small."""
        raise NotImplementedError


class Damping(Property):
    """Torque against speed."""

    name, unit = "damping", "N m s/rad"
    isaac = "damping of the joint (not of its drive)"
    gazebo = "<axis><dynamics><damping>"

    def read(self, user: UserModel, index: int) -> float:
        return float(user.model.dof_damping[user.dof[index]])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        model.dof_damping[user.dof[index]] = value

    def step(self, scales: Scales, value: float) -> float:
        return 0.05 * scales.torque / scales.speed


class FrictionLoss(Property):
    """Dry friction."""

    name, unit = "frictionloss", "N m"
    isaac = "static and dynamic friction effort (joint friction)"
    gazebo = "<axis><dynamics><friction>"

    def read(self, user: UserModel, index: int) -> float:
        return float(user.model.dof_frictionloss[user.dof[index]])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        model.dof_frictionloss[user.dof[index]] = value

    def step(self, scales: Scales, value: float) -> float:
        return 0.05 * scales.torque


class Armature(Property):
    """The rotor's inertia as the joint sees it."""

    name, unit = "armature", "kg m^2"
    isaac = "armature"
    gazebo = "none: add it to the link's <inertia> about the axis"

    def read(self, user: UserModel, index: int) -> float:
        return float(user.model.dof_armature[user.dof[index]])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        model.dof_armature[user.dof[index]] = value

    def step(self, scales: Scales, value: float) -> float:
        return 0.05 * scales.torque / scales.acceleration


class Stiffness(Property):
    """A spring of the joint about its reference."""

    name, unit = "stiffness", "N m/rad"
    isaac = "none: a joint drive of its own, with this stiffness"
    gazebo = "<axis><dynamics><spring_stiffness>"

    def read(self, user: UserModel, index: int) -> float:
        return float(user.model.jnt_stiffness[user.joint_ids[index]])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        model.jnt_stiffness[user.joint_ids[index]] = value

    def step(self, scales: Scales, value: float) -> float:
        return 0.05 * scales.torque / scales.travel


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


class Ref(Property):
    """Encoder zero: what the machine's encoder shows where the model's joint is at zero."""

    name, unit = "ref", "rad"
    lowest = float("-inf")
    isaac = "none: add it to positions and commands of this joint"
    gazebo = "none: turn the joint's <pose> back by it"

    def read(self, user: UserModel, index: int) -> float:
        return float(user.model.qpos0[user.qpos[index]])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        model.qpos0[user.qpos[index]] = value

    def step(self, scales: Scales, value: float) -> float:
        return 0.01


class Mass(Property):
    """Mass of the link that a joint moves, its centre and inertia about it kept."""

    name, unit, place = "mass", "kg", "link"
    lowest, ends = 1e-6, True
    isaac = "mass of the body"
    gazebo = "<inertial><mass>"

    def read(self, user: UserModel, index: int) -> float:
        return float(user.model.body_mass[user.body_of(index)])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        model.body_mass[user.body_of(index)] = value

    def step(self, scales: Scales, value: float) -> float:
        return 0.03 * scales.mass


class CentreOfMass(Property):
    """One coordinate of the centre of mass of the link that a joint moves."""

    unit, place = "m", "link"
    lowest = float("-inf")
    isaac = "centre of mass of the body"
    gazebo = "<inertial><pose>"
    axis: ClassVar[int]

    def read(self, user: UserModel, index: int) -> float:
        return float(user.model.body_ipos[user.body_of(index), self.axis])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        model.body_ipos[user.body_of(index), self.axis] = value

    def step(self, scales: Scales, value: float) -> float:
        return 0.003


class CentreX(CentreOfMass):
    """Along the link's x."""

    name, axis = "com_x", 0


class CentreY(CentreOfMass):
    """Along the link's y."""

    name, axis = "com_y", 1


class CentreZ(CentreOfMass):
    """Along the link's z."""

    name, axis = "com_z", 2


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


PROPERTIES: dict[str, Property] = {
    each.name: each
    for each in (
        Damping(),
        FrictionLoss(),
        Armature(),
        Kp(),
        Kv(),
        Stiffness(),
        Ref(),
        Mass(),
        CentreX(),
        CentreY(),
        CentreZ(),
        Delay(),
    )
}


def _gear(user: UserModel, index: int) -> float:
    return float(user.model.actuator_gear[user.actuators[index], 0])
