"""Random robots: trees with every kind of joint, DH tables, floating and mounted bases."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import pdoik
from bench.ik.soak.robots import FloatArray, RobotSpec, Sphere, Spheroid, builtin_spec, numbers

KINDS = ("revolute", "continuous", "prismatic", "fixed")
SHARES = (0.55, 0.2, 0.15, 0.1)
FAMILIES = ("panda", "ur10", "iiwa14", "h1", "random tree", "from_dh", "floating base")
HUGE = (1e3, 1e9)  # speed limits that are none in effect [rad/s]


def draw_robot(family: str, rng: np.random.Generator, speeds: str = "usual") -> RobotSpec:
    """A robot of a family.

    Args:
        family: Of FAMILIES.
        rng: Decides everything.
        speeds: Of the limits in a random description: "usual", "none" (none wherever a description
            need not have one) or "huge".
    """
    if family == "random tree":
        return random_tree(rng, speeds)
    if family == "from_dh":
        return random_rows(rng)
    if family == "floating base":
        return floating(rng, speeds)
    return _variant(builtin_spec(family), rng)


def _variant(spec: RobotSpec, rng: np.random.Generator) -> RobotSpec:
    """A built-in robot as it comes, or seen from elsewhere, or by other tips."""
    draw = rng.random()
    if spec.name == "h1":
        if draw < 0.4:
            count = int(rng.integers(1, 5))
            tips = [str(tip) for tip in rng.permutation(spec.tip_links)[:count]]
            return replace(spec, tip_links=tips)
        if draw < 0.7:
            left, right, *elbows = spec.tip_links
            return replace(spec, base_link=left, tip_links=[right, *elbows][: rng.integers(1, 4)])
    elif draw < 0.15:
        return replace(spec, T_world_base=_random_pose(rng, 1.0).tolist())
    return spec


def floating(rng: np.random.Generator, speeds: str) -> RobotSpec:
    """A robot whose base may move within bounds."""
    names = ("panda", "ur10", "iiwa14", "h1")
    spec = random_tree(rng, speeds) if rng.random() < 0.5 else builtin_spec(str(rng.choice(names)))
    middle = rng.uniform(-0.5, 0.5, 6)
    reach = rng.uniform(0.05, 1.5, 6)
    reach[4] = rng.uniform(0.05, 1.0)
    if rng.random() < 0.2:
        reach[rng.integers(6)] = 0.0
    tips = spec.tip_links
    if spec.name == "h1":
        tips = [str(tip) for tip in rng.permutation(tips)[: rng.integers(1, 5)]]
    bounds = [(middle - reach).tolist(), (middle + reach).tolist()]
    return replace(spec, tip_links=tips, floating_base=bounds)


def random_rows(rng: np.random.Generator) -> RobotSpec:
    """A DH table, with and without limits."""
    rows: list[dict[str, Any]] = []
    for _ in range(int(rng.integers(3, 9))):
        prismatic = bool(rng.random() < 0.15)
        row: dict[str, Any] = {
            "alpha": float(rng.choice([0.0, np.pi / 2, -np.pi / 2, rng.uniform(-3, 3)])),
            "a": float(rng.choice([0.0, rng.uniform(0.05, 0.4)])),
            "d": float(rng.choice([0.0, rng.uniform(-0.4, 0.4)])),
            "theta_offset": float(rng.choice([0.0, rng.uniform(-3, 3)])),
            "prismatic": prismatic,
            "lower": -np.inf,
            "upper": np.inf,
        }
        if prismatic:
            row["lower"], row["upper"] = -rng.uniform(0.0, 0.3), rng.uniform(0.05, 0.5)
        elif rng.random() < 0.6:
            row["lower"], row["upper"] = -rng.uniform(0.3, 6.0), rng.uniform(0.3, 6.0)
        rows.append(row)
    links = [f"link{i}" for i in range(len(rows) + 1)] + ["tool"]
    ends = [(row["a"], 0.0, 0.0) for row in rows] + [(0.0, 0.0, 0.1)] * 2
    spheres, spheroids = _hulls(rng, links, ends)
    spec = RobotSpec(rows=rows, tip_links=["tool"], spheres=spheres, spheroids=spheroids)
    return _with_ignored_pairs(spec)


def random_tree(rng: np.random.Generator, speeds: str = "usual") -> RobotSpec:
    """A URDF with branches, mimic joints, any axes and origins, names in no order."""
    count = int(rng.integers(4, 13))
    names = [f"l{i}" for i in rng.permutation(count)]
    joints = [f"j{i}" for i in rng.permutation(count - 1)]
    kinds = [str(kind) for kind in rng.choice(KINDS, size=count - 1, p=SHARES)]
    if not set(kinds) - {"fixed"}:
        kinds[0] = "revolute"
    if speeds == "none" and "continuous" not in kinds:
        kinds[int(rng.integers(len(kinds)))] = "continuous"
    parents = [int(rng.integers(max(0, child - 2), child)) for child in range(1, count)]
    mimics = _mimics(rng, joints, kinds)
    ends = [(0.0, 0.0, 0.15)] * count
    parts = [_link(rng, name) for name in names]
    for child, (joint, kind) in enumerate(zip(joints, kinds, strict=True), start=1):
        parent = parents[child - 1]
        xyz = rng.uniform(-0.3, 0.3, 3) if rng.random() < 0.9 else np.zeros(3)
        ends[parent] = (float(xyz[0]), float(xyz[1]), float(xyz[2]))
        origin = f'<origin xyz="{numbers(xyz)}" rpy="{numbers(_rpy(rng))}"/>'
        body = origin + _axis(rng) + _limit(rng, kind, speeds) + mimics.get(joint, "")
        between = f'<parent link="{names[parent]}"/><child link="{names[child]}"/>'
        parts.append(f'<joint name="{joint}" type="{kind}">{between}{body}</joint>')
    text = "\n".join(str(part) for part in rng.permutation(parts))
    leaves = [names[i] for i in range(1, count) if i not in parents]
    tips = [str(tip) for tip in rng.permutation(leaves)[: rng.integers(1, 4)]]
    spheres, spheroids = _hulls(rng, names, ends, [names[parent] for parent in [0, *parents]])
    others = [name for name in names if name not in tips]
    spec = RobotSpec(
        urdf=f'<?xml version="1.0"?>\n<robot name="random">\n{text}\n</robot>',
        tip_links=tips,
        base_link=str(rng.choice(others)) if rng.random() < 0.2 else "",
        spheres=spheres,
        spheroids=spheroids,
    )
    try:
        return _with_ignored_pairs(spec)
    except pdoik.LoadError:  # a follower's limits and its leader's have nothing in common
        return random_tree(rng, speeds)


def _with_ignored_pairs(spec: RobotSpec) -> RobotSpec:
    """Those that touch in most configurations may touch, or nothing would be a solution."""
    robot = spec.make()
    if robot.dof == 0:
        raise pdoik.LoadError("nothing moves")
    pairs = pdoik.pairs_always_touching(robot, samples=100, share=0.6)
    return replace(spec, ignored_pairs=pairs)


def _mimics(rng: np.random.Generator, joints: list[str], kinds: list[str]) -> dict[str, str]:
    """Up to two joints that follow another of their kind: their <mimic> elements."""
    moving = [k for k, kind in enumerate(kinds) if kind != "fixed"]
    followers = [int(k) for k in rng.permutation(moving)[: rng.integers(0, 3)]]
    result = {}
    for k in followers:
        leaders = [j for j in moving if kinds[j] == kinds[k] and j not in followers]
        if leaders:
            leader, multiplier = joints[int(rng.choice(leaders))], rng.uniform(-1.5, 1.5)
            if rng.random() < 0.4:
                multiplier = rng.choice([-1.0, 1.0, 2.0])
            figures = f'multiplier="{float(multiplier)!r}" offset="{rng.uniform(-0.1, 0.1)!r}"'
            result[joints[k]] = f'<mimic joint="{leader}" {figures}/>'
    return result


def _limit(rng: np.random.Generator, kind: str, speeds: str) -> str:
    if kind == "fixed" or (kind == "continuous" and (speeds == "none" or rng.random() < 0.5)):
        return ""
    low, high = -rng.uniform(0.3, 6.0), rng.uniform(0.3, 6.0)
    if kind == "prismatic":
        low, high = 0.1 * low, 0.1 * high
    speed = 10 ** rng.uniform(*np.log10(HUGE)) if speeds == "huge" else rng.uniform(0.5, 4.0)
    ends = "" if kind == "continuous" else f'lower="{low!r}" upper="{high!r}" '
    return f'<limit {ends}effort="10" velocity="{float(speed)!r}"/>'


def _rpy(rng: np.random.Generator) -> FloatArray:
    rpy = rng.uniform(-np.pi, np.pi, 3)
    if rng.random() < 0.3:  # where roll and yaw turn about one line
        rpy[1] = rng.choice([-0.5, 0.0, 0.5]) * np.pi
    return rpy


def _axis(rng: np.random.Generator) -> str:
    axis = rng.normal(size=3)
    if rng.random() < 0.5:
        axis = np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    return f'<axis xyz="{numbers(axis / np.linalg.norm(axis))}"/>'


def _link(rng: np.random.Generator, name: str) -> str:
    mass = rng.uniform(0.1, 5.0)
    a, b, c = mass * rng.uniform(0.01, 0.2, 3) ** 2
    inertia = f'ixx="{b + c}" iyy="{a + c}" izz="{a + b}" ixy="0" ixz="0" iyz="0"'
    at = f'<origin xyz="{numbers(rng.uniform(-0.1, 0.1, 3))}" rpy="{numbers(_rpy(rng))}"/>'
    inertial = f'<inertial>{at}<mass value="{mass!r}"/><inertia {inertia}/></inertial>'
    return f'<link name="{name}">{inertial}</link>'


def _hulls(
    rng: np.random.Generator,
    links: list[str],
    ends: list[tuple[float, float, float]],
    parents: list[str] | None = None,
) -> tuple[list[Sphere], list[Spheroid]]:
    """Spheres and spheroids on most links, some spheroids between a link and its parent."""
    spheres: list[Sphere] = []
    spheroids: list[Spheroid] = []
    for k, (link, end) in enumerate(zip(links, ends, strict=True)):
        draw, thick = rng.random(), float(rng.uniform(0.01, 0.08))
        off = rng.uniform(-0.05, 0.05, 3) * (rng.random() < 0.5)
        at = (float(off[0]), float(off[1]), float(off[2]))
        if draw < 0.3:
            spheres.append((link, at, thick))
        elif draw < 0.75 and np.linalg.norm(end) > 0.02:
            spheroids.append((link, at, link, end, float(_semi_major(at, end, thick))))
        elif draw < 0.85:
            other = parents[k] if parents is not None else links[max(0, k - 1)]
            if other != link:
                spheroids.append((other, (0.0, 0.0, 0.0), link, at, float(rng.uniform(0.25, 0.5))))
    return spheres, spheroids


def _semi_major(a: tuple[float, ...], b: tuple[float, ...], thick: float) -> float:
    """So that the hull is `thick` at its waist [m]."""
    half = 0.5 * np.linalg.norm(np.subtract(a, b))
    return float(np.hypot(half, thick))


def _random_pose(rng: np.random.Generator, reach: float) -> FloatArray:
    """Any direction, a position within +-reach, (4, 4)."""
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    T = np.eye(4)
    T[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    T[:3, 3] = rng.uniform(-reach, reach, 3)
    return T
