"""A body and what it must not touch as MuJoCo has them, and mink's limit that keeps these apart."""

from itertools import combinations
from typing import Any

import numpy as np

from bench.ik.goals.peers.body import MARGIN, Body

DETECTION = 0.02  # from where on something limits a step [m]
POINT = 1e-4  # radius that stands for none [m]


def model_of(mujoco: Any, body: Body) -> Any:
    """The body, and what it must not touch on bodies of their own, as mink wants them."""
    spec = mujoco.MjSpec.from_string(body.bare)
    spec.compiler.fusestatic = False
    kinds = mujoco.mjtGeom
    hull = {"contype": 3, "conaffinity": int(body.self_collision)}
    for i, (link, a, b, radius) in enumerate(body.capsules if body.has_contacts else ()):
        spec.body(body.bare_name(link)).add_geom(
            name=f"hull{i}",
            type=kinds.mjGEOM_CAPSULE,
            fromto=[*a, *b],
            size=[radius, 0.0, 0.0],
            **hull,
        )
    links = dict.fromkeys(capsule.link for capsule in body.capsules)
    apart = {frozenset(pair) for pair in body.apart}
    for one, other in combinations(links, 2):
        if body.self_collision and frozenset((one, other)) not in apart:
            spec.add_exclude(bodyname1=body.bare_name(one), bodyname2=body.bare_name(other))
    shapes = [
        (f"point{i}", point, kinds.mjGEOM_SPHERE, [POINT, 0.0, 0.0])
        for i, point in enumerate(body.points)
    ]
    if body.table is not None:
        shapes.append(("table", (0, 0, body.table), kinds.mjGEOM_PLANE, [0.0, 0.0, 1.0]))
    for name, place, kind, size in shapes:
        added = spec.worldbody.add_body(name=name, mocap=True, pos=place)
        added.add_geom(name=name, type=kind, size=size, contype=0, conaffinity=2)
    return spec.compile()


def contact_limit(mink: Any, model: Any, body: Body) -> Any:
    """That steps keep all that must not touch apart."""
    hulls: dict[str, list[str]] = {}
    for i, capsule in enumerate(body.capsules):
        hulls.setdefault(capsule.link, []).append(f"hull{i}")
    pairs = [(hulls[one], hulls[other]) for one, other in body.apart]
    others = [f"point{i}" for i in range(len(body.points))]
    others += ["table"] if body.table is not None else []
    if others:
        moved = [name for link in hulls if link not in body.still for name in hulls[link]]
        pairs.append((moved, others))
    return _ActiveRows(
        mink,
        mink.CollisionAvoidanceLimit(
            model,
            pairs,
            minimum_distance_from_collisions=MARGIN,
            collision_detection_distance=DETECTION,
        ),
    )


class _ActiveRows:
    """mink's limit without the rows of pairs that are far apart, which would bind nothing."""

    def __init__(self, mink: Any, limit: Any) -> None:
        self._constraint, self._limit = mink.Constraint, limit

    def compute_qp_inequalities(self, configuration: Any, dt: float) -> Any:
        """As mink calls it."""
        all_of = self._limit.compute_qp_inequalities(configuration, dt)
        near = np.isfinite(all_of.h)
        return self._constraint(G=all_of.G[near], h=all_of.h[near])
