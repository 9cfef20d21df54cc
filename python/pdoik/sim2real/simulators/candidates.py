"""Candidates: the user's model with other values of some properties."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco

from .body_words import carry_load
from .drive_words import has_filter
from .property import EVERY
from .user_model import UserModel
from .vocabulary import PROPERTIES

_ORDER = {name: place for place, name in enumerate(PROPERTIES)}
_ALONE = (
    "damping",
    "frictionloss",
    "armature",
    "kp",
    "kv",
    "stiffness",
    "ref",
    "delay",
    "filter",
    "force_limit",
)
"""Properties that each joint may have more or less of."""
_CENTRE = ("com_x", "com_y", "com_z")


@dataclass(frozen=True, slots=True, order=True)
class ParameterId:
    """One property of one joint or of the link that it moves; `EVERY` of all joints alike."""

    property: str
    index: int


@dataclass(frozen=True, slots=True)
class Term:
    """Parameters taken up or left out as one: a property, or a link's mass with its centre."""

    name: str
    parameter_ids: tuple[ParameterId, ...]

    @property
    def indices(self) -> frozenset[int]:
        """Places in the study's joints."""
        return frozenset(parameter_id.index for parameter_id in self.parameter_ids)


Values = Mapping[ParameterId, float]


def terms_of(user: UserModel) -> tuple[Term, ...]:
    """All that a user's model can be changed by."""
    n = len(user.joints)
    found = [Term(name, (ParameterId(name, k),)) for name in _ALONE for k in range(n)]
    found += [
        Term("spring", (ParameterId("stiffness", k), ParameterId("spring_torque", k)))
        for k in range(n)
    ]
    found += [Term("gains", (ParameterId("gain_factor", k),)) for k in range(n)]
    if n > 1:
        shared = (("delay", "delay"), ("gains", "gain_factor"), ("kp", "kp_factor"))
        found += [Term(name, (ParameterId(parameter_id, EVERY),)) for name, parameter_id in shared]
    heavy = [k for k in range(n) if user.model.body_mass[user.body_of(k)] > 0.0]
    found += [Term("mass", (ParameterId("mass", k),)) for k in heavy]
    last = [k for k in heavy if not _carries_joints(user, k)]
    loaded = ("mass", *_CENTRE)
    found += [Term("payload", tuple(ParameterId(name, k) for name in loaded)) for k in last]
    return tuple(found)


def baseline(user: UserModel, parameter_id: ParameterId) -> float:
    """The parameter's value in the user's model."""
    return PROPERTIES[parameter_id.property].read(user, parameter_id.index)


def model_with(user: UserModel, values: Values) -> Any:
    """A copy of the user's mujoco.MjModel with these values, all that follows from them anew."""
    model = copy.copy(user.model)
    for parameter_id in sorted(values, key=lambda each: _ORDER[each.property]):
        PROPERTIES[parameter_id.property].write(
            user, model, parameter_id.index, values[parameter_id]
        )
    for k in {parameter_id.index for parameter_id in values if parameter_id.property in _CENTRE}:
        carry_load(user, model, k)
    if any(parameter_id.property not in ("delay", "filter") for parameter_id in values):
        mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def delays_with(user: UserModel, values: Values) -> list[float]:
    """The delay of each joint's command, (n,) [s]."""
    shared = values.get(ParameterId("delay", EVERY), 0.0)
    return [shared + values.get(ParameterId("delay", k), 0.0) for k in range(len(user.joints))]


def filters_with(user: UserModel, values: Values) -> list[float]:
    """Time constant of what smooths each joint's command before the model has it, (n,) [s]."""
    return [
        0.0 if has_filter(user, actuator) else values.get(ParameterId("filter", k), 0.0)
        for k, actuator in enumerate(user.actuators)
    ]


def _carries_joints(user: UserModel, k: int) -> bool:
    """Whether a further joint of the study is on the link that a joint moves."""
    model, mine = user.model, user.body_of(k)
    for other in range(len(user.joints)):
        body = int(model.body_parentid[user.body_of(other)])
        while body > 0:
            if body == mine:
                return True
            body = int(model.body_parentid[body])
    return False
