"""Where a robot's links are, by Pinocchio, and its limits, from the description's own text."""

import ctypes
from collections.abc import Sequence
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from bench.common.arrays import BoolArray, FloatArray
from bench.ik.soak.robots import RobotSpec

FLOATING = ("base_x", "base_y", "base_z", "base_yaw", "base_pitch", "base_roll")
NUMBERS = 12  # of a placement in Pinocchio's memory: a rotation by columns, a translation


class Joint(NamedTuple):
    """What the judge knows of a joint that moves: position = multiplier * q[index] + offset."""

    index: int
    lower: float
    upper: float
    multiplier: float = 1.0
    offset: float = 0.0
    velocity: float = np.inf

    @property
    def follows(self) -> bool:
        """Whether it mimics another."""
        return self.multiplier != 1.0 or self.offset != 0.0

    def at(self, Q: FloatArray) -> FloatArray:
        """The joint's position in configurations (B, n)."""
        return self.multiplier * Q[:, self.index] + self.offset


class Placed(NamedTuple):
    """All links in B configurations, in the base frame."""

    R: FloatArray  # of the model's joints, (B, J, 3, 3)
    p: FloatArray  # (B, J, 3) [m]
    com: FloatArray | None  # (B, 3) [m]


class Kinematics:
    """Pinocchio's model of a robot; q's entries are in the order of `joint_names`."""

    def __init__(self, spec: RobotSpec, joint_names: Sequence[str]) -> None:
        self.spec, self.names = spec, list(joint_names)
        root = "link0"
        if spec.rows:
            self.model = _model_of_rows(spec.rows)
            self.joints = {
                f"joint{i + 1}": Joint(i, row["lower"], row["upper"])
                for i, row in enumerate(spec.rows)
            }
        else:  # with a free flyer: without one Pinocchio leaves the root link's mass out
            xml = ElementTree.fromstring(spec.description())
            free = pin.JointModelFreeFlyer()
            self.model = pin.buildModelFromXML(spec.description(), free)
            self.joints = _joints(spec, xml, self.names)
            children = {joint.find("child").attrib["link"] for joint in xml.iterfind("joint")}
            names = [link.attrib["name"] for link in xml.iterfind("link")]
            root = next(name for name in names if name not in children)
        self.data = self.model.createData()
        self.neutral = pin.neutral(self.model)
        self._slots = [  # entries of Pinocchio's q, and whether they are a point of the circle
            (self.model.joints[self.model.getJointId(name)], joint)
            for name, joint in self.joints.items()
            if name not in FLOATING or spec.floating_base is None
        ]
        self._seats: dict[str, tuple[int, FloatArray, FloatArray]] = {}
        self._memory = _memory(self.model, self.data)
        self.base = self.seat(spec.base_link or root)
        moved = spec.floating_base is not None or spec.T_world_base is not None
        self._rebased = bool(spec.base_link) or moved
        self.lower, self.upper = np.full((2, len(self.names)), np.inf) * [[-1.0], [1.0]]
        self.velocity = np.full(len(self.names), np.inf)
        for joint in self.joints.values():
            if not joint.follows:
                i = joint.index
                self.lower[i] = max(self.lower[i], joint.lower)
                self.upper[i] = min(self.upper[i], joint.upper)
                self.velocity[i] = min(self.velocity[i], joint.velocity)

    def seat(self, link: str) -> tuple[int, FloatArray, FloatArray]:
        """The model's joint that a link hangs on, and where it sits on it: R (3, 3), p (3,)."""
        if link not in self._seats:
            frame = self.model.frames[self.model.getFrameId(link, pin.FrameType.BODY)]
            R, p = frame.placement.rotation.copy(), frame.placement.translation.copy()
            self._seats[link] = frame.parentJoint, R, p
        return self._seats[link]

    def place(self, Q: FloatArray, *, com: bool = False) -> Placed:
        """Configurations (B, n); the centre of mass only if asked for."""
        raw = np.empty((len(Q), len(self._memory)))
        centres = np.empty((len(Q), 3)) if com else None
        for k, q in enumerate(self._configurations(Q)):
            pin.forwardKinematics(self.model, self.data, q)
            raw[k] = self._memory
            if centres is not None:
                centres[k] = pin.centerOfMass(self.model, self.data, q, False)
        raw = raw.reshape(len(Q), -1, NUMBERS)
        R = raw[:, :, :9].reshape(len(Q), -1, 3, 3).swapaxes(-1, -2)
        placed = Placed(R, raw[:, :, 9:], centres)
        return self._from_base(placed, Q) if self._rebased else placed

    def link(self, placed: Placed, name: str) -> tuple[FloatArray, FloatArray]:
        """A link's R (B, 3, 3) and p (B, 3)."""
        joint, R, p = self.seat(name)
        return placed.R[:, joint] @ R, placed.p[:, joint] + placed.R[:, joint] @ p

    def limits_hold(self, Q: FloatArray) -> BoolArray:
        """Whether every joint is inside its own limits, exactly; followers but for rounding."""
        holds = ((self.lower <= Q) & (self.upper >= Q)).all(axis=1)
        for joint in self.joints.values():
            if joint.follows:
                x = joint.at(Q)
                room = 1e-12 * (1.0 + np.abs(x))
                holds &= (joint.lower - room <= x) & (x <= joint.upper + room)
        return holds

    def into_limits(self, Q: FloatArray) -> FloatArray:
        """Q moved inside the limits, those of followers included."""
        Q = np.clip(Q, self.lower, self.upper)
        for joint in self.joints.values():
            if joint.multiplier == 0.0 or not np.isfinite(joint.lower):
                continue
            ends = (np.array([joint.lower, joint.upper]) - joint.offset) / joint.multiplier
            Q[:, joint.index] = Q[:, joint.index].clip(ends.min(), ends.max())
        return Q

    def _configurations(self, Q: FloatArray) -> FloatArray:
        """As Pinocchio has them: followers filled in, unlimited angles as points of the circle."""
        whole = np.tile(self.neutral, (len(Q), 1))
        for slot, joint in self._slots:
            x = joint.at(Q)
            if slot.nq == 2:
                whole[:, slot.idx_q], whole[:, slot.idx_q + 1] = np.cos(x), np.sin(x)
            else:
                whole[:, slot.idx_q] = x
        return whole

    def _from_base(self, placed: Placed, Q: FloatArray) -> Placed:
        """Moves links from the model's root to the base frame, or to the world it stands in."""
        joint, R, p = self.base
        turn = (placed.R[:, joint] @ R).swapaxes(-1, -2)
        p_base = placed.p[:, joint] + placed.R[:, joint] @ p
        shift = -np.einsum("bij,bj->bi", turn, p_base)
        if self.spec.T_world_base is not None:
            T = np.array(self.spec.T_world_base)
            turn, shift = T[:3, :3] @ turn, shift @ T[:3, :3].T + T[:3, 3]
        if self.spec.floating_base is not None:
            x, y, z, yaw, pitch, roll = (Q[:, self.names.index(name)] for name in FLOATING)
            R_world = _about(2, yaw) @ _about(1, pitch) @ _about(0, roll)
            turn = R_world @ turn
            shift = np.einsum("bij,bj->bi", R_world, shift) + np.stack([x, y, z], axis=1)
        com = placed.com
        if com is not None:
            com = np.einsum("bij,bj->bi", turn, com) + shift
        p = np.einsum("bij,bkj->bki", turn, placed.p) + shift[:, None]
        return Placed(turn[:, None] @ placed.R, p, com)


def _about(axis: int, angle: FloatArray) -> FloatArray:
    """Rotations about a coordinate axis, (B, 3, 3)."""
    R = np.zeros((len(angle), 3, 3))
    j, k = (axis + 1) % 3, (axis + 2) % 3
    R[:, axis, axis] = 1.0
    R[:, j, j] = R[:, k, k] = np.cos(angle)
    R[:, k, j] = np.sin(angle)
    R[:, j, k] = -np.sin(angle)
    return R


def _model_of_rows(rows: Sequence[dict[str, float]]) -> pin.Model:
    """T = Rx(alpha) Tx(a) Rz(theta + theta_offset) Tz(d); q adds to theta, or to d if prismatic."""
    model = pin.Model()
    at = 0
    model.addFrame(pin.Frame("link0", 0, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    for i, row in enumerate(rows, start=1):
        x = pin.SE3(pin.utils.rotate("x", row["alpha"]), np.array([row["a"], 0.0, 0.0]))
        z = pin.SE3(pin.utils.rotate("z", row["theta_offset"]), np.array([0.0, 0.0, row["d"]]))
        joint = pin.JointModelPZ() if row["prismatic"] else pin.JointModelRZ()
        at = model.addJoint(at, joint, x * z, f"joint{i}")
        model.addFrame(pin.Frame(f"link{i}", at, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    model.addFrame(pin.Frame("tool", at, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    return model


def _joints(spec: RobotSpec, xml: ElementTree.Element, names: list[str]) -> dict[str, Joint]:
    """Joints of a description that move; mimic ones are resolved to what they follow."""
    elements = {
        joint.attrib["name"]: joint
        for joint in xml.iterfind("joint")
        if joint.attrib["type"] != "fixed"
    }
    joints = {}
    for name, element in elements.items():
        multiplier, offset, leader = 1.0, 0.0, name
        while (mimic := elements[leader].find("mimic")) is not None:
            offset += multiplier * float(mimic.attrib.get("offset", 0.0))
            multiplier *= float(mimic.attrib.get("multiplier", 1.0))
            leader = mimic.attrib["joint"]
        limit = element.find("limit")
        figures = {} if limit is None else limit.attrib
        lower, upper = -np.inf, np.inf
        if element.attrib["type"] != "continuous":
            lower, upper = float(figures["lower"]), float(figures["upper"])
        velocity = float(figures.get("velocity", np.inf))
        joints[name] = Joint(names.index(leader), lower, upper, multiplier, offset, velocity)
    if spec.floating_base is not None:
        for name, low, high in zip(FLOATING, *spec.floating_base, strict=True):
            joints[name] = Joint(names.index(name), low, high)
    return joints


def _memory(model: pin.Model, data: pin.Data) -> FloatArray:
    """Pinocchio's placements of all joints as one array that follows them.

    They lie one after the other. To fetch them one by one takes a hundred times as long.
    """
    first = data.oMi[0].rotation.__array_interface__["data"][0]
    count = NUMBERS * model.njoints
    memory = np.ctypeslib.as_array((ctypes.c_double * count).from_address(first))
    bounded = model.copy()  # with limits that random configurations can be drawn from
    bounded.lowerPositionLimit = np.full(model.nq, -1.0)
    bounded.upperPositionLimit = np.full(model.nq, 1.0)
    pin.forwardKinematics(model, data, pin.randomConfiguration(bounded))
    for own, T in zip(memory.reshape(-1, NUMBERS), data.oMi, strict=True):
        turned, shifted = own[:9] == T.rotation.ravel(order="F"), own[9:] == T.translation
        at = own.__array_interface__["data"][0]
        if at != T.rotation.__array_interface__["data"][0] or not (turned.all() and shifted.all()):
            raise RuntimeError("Pinocchio's placements do not lie as they did in memory")
    return memory
