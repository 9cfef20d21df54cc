"""Which bodies of a MuJoCo model are the robot."""

from __future__ import annotations

from typing import Any

from pdoik.scenes.own_links import OwnLinks


def own_bodies(model: Any, bodies: list[str], joints: list[str], own: OwnLinks | None) -> set[int]:
    """The bodies that the robot's joints move, its base link, and what hangs on these.

    What carries its first joint is its own too, and above it what it has hulls for. By chance a
    name is in two files: the robot is there if half of its joints or of the links they move are.

    Args:
        model: MuJoCo's.
        bodies: Their names, in order.
        joints: Theirs.
        own: The robot's; None for none.
    """
    if own is None or not (own.is_half_of(own.joints, joints) or own.is_half_of(own.moved, bodies)):
        return set()
    moved = {b for b, name in enumerate(bodies) if b and name in own.moved}
    moved |= {int(model.jnt_bodyid[j]) for j, name in enumerate(joints) if name in own.joints}
    base = {b for b, name in enumerate(bodies) if b and name == own.base_link}
    carrying = {int(model.body_parentid[b]) for b in moved}
    filled = {b for b, name in enumerate(bodies) if name in own.still & own.hulls}
    above = {b for b in filled if any(_is_below(model, m, b) for m in moved)}
    return (with_all_below(model, moved | base) | carrying | above) - {0}


def with_all_below(model: Any, bodies: set[int]) -> set[int]:
    """These and what hangs on them; MuJoCo has parents before their children."""
    found = bodies - {0}
    for b in range(1, model.nbody):
        if int(model.body_parentid[b]) in found:
            found.add(b)
    return found


def _is_below(model: Any, body: int, above: int) -> bool:
    while body:
        body = int(model.body_parentid[body])
        if body == above:
            return True
    return False
