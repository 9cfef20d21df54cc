"""Physics that the catalogue does not hold: the right answer is that it is unknown."""

import math

import numpy as np

from bench.sim2real.concealed.effect import Effect, Scene, StepLaw, effect, one_column
from bench.sim2real.concealed.mjcf import Machine
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import TIMESTEP, Run
from bench.sim2real.frame.arm import Arm, Array, Link

KINDS = (
    *("quadratic_drag", "friction_by_neighbour", "detents", "pump", "damping_by_position"),
    *("root_friction", "drag_by_neighbour", "speed_ripple", "crosstalk", "slosh"),
)


@effect("unknown", "size", effort_share=0.15, names=())
class Outside(Effect):
    """A torque law of position, speed, time and another joint."""

    kind: str = "quadratic_drag"
    other: int = 0
    size: float = 1.0
    figures: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: float = 0.1

    def torque(self, q: Array, v: Array, t: Array) -> Array:
        """What the drive must add; q and v are (n, ...) so that both joints can be seen.

        Dry friction is steep near rest, as the step bears.
        """
        a, b, c = self.figures
        x, u = q[self.joint], v[self.joint]
        y, w = q[self.other], v[self.other]
        side = np.tanh(u / max(0.01, self.size * TIMESTEP / (0.5 * self.inertia)))
        if self.kind == "quadratic_drag":
            shape = u * np.abs(u)
        elif self.kind == "friction_by_neighbour":
            shape = side * (0.5 + 0.5 * np.sin(2.0 * y + a))
        elif self.kind == "detents":
            shape = sum(
                ((x - p) / 0.06) * np.exp(0.5 - 0.5 * ((x - p) / 0.06) ** 2) for p in (a, b, c)
            )
        elif self.kind == "pump":
            shape = np.sin(a * t + b) + 0.4 * np.sin(2.0 * a * t + c)
        elif self.kind == "damping_by_position":
            shape = u * np.sin(1.5 * x + a) ** 2
        elif self.kind == "root_friction":
            shape = side * np.sqrt(np.abs(u))
        elif self.kind == "drag_by_neighbour":
            shape = w
        elif self.kind == "speed_ripple":
            shape = u * np.cos(round(a) * x + b)
        else:
            raise ValueError(f"kind is {self.kind!r}, expected one of {', '.join(KINDS)}")
        return self.size * shape

    def residual(self, ref: Reference) -> Array:
        return one_column(ref, self.joint, self.torque(ref.q.T, ref.dq.T, ref.time))

    def step_law(self, run: Run) -> StepLaw | None:
        dof, applied, data = run.world.dof(self.joint), run.applied, run.data
        qpos, qvel, motor = run.qpos, run.qvel, run.motor

        def law() -> None:
            applied[dof] -= self.torque(qpos[motor], qvel[motor], data.time)

        return law


@effect("unknown", "share", bounds=(0.005, 0.5), names=())
class Crosstalk(Effect):
    """A torque sensor that also feels its neighbour's torque."""

    other: int = 0
    share: float = 0.1

    def residual(self, ref: Reference) -> Array:
        return one_column(ref, self.joint, self.share * ref.tau[:, self.other])

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        channels["tau"][:, self.joint] += self.share * channels["tau"][:, self.other]


@effect("unknown", "mass", names=())
class Slosh(Effect):
    """A known load that swings on a spring instead of being fixed; the model has it at rest."""

    mass: float = 1.0
    pivot: Array | None = None  # (3,) in the last link's frame [m]
    drop: float = 0.1  # from the pivot to the load, along the last link's z [m]
    hertz: float = 2.0

    def load(self) -> Link:
        """As the believed model has it."""
        com = self.pivot + np.array([0.0, 0.0, self.drop])
        return Link(mass=self.mass, com=com, inertia=np.eye(3) * self.mass * 4e-4)

    def links(self, ref: Reference) -> tuple[int, ...]:
        return (ref.arm.n - 1,)

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """A pendulum on two sprung hinges in the last body."""
        inertia = self.mass * (self.drop**2 + 4e-4)
        stiffness = inertia * (2.0 * math.pi * self.hertz) ** 2
        damping = 2.0 * 0.04 * math.sqrt(stiffness * inertia)
        springs = f'stiffness="{stiffness:.6g}" damping="{damping:.6g}"'
        x, y, z = self.pivot
        i = self.mass * 4e-4
        machine.extra = (
            f'<body pos="{x:.6g} {y:.6g} {z:.6g}"><inertial pos="0 0 {self.drop:.6g}"'
            f' mass="{self.mass:.6g}" diaginertia="{i:.6g} {i:.6g} {i:.6g}"/>'
            f'<joint type="hinge" axis="1 0 0" {springs}/>'
            f'<joint type="hinge" axis="0 1 0" {springs}/></body>'
        )

    def change_arm(self, arm: Arm) -> Arm:
        """The believed arm without the load, which the pendulum carries."""
        link, load = arm.links[-1], self.load()
        mass = link.mass - load.mass
        com = (link.mass * link.com - load.mass * load.com) / mass
        inertia = link.about(com) - load.about(com)
        return arm.with_link(arm.n - 1, Link(mass=mass, com=com, inertia=inertia))


def outside(scene: Scene, kind: str) -> Effect:
    """A law of one of the kinds, sized against the noise."""
    rng, ref = scene.rng, scene.ref
    if kind not in KINDS:
        raise ValueError(f"kind is {kind!r}, expected one of {', '.join(KINDS)}")
    if kind == "crosstalk":
        return scene.somewhere(lambda j: Crosstalk(joint=j, other=neighbour(j)))
    raw = rng.uniform(0.0, 1.0, 3)

    def make(j: int) -> Effect:
        figures = _figures(kind, raw, ref.q[:, j])
        inertia = float(ref.lightest[j])
        return Outside(joint=j, other=neighbour(j), kind=kind, figures=figures, inertia=inertia)

    return scene.somewhere(make)


def neighbour(joint: int) -> int:
    """The joint before, of the first the one after."""
    return joint - 1 if joint > 0 else 1


def _figures(kind: str, raw: Array, q: Array) -> tuple[float, float, float]:
    if kind == "detents":
        a, b, c = np.quantile(q, [0.2 + 0.15 * raw[0], 0.45 + 0.1 * raw[1], 0.65 + 0.15 * raw[2]])
        return float(a), float(b), float(c)
    if kind == "pump":
        return 2.0 * np.pi * (0.4 + 1.5 * raw[0]), 6.28 * raw[1], 6.28 * raw[2]
    if kind == "speed_ripple":
        return 5.0 + 15.0 * raw[0], 6.28 * raw[1], 0.0
    return 6.28 * raw[0], 0.0, 0.0


def slosh(arm: Arm, rng: np.random.Generator) -> Slosh:
    """A load of about a tenth of what the strongest drive holds at full stretch."""
    reach = sum(float(np.linalg.norm(joint.T_parent_joint[:3, 3])) for joint in arm.joints[1:])
    reach += float(np.linalg.norm(arm.T_last_tip[:3, 3]))
    effort = max(joint.effort for joint in arm.joints)
    mass = float(f"{rng.uniform(0.05, 0.12) * effort / (9.81 * reach):.4g}")
    drop, hertz = (float(x) for x in np.round(rng.uniform([0.05, 1.0], [0.15, 2.5]), 3))
    return Slosh(mass=mass, pivot=arm.T_last_tip[:3, 3].copy(), drop=drop, hertz=hertz)
