"""Where a robot's links are, by Pinocchio, and its limits, from the description's own text."""

import ctypes
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from bench.common.arrays import FloatArray
from bench.ik.soak.robots import RobotSpec

FLOATING = ("base_x", "base_y", "base_z", "base_yaw", "base_pitch", "base_roll")
NUMBERS = 12  # of a placement in Pinocchio's memory: a rotation by columns, a translation


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """What the judge knows of a joint that moves: position = multiplier * q[index] + offset."""

    index: int
    multiplier: float
    offset: float
    lower: float
    upper: float
    velocity: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Placed:
    """All links in B configurations, in the base frame."""

    R: FloatArray  # of the model's joints, (B, J, 3, 3)
    p: FloatArray  # (B, J, 3) [m]
    com: FloatArray | None  # (B, 3) [m]


class Kinematics:
    """Pinocchio's model of a robot.

    Args:
        spec: The robot.
        joint_names: The order of q's entries.
    """

    def __init__(self, spec: RobotSpec, joint_names: Sequence[str]) -> None:
        self.spec = spec
        self.names = list(joint_names)
        self.model = _model_of_rows(spec.rows) if spec.rows else _model_of_urdf(spec.description())
        self.joints = _joints_of_rows(spec.rows) if spec.rows else _joints(spec, self.names)
        self.data = self.model.createData()
        self.neutral = pin.neutral(self.model)
        self._slots = [  # entries of Pinocchio's q, and whether they are a point of the circle
            (self.model.joints[self.model.getJointId(name)], joint)
            for name, joint in self.joints.items()
            if name not in FLOATING or spec.floating_base is None
        ]
        self._seats: dict[str, tuple[int, FloatArray, FloatArray]] = {}
        self._memory = _memory(self.model, self.data)
        base = spec.base_link or self._root()
        self.base = self.seat(base)
        self._moved = spec.floating_base is not None or spec.T_world_base is not None
        self._rebased = bool(spec.base_link) or self._moved
        self.lower, self.upper = np.full((2, len(self.names)), np.inf) * [[-1.0], [1.0]]
        self.velocity = np.full(len(self.names), np.inf)
        for joint in self.joints.values():
            if joint.multiplier == 1.0 and joint.offset == 0.0:
                i = joint.index
                self.lower[i] = max(self.lower[i], joint.lower)
                self.upper[i] = min(self.upper[i], joint.upper)
                self.velocity[i] = min(self.velocity[i], joint.velocity)

    def _root(self) -> str:
        if self.spec.rows:
            return "link0"
        xml = ElementTree.fromstring(self.spec.description())
        children = {joint.find("child").attrib["link"] for joint in xml.iterfind("joint")}  # type: ignore[union-attr]
        return next(
            link.attrib["name"]
            for link in xml.iterfind("link")
            if link.attrib["name"] not in children
        )

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
        placed = Placed(R=R, p=raw[:, :, 9:], com=centres)
        return self._from_base(placed, Q) if self._rebased else placed

    def link(self, placed: Placed, name: str) -> tuple[FloatArray, FloatArray]:
        """A link's R (B, 3, 3) and p (B, 3)."""
        joint, R, p = self.seat(name)
        return placed.R[:, joint] @ R, placed.p[:, joint] + placed.R[:, joint] @ p

    def limits_hold(self, Q: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether every joint is inside its own limits, exactly; followers but for rounding."""
        holds = ((self.lower <= Q) & (self.upper >= Q)).all(axis=1)
        for joint in self.joints.values():
            x = joint.multiplier * Q[:, joint.index] + joint.offset
            room = 1e-12 * (1.0 + np.abs(x))
            if joint.multiplier != 1.0 or joint.offset != 0.0:
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
            x = joint.multiplier * Q[:, joint.index] + joint.offset
            if slot.nq == 2:
                whole[:, slot.idx_q], whole[:, slot.idx_q + 1] = np.cos(x), np.sin(x)
            else:
                whole[:, slot.idx_q] = x
        return whole

    def _from_base(self, placed: Placed, Q: FloatArray) -> Placed:
        """From the model's root to the base frame, or to the world that the base stands in."""
        joint, R, p = self.base
        R_base = placed.R[:, joint] @ R
        p_base = placed.p[:, joint] + placed.R[:, joint] @ p
        turn = R_base.swapaxes(-1, -2)
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
        return Placed(
            R=turn[:, None] @ placed.R,
            p=np.einsum("bij,bkj->bki", turn, placed.p) + shift[:, None],
            com=com,
        )


def _about(axis: int, angle: FloatArray) -> FloatArray:
    """Rotations about a coordinate axis, (B, 3, 3)."""
    R = np.zeros((len(angle), 3, 3))
    j, k = (axis + 1) % 3, (axis + 2) % 3
    R[:, axis, axis] = 1.0
    R[:, j, j] = R[:, k, k] = np.cos(angle)
    R[:, k, j] = np.sin(angle)
    R[:, j, k] = -np.sin(angle)
    return R


def _model_of_urdf(text: str) -> pin.Model:
    """With a free flyer for a root: without one Pinocchio leaves the root link's mass out."""
    return pin.buildModelFromXML(text, pin.JointModelFreeFlyer())


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


def _joints_of_rows(rows: Sequence[dict[str, float]]) -> dict[str, Joint]:
    return {
        f"joint{i + 1}": Joint(
            index=i,
            multiplier=1.0,
            offset=0.0,
            lower=row["lower"],
            upper=row["upper"],
            velocity=np.inf,
        )
        for i, row in enumerate(rows)
    }


def _joints(spec: RobotSpec, names: list[str]) -> dict[str, Joint]:
    """Of a description's joints those that move, mimic ones resolved to what they follow."""
    elements = {
        joint.attrib["name"]: joint
        for joint in ElementTree.fromstring(spec.description()).iterfind("joint")
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
        if element.attrib["type"] == "continuous":
            lower, upper = -np.inf, np.inf
        else:
            lower, upper = float(figures["lower"]), float(figures["upper"])
        joints[name] = Joint(
            index=names.index(leader),
            multiplier=multiplier,
            offset=offset,
            lower=lower,
            upper=upper,
            velocity=float(figures.get("velocity", np.inf)),
        )
    for i, name in enumerate(FLOATING if spec.floating_base is not None else ()):
        low, high = spec.floating_base[0][i], spec.floating_base[1][i]  # type: ignore[index]
        joints[name] = Joint(
            index=names.index(name),
            multiplier=1.0,
            offset=0.0,
            lower=low,
            upper=high,
            velocity=np.inf,
        )
    return joints


def _memory(model: pin.Model, data: pin.Data) -> FloatArray:
    """Pinocchio's placements of all joints as one array that follows them.

    They lie one after the other. To fetch them one by one takes a hundred times as long.
    """
    addresses = [data.oMi[j].rotation.__array_interface__["data"][0] for j in range(model.njoints)]
    size = np.dtype(np.float64).itemsize
    memory = np.ctypeslib.as_array(
        (ctypes.c_double * (NUMBERS * model.njoints)).from_address(addresses[0])
    )
    pin.forwardKinematics(model, data, pin.randomConfiguration(_bounded(model)))
    for j, address in enumerate(addresses):
        own = memory[NUMBERS * j : NUMBERS * (j + 1)]
        placement = data.oMi[j]
        is_there = address == addresses[0] + j * NUMBERS * size
        if not (
            is_there
            and (own[:9] == placement.rotation.ravel(order="F")).all()
            and (own[9:] == placement.translation).all()
        ):
            raise RuntimeError("Pinocchio's placements do not lie as they did in memory")
    return memory


def _bounded(model: pin.Model) -> pin.Model:
    """The model with limits that random configurations can be drawn from."""
    bounded = model.copy()
    bounded.lowerPositionLimit = np.full(model.nq, -1.0)
    bounded.upperPositionLimit = np.full(model.nq, 1.0)
    return bounded
