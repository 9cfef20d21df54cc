"""What a world is asked to be, and which worlds a campaign is of."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from bench.sim2real.frame.streams import stream

Array = npt.NDArray[np.float64]

FIRST_PROOF_SEED = 3_000_000  # development uses seeds below 10 000
ROBOTS = ("go2", "h1")
BACKGROUNDS = ("plain", "dense")

JOINT_KINDS = (
    *("coulomb_friction", "viscous_friction", "torque_gain", "torque_offset", "rotor_inertia"),
    *("joint_offset", "position_dependent_spring", "torque_saturation", "command_delay"),
    *("backlash",),
)
BODY_KINDS = ("payload", "link_inertial_error")
IMU_KINDS = ("imu_offset", "imu_tilt")
GROUND_KINDS = ("foot_friction", "foot_softness", "ground_slope", "ground_height")
KINDS = (*JOINT_KINDS, *BODY_KINDS, *IMU_KINDS, *GROUND_KINDS)
HEALTHY = "healthy"


@dataclass(frozen=True, slots=True, kw_only=True)
class Spec:
    """A study to be made; the same spec gives the same files."""

    seed: int
    robot: str = "go2"
    background: str = "plain"  # plain: exact but for what is hidden; dense: as machines are
    kind: str = HEALTHY  # one of KINDS, or nothing hidden
    seconds: float | None = None  # of each run; None: 15 to 18 s, drawn

    def __post_init__(self) -> None:
        for name, value, known in (
            ("robot", self.robot, ROBOTS),
            ("background", self.background, BACKGROUNDS),
            ("kind", self.kind, (HEALTHY, *KINDS)),
        ):
            if value not in known:
                raise ValueError(f"{name}: expected one of {', '.join(known)}, got {value!r}")

    @property
    def name(self) -> str:
        return f"{self.robot}_{self.kind}_{self.background}_{self.seed}"

    def stream(self, purpose: str) -> np.random.Generator:
        """Random numbers for one purpose.

        Motions and sensors do not depend on what is hidden: a healthy machine of the same seed
        does the same.
        """
        return stream(self.seed, self.robot, self.background, purpose)


def draw(
    seed: int, robot: str | None = None, background: str | None = None, kind: str | None = None
) -> Spec:
    """A spec, with what is not given drawn by the seed: one world in six has nothing hidden."""
    rng = stream(seed, "spec")
    drawn_robot, drawn_background = str(rng.choice(ROBOTS)), str(rng.choice(BACKGROUNDS))
    drawn_kind = HEALTHY if rng.random() < 1.0 / 6.0 else str(rng.choice(KINDS))
    return Spec(
        seed=seed,
        robot=robot or drawn_robot,
        background=background or drawn_background,
        kind=kind or drawn_kind,
    )


def specs_of(
    seed: int, count: int, robots: Iterable[str] = ROBOTS, backgrounds: Iterable[str] = BACKGROUNDS
) -> dict[str, Spec]:
    """Specs by names that tell nothing but their order.

    Robots and backgrounds take turns; with each, every fifth world or so has nothing hidden, and
    the kinds come one after the other in an order that the seed tells.
    """
    sorts = [(r, b) for r in robots for b in backgrounds]
    queues = {sort: _kinds(seed, *sort) for sort in sorts}
    specs = {}
    for k in range(count):
        robot, background = sorts[k % len(sorts)]
        queue = queues[robot, background]
        kind = queue[(k // len(sorts)) % len(queue)]
        specs[f"world{k:04d}"] = Spec(seed=seed + k, robot=robot, background=background, kind=kind)
    return specs


def _kinds(seed: int, robot: str, background: str) -> list[str]:
    """All kinds once, and as many healthy machines as there are sixths of the whole."""
    rng = stream(seed, f"{robot} {background}")
    kinds = [*KINDS, *[HEALTHY] * -(-len(KINDS) // 5)]
    return [str(kind) for kind in rng.permutation(kinds)]
