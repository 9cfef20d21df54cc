"""Random URDF trees: all joint types, branches, any axes and origins, names in no order."""

from dataclasses import dataclass, field

import numpy as np

TYPES = ("revolute", "continuous", "prismatic", "fixed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Mimic:
    """position(joint) = multiplier * position(of) + offset."""

    of: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomUrdf:
    """A URDF's text and what a test cannot read off pdoik itself."""

    xml: str
    links: list[str]
    mimics: dict[str, Mimic] = field(default_factory=dict)

    def positions(self, free: dict[str, float]) -> dict[str, float]:
        """Positions of all joints that move from those that do not follow another."""
        result = dict(free)
        for joint, mimic in self.mimics.items():
            result[joint] = mimic.multiplier * free[mimic.of] + mimic.offset
        return result


def random_urdf(
    rng: np.random.Generator, *, links: int = 9, types: tuple[str, ...] = TYPES, mimics: int = 0
) -> RandomUrdf:
    """A tree whose joints are of the given types; up to `mimics` of them follow others."""
    joints = [f"j{i}" for i in rng.permutation(links - 1)]
    names = [f"l{i}" for i in rng.permutation(links)]
    kinds = {joint: str(rng.choice(types)) for joint in joints}
    kinds[joints[0]] = next(kind for kind in types if kind != "fixed")
    followers = _followers(rng, joints, kinds, mimics)
    parts = [_link(rng, name) for name in names]
    for child, joint in enumerate(joints, start=1):
        parent = names[int(rng.integers(max(0, child - 3), child))]
        parts.append(_joint(rng, joint, kinds[joint], parent, names[child], followers.get(joint)))
    body = "\n".join(str(part) for part in rng.permutation(parts))
    return RandomUrdf(
        xml=f'<?xml version="1.0"?>\n<robot name="random">\n{body}\n</robot>',
        links=names,
        mimics=followers,
    )


def _followers(
    rng: np.random.Generator, joints: list[str], kinds: dict[str, str], count: int
) -> dict[str, Mimic]:
    moving = [joint for joint in joints if kinds[joint] != "fixed"]
    result: dict[str, Mimic] = {}
    for joint in moving[1 : 1 + count]:
        leaders = [other for other in moving if kinds[other] == kinds[joint] and other != joint]
        leaders = [other for other in leaders if other not in moving[1 : 1 + count]]
        if leaders:
            multiplier, offset = rng.uniform(-1.5, 1.5), rng.uniform(-0.1, 0.1)
            result[joint] = Mimic(of=leaders[0], multiplier=multiplier, offset=offset)
    return result


def _numbers(values: np.ndarray) -> str:
    return " ".join(repr(float(value)) for value in values)


def _origin(rng: np.random.Generator) -> str:
    rpy = rng.uniform(-np.pi, np.pi, 3)
    if rng.random() < 0.3:  # where roll and yaw turn about one line
        rpy[1] = rng.choice([-0.5, 0.0, 0.5]) * np.pi
    return f'<origin xyz="{_numbers(rng.uniform(-0.4, 0.4, 3))}" rpy="{_numbers(rpy)}"/>'


def _axis(rng: np.random.Generator) -> str:
    if rng.random() < 0.5:
        axis = np.zeros(3)
        axis[rng.integers(3)] = rng.choice([-1.0, 1.0])
    else:
        axis = rng.normal(size=3)
        axis *= 1.0 if rng.random() < 0.5 else 1.0 / np.linalg.norm(axis)
        axis /= np.linalg.norm(axis)  # Pinocchio takes axes as they are
    return f'<axis xyz="{_numbers(axis)}"/>'


def _link(rng: np.random.Generator, name: str) -> str:
    mass = rng.uniform(0.1, 5.0)
    a, b, c = mass * rng.uniform(0.01, 0.2, 3) ** 2
    inertia = f'ixx="{b + c}" iyy="{a + c}" izz="{a + b}" ixy="0" ixz="0" iyz="0"'
    inertial = f'<inertial>{_origin(rng)}<mass value="{mass}"/><inertia {inertia}/></inertial>'
    return f'<link name="{name}">{inertial}</link>'


def _joint(
    rng: np.random.Generator, name: str, kind: str, parent: str, child: str, mimic: Mimic | None
) -> str:
    low, high = (-rng.uniform(0.5, 6.0), rng.uniform(0.5, 6.0))
    if kind == "prismatic":
        low, high = 0.1 * low, 0.1 * high
    limit = f'<limit lower="{low}" upper="{high}" effort="10" velocity="{rng.uniform(0.5, 4)}"/>'
    follow = ""
    if mimic is not None:
        follow = (
            f'<mimic joint="{mimic.of}" multiplier="{mimic.multiplier}" offset="{mimic.offset}"/>'
        )
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{_origin(rng)}{_axis(rng)}{limit if kind != 'fixed' else ''}{follow}</joint>"
    )
