"""Robot descriptions as MuJoCo reads them, without shapes: they may name meshes nobody has."""

from __future__ import annotations

import difflib
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import mujoco
import numpy as np

from pdoik.descriptions import pose_of, tree_of
from pdoik.errors import LoadError

from .inertial import Inertial

DROPPED_LINK_PARTS = ("visual", "collision", "inertial")
STRIPPED_GROUPS = (
    *("keys", "sensors", "actuators", "equalities", "tendons", "excludes", "pairs", "skins"),
    *("flexes", "cameras", "lights", "geoms", "sites", "meshes", "materials"),
)
KEPT_TAGS = ("link", "joint")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Description:
    """A robot's tree for MuJoCo, and its links' inertial parameters apart.

    The spec's bodies carry placeholders: MuJoCo refuses inertias that are a little off, such as
    identified ones, and would change the others' frames.
    """

    spec: Any  # mujoco.MjSpec
    inertials: dict[str, Inertial]
    format: Literal["urdf", "mjcf"]

    @property
    def joints(self) -> tuple[str, ...]:
        return tuple(joint.name for joint in self.spec.joints)

    @property
    def links(self) -> tuple[str, ...]:
        return tuple(body.name for body in self.spec.bodies)

    def links_of(self, joints: Iterable[str]) -> tuple[str, ...]:
        """The link that each joint moves."""
        moved = {joint.name: joint.parent.name for joint in self.spec.joints}
        return tuple(moved[nearest(joint, moved, "joint")] for joint in joints)


def read_description(robot: str | Path) -> Description:
    """The robot of a file, or of the text of one.

    Raises:
        LoadError: it cannot be read as a URDF or MJCF.
    """
    root = tree_of(robot)
    try:
        if root.tag == "robot":
            return _from_urdf(root)
        if root.tag == "mujoco":
            return _from_mjcf(robot)
    except ValueError as error:
        raise LoadError(f"robot: {error}") from None
    raise LoadError(f"robot: expected a URDF or an MJCF, got an element <{root.tag}>")


def nearest(name: str, names: Iterable[str], what: str) -> str:
    """`name` if it is among the names.

    Raises:
        ValueError: it is not; the message says which comes nearest.
    """
    names = tuple(names)
    if name in names:
        return name
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.0)
    raise ValueError(f"the robot has no {what} {name!r}" + (f", nearest: {near[0]!r}" * bool(near)))


def urdf_inertial(link: ElementTree.Element) -> Inertial:
    """Inertial parameters of a URDF's <link>, in the link's frame.

    Raises:
        ValueError: a figure is missing or no number.
    """
    element = link.find("inertial")
    if element is None:
        return Inertial.nothing()
    try:
        T_link_com, mass, given = pose_of(element), element.find("mass"), element.find("inertia")
        value = 0.0 if mass is None else float(mass.get("value", ""))
        I = np.zeros((3, 3))  # noqa: E741
        if given is not None:
            for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
                I[i, j] = I[j, i] = float(given.get("i" + "xyz"[i] + "xyz"[j], 0.0))
    except ValueError as error:
        raise ValueError(f"inertial of link {link.get('name', '')}: {error}") from None
    R = T_link_com[:3, :3]
    return Inertial.about_com(value, T_link_com[:3, 3], R @ I @ R.T)


def _from_urdf(root: ElementTree.Element) -> Description:
    inertials = {link.get("name", ""): urdf_inertial(link) for link in root.findall("link")}
    bare = ElementTree.Element("robot", {"name": root.get("name", "robot")})
    settings = ElementTree.SubElement(bare, "mujoco")
    ElementTree.SubElement(settings, "compiler", {"fusestatic": "false"})
    bare.extend(element for element in root if element.tag in KEPT_TAGS)
    for link in bare.findall("link"):
        for element in [part for part in link if part.tag in DROPPED_LINK_PARTS]:
            link.remove(element)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(bare, encoding="unicode"))
    return _strip(spec, inertials, "urdf")


def _from_mjcf(robot: str | Path) -> Description:
    if isinstance(robot, Path):
        spec = mujoco.MjSpec.from_file(str(robot))
    else:
        spec = mujoco.MjSpec.from_string(robot)
    for k, body in enumerate(spec.bodies):
        body.name = body.name or f"body_{k}"
    for geom in [geom for geom in spec.geoms if geom.parent.explicitinertial]:
        spec.delete(geom)  # its mesh may be missing; what gives a body its mass must stay
    for mesh in set(spec.meshes) - {spec.mesh(geom.meshname) for geom in spec.geoms}:
        spec.delete(mesh)
    for group in (spec.skins, spec.textures, spec.hfields):
        for element in list(group):
            spec.delete(element)
    model = spec.compile()
    inertials = {}
    for body in spec.bodies[1:]:
        k = model.body(body.name).id
        R = np.empty(9)
        mujoco.mju_quat2Mat(R, model.body_iquat[k])
        axes = R.reshape(3, 3)
        about_com = axes @ np.diag(model.body_inertia[k]) @ axes.T
        inertials[body.name] = Inertial.about_com(
            float(model.body_mass[k]), model.body_ipos[k], about_com
        )
    return _strip(spec, inertials, "mjcf")


def _strip(spec: Any, inertials: dict[str, Inertial], form: Literal["urdf", "mjcf"]) -> Description:
    """Leave links and joints only."""
    for group in STRIPPED_GROUPS:
        for element in list(getattr(spec, group)):
            spec.delete(element)
    for body in spec.bodies[1:]:
        body.explicitinertial = True
        # Neither at the origin nor along the axes: MuJoCo takes no shortcut that true values break.
        body.mass, body.ipos, body.inertia = 1.0, (0.1, 0.2, 0.3), (1.0, 1.1, 1.2)
        body.iquat = (0.5, 0.5, 0.1, 0.7)
        body.fullinertia = [np.nan] * 6
        body.gravcomp = 0.0
        inertials.setdefault(body.name, Inertial.nothing())
    return Description(spec=spec, inertials=inertials, format=form)
