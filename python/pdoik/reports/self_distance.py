"""How near a robot's links are to one another, from its description and hulls alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from .._core import Robot
from .contacts import Wanted
from .convex import apart
from .kinematics import Kinematics
from .link_bodies import LinkBodies
from .robot import JOINT_TYPES
from .values import FloatArray

_STILL = 1e-10  # a point that moves by less between random configurations does not move [m]


class Capsule(NamedTuple):
    """What lies within a radius of a segment of a link; a ball if its ends are one point."""

    link: str
    a: tuple[float, float, float]
    b: tuple[float, float, float]
    radius: float


class SelfDistance:
    """Distances between hulls that are neither on one link nor on links that are joined.

    A hull whose axis is that of a joint moves with the links on both sides of it, and counts as on
    either; links that fixed joints hold together are one.

    Args:
        robot: Its description.
        kinematics: Its own.
        capsules: Its hulls.
        wanted: What distance is wanted of two links.
        default: Of those of which nothing is said [m].
        own: Links themselves, which decide where capsules are nearer than wanted.
    """

    def __init__(
        self,
        robot: Robot,
        kinematics: Kinematics,
        capsules: Sequence[Capsule],
        wanted: Wanted,
        default: float,
        own: LinkBodies,
    ) -> None:
        _, links, joints, base, *_ = robot.__getstate__()
        self.capsules, self._own = capsules, own
        body = {link[0]: link[0] for link in links}  # the links that are rigid to each other
        for joint in joints:
            if JOINT_TYPES[joint[1]] == "fixed":
                old, new = body[joint[3]], body[joint[2]]
                body = {link: new if at == old else at for link, at in body.items()}
        next_to: dict[str, set[str]] = {at: set() for at in body.values()}
        for joint in joints:
            parent, child = body[joint[2]], body[joint[3]]
            if parent != child:
                next_to[parent].add(child)
                next_to[child].add(parent)
        to_base = {body[base]: body[base]}
        queue = [body[base]]
        for at in queue:
            new_ones = next_to[at] - to_base.keys()
            to_base |= dict.fromkeys(new_ones, at)
            queue += sorted(new_ones)
        rng = np.random.default_rng(1)
        seen = [kinematics.poses(rng.uniform(-1, 1, robot.dof)) for _ in range(4)]
        on = [self._moves_with(each, body[each.link], to_base, seen) for each in capsules]
        self._pairs, self._wanted = [], []
        of_links: dict[tuple[str, str], float] = {}
        for i in range(len(capsules)):
            for j in range(i):
                if any(x == y or y in next_to[x] for x in on[i] for y in on[j]):
                    continue
                pair = (capsules[i].link, capsules[j].link)
                if pair not in of_links:
                    of_links[pair] = wanted.of(pair[:1], pair[1:], default)
                if of_links[pair] > -np.inf:
                    self._pairs.append((i, j))
                    self._wanted.append(of_links[pair])

    @staticmethod
    def _moves_with(
        capsule: Capsule,
        at: str,
        to_base: Mapping[str, str],
        seen: Sequence[Mapping[str, FloatArray]],
    ) -> list[str]:
        """The body of its link, and those towards the base that it is rigid to as well."""
        bodies = [at]
        while to_base[at] != at:
            at = to_base[at]
            local = [
                np.linalg.inv(poses[at]) @ poses[capsule.link] @ [*point, 1.0]
                for point in (capsule.a, capsule.b)
                for poses in seen
            ]
            moved = np.ptp(np.reshape(local, (2, len(seen), 4)), axis=1)
            if moved.max() > _STILL:
                break
            bodies.append(at)
        return bodies

    def __call__(self, poses: Mapping[str, FloatArray]) -> tuple[float, float, bool]:
        """The least of them, and the least beyond what is wanted; infinite without any [m].

        And whether links themselves said so.
        """
        if not self._pairs:
            return np.inf, np.inf, False
        ends = np.array(
            [
                [(poses[each.link] @ [*point, 1.0])[:3] for point in (each.a, each.b)]
                for each in self.capsules
            ]
        )
        i, j = np.array(self._pairs).T
        radii = np.array([each.radius for each in self.capsules])
        middle, half = ends.mean(axis=1), 0.5 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        away = np.linalg.norm(middle[i] - middle[j], axis=1)
        bound = away - (half + radii)[i] - (half + radii)[j]  # it is no less
        wanted = np.array(self._wanted)
        least = room = np.inf
        own: dict[tuple[str, str], float] = {}  # of two links
        for k in np.argsort(bound - np.maximum(wanted, 0.0)):
            if bound[k] >= least and bound[k] - wanted[k] >= room:
                continue
            gap = float(_between(*ends[i[k]], *ends[j[k]]) - radii[i[k]] - radii[j[k]])
            if self._own and gap < wanted[k]:
                links = self.capsules[i[k]].link, self.capsules[j[k]].link
                if links not in own:
                    a, b = (self._own(link, poses) for link in links)
                    own[links] = min(apart(x, y, float(wanted[k])) for x in a for y in b)
                gap = max(gap, own[links])
            least, room = min(least, gap), min(room, gap - float(wanted[k]))
        return least, room, bool(own)


def _between(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> float:
    """Distance of two segments: where both run on, or from an end of one of them [m]."""
    u, v, w = b - a, d - c, a - c
    ends = [_to_segment(p, c, d) for p in (a, b)] + [_to_segment(p, a, b) for p in (c, d)]
    uu, uv, vv = u @ u, u @ v, v @ v
    determinant = uu * vv - uv * uv
    if determinant > 1e-12 * uu * vv:
        s = (uv * (v @ w) - vv * (u @ w)) / determinant
        t = (uu * (v @ w) - uv * (u @ w)) / determinant
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            ends.append(float(np.linalg.norm(w + s * u - t * v)))
    return min(ends)


def _to_segment(p: FloatArray, a: FloatArray, b: FloatArray) -> float:
    along = b - a
    t = np.clip((p - a) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
    return float(np.linalg.norm(p - a - t * along))
