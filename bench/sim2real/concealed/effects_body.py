"""Bodies and their surroundings: rotors, payloads, wrong links, a tilted base, a push."""

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco
import numpy as np

from bench.sim2real.concealed.arm import Arm, Array, Link, Machine, rotation_rpy
from bench.sim2real.concealed.effect import Effect, StepLaw, one_column
from bench.sim2real.concealed.reference import Dynamics, Reference
from bench.sim2real.concealed.world import Run

AXES = ("x", "y", "z")


@dataclass(frozen=True, slots=True, kw_only=True)
class RotorInertia(Effect):
    """The rotor is heavier than the data sheet says."""

    inertia: float = 0.1

    id = "rotor_inertia"
    amplitude = "inertia"

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"inertia": self.inertia}

    def residual(self, ref: Reference) -> Array:
        """In proportion to acceleration."""
        return one_column(ref, self.joint, self.inertia * ref.ddq[:, self.joint])

    def limits(self, ref: Reference) -> tuple[float, float]:
        """Up to twice what the data sheet says, beyond it."""
        return 0.0, 2.0 * float(ref.armature[self.joint])

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """More armature."""
        machine.armature[self.joint] += self.inertia


@dataclass(frozen=True, slots=True, kw_only=True)
class Body(Effect):
    """The true chain differs from the believed one."""

    def residual(self, ref: Reference) -> Array:
        """Inverse dynamics of the one less the other's."""
        true = Dynamics(self.change_arm(ref.arm), ref.armature)
        return true.torque(ref.q, ref.dq, ref.ddq) - ref.tau


@dataclass(frozen=True, slots=True, kw_only=True)
class Payload(Body):
    """A body nobody told the model of, on the last link."""

    mass: float = 1.0
    com: Array = field(default_factory=lambda: np.zeros(3))
    radius: Array = field(default_factory=lambda: np.full(3, 0.03))  # of gyration [m]

    id = "payload"
    amplitude = "mass"
    bounds = (0.02, 8.0)

    def _body(self) -> Link:
        a, b, c = self.radius**2
        return Link(
            mass=self.mass, com=self.com, inertia=self.mass * np.diag([b + c, a + c, a + b])
        )

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them; inertia about the payload's centre of mass."""
        J = np.diag(self._body().inertia)
        return {
            "mass": self.mass,
            **{f"com_{a}": float(x) for a, x in zip(AXES, self.com, strict=True)},
            **{f"i{a}{a}": float(x) for a, x in zip(AXES, J, strict=True)},
        }

    def links(self, ref: Reference) -> tuple[int, ...]:
        """The last link."""
        return (ref.arm.n - 1,)

    def change_arm(self, arm: Arm) -> Arm:
        """Fixed to the last link."""
        return arm.with_link(arm.n - 1, arm.links[-1].plus(self._body()))


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkError(Body):
    """One link is heavier, or its centre of mass is elsewhere, than believed."""

    link: int = 0
    size: float = 1.0
    mass_share: float = 0.3  # at size 1, of the link's mass
    shift: Array = field(default_factory=lambda: np.zeros(3))  # of the com at size 1 [m]

    id = "link_inertial_error"
    amplitude = "size"
    bounds = (0.02, 3.0)

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
        return {
            "d_mass": new.mass - old.mass,
            **{f"d_first_moment_{a}": float(x) for a, x in zip(AXES, first, strict=True)},
            **{
                f"d_i{AXES[r]}{AXES[c]}": float(J[r, c])
                for r, c in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
            },
        }

    def links(self, ref: Reference) -> tuple[int, ...]:
        """The wrong one."""
        return (self.link,)

    def change_arm(self, arm: Arm) -> Arm:
        """With the true link."""
        return arm.with_link(self.link, self._true(arm))


@dataclass(frozen=True, slots=True, kw_only=True)
class GravityDirection(Effect):
    """The base is not level: rolled about its x, then about its new y axis."""

    tilt: float = 0.03
    heading: float = 0.0

    id = "gravity_direction"
    amplitude = "tilt"
    bounds = (0.002, 0.25)

    def _tilts(self) -> Array:
        return self.tilt * np.array([np.cos(self.heading), np.sin(self.heading)])

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        x, y = self._tilts()
        return {"tilt_x": float(x), "tilt_y": float(y)}

    def gravity(self) -> Array:
        """In the base's axes."""
        x, y = self._tilts()
        turned = rotation_rpy(np.array([x, 0.0, 0.0])) @ rotation_rpy(np.array([0.0, y, 0.0]))
        return turned.T @ np.array([0.0, 0.0, -9.81])

    def residual(self, ref: Reference) -> Array:
        """Other gravity torques."""
        true = Dynamics(ref.arm, ref.armature, self.gravity())
        return true.torque(ref.q, ref.dq, ref.ddq) - ref.tau

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """Gravity as the base sees it."""
        machine.gravity = self.gravity()


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact(Effect):
    """Somebody pushes: a force constant in the base's axes on a link, for some seconds."""

    link: int = 0
    force: float = 10.0
    direction: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    at_tip: bool = True

    id = "external_contact"
    amplitude = "force"
    bounds = (0.5, 150.0)

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them: on the arm."""
        f = self.force * self.direction
        return {f"force_{a}": float(x) for a, x in zip(AXES, f, strict=True)}

    def links(self, ref: Reference) -> tuple[int, ...]:
        """The pushed one."""
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
