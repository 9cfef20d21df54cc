"""Words of joints: losses, rotors, springs and the encoder's zero."""

from __future__ import annotations

from typing import Any

from . import drive_words
from .property import OfArray, Property, held
from .user_model import UserModel

_SOFTEST = 1e-6  # a spring that gives its torque wherever the joint is [N m/rad]


class OfDof(OfArray):
    """A number of a joint's degree of freedom."""

    def at(self, user: UserModel, index: int) -> int:
        return user.dof[index]


class Damping(OfDof):
    """Torque against speed."""

    array = "dof_damping"
    name, unit = "damping", "N m s/rad"
    isaac = "damping of the joint (not of its drive)"
    gazebo = "<axis><dynamics><damping>"

    def feigned(self, user: UserModel, index: int) -> float:
        return drive_words.Kp().read(user, index) * held(user)


class FrictionLoss(OfDof):
    """Dry friction."""

    array = "dof_frictionloss"
    name, unit = "frictionloss", "N m"
    isaac = "static and dynamic friction effort (joint friction)"
    gazebo = "<axis><dynamics><friction>"


class Armature(OfDof):
    """The rotor's inertia as the joint sees it."""

    array = "dof_armature"
    name, unit = "armature", "kg m^2"
    isaac = "armature"
    gazebo = "none: add it to the link's <inertia> about the axis"

    def feigned(self, user: UserModel, index: int) -> float:
        return drive_words.Kv().read(user, index) * held(user)


class Stiffness(OfArray):
    """A spring of the joint about its reference."""

    array = "jnt_stiffness"
    name, unit = "stiffness", "N m/rad"
    isaac = "none: a joint drive of its own, with this stiffness"
    gazebo = "<axis><dynamics><spring_stiffness>"

    def at(self, user: UserModel, index: int) -> int:
        return user.joint_ids[index]


class SpringTorque(Property):
    """Torque of a joint's spring where the joint is at zero: stiffness times `springref`.

    With the stiffness it says where the spring rests, and unlike `springref` it shows something
    where there is no stiffness yet.
    """

    name, unit = "spring_torque", "N m"
    mujoco = "springref: this over the stiffness"
    isaac = "target of that drive: this over its stiffness"
    gazebo = "<axis><dynamics><spring_reference>: this over the stiffness"

    def read(self, user: UserModel, index: int) -> float:
        model = user.model
        stiffness = float(model.jnt_stiffness[user.joint_ids[index]])
        return stiffness * float(model.qpos_spring[user.qpos[index]])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        joint = user.joint_ids[index]
        if value == 0.0 and model.jnt_stiffness[joint] <= 0.0:
            return
        model.jnt_stiffness[joint] = max(model.jnt_stiffness[joint], _SOFTEST)
        model.qpos_spring[user.qpos[index]] = value / float(model.jnt_stiffness[joint])


class Ref(OfArray):
    """Encoder zero: what the machine's encoder shows where the model's joint is at zero."""

    array = "qpos0"
    name, unit = "ref", "rad"
    isaac = "none: add it to positions and commands of this joint"
    gazebo = "none: turn the joint's <pose> back by it"

    def at(self, user: UserModel, index: int) -> int:
        return user.qpos[index]
