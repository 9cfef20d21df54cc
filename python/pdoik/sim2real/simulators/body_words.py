"""Words of links: mass and its centre, and the inertia that a load brings with it."""

from __future__ import annotations

from typing import Any, ClassVar

import mujoco
import numpy as np

from pdoik.recordings import FloatArray

from .property import OfArray
from .user_model import UserModel


class Mass(OfArray):
    """Mass of the link that a joint moves, its centre and inertia about it kept."""

    array = "body_mass"
    name, unit, place = "mass", "kg", "link"
    isaac = "mass of the body"
    gazebo = "<inertial><mass>"

    def at(self, user: UserModel, index: int) -> int:
        return user.body_of(index)


class CentreOfMass(OfArray):
    """One coordinate of the centre of mass of the link that a joint moves."""

    array = "body_ipos"
    unit, place = "m", "link"
    isaac = "centre of mass of the body"
    gazebo = "<inertial><pose>"
    axis: ClassVar[int]

    def at(self, user: UserModel, index: int) -> tuple[int, int]:
        return user.body_of(index), self.axis


class CentreX(CentreOfMass):
    """Along the link's x."""

    name, axis = "com_x", 0


class CentreY(CentreOfMass):
    """Along the link's y."""

    name, axis = "com_y", 1


class CentreZ(CentreOfMass):
    """Along the link's z."""

    name, axis = "com_z", 2


def carry_load(user: UserModel, model: Any, index: int) -> None:
    """Give a link that became heavier the inertia that a point mass brings, in place.

    The mass m_p that turns mass m and centre c into m' and c' lies at d = (c' - c) m' / m_p from c
    and adds m m_p / m' (|d|^2 - d d^T) to the inertia about the centre. No load is taken to lie
    further out than the machine's own length. A link that became lighter keeps its inertia.
    """
    body = user.body_of(index)
    mass, total = float(user.model.body_mass[body]), float(model.body_mass[body])
    load, shift = total - mass, model.body_ipos[body] - user.model.body_ipos[body]
    size = float(np.linalg.norm(shift))
    if load <= 0.0 or mass <= 0.0 or size == 0.0:
        return
    arm = min(size * total / load, _reach(user, body))
    d = shift * (arm / size)
    turned = _rotation(user.model.body_iquat[body])
    inertia = (turned * user.model.body_inertia[body]) @ turned.T
    inertia += mass * load / total * (float(d @ d) * np.eye(3) - np.outer(d, d))
    moments, axes = np.linalg.eigh(inertia)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    model.body_inertia[body] = moments
    mujoco.mju_mat2Quat(model.body_iquat[body], axes.ravel())


def _reach(user: UserModel, body: int) -> float:
    """Length of the chain up to a body, and how far out its own centre is [m]."""
    model, length = user.model, float(np.linalg.norm(user.model.body_ipos[body]))
    while body > 0:
        length += float(np.linalg.norm(model.body_pos[body]))
        body = int(model.body_parentid[body])
    return length


def _rotation(wxyz: FloatArray) -> FloatArray:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.asarray(wxyz, dtype=np.float64))
    return matrix.reshape(3, 3)
