"""What the study's checks need to know of a robot's description, URDF or MJCF."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pdoik._nearest import nearest
from pdoik.errors import LoadError
from pdoik.recordings import FloatArray


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
    free: dict[str, str] = field(default_factory=dict)  # joint by the link it lets float or glide
    leaders: dict[str, str] = field(default_factory=dict)  # joint that each follower follows
    notes: tuple[str, ...] = field(default=())

    def mass_moved_by(self, joint: str) -> float:
        """Of the joint's link and all after it [kg]."""
        moved = self.joints[joint].link
        return sum(mass for link, mass in self.masses.items() if moved in self.chain(link))

    @property
    def arm(self) -> tuple[str, ...]:
        """The joints from the base on, up to where those beyond are on several links: in order."""
        moving: dict[str, list[str]] = {}  # by the link, which may have several
        for name, facts in self.joints.items():
            if name not in self.leaders:
                moving.setdefault(facts.link, []).append(name)
        ahead: dict[str, list[str]] = {}  # of each such link, "" of the base, those next
        for link in moving:
            above = next((each for each in self.chain(link)[1:] if each in moving), "")
            ahead.setdefault(above, []).append(link)
        found: list[str] = []
        link = ""
        while len(following := ahead.get(link, [])) == 1:
            (link,) = following
            found += moving[link]
        return tuple(found)

    def chain(self, link: str) -> list[str]:
        """The link and those before it, to the base."""
        chain = [link]
        while chain[-1] in self.parents and len(chain) <= len(self.masses):
            chain.append(self.parents[chain[-1]])
        return chain


def robot_facts(path: Path) -> RobotFacts:
    """Facts from a URDF or MJCF file, distinguished by their root element.

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


def check_robot(
    facts: RobotFacts, joints: Collection[str], tip: str | None, *, floats: bool = False
) -> tuple[str, ...]:
    """That the description has the joints and the tip, and mass behind every joint.

    Args:
        facts: Of the description.
        joints: Of the study.
        tip: Of the study.
        floats: Whether the study says that the base does.

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
        for above in facts.chain(link):
            root = facts.parents.get(above, "world") == "world"
            if above in facts.free and not (floats and root):
                raise LoadError(
                    f"{facts.path.name}: joint {joint!r} is on link {above!r}, which joint"
                    f" {facts.free[above]!r} lets float: say 'base:' in the study and record how it"
                    " moved (an IMU's gyro and acc, or the base's pose), or give a description"
                    " whose base is fixed as it was"
                )
        if not facts.mass_moved_by(joint) > 0:
            notes.append(
                f"joint {joint} moves no mass in the robot's description: of its load nothing is"
                " predicted"
            )
        elif facts.masses.get(link, 0.0) == 0:
            notes.append(f"link {link} has no mass in the robot's description")
    if not any(facts.mass_moved_by(joint) > 0 for joint in joints):
        raise LoadError(
            f"{facts.path.name}: none of the joints {', '.join(joints)} moves any mass, expected"
            " links with <inertial>"
        )
    notes += _held(facts, joints)
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


_NAMED = 6  # joints in one note


def _held(facts: RobotFacts, joints: Collection[str]) -> list[str]:
    """Notes on joints of the description that the study does not list."""
    notes = [
        f"joint {name} follows joint {leader} in the robot's description, but is held at its zero"
        " here"
        for name, leader in facts.leaders.items()
        if name in facts.joints and name not in joints
    ]
    others = [name for name in facts.joints if name not in joints and name not in facts.leaders]
    if others:
        more = f" and {len(others) - _NAMED} more" if len(others) > _NAMED else ""
        notes.append(f"not in the study, so held at zero: joint {', '.join(others[:_NAMED])}{more}")
    return notes


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
    free: dict[str, str] = {}
    leaders: dict[str, str] = {}
    for joint in root.findall("joint"):
        name, kind = joint.get("name", ""), joint.get("type", "")
        parent, child = joint.find("parent"), joint.find("child")
        if parent is None or child is None:
            raise LoadError(f"{path.name}: joint {name!r}: expected <parent> and <child>")
        link = child.get("link", "")
        parents[link] = parent.get("link", "")
        if kind in ("floating", "planar"):
            free[link] = name
        if kind not in ("revolute", "continuous", "prismatic"):
            continue
        mimic = joint.find("mimic")
        if mimic is not None:
            leaders[name] = mimic.get("joint", "")
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
    return RobotFacts(
        path=path, joints=joints, masses=masses, parents=parents, free=free, leaders=leaders
    )


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
    joints, free = {}, {}
    for k in range(model.njnt):
        kind = kinds.get(int(model.jnt_type[k]))
        if kind is None:
            free[bodies[model.jnt_bodyid[k]]] = model.joint(k).name or f"joint {k}"
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
        free=free,
    )
