"""A URDF of a MuJoCo model: bodies, joints, inertias and collision geometry.

MuJoCo reads the file, so that defaults, includes, attachments and compiler options count. A joint's
value is MuJoCo's `qpos`. What a URDF cannot say is refused (ball joints) or left out (tendons,
actuators); a body that floats stands where the model places it.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import numpy.typing as npt

from ..errors import LoadError

Array = npt.NDArray[np.float64]

_NAMELESS = ("", "MuJoCo Model")  # what it calls models that are not named
_UNKNOWN = 1e9  # a limit that the model does not have: no limit
_SAID = "{:.12g}".format


def urdf_of_mjcf(path: Path, meshes: Path | None = None) -> str:
    """The text.

    Args:
        path: The MJCF.
        meshes: Folder for the meshes of its geometry; without it, meshes are left out.

    Raises:
        LoadError: MuJoCo is not installed or refuses the file, or a joint is a ball.
    """
    return _Writer(model_of_mjcf(path), path, meshes).text()


def model_of_mjcf(source: Path | str) -> Any:
    """MuJoCo's model of a file, or of XML text.

    Raises:
        LoadError: MuJoCo is not installed or refuses the file.
    """
    name = source if isinstance(source, Path) else "the text"
    try:
        import mujoco
    except ImportError as error:
        raise LoadError(f"{name} is MJCF: pip install mujoco") from error
    try:
        if isinstance(source, Path):
            return mujoco.MjModel.from_xml_path(str(source))
        return mujoco.MjModel.from_xml_string(source)
    except (ValueError, RuntimeError) as error:
        said = " ".join(str(error).split())
        raise LoadError(f"{name}: MuJoCo cannot read it: {said}") from error


class _Writer:
    """Writer of one model's URDF."""

    def __init__(self, model: Any, path: Path, meshes: Path | None) -> None:
        import mujoco

        self._mj, self._model, self._path, self._meshes = mujoco, model, path, meshes
        named = model.names.partition(b"\0")[0].decode()
        self._robot = Element("robot", name=path.stem if named in _NAMELESS else named)
        self._written: set[int] = set()  # meshes

    def text(self) -> str:
        """All of it."""
        links = {0: "world"}
        self._link("world", 0)
        for body in range(1, self._model.nbody):
            links[body] = self._body(body, links[int(self._model.body_parentid[body])])
        self._sites(links)
        self._couple()
        ElementTree.indent(self._robot)
        return ElementTree.tostring(self._robot, encoding="unicode")

    def _body(self, body: int, parent: str) -> str:
        """A body and the joints that move it, which follow one another by links without mass."""
        model = self._model
        name = self._name("mjOBJ_BODY", body, "body")
        xyz, rotation = model.body_pos[body].copy(), _matrix(self._mj, model.body_quat[body])
        first = int(model.body_jntadr[body])
        moving = [j for j in range(first, first + int(model.body_jntnum[body])) if self._moves(j)]
        at = np.zeros(3)  # of the last joint's anchor in the body's frame
        for j in moving:
            joint = self._name("mjOBJ_JOINT", j, "joint")
            step, at = model.jnt_pos[j] - at, model.jnt_pos[j].copy()
            end = name if j == moving[-1] and not at.any() else f"{name}/{joint}"
            slides = model.jnt_type[j] == self._mj.mjtJoint.mjJNT_SLIDE
            axis, begin = model.jnt_axis[j], float(model.qpos0[model.jnt_qposadr[j]])
            xyz = xyz + rotation @ (step - begin * axis * slides)
            if not slides:
                rotation = rotation @ _turn(self._mj, axis, -begin)
            element = self._joint(joint, "prismatic" if slides else "revolute", parent, end)
            _origin(element, xyz, rotation)
            SubElement(element, "axis", xyz=_numbers(axis))
            self._limit(element, j, slides)
            if end != name:
                SubElement(self._robot, "link", name=end)
            parent, xyz, rotation = end, np.zeros(3), np.eye(3)
        if parent != name:
            _origin(self._joint(f"{name}/fixed", "fixed", parent, name), xyz - at, rotation)
        self._link(name, body)
        return name

    def _sites(self, links: dict[int, str]) -> None:
        """Sites that have names, as links without mass: goals are often given for them."""
        model = self._model
        for s in range(model.nsite):
            name = self._mj.mj_id2name(model, self._mj.mjtObj.mjOBJ_SITE, s)
            body = int(model.site_bodyid[s])
            if not name or body == 0:
                continue
            link = f"{name}/site" if name in links.values() else str(name)
            rotation = _matrix(self._mj, model.site_quat[s])
            joint = self._joint(f"{name}/fixed_site", "fixed", links[body], link)
            _origin(joint, model.site_pos[s], rotation)
            SubElement(self._robot, "link", name=link)

    def _moves(self, j: int) -> bool:
        kinds = self._mj.mjtJoint
        if self._model.jnt_type[j] == kinds.mjJNT_BALL:
            name = self._name("mjOBJ_JOINT", j, "joint")
            raise LoadError(f"{self._path}: joint {name!r} is a ball, which no single number moves")
        return bool(self._model.jnt_type[j] != kinds.mjJNT_FREE)

    def _joint(self, name: str, kind: str, parent: str, child: str) -> Element:
        element = SubElement(self._robot, "joint", name=name, type=kind)
        SubElement(element, "parent", link=parent)
        SubElement(element, "child", link=child)
        return element

    def _limit(self, element: Element, j: int, slides: bool) -> None:
        """Positions as far as they are limited, forces as far as actuators are; speeds never."""
        model = self._model
        low, high = model.jnt_range[j] if model.jnt_limited[j] else (-_UNKNOWN, _UNKNOWN)
        if not model.jnt_limited[j] and not slides:
            element.set("type", "continuous")
        effort = model.jnt_actfrcrange[j][1] if model.jnt_actfrclimited[j] else self._force(j)
        said = {"lower": low, "upper": high, "effort": effort, "velocity": _UNKNOWN}
        SubElement(element, "limit", {key: _SAID(value) for key, value in said.items()})

    def _force(self, j: int) -> float:
        """The most that the actuators of a joint give it."""
        model, most = self._model, 0.0
        for a in range(model.nu):
            of_joint = model.actuator_trntype[a] == self._mj.mjtTrn.mjTRN_JOINT
            if of_joint and model.actuator_trnid[a][0] == j and model.actuator_forcelimited[a]:
                most += float(abs(model.actuator_gear[a][0]) * model.actuator_forcerange[a][1])
        return most or _UNKNOWN

    def _link(self, name: str, body: int) -> None:
        link, model = SubElement(self._robot, "link", name=name), self._model
        mass = float(model.body_mass[body])
        if mass > 0.0:
            inertial = SubElement(link, "inertial")
            _origin(inertial, model.body_ipos[body], _matrix(self._mj, model.body_iquat[body]))
            SubElement(inertial, "mass", value=_SAID(mass))
            xx, yy, zz = map(_SAID, model.body_inertia[body])
            SubElement(inertial, "inertia", ixx=xx, iyy=yy, izz=zz, ixy="0", ixz="0", iyz="0")
        for g in range(model.ngeom):
            if model.geom_bodyid[g] == body and (
                model.geom_contype[g] or model.geom_conaffinity[g]
            ):
                self._geom(link, g)

    def _geom(self, link: Element, g: int) -> None:
        """A shape that may touch; planes and height fields are the world's."""
        model, kinds = self._model, self._mj.mjtGeom
        size, kind = model.geom_size[g], kinds(int(model.geom_type[g]))
        xyz, rotation = model.geom_pos[g], _matrix(self._mj, model.geom_quat[g])
        if kind == kinds.mjGEOM_CAPSULE:
            self._shape(link, xyz, rotation, "cylinder", radius=size[0], length=2.0 * size[1])
            for end in (-size[1], size[1]):
                self._shape(link, xyz + end * rotation[:, 2], rotation, "sphere", radius=size[0])
        elif kind == kinds.mjGEOM_SPHERE:
            self._shape(link, xyz, rotation, "sphere", radius=size[0])
        elif kind == kinds.mjGEOM_CYLINDER:
            self._shape(link, xyz, rotation, "cylinder", radius=size[0], length=2.0 * size[1])
        elif kind in (kinds.mjGEOM_BOX, kinds.mjGEOM_ELLIPSOID):  # an ellipsoid fits in its box
            self._shape(link, xyz, rotation, "box", size=_numbers(2.0 * size))
        elif kind == kinds.mjGEOM_MESH and self._meshes is not None:
            file = self._mesh(int(model.geom_dataid[g]), self._meshes)
            self._shape(link, xyz, rotation, "mesh", filename=str(file))

    def _shape(
        self, link: Element, xyz: Array, rotation: Array, tag: str, **said: float | str
    ) -> None:
        collision = SubElement(link, "collision")
        _origin(collision, xyz, rotation)
        texts = {k: v if isinstance(v, str) else _SAID(v) for k, v in said.items()}
        SubElement(SubElement(collision, "geometry"), tag, texts)

    def _mesh(self, m: int, folder: Path) -> Path:
        """A file of a mesh as MuJoCo has it, its own pose taken off."""
        import trimesh

        model, file = self._model, (folder / f"mesh{m}.stl").resolve()
        if m not in self._written:
            self._written.add(m)
            first, count = int(model.mesh_vertadr[m]), int(model.mesh_vertnum[m])
            begin, faces = int(model.mesh_faceadr[m]), int(model.mesh_facenum[m])
            vertices = model.mesh_vert[first : first + count].astype(np.float64)
            triangles = model.mesh_face[begin : begin + faces].astype(np.int64)
            trimesh.Trimesh(vertices, triangles, process=False).export(file)
        return file

    def _couple(self) -> None:
        """Joints that follow another one, where the equality is a line."""
        model = self._model
        elements = {e.get("name"): e for e in self._robot.findall("joint")}
        for e in range(model.neq):
            of_joints = model.eq_type[e] == self._mj.mjtEq.mjEQ_JOINT
            one, other = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
            curve = model.eq_data[e][:5]
            if not of_joints or other < 0 or curve[2:].any() or not model.eq_active0[e]:
                continue
            begin, of_other = (float(model.qpos0[model.jnt_qposadr[j]]) for j in (one, other))
            name, leader = (self._name("mjOBJ_JOINT", j, "joint") for j in (one, other))
            SubElement(
                elements[name],
                "mimic",
                joint=leader,
                multiplier=_SAID(curve[1]),
                offset=_SAID(begin + curve[0] - curve[1] * of_other),
            )

    def _name(self, kind: str, number: int, word: str) -> str:
        named = self._mj.mj_id2name(self._model, getattr(self._mj.mjtObj, kind), number)
        return str(named) if named else f"{word}{number}"


def _matrix(mj: Any, quaternion: Array) -> Array:
    found = np.zeros(9)
    mj.mju_quat2Mat(found, quaternion)
    return found.reshape(3, 3)


def _turn(mj: Any, axis: Array, angle: float) -> Array:
    quaternion = np.zeros(4)
    mj.mju_axisAngle2Quat(quaternion, axis, angle)
    return _matrix(mj, quaternion)


def _origin(element: Element, xyz: Array, rotation: Array) -> None:
    pitch = np.arctan2(-rotation[2, 0], np.hypot(rotation[0, 0], rotation[1, 0]))
    if np.cos(pitch) > 1e-9:
        roll = np.arctan2(rotation[2, 1], rotation[2, 2])
        yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
    else:  # roll and yaw turn about one axis
        roll, yaw = 0.0, np.arctan2(-rotation[0, 1], rotation[1, 1])
    SubElement(element, "origin", xyz=_numbers(xyz), rpy=_numbers(np.array([roll, pitch, yaw])))


def _numbers(values: Array) -> str:
    return " ".join(map(_SAID, values))
