"""The arms of the worlds: four known ones and random ones of 2 to 7 joints."""

from pathlib import Path

import numpy as np

from bench.sim2real.frame.arm import Arm, Array, Joint, Link, pose, read_chain, rotation_rpy

FOLDER = Path(__file__).parents[3] / "cpp" / "robots"
KNOWN = {
    "panda": ("panda.urdf", "panda_link0", "panda_link8"),
    "ur10": ("ur10.urdf", "base_link", "tool0"),
    "iiwa14": ("iiwa14.urdf", "iiwa_link_0", "iiwa_link_ee"),
    "h1_arm": ("h1.urdf", "torso_link", "left_elbow_link"),
}
RANDOM = tuple(f"random{n}" for n in range(2, 8))
NAMES = (*KNOWN, *RANDOM)


def robot(name: str, rng: np.random.Generator) -> Arm:
    """The arm of this name; random arms differ from draw to draw."""
    if name in KNOWN:
        file, base, tip = KNOWN[name]
        return read_chain(FOLDER / file, base, tip)
    if name in RANDOM:
        return random_arm(rng, int(name.removeprefix("random")))
    raise ValueError(f"robot is {name!r}, expected one of {', '.join(NAMES)}")


def random_arm(rng: np.random.Generator, n: int) -> Arm:
    """Links are boxes of random size and density; the next joint is never on this one's axis."""
    lengths = rng.uniform(0.15, 0.4, n) * (1.0 if n < 5 else 0.8)
    densities = rng.uniform(500.0, 1600.0, n)
    joints, links = [], []
    offset = np.array([0.0, 0.0, rng.uniform(0.1, 0.4)])
    for k in range(n):
        axis = _axis(rng, None, first=k == 0)
        R = rotation_rpy(rng.choice([-0.5, 0.0, 0.5, 1.0], 3) * np.pi) if k else np.eye(3)
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, offset
        direction = _axis(rng, axis, first=False, free=0.3)
        offset = lengths[k] * direction
        width = rng.uniform(0.08, 0.14) * (1.0 - 0.5 * k / n)
        links.append(_box(rng, lengths[k], width, densities[k], offset))
        half = rng.uniform(1.2, 2.8)
        joints.append(
            Joint(
                T_parent_joint=T,
                axis=axis,
                lower=float(np.round(-half, 4)),
                upper=float(np.round(half, 4)),
                effort=1.0,
                speed=float(np.round(rng.uniform(1.5, 3.0), 2)),
            )
        )
    T_last_tip = pose(offset, np.zeros(3))
    return _with_efforts(Arm(joints=tuple(joints), links=tuple(links), T_last_tip=T_last_tip))


def _axis(
    rng: np.random.Generator, other: Array | None, *, first: bool, free: float = 0.5
) -> Array:
    """A unit vector; not near `other` when one is given; the first joint is often upright."""
    if first and rng.random() < 0.5:
        return np.array([0.0, 0.0, 1.0])
    while True:
        if rng.random() < free:
            axis = rng.normal(size=3)
        else:
            axis = np.zeros(3)
            axis[rng.integers(3)] = rng.choice([-1.0, 1.0])
        axis /= np.linalg.norm(axis)
        if other is None or abs(axis @ other) < 0.7:
            return axis


def _box(
    rng: np.random.Generator, length: float, width: float, density: float, offset: Array
) -> Link:
    mass = float(np.round(density * length * width**2 * rng.uniform(0.6, 1.0), 4))
    along = offset / np.linalg.norm(offset)
    side = np.cross(along, [0.0, 0.0, 1.0] if abs(along[2]) < 0.8 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    R = np.column_stack([along, side, np.cross(along, side)])
    a, b, c = length * rng.uniform(0.8, 1.1), width, width * rng.uniform(0.7, 1.3)
    principal = mass / 12.0 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
    com = 0.5 * offset + rng.uniform(-0.2, 0.2, 3) * width
    return Link(mass=mass, com=com, inertia=R @ np.diag(principal) @ R.T)


def _with_efforts(arm: Arm) -> Arm:
    """Each drive can hold twice the outstretched arm beyond it and a little more."""
    joints = []
    for k, joint in enumerate(arm.joints):
        reach, torque = 0.0, 2.0
        for link, following in zip(arm.links[k:], (*arm.joints[k + 1 :], None), strict=True):
            torque += 9.81 * link.mass * (reach + float(np.linalg.norm(link.com)))
            if following is not None:
                reach += float(np.linalg.norm(following.T_parent_joint[:3, 3]))
        fields = {name: getattr(joint, name) for name in joint.__slots__}
        joints.append(Joint(**{**fields, "effort": float(np.ceil(2.0 * torque))}))
    return Arm(joints=tuple(joints), links=arm.links, T_last_tip=arm.T_last_tip)
