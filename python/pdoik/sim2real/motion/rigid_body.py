"""Inverse dynamics of the model the user believes, over whole recordings (Pinocchio)."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from pdoik.descriptions import RobotDescription
from pdoik.recordings import FloatArray

from ..study import Payload

STANDARD_GRAVITY = 9.81
_SPEED_OF_REST = 2e-3  # within which the description's dry friction turns [rad/s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Dynamics:
    """Inverse dynamics along a motion and its derivatives."""

    tau: FloatArray  # (T, rows) of the rigid body, with the known rotor inertia [N m]
    dtau_dq: FloatArray  # (T, rows, n)
    dtau_dv: FloatArray  # (T, rows, n)
    mass_matrix: FloatArray  # (T, rows, n), without rotors
    dtau_dgravity: FloatArray  # (T, rows, 3) per m/s^2 of gravity along x, y, z of the base


class RigidBody:
    """The study's joints of a URDF or MJCF; every other joint is held at its neutral position.

    `rows` of torques are one a joint; where the base floats six more follow, the force [N] and the
    moment [N m] on it, in its own axes.
    """

    def __init__(
        self,
        robot: Path,
        joints: tuple[str, ...],
        rotor_inertia: FloatArray | None,
        *,
        floats: bool = False,
    ) -> None:
        """Raises ValueError where a joint of the study has not one degree of freedom.

        Args:
            robot: URDF or MJCF.
            joints: of the study, in its order.
            rotor_inertia: (n,) seen at the joints [kg m^2]; None: none.
            floats: whether the base is free to move.
        """
        model = RobotDescription.of_file(robot).pinocchio(floats=floats)
        first = 2 if floats else 1
        held = [i for i in range(first, model.njoints) if model.names[i] not in joints]
        model = pin.buildReducedModel(model, held, pin.neutral(model))
        for name in joints:
            if model.joints[model.getJointId(name)].nv != 1:
                raise ValueError(f"joint {name} has not one degree of freedom")
        model.gravity.linear = np.array([0.0, 0.0, -STANDARD_GRAVITY])
        model.armature = np.zeros(model.nv)
        self.model: Any = model
        self.joints = joints
        self.n = len(joints)
        self._data: Any = model.createData()
        ids = [model.getJointId(name) for name in joints]
        self._ids = ids
        self._v = np.array([model.joints[i].idx_v for i in ids])  # place of each joint in v
        self._q = np.array([model.joints[i].idx_q for i in ids])
        self._circle = np.array([model.joints[i].nq == 2 for i in ids])  # continuous: cos, sin
        self._rows = np.concatenate([self._v, np.arange(6 if floats else 0)]).astype(np.intp)
        self._link_ids = [*ids, *([1] if floats else [])]  # joints that carry the links
        self.links = tuple(_link_of(model, i) for i in self._link_ids)
        ancestors = np.array([[_carries(model, a, b) for b in ids] for a in ids])
        self.depth = ancestors.sum(axis=0)  # study joints from the base to each, itself included
        self.last = int(np.argmax(self.depth))  # the joint that moves the last link
        self.damping = np.array(model.damping)[self._v]  # as the description has it
        self.friction = _dry_friction(model)[self._v]
        self.rotor = np.zeros(self.n) if rotor_inertia is None else rotor_inertia
        self._own = np.stack([model.inertias[i].toDynamicParameters() for i in self._link_ids])

    @property
    def rows(self) -> int:
        """Rows of its torques: the joints', and the base's where that floats."""
        return len(self._rows)

    def _position(self, q: FloatArray) -> FloatArray:
        """Pinocchio's configurations, (T, nq)."""
        configuration = np.tile(pin.neutral(self.model), (len(q), 1))
        plain = ~self._circle
        configuration[:, self._q[plain]] = q[:, plain]
        for j in np.flatnonzero(self._circle):
            configuration[:, self._q[j]] = np.cos(q[:, j])
            configuration[:, self._q[j] + 1] = np.sin(q[:, j])
        return configuration

    def _velocity(self, dq: FloatArray) -> FloatArray:
        velocity = np.zeros((len(dq), self.model.nv))
        velocity[:, self._v] = dq
        return velocity

    def _acceleration(self, ddq: FloatArray) -> FloatArray:
        return self._velocity(ddq)

    def dynamics(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> Dynamics:
        """Torques and derivatives, for (T, n) each."""
        model, data, rows = self.model, self._data, self._rows
        count, n = q.shape
        grid = np.ix_(np.arange(count), rows, self._v)
        configuration, velocity = self._position(q), self._velocity(dq)
        acceleration = self._acceleration(ddq)
        tau = np.empty((count, model.nv))
        by_q, by_v, mass = (np.empty((count, model.nv, model.nv)) for _ in range(3))
        by_gravity = self._by_gravity(configuration)
        for t in range(count):
            pin.computeRNEADerivatives(model, data, configuration[t], velocity[t], acceleration[t])
            tau[t], by_q[t], by_v[t], mass[t] = data.tau, data.dtau_dq, data.dtau_dv, data.M
        tau, by_q, by_v = tau[:, rows], by_q[grid], by_v[grid]
        upper = np.triu(mass)  # Pinocchio leaves the other half as it was
        mass = (upper + np.triu(upper, 1).transpose(0, 2, 1))[grid]
        tau[:, :n] += self.rotor * ddq + self.damping * dq
        tau[:, :n] += self.friction * np.tanh(dq / _SPEED_OF_REST)
        return Dynamics(
            tau=tau, dtau_dq=by_q, dtau_dv=by_v, mass_matrix=mass, dtau_dgravity=by_gravity
        )

    def torque(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
        """Torques of the rigid body alone, (T, rows): no rotors, no friction."""
        model, data, rows = self.model, self._data, self._rows
        each = zip(self._position(q), self._velocity(dq), self._acceleration(ddq), strict=True)
        return np.stack([pin.rnea(model, data, a, b, c)[rows] for a, b, c in each])

    def displaced(self, j: int, shift: FloatArray, turn: FloatArray) -> RigidBody:
        """The same body with joint j placed elsewhere.

        Args:
            j: a study joint.
            shift: (3,) added to its origin, in its parent's axes [m].
            turn: (3,) rotation vector after its orientation, in its own axes [rad].
        """
        other = copy.copy(self)
        other.model = self.model.copy()
        placement = other.model.jointPlacements[self._ids[j]].copy()
        placement.translation = placement.translation + shift
        placement.rotation = placement.rotation @ pin.exp3(turn)
        other.model.jointPlacements[self._ids[j]] = placement
        other._data = other.model.createData()
        return other

    def holding(self, payload: Payload) -> RigidBody:
        """The same robot with a known body; `inertial_parameters` stay those of the robot alone.

        Raises:
            ValueError: no study joint moves its link.
        """
        joint, inertia = self._carried(payload)
        other = copy.copy(self)
        other.model = self.model.copy()
        carrying = self._link_ids[joint]
        other.model.inertias[carrying] = self.model.inertias[carrying] + inertia
        other._data = other.model.createData()
        return other

    def carrier(self, payload: Payload) -> tuple[int, FloatArray]:
        """The link, by place in `links`, that holds a known body, and its ten parameters there.

        Raises:
            ValueError: no study joint moves its link.
        """
        joint, inertia = self._carried(payload)
        return joint, np.asarray(inertia.toDynamicParameters(), dtype=np.float64)

    def _carried(self, payload: Payload) -> tuple[int, Any]:
        there = self.model.existFrame(payload.link)
        frame = self.model.frames[self.frame(payload.link)] if there else None
        if frame is None or frame.parentJoint not in self._link_ids:
            raise ValueError(f"payload: link {payload.link!r} is moved by no joint of the study")
        own = pin.Inertia(payload.mass, np.array(payload.com), payload.inertia_matrix)
        return self._link_ids.index(frame.parentJoint), frame.placement.act(own)

    def placement_rotation(self, j: int) -> FloatArray:
        """Orientation of joint j's frame on its parent at its zero, (3, 3)."""
        return np.array(self.model.jointPlacements[self._ids[j]].rotation)

    def mass_diagonal(self, q: FloatArray) -> FloatArray:
        """Inertia each joint sees with the others at rest, rotors included; q and result (n,)."""
        return np.asarray(np.diag(self.mass_matrices(q[None])[0]) + self.rotor, dtype=np.float64)

    def mass_matrices(self, q: FloatArray) -> FloatArray:
        """Inertias of the rigid body alone for (T, n), (T, n, n): no rotors."""
        model, data, grid = self.model, self._data, np.ix_(self._v, self._v)
        return np.stack([pin.crba(model, data, row)[grid] for row in self._position(q)])

    def gravity(self, q: FloatArray) -> FloatArray:
        """Torques that hold the robot still, (T, n)."""
        configuration = self._position(q)
        model, data, v = self.model, self._data, self._v
        return np.stack(
            [pin.computeGeneralizedGravity(model, data, row)[v].copy() for row in configuration]
        )

    def _by_gravity(self, configuration: FloatArray) -> FloatArray:
        model, v = self.model.copy(), self._rows
        data = model.createData()
        result = np.empty((len(configuration), len(v), 3))
        for axis in range(3):
            model.gravity.linear = np.eye(3)[axis]
            for t, row in enumerate(configuration):
                result[t, :, axis] = pin.computeGeneralizedGravity(model, data, row)[v]
        return result

    def regressor(
        self, q: FloatArray, dq: FloatArray, ddq: FloatArray, gravity: FloatArray | None = None
    ) -> FloatArray:
        """Torque per inertial parameter, (T, rows, links, 10).

        Ten per link, in the link's frame at its joint: mass, first moments x y z, inertias about
        the frame's origin xx xy yy xz yz zz (Pinocchio's order).

        Args:
            q: (T, n) positions.
            dq: their derivatives.
            ddq: those of these.
            gravity: (3,) in the base's frame [m/s^2]; the model's own where it is None.
        """
        model = self.model
        if gravity is not None:
            model = model.copy()
            model.gravity.linear = gravity
        configuration, velocity = self._position(q), self._velocity(dq)
        acceleration = self._acceleration(ddq)
        order = [(i - 1) * 10 + k for i in self._link_ids for k in range(10)]
        result = np.empty((len(q), self.rows, len(self.links), 10))
        for t in range(len(q)):
            each = pin.computeJointTorqueRegressor(
                model, self._data, configuration[t], velocity[t], acceleration[t]
            )
            each = each.reshape(self.model.nv, -1)  # flat where there is one joint
            result[t] = each[self._rows][:, order].reshape(result.shape[1:])
        return result

    def inertial_parameters(self) -> FloatArray:
        """The model's own ten parameters per link, (links, 10), as `regressor` orders them."""
        return self._own.copy()

    def inertial_scale(self, link: int) -> FloatArray:
        """Size of a link's ten inertial parameters: mass, mass times reach, largest inertia.

        A link that has none, or next to none, is as large as a tenth of the largest.
        """
        each = np.stack([_scale(ten) for ten in self.inertial_parameters()])
        return np.asarray(np.maximum(each[link], _LEAST_SCALE * each.max(axis=0)))

    def axis(self, j: int) -> FloatArray | None:
        """Axis joint j turns about in its own frame, (3,); None where it slides."""
        velocity = np.zeros(self.model.nv)
        velocity[self._v[j]] = 1.0
        joint = self.model.joints[self._ids[j]]
        motion = joint.createData()
        joint.calc(motion, pin.neutral(self.model), velocity)
        axis = np.array(motion.v.angular)
        return axis if np.any(axis) else None

    def neighbours(self) -> list[tuple[int, int]]:
        """Pairs of joints that follow one another along a chain, in both orders."""
        before = [self._before(i) for i in self._ids]
        pairs = [(a, b) for b, a in enumerate(before) if a is not None]
        pairs.sort(key=lambda pair: int(self.depth[pair[0]]))
        return pairs + [(b, a) for a, b in pairs]

    def _before(self, joint: int) -> int | None:
        """The study joint next towards the base."""
        above = int(self.model.parents[joint])
        return self._ids.index(above) if above in self._ids else None

    def frame(self, name: str | None) -> int:
        """Index of the frame of a link; of the last link for None."""
        wanted = self.links[self.last] if name is None else name
        if self.model.existFrame(wanted, pin.BODY):  # a joint may have the same name
            return int(self.model.getFrameId(wanted, pin.BODY))
        if not self.model.existFrame(wanted):
            raise ValueError(f"tip {wanted!r} is no link of the robot")
        return int(self.model.getFrameId(wanted))

    def poses_and_jacobians(self, q: FloatArray, frame: int) -> tuple[FloatArray, FloatArray]:
        """Poses (T, 4, 4) and Jacobians (T, 6, n), linear then angular, base axes, of a frame."""
        model, data, v = self.model, self._data, self._v
        poses = np.empty((len(q), 4, 4))
        jacobians = np.empty((len(q), 6, self.n))
        for t, row in enumerate(self._position(q)):
            jacobian = pin.computeFrameJacobian(model, data, row, frame, pin.LOCAL_WORLD_ALIGNED)
            jacobians[t] = jacobian.reshape(6, -1)[:, v]  # flat where there is one joint
            poses[t] = data.oMf[frame].homogeneous
        return poses, jacobians

    def joint_poses(self, q: FloatArray) -> FloatArray:
        """Pose of each study joint's frame in the base, (T, n, 4, 4)."""
        poses = np.empty((len(q), self.n, 4, 4))
        for t, row in enumerate(self._position(q)):
            pin.forwardKinematics(self.model, self._data, row)
            for j, i in enumerate(self._ids):
                poses[t, j] = self._data.oMi[i].homogeneous
        return poses


_LEAST_SCALE = 0.1  # of the largest link's figures


def _scale(ten: FloatArray) -> FloatArray:
    mass = max(float(ten[0]), 1e-6)
    largest = max(float(np.abs(ten[4:]).max()), 1e-9)
    reach = max(float(np.linalg.norm(ten[1:4])) / mass, float(np.sqrt(largest / mass)))
    return np.array([mass] + [mass * reach] * 3 + [largest] * 6)


def _link_of(model: Any, joint: int) -> str:
    """The link that a joint moves."""
    for frame in model.frames:
        if frame.parentJoint == joint and frame.type == pin.BODY:
            return str(frame.name)
    return str(model.names[joint])


def _carries(model: Any, joint: int, other: int) -> bool:
    """Whether the other joint is the joint itself or sits on what it moves."""
    return joint in model.supports[other]


def _dry_friction(model: Any) -> FloatArray:
    """The description's dry friction of each joint (Pinocchio has renamed the field)."""
    for name in ("upperDryFrictionLimit", "friction"):
        if hasattr(model, name):
            return np.abs(np.array(getattr(model, name), dtype=np.float64))
    return np.zeros(model.nv)
