"""Whether a robot's description fits a study: its joints, its tip, and mass behind each joint."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from pdoik._nearest import nearest
from pdoik.descriptions import RobotFacts
from pdoik.errors import LoadError
from pdoik.recordings import FloatArray


def check_robot(
    facts: RobotFacts, joints: Collection[str], tip: str | None, *, floats: bool = False
) -> tuple[str, ...]:
    """Check that the description has the joints and the tip, and mass behind every joint.

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


_NAMED = 6  # numerics: joints in one note


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
