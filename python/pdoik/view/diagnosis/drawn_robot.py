"""The study's robot as links that can be drawn in any colour."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
import numpy.typing as npt
import trimesh
import yaml

import pdoik
from pdoik._addresses import Packages
from pdoik.descriptions import UrdfJoint, pose_of, tree_of, urdf_file, urdf_joints
from pdoik.errors import PdoikError
from pdoik.sim2real.model import Model

from ..body import segment_mesh
from ..drawing.hull_bodies import hull_bodies
from ..model import read_robot
from ..visuals import load_visuals

FloatArray = npt.NDArray[np.float64]

_THIN = 0.022  # radius of a link without geometry, of the robot's size


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnRobot:
    """Meshes by link, in the links' frames, and which joint of the study moves each.

    Attributes:
        robot: Kinematics of every link.
        meshes: By link.
        mover: The number of the study's joint that moves a link, by link; none for fixed ones.
        joints: By name.
        size: About how far it stretches [m].
        notes: What could not be had.
    """

    robot: pdoik.Robot
    meshes: dict[str, Any]
    mover: dict[str, int]
    joints: dict[str, UrdfJoint]
    columns: npt.NDArray[np.intp]  # (n,) place of the study's joints in the robot's
    rest: FloatArray  # (dof,) of joints that the study leaves out
    size: float
    notes: tuple[str, ...] = ()

    def poses(self, q: FloatArray) -> dict[str, FloatArray]:
        """T_base_link of every link with a mesh, of the study's joints (n,)."""
        full = self._full(q)
        return {link: np.asarray(self.robot.fk(full, link)) for link in self.meshes}

    def pose_of(self, link: str, q: FloatArray) -> FloatArray:
        """T_base_link (4, 4)."""
        return np.asarray(self.robot.fk(self._full(q), link))

    def _full(self, q: FloatArray) -> FloatArray:
        full = self.rest.copy()
        full[self.columns] = q
        return full


def drawn_robot(model: Model, packages: Packages = ()) -> DrawnRobot:
    """Robot of the study's file, with its meshes, or else from the text that model.json keeps.

    Args:
        model: Of the report.
        packages: Where meshes are looked for, as in `pdoik.urdf_text`.

    Raises:
        LoadError, ValueError: There is no robot, or it cannot be drawn.
    """
    notes: list[str] = []
    with tempfile.TemporaryDirectory(prefix="pdoik-view-") as folder:
        file = _file_of(model, Path(folder), packages, notes)
        robot = read_robot(file)
        root = tree_of(file)
        visuals, missing = load_visuals(file, packages)
    if missing:
        notes.append(f"{len(missing)} links lack meshes: {missing[0]}")
    missing_joints = [name for name in model.joints if name not in robot.joint_names]
    if missing_joints:
        raise ValueError(f"the robot has no joint {missing_joints[0]!r} that can be drawn")
    joints = {each.name: each for each in urdf_joints(root)}
    rest = np.clip(0.0, robot.lower, robot.upper)
    known = set(robot.link_names)
    origins = {link: np.asarray(robot.fk(rest, link))[:3, 3] for link in robot.link_names}
    size = max(float(np.linalg.norm(np.ptp(np.array(list(origins.values())), axis=0))), 0.1)
    meshes = {link: _mesh(glb) for link, glb in visuals.items() if link in known}
    inside = [each for each in joints.values() if {each.parent, each.child} <= known]
    if not meshes and (shipped := _shipped(robot)) is not None:
        meshes = hull_bodies(shipped)
    if not meshes:
        meshes = _sticks(root, robot, rest, inside, _THIN * size)
    ends = np.array(
        [
            (np.asarray(robot.fk(rest, link)) @ np.append(corner, 1.0))[:3]
            for link, mesh in meshes.items()
            for corner in np.asarray(mesh.bounds)
        ]
    )
    return DrawnRobot(
        robot=robot,
        meshes=meshes,
        mover=_movers(inside, model.joints),
        joints=joints,
        columns=np.array([robot.joint_names.index(name) for name in model.joints], dtype=np.intp),
        rest=rest,
        size=max(float(np.linalg.norm(np.ptp(ends, axis=0))), 0.1),
        notes=tuple(notes),
    )


def _file_of(model: Model, folder: Path, packages: Packages, notes: list[str]) -> Path:
    """A URDF of the robot."""
    own = _studys(model.study)
    if own is not None:
        try:
            return urdf_file(own, packages=packages)
        except (PdoikError, OSError) as error:
            notes.append(f"drawn without meshes: {error}")
    elif model.robot is not None:
        notes.append("drawn without meshes: the study's robot is not where it was")
    text = model.description
    path = folder / ("robot.urdf" if "<robot" in text else "robot.xml")
    path.write_text(text, encoding="utf-8")
    return urdf_file(path)


def _studys(study: str | None) -> Path | None:
    """The file that a study names as its robot, if it is there."""
    try:
        content = yaml.safe_load(Path(study or "").read_text(encoding="utf-8"))
        path = Path(study or "").parent / Path(content["robot"]).expanduser()
    except (OSError, UnicodeDecodeError, yaml.YAMLError, KeyError, TypeError):
        return None
    return path if path.is_file() else None


def _shipped(robot: pdoik.Robot) -> pdoik.Robot | None:
    """The robot with hulls that is shipped with the library, if this is it."""
    for name in pdoik.Robot.builtin_names():
        shipped = pdoik.Robot.builtin(name)
        if name == robot.name and list(shipped.joint_names) == list(robot.joint_names):
            return shipped
    return None


def _movers(joints: Sequence[UrdfJoint], names: Sequence[str]) -> dict[str, int]:
    """The nearest joint of the study above each link."""
    above = {each.child: each for each in joints}
    movers = {}
    for link in above:
        at: str | None = link
        while at in above:
            if above[at].name in names:
                movers[link] = names.index(above[at].name)
                break
            at = above[at].parent
    return movers


def _sticks(
    root: Element,
    robot: pdoik.Robot,
    q: FloatArray,
    joints: Sequence[UrdfJoint],
    radius: float,
) -> dict[str, Any]:
    """Rods from each link's origin to those of its children, or to twice its centre of mass."""
    meshes = {}
    for link in robot.link_names:
        T_link_base = np.linalg.inv(np.asarray(robot.fk(q, link)))
        ends = [
            (T_link_base @ np.asarray(robot.fk(q, each.child)))[:3, 3]
            for each in joints
            if each.parent == link
        ]
        if not ends:
            ends = [2.0 * _center(root, link)]
        moving = any(each.child == link and each.type != "fixed" for each in joints)
        parts = [trimesh.creation.icosphere(subdivisions=3, radius=1.5 * radius)] if moving else []
        parts += [
            segment_mesh(np.zeros(3), end, radius) for end in ends if np.linalg.norm(end) > radius
        ]
        if parts:
            meshes[link] = trimesh.util.concatenate(parts)
    return meshes


def _center(root: Element, link: str) -> FloatArray:
    inertial = root.find(f"link[@name='{link}']/inertial")
    return np.zeros(3) if inertial is None else pose_of(inertial)[:3, 3]


def _mesh(glb: bytes) -> Any:
    """One mesh of all that a link has."""
    scene = trimesh.load_scene(io.BytesIO(glb), file_type="glb")
    return scene.to_mesh()
