"""Gears and geometry: play, springs, offsets, wrong placements, coupled motors."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from bench.sim2real.concealed.arm import Arm, Array, Machine, rotation_rpy
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.reference import Dynamics, Reference


@dataclass(frozen=True, slots=True, kw_only=True)
class Backlash(Effect):
    """Play between motor and link: two hinges in series, the second with stops."""

    gap: float = 0.01
    grease: float = 0.01  # damping inside the play [N m s/rad]

    id = "backlash"
    amplitude = "gap"
    bounds = (0.0003, 0.05)
    calibrated = True

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"gap": self.gap}

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """Stops as stiff as the step bears."""
        half = 0.5 * self.gap
        machine.series[self.joint] = (
            f'damping="{self.grease:.6g}" limited="true" range="{-half:.9g} {half:.9g}"'
            ' solreflimit="0.0015 1" solimplimit="0.95 0.99 0.0002 0.5 2"'
        )

    def rest(self, load: float) -> float:
        """The second hinge's position under a load."""
        return -0.5 * self.gap * float(np.sign(load))


@dataclass(frozen=True, slots=True, kw_only=True)
class Elasticity(Effect):
    """A spring and a damper between motor and link."""

    compliance: float = 1e-3  # [rad/(N m)]
    damping: float = 0.5

    id = "joint_elasticity"
    amplitude = "compliance"
    calibrated = True
    softest: float = 0.01

    @property
    def stiffness(self) -> float:
        """[N m/rad]."""
        return float(f"{1.0 / min(self.compliance, self.softest):.6g}")

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"stiffness": self.stiffness, "damping": self.damping}

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """A sprung second hinge."""
        machine.series[self.joint] = (
            f'stiffness="{self.stiffness:.9g}" damping="{self.damping:.9g}"'
        )

    def rest(self, load: float) -> float:
        """The second hinge's position under a load."""
        return -load / self.stiffness


@dataclass(frozen=True, slots=True, kw_only=True)
class JointOffset(Effect):
    """The encoder's zero is elsewhere: true = measured + offset."""

    size: float = 0.02
    sign: float = 1.0

    id = "joint_offset"
    amplitude = "size"
    bounds = (0.001, 0.12)

    @property
    def encoder_offset(self) -> float:
        """What the world adds to the encoder [rad]."""
        return self.sign * self.size

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"offset": self.encoder_offset}

    def residual(self, ref: Reference) -> Array:
        """Torques at the true position less those at the measured one."""
        q = ref.q.copy()
        q[:, self.joint] += self.encoder_offset
        return ref.dynamics.torque(q, ref.dq, ref.ddq) - ref.tau

    def tip_shift(self, ref: Reference, rows: Array) -> Array:
        """How far the tip is from where the model has it, (T, 3)."""
        q = ref.q[rows].copy()
        before = ref.dynamics.tips(q)[0]
        q[:, self.joint] += self.encoder_offset
        return ref.dynamics.tips(q)[0] - before


@dataclass(frozen=True, slots=True, kw_only=True)
class KinematicError(Effect):
    """A joint sits elsewhere on its parent.

    True origin = believed + (dx, dy, dz) in the parent link's axes; true rotation = believed
    rotation * Rz(rz) Ry(ry) Rx(rx).
    """

    size: float = 1.0
    shift: Array = field(default_factory=lambda: np.zeros(3))  # at size 1 [m]
    turn: Array = field(default_factory=lambda: np.zeros(3))  # at size 1 [rad]

    id = "kinematic_error"
    amplitude = "size"
    bounds = (0.02, 10.0)

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them: the rotation as a vector."""
        turn = Rotation.from_matrix(rotation_rpy(self.size * self.turn)).as_rotvec()
        figures = [*(self.size * self.shift), *turn]
        names = ("dx", "dy", "dz", "rx", "ry", "rz")
        return {name: float(x) for name, x in zip(names, figures, strict=True)}

    def change_arm(self, arm: Arm) -> Arm:
        """Placed truly."""
        T = arm.joints[self.joint].T_parent_joint.copy()
        T[:3, 3] += self.size * self.shift
        T[:3, :3] = T[:3, :3] @ rotation_rpy(self.size * self.turn)
        return arm.with_placement(self.joint, T)

    def residual(self, ref: Reference) -> Array:
        """Inverse dynamics of the one less the other's."""
        true = Dynamics(self.change_arm(ref.arm), ref.armature)
        return true.torque(ref.q, ref.dq, ref.ddq) - ref.tau

    def tip_shift(self, ref: Reference, rows: Array) -> Array:
        """How far the tip is from where the model has it, (T, 3)."""
        true = Dynamics(self.change_arm(ref.arm), ref.armature)
        return true.tips(ref.q[rows])[0] - ref.dynamics.tips(ref.q[rows])[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling(Effect):
    """One motor moves two joints: true q_k = q_k + ratio q_j."""

    other: int = 0
    ratio: float = 0.05
    sign: float = 1.0

    id = "joint_coupling"
    amplitude = "ratio"
    bounds = (0.003, 0.35)

    @property
    def motor_ratio(self) -> float:
        """What the world turns joint k by, per motor j."""
        return self.sign * self.ratio

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"ratio": self.motor_ratio}

    def joints(self, ref: Reference | None) -> tuple[int, ...]:
        """The one moved too, and the one that moves it."""
        return (self.joint, self.other)

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """Rotor k turns with joint k less ratio times joint j: an inertia on a tendon."""
        inertia = machine.armature[self.joint]
        machine.armature[self.joint] = 0.0
        machine.tendons.append(
            f'<fixed armature="{inertia:.9g}"><joint joint="m{self.joint}" coef="1"/>'
            f'<joint joint="m{self.other}" coef="{-self.motor_ratio:.9g}"/></fixed>'
        )

    def residual(self, ref: Reference) -> Array:
        """Motor torques of the true motion less the believed ones."""
        q, dq, ddq = ref.q.copy(), ref.dq.copy(), ref.ddq.copy()
        for x in (q, dq, ddq):
            x[:, self.joint] += self.motor_ratio * x[:, self.other]
        rotor = ref.armature * (ref.ddq - ddq)
        tau = ref.dynamics.torque(q, dq, ddq) + rotor
        body_k = tau[:, self.joint]
        tau[:, self.other] += self.motor_ratio * body_k
        tau[:, self.other] -= self.motor_ratio * ref.armature[self.joint] * ref.ddq[:, self.joint]
        return tau - ref.tau

    def tip_shift(self, ref: Reference, rows: Array) -> Array:
        """How far the tip is from where the model has it, (T, 3)."""
        q = ref.q[rows].copy()
        before = ref.dynamics.tips(q)[0]
        q[:, self.joint] += self.motor_ratio * q[:, self.other]
        return ref.dynamics.tips(q)[0] - before
