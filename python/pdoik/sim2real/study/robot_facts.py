"""What the study's checks need to know of a robot's description, URDF or MJCF."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pdoik.errors import LoadError

from .columns import nearest
from .recording import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFacts:
    """A joint that can move."""

    name: str
    type: str  # revolute, continuous or prismatic
    link: str  # the link it moves
    lower: float = -np.inf
    upper: float = np.inf
    effort: float | None = None  # limit [N m], None: not said
    armature: float = 0.0  # [kg m^2]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFacts:
    """Joints and links by name."""

    path: Path
    joints: dict[str, JointFacts]
    masses: dict[str, float]  # of each link [kg]
    parents: dict[str, str]  # link before each link
    frames: tuple[str, ...] = ()  # other names that may be the tip
    notes: tuple[str, ...] = field(default=())

    def mass_moved_by(self, joint: str) -> float:
        """Of the joint's link and all after it [kg]."""
        return sum(
            mass for link, mass in self.masses.items() if self.joints[joint].link in self._up(link)
        )

    def _up(self, link: str) -> list[str]:
        chain = [link]
        while chain[-1] in self.parents and len(chain) <= len(self.masses):
            chain.append(self.parents[chain[-1]])
        return chain


def robot_facts(path: Path) -> RobotFacts:
    """Facts from a URDF or MJCF file, told apart by their root element.

    Raises:
        LoadError: no such file, no XML, or neither of the two.
    """
    if not path.is_file():
        beside = [each.name for each in path.parent.iterdir()] if path.parent.is_dir() else []
        raise LoadError(f"robot: no such file: {path}{nearest(path.name, beside)}")
    try:
        root = ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, OSError, ValueError) as error:
        raise LoadError(f"{path.name}: no XML: {error}") from error
    if root.tag == "robot":
        return _from_urdf(path, root)
    if root.tag == "mujoco":
        return _from_mjcf(path)
    raise LoadError(f"{path.name}: expected a URDF (<robot>) or MJCF (<mujoco>), got <{root.tag}>")


def check_robot(facts: RobotFacts, joints: Collection[str], tip: str | None) -> tuple[str, ...]:
    """That the description has the joints and the tip, and mass behind every joint.

    Returns:
        Notes on links without mass.

    Raises:
        LoadError: it has not.
    """
    notes = []
    for joint in joints:
        if joint not in facts.joints:
            raise LoadError(
                f"{facts.path.name}: no joint {joint!r} that moves{nearest(joint, facts.joints)}"
            )
        link = facts.joints[joint].link
        mass = facts.mass_moved_by(joint)
        if not mass > 0:
            raise LoadError(
                f"{facts.path.name}: joint {joint!r} moves a mass of {mass:g} kg (link {link!r} and"
                " all after it), expected more than 0"
            )
        if facts.masses.get(link, 0.0) == 0:
            notes.append(f"link {link} has no mass in the robot's description")
    negative = [link for link, mass in facts.masses.items() if mass < 0]
    if negative:
        mass = facts.masses[negative[0]]
        raise LoadError(f"{facts.path.name}: link {negative[0]!r} has a mass of {mass:g} kg")
    known = (*facts.masses, *facts.frames)
    if tip is not None and tip not in known:
        raise LoadError(
            f"{facts.path.name}: no link {tip!r} (the study's tip){nearest(tip, known)}"
        )
    return tuple(notes)


def armatures(facts: RobotFacts, joints: tuple[str, ...]) -> FloatArray | None:
    """The rotors' inertias that the description gives, (n,), None if it gives none."""
    values = np.array([facts.joints[joint].armature for joint in joints])
    return values if values.any() else None


def _from_urdf(path: Path, root: ElementTree.Element) -> RobotFacts:
    masses = {}
    for element in root.findall("link"):
        name = element.get("name", "")
        mass = element.find("inertial/mass")
        masses[name] = _number(path, mass, "value", f"link {name!r}: mass")
    joints, parents = {}, {}
    for joint in root.findall("joint"):
        name, kind = joint.get("name", ""), joint.get("type", "")
        parent, child = joint.find("parent"), joint.find("child")
        if parent is None or child is None:
            raise LoadError(f"{path.name}: joint {name!r}: expected <parent> and <child>")
        link = child.get("link", "")
        parents[link] = parent.get("link", "")
        if kind not in ("revolute", "continuous", "prismatic"):
            continue
        limit = joint.find("limit")
        bounded = limit is not None and kind != "continuous"
        where = f"joint {name!r}: limit"
        joints[name] = JointFacts(
            name=name,
            type=kind,
            link=link,
            lower=_number(path, limit, "lower", where) if bounded else -np.inf,
            upper=_number(path, limit, "upper", where) if bounded else np.inf,
            effort=_number(path, limit, "effort", where) or None,
        )
    return RobotFacts(path=path, joints=joints, masses=masses, parents=parents)


def _number(path: Path, element: ElementTree.Element | None, key: str, what: str) -> float:
    written = "0" if element is None else element.get(key, "0")
    try:
        return float(written)
    except ValueError as error:
        raise LoadError(f"{path.name}: {what}: {key}={written!r} is no number") from error


def _from_mjcf(path: Path) -> RobotFacts:
    import mujoco

    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise LoadError(f"{path.name}: MuJoCo cannot read it: {error}") from error
    bodies = [model.body(k).name or f"body {k}" for k in range(model.nbody)]
    hinge, slide = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE
    kinds = {int(hinge): "revolute", int(slide): "prismatic"}
    joints = {}
    for k in range(model.njnt):
        kind = kinds.get(int(model.jnt_type[k]))
        if kind is None:
            continue
        name = model.joint(k).name
        limited = bool(model.jnt_limited[k])
        forced = bool(model.jnt_actfrclimited[k])
        joints[name] = JointFacts(
            name=name,
            type=kind,
            link=bodies[model.jnt_bodyid[k]],
            lower=float(model.jnt_range[k, 0]) if limited else -np.inf,
            upper=float(model.jnt_range[k, 1]) if limited else np.inf,
            effort=float(model.jnt_actfrcrange[k, 1]) if forced else None,
            armature=float(model.dof_armature[model.jnt_dofadr[k]]),
        )
    return RobotFacts(
        path=path,
        joints=joints,
        masses={bodies[k]: float(model.body_mass[k]) for k in range(model.nbody)},
        parents={bodies[k]: bodies[model.body_parentid[k]] for k in range(1, model.nbody)},
        frames=tuple(model.site(k).name for k in range(model.nsite)),
    )
