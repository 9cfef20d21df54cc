"""MJCF text of a compiled model, to the last digit: MuJoCo's own writer rounds to six."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from .assemble import HINGE, SLIDE
from .description import Description, read_description
from .plant import build_plant


def flat_mjcf(robot: Path) -> str:
    """An MJCF's links and joints in one text, without shapes and what belongs to a scene."""
    described = read_description(robot)
    joints = movable_joints(described)
    return mjcf_text(build_plant(robot, joints).model)


def movable_joints(described: Description) -> tuple[str, ...]:
    """Joints with one degree of freedom."""
    joints = described.spec.joints
    return tuple(joint.name for joint in joints if int(joint.type) in (SLIDE, HINGE))


def mjcf_text(
    model: Any,
    *,
    comment: Iterable[str] = (),
    actuators: Iterable[dict[str, str]] = (),
    timestep: float = 1e-3,
) -> str:
    """Links, joints with their figures, gravity and actuators.

    Args:
        model: mujoco.MjModel; its geoms, sites and tendons are left out.
        comment: Lines at the top.
        actuators: Attributes of <general> elements.
        timestep: [s].
    """
    root = ElementTree.Element("mujoco", {"model": "pdoik"})
    lines = [line.replace("--", "- -") for line in comment]
    if lines:
        root.append(ElementTree.Comment("\n" + "".join(f"    {line}\n" for line in lines) + "  "))
    compiler = {"angle": "radian", "autolimits": "true"}
    if _some_inertia_is_odd(model):
        compiler["balanceinertia"] = "true"
    if _some_moves_no_mass(model):
        compiler |= {"boundmass": "1e-6", "boundinertia": "1e-9"}
    ElementTree.SubElement(root, "compiler", compiler)
    ElementTree.SubElement(
        root,
        "option",
        {
            "timestep": repr(timestep),
            "integrator": "implicitfast",
            "gravity": _text(model.opt.gravity),
        },
    )
    elements = {0: ElementTree.SubElement(root, "worldbody")}
    for k in range(1, model.nbody):
        elements[k] = _body(elements[int(model.body_parentid[k])], model, k)
    for j in range(model.njnt):
        _joint(elements[int(model.jnt_bodyid[j])], model, j)
    actuators = list(actuators)
    if actuators:
        group = ElementTree.SubElement(root, "actuator")
        for attributes in actuators:
            ElementTree.SubElement(group, "general", attributes)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def odd_inertias(model: Any) -> tuple[str, ...]:
    """Links whose moments of inertia break A + B >= C, which MJCF refuses."""
    I = np.sort(model.body_inertia, axis=1)  # noqa: E741
    odd = np.flatnonzero(I[:, 0] + I[:, 1] < I[:, 2] * (1.0 - 1e-12))
    return tuple(model.body(int(k)).name for k in odd)


def _some_inertia_is_odd(model: Any) -> bool:
    return bool(odd_inertias(model))


def _some_moves_no_mass(model: Any) -> bool:
    """Whether a link that a joint moves has no mass or no inertia, which MuJoCo refuses."""
    moving = model.jnt_bodyid
    return bool((model.body_mass[moving] < 1e-6).any() or (model.body_inertia[moving] < 1e-9).any())


def _body(parent: ElementTree.Element, model: Any, k: int) -> ElementTree.Element:
    body = ElementTree.SubElement(
        parent,
        "body",
        {
            "name": model.body(k).name,
            "pos": _text(model.body_pos[k]),
            "quat": _text(model.body_quat[k]),
        },
    )
    if model.body_mass[k] > 0:
        ElementTree.SubElement(
            body,
            "inertial",
            {
                "pos": _text(model.body_ipos[k]),
                "quat": _text(model.body_iquat[k]),
                "mass": _text([model.body_mass[k]]),
                "diaginertia": _text(model.body_inertia[k]),
            },
        )
    return body


def _joint(body: ElementTree.Element, model: Any, j: int) -> None:
    dof = int(model.jnt_dofadr[j])
    attributes = {
        "name": model.joint(j).name,
        "type": "hinge" if int(model.jnt_type[j]) == HINGE else "slide",
        "pos": _text(model.jnt_pos[j]),
        "axis": _text(model.jnt_axis[j]),
    }
    low, high = model.jnt_range[j]
    if low < high:
        attributes["range"] = _text((low, high))
    figures = {
        "armature": model.dof_armature[dof],
        "damping": model.dof_damping[dof],
        "frictionloss": model.dof_frictionloss[dof],
        "stiffness": model.jnt_stiffness[j],
    }
    attributes |= {name: _text([value]) for name, value in figures.items() if value}
    if model.jnt_stiffness[j]:
        attributes["springref"] = _text([model.qpos_spring[model.jnt_qposadr[j]]])
    if model.dof_frictionloss[dof]:  # or a resting joint creeps
        attributes["solreffriction"] = _text(model.dof_solref[dof])
        attributes["solimpfriction"] = _text(model.dof_solimp[dof])
    if model.jnt_limited[j]:
        attributes["solreflimit"] = _text(model.jnt_solref[j])
        attributes["solimplimit"] = _text(model.jnt_solimp[j])
    element = ElementTree.Element("joint", attributes)
    body.insert(sum(child.tag in ("inertial", "joint") for child in body), element)


def _text(values: Iterable[float]) -> str:
    return " ".join(f"{float(value):.17g}" for value in values)
