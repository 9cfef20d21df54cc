"""Bodies and their surroundings: rotors, payloads, wrong links, a tilted base, a push."""

from dataclasses import dataclass, field

import mujoco
import numpy as np

from bench.sim2real.concealed.effect import Effect, Gate, Scene, StepLaw, effect, one_column
from bench.sim2real.concealed.mjcf import Machine
from bench.sim2real.concealed.reference import Dynamics, Reference
from bench.sim2real.concealed.world import Run
from bench.sim2real.frame.arm import Arm, Array, Link, rotation_rpy

AXES = ("x", "y", "z")


def by_axis(values: Array, form: str) -> dict[str, float]:
    """Parameters of a vector: their names have {} where an axis is named."""
    return {form.format(a): float(x) for a, x in zip(AXES, values, strict=True)}


@effect("rotor_inertia", "inertia")
class RotorInertia(Effect):
    """The rotor is heavier than the data sheet says, by up to twice that."""

    inertia: float = 0.1

    def residual(self, ref: Reference) -> Array:
        return one_column(ref, self.joint, self.inertia * ref.ddq[:, self.joint])

    def limits(self, ref: Reference) -> tuple[float, float]:
        return 0.0, 2.0 * float(ref.armature[self.joint])

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        machine.armature[self.joint] += self.inertia


@dataclass(frozen=True, slots=True, kw_only=True)
class Body(Effect):
    """The true chain differs from the believed one."""

    def residual(self, ref: Reference) -> Array:
        true = Dynamics(self.change_arm(ref.arm), ref.armature)
        return true.torque(ref.q, ref.dq, ref.ddq) - ref.tau


@effect("payload", "mass", bounds=(0.02, 8.0), names=())
class Payload(Body):
    """A body that the model does not have, on the last link."""

    mass: float = 1.0
    com: Array = field(default_factory=lambda: np.zeros(3))
    radius: Array = field(default_factory=lambda: np.full(3, 0.03))  # of gyration [m]

    def _inertia(self) -> Array:
        a, b, c = self.radius**2
        return self.mass * np.diag([b + c, a + c, a + b])

    def parameters(self) -> dict[str, float]:
        """Inertia about the payload's centre of mass."""
        inertia = by_axis(np.diag(self._inertia()), "i{0}{0}")
        return {"mass": self.mass, **by_axis(self.com, "com_{}"), **inertia}

    def links(self, ref: Reference) -> tuple[int, ...]:
        return (ref.arm.n - 1,)

    def change_arm(self, arm: Arm) -> Arm:
        body = Link(mass=self.mass, com=self.com, inertia=self._inertia())
        return arm.with_link(arm.n - 1, arm.links[-1].plus(body))


@effect("link_inertial_error", "size", bounds=(0.02, 3.0), names=())
class LinkError(Body):
    """One link is heavier, or its centre of mass is elsewhere, than believed."""

    link: int = 0
    size: float = 1.0
    mass_share: float = 0.3  # at size 1, of the link's mass
    shift: Array = field(default_factory=lambda: np.zeros(3))  # of the com at size 1 [m]

    def _true(self, arm: Arm) -> Link:
        old = arm.links[self.link]
        share = 1.0 + self.size * self.mass_share
        com = old.com + self.size * self.shift
        return Link(mass=old.mass * share, com=com, inertia=old.inertia * share)

    def parameters_of(self, arm: Arm) -> dict[str, float]:
        """As the catalogue names them, at the link frame's origin."""
        old, new = arm.links[self.link], self._true(arm)
        first = new.mass * new.com - old.mass * old.com
        J = new.about(np.zeros(3)) - old.about(np.zeros(3))
        second = {
            f"d_i{AXES[r]}{AXES[c]}": float(J[r, c])
            for r, c in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
        }
        return {"d_mass": new.mass - old.mass, **by_axis(first, "d_first_moment_{}"), **second}

    def links(self, ref: Reference) -> tuple[int, ...]:
        return (self.link,)

    def change_arm(self, arm: Arm) -> Arm:
        return arm.with_link(self.link, self._true(arm))


@effect("gravity_direction", "tilt", bounds=(0.002, 0.25), names=())
class GravityDirection(Effect):
    """The base is not level: rolled about its x, then about its new y axis."""

    tilt: float = 0.03
    heading: float = 0.0

    def _tilts(self) -> Array:
        return self.tilt * np.array([np.cos(self.heading), np.sin(self.heading)])

    def parameters(self) -> dict[str, float]:
        x, y = self._tilts()
        return {"tilt_x": float(x), "tilt_y": float(y)}

    def gravity(self) -> Array:
        """In the base's axes, (3,)."""
        x, y = self._tilts()
        turned = rotation_rpy(np.array([x, 0.0, 0.0])) @ rotation_rpy(np.array([0.0, y, 0.0]))
        return turned.T @ np.array([0.0, 0.0, -9.81])

    def residual(self, ref: Reference) -> Array:
        true = Dynamics(ref.arm, ref.armature, self.gravity())
        return true.torque(ref.q, ref.dq, ref.ddq) - ref.tau

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        machine.gravity = self.gravity()


@effect("external_contact", "force", bounds=(0.5, 150.0), names=())
class Contact(Effect):
    """Somebody pushes: a force constant in the base's axes on a link, for some seconds."""

    link: int = 0
    force: float = 10.0
    direction: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    at_tip: bool = True

    def parameters(self) -> dict[str, float]:
        """On the arm."""
        return by_axis(self.force * self.direction, "force_{}")

    def links(self, ref: Reference) -> tuple[int, ...]:
        return (self.link,)

    def residual(self, ref: Reference) -> Array:
        """What the drives must add: - J^T f inside the window."""
        model, data = ref.dynamics.model, ref.dynamics.data
        weight = self.gate.weight(0.0, ref.time) * np.isin(
            ref.recording, self.gate.recordings or range(99)
        )
        result = np.zeros_like(ref.q)
        jacobian = np.empty((3, model.nv))
        body = model.body(f"b{self.link}").id
        for row in np.flatnonzero(weight):
            data.qpos[:] = ref.q[row]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            point = data.site_xpos[0] if self.at_tip else data.xpos[body]
            mujoco.mj_jac(model, data, jacobian, None, point.copy(), body)
            result[row] = -weight[row] * jacobian.T @ (self.force * self.direction)
        return result

    def step_law(self, run: Run) -> StepLaw | None:
        """The force and its moment about the link's centre of mass."""
        if self.gate.recordings is not None and run.recording not in self.gate.recordings:
            return None
        data, body = run.data, run.model.body(f"b{self.link}").id
        push, weight = self.force * self.direction, self.gate.weight_of
        low, high = self.gate.low, self.gate.high

        def law() -> None:
            if not low <= data.time <= high + 0.01:
                return
            force = weight(0.0, data.time) * push
            point = data.site_xpos[0] if self.at_tip else data.xpos[body]
            data.xfrc_applied[body, :3] = force
            data.xfrc_applied[body, 3:] = np.cross(point - data.xipos[body], force)

        return law


def rotor(scene: Scene) -> Effect:
    """A heavier rotor."""
    return scene.somewhere(lambda j: RotorInertia(joint=j, inertia=0.01))


def payload(scene: Scene) -> Effect:
    """Near the tip, up to 14 cm off."""
    rng = scene.rng
    com = scene.ref.arm.T_last_tip[:3, 3] + rng.uniform(-0.08, 0.08, 3)
    radius = np.round(rng.uniform(0.02, 0.06, 3), 4)
    return scene.sized(Payload(com=np.round(com, 4), radius=radius, mass=0.5))


def link_error(scene: Scene) -> Effect:
    """Heavier or lighter, or with its centre of mass a few centimetres off, or both."""
    rng = scene.rng
    kind = rng.integers(3)
    share = 0.0 if kind == 0 else float(np.round(rng.choice([-0.15, 0.3]) * rng.uniform(0.5, 1), 4))
    shift = np.zeros(3) if kind == 1 else np.round(rng.normal(0.0, 0.015, 3), 4)
    return scene.somewhere(lambda k: LinkError(link=k, mass_share=share, shift=shift, size=0.5))


def gravity(scene: Scene) -> Effect:
    """Up to some degrees."""
    return scene.sized(GravityDirection(heading=scene.uniform(-np.pi, np.pi)))


def contact(scene: Scene) -> Effect:
    """On one of the last links for a few seconds (in a corner: one) of one recording."""
    rng, ref = scene.rng, scene.ref
    n = ref.arm.n
    link = int(rng.integers(max(0, n - 3), n))
    recording = int(rng.integers(ref.recording[-1] + 1))
    end = float(ref.time[ref.recording == recording][-1])
    length = rng.uniform(0.8, 1.3) if scene.corner else rng.uniform(1.5, 4.0)
    first = end - length - 1.5 if scene.corner else 2.0
    low = float(np.round(rng.uniform(first, end - length - 1.0), 2))
    window = {"low": low, "high": round(low + length, 2), "edge": 0.1}
    gate = Gate(kind="time", **window, recordings=(recording,))
    direction = rng.normal(size=3)
    direction = direction / np.linalg.norm(direction)
    at_tip = link == n - 1 and bool(rng.random() < 0.5)
    return scene.sized(Contact(link=link, direction=direction, at_tip=at_tip, gate=gate))
