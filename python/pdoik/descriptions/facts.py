"""Joints and links of a robot's description, URDF or MJCF, with limits, types and masses."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from ..errors import LoadError
from .xml import UrdfJoint, urdf_joints


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
        """Mass of the joint's link and all after it [kg]."""
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

    @property
    def root(self) -> str:
        """The first link, or the body that an MJCF lets float."""
        free = [link for link in self.free if self.parents.get(link, "world") in ("world", "")]
        if free:
            return free[0]
        first = [link for link in self.masses if link not in self.parents and link != "world"]
        if not first:  # MJCF whose first body is fixed to the world
            first = [link for link, parent in self.parents.items() if parent == "world"]
        return first[0]

    def chain(self, link: str) -> list[str]:
        """The link and those before it, to the base."""
        chain = [link]
        while chain[-1] in self.parents and len(chain) <= len(self.masses):
            chain.append(self.parents[chain[-1]])
        return chain


def facts_of_urdf(path: Path, root: Element) -> RobotFacts:
    """Facts of a URDF's tree.

    Raises:
        LoadError: A number or an end of a joint is missing or wrong.
    """
    try:
        joints = list(urdf_joints(root))
        moving = [each for each in joints if each.type in ("revolute", "continuous", "prismatic")]
        return RobotFacts(
            path=path,
            joints={
                each.name: JointFacts(
                    name=each.name,
                    type=each.type,
                    link=each.child,
                    lower=-np.inf if _is_endless(each) else each.limit("lower") or 0.0,
                    upper=np.inf if _is_endless(each) else each.limit("upper") or 0.0,
                    effort=each.limit("effort") or None,
                )
                for each in moving
            },
            masses={link.get("name", ""): _mass(link) for link in root.findall("link")},
            parents={each.child: each.parent for each in joints},
            free={each.child: each.name for each in joints if each.type in ("floating", "planar")},
            leaders={each.name: each.leader for each in moving if each.leader is not None},
        )
    except LoadError as error:
        raise LoadError(f"{path.name}: {error}") from error


def _is_endless(joint: UrdfJoint) -> bool:
    """Whether nothing limits how far a joint goes."""
    return joint.type == "continuous" or joint.element.find("limit") is None


def _mass(link: Element) -> float:
    element = link.find("inertial/mass")
    written = "0" if element is None else element.get("value", "0")
    try:
        return float(written)
    except ValueError as error:
        where = f"link {link.get('name', '')!r}: mass"
        raise LoadError(f"{where}: value={written!r} is no number") from error


def facts_of_mjcf(path: Path, model: Any) -> RobotFacts:
    """Facts of MuJoCo's model of an MJCF."""
    import mujoco

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
