"""Gears and geometry: play, springs, offsets, wrong placements, coupled motors."""

from dataclasses import field

import numpy as np
from scipy.spatial.transform import Rotation

from bench.sim2real.concealed.effect import Effect, Scene, effect
from bench.sim2real.concealed.effects_body import Body
from bench.sim2real.concealed.mjcf import Machine
from bench.sim2real.concealed.reference import Dynamics, Reference
from bench.sim2real.frame.arm import Arm, Array, rotation_rpy


@effect("backlash", "gap", bounds=(0.0003, 0.05), calibrated=True)
class Backlash(Effect):
    """Play between motor and link: two hinges in series, the second with stops."""

    gap: float = 0.01
    grease: float = 0.01  # damping inside the play [N m s/rad]

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        half = 0.5 * self.gap
        machine.series[self.joint] = (
            f'damping="{self.grease:.6g}" limited="true" range="{-half:.9g} {half:.9g}"'
            ' solreflimit="0.0015 1" solimplimit="0.95 0.99 0.0002 0.5 2"'
        )

    def rest(self, load: float) -> float:
        return -0.5 * self.gap * float(np.sign(load))


@effect("joint_elasticity", "compliance", names=("stiffness", "damping"), calibrated=True)
class Elasticity(Effect):
    """A spring and a damper between motor and link."""

    compliance: float = 1e-3  # [rad/(N m)]
    damping: float = 0.5

    softest: float = 0.01

    @property
    def stiffness(self) -> float:
        """[N m/rad]."""
        return float(f"{1.0 / min(self.compliance, self.softest):.6g}")

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        spring = f'stiffness="{self.stiffness:.9g}" damping="{self.damping:.9g}"'
        machine.series[self.joint] = spring

    def rest(self, load: float) -> float:
        return -load / self.stiffness


@effect("joint_offset", "size", names={"offset": "encoder_offset"}, bounds=(0.001, 0.12))
class JointOffset(Effect):
    """The encoder's zero is elsewhere: true = measured + offset."""

    size: float = 0.02
    sign: float = 1.0

    @property
    def encoder_offset(self) -> float:
        """What the world adds to the encoder [rad]."""
        return self.sign * self.size

    def residual(self, ref: Reference) -> Array:
        q = ref.q.copy()
        q[:, self.joint] += self.encoder_offset
        return ref.dynamics.torque(q, ref.dq, ref.ddq) - ref.tau

    def tip_shift(self, ref: Reference, rows: Array) -> Array:
        q = ref.q[rows].copy()
        before = ref.dynamics.tips(q)[0]
        q[:, self.joint] += self.encoder_offset
        return ref.dynamics.tips(q)[0] - before


@effect("kinematic_error", "size", bounds=(0.02, 10.0), names=())
class KinematicError(Body):
    """A joint sits elsewhere on its parent.

    True origin = believed + (dx, dy, dz) in the parent link's axes; true rotation = believed
    rotation * Rz(rz) Ry(ry) Rx(rx).
    """

    size: float = 1.0
    shift: Array = field(default_factory=lambda: np.zeros(3))  # at size 1 [m]
    turn: Array = field(default_factory=lambda: np.zeros(3))  # at size 1 [rad]

    def parameters(self) -> dict[str, float]:
        turn = Rotation.from_matrix(rotation_rpy(self.size * self.turn)).as_rotvec()
        figures = [*(self.size * self.shift), *turn]
        names = ("dx", "dy", "dz", "rx", "ry", "rz")
        return {name: float(x) for name, x in zip(names, figures, strict=True)}

    def change_arm(self, arm: Arm) -> Arm:
        T = arm.joints[self.joint].T_parent_joint.copy()
        T[:3, 3] += self.size * self.shift
        T[:3, :3] = T[:3, :3] @ rotation_rpy(self.size * self.turn)
        return arm.with_placement(self.joint, T)

    def tip_shift(self, ref: Reference, rows: Array) -> Array:
        true = Dynamics(self.change_arm(ref.arm), ref.armature)
        return true.tips(ref.q[rows])[0] - ref.dynamics.tips(ref.q[rows])[0]


@effect("joint_coupling", "ratio", names={"ratio": "motor_ratio"}, bounds=(0.003, 0.35))
class Coupling(Effect):
    """One motor moves two joints: true q_k = q_k + ratio q_j."""

    other: int = 0
    ratio: float = 0.05
    sign: float = 1.0

    @property
    def motor_ratio(self) -> float:
        """What the world turns joint k by, per motor j."""
        return self.sign * self.ratio

    def joints(self, ref: Reference | None) -> tuple[int, ...]:
        return (self.joint, self.other)

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        inertia = machine.armature[self.joint]
        machine.armature[self.joint] = 0.0
        machine.tendons.append(
            f'<fixed armature="{inertia:.9g}"><joint joint="m{self.joint}" coef="1"/>'
            f'<joint joint="m{self.other}" coef="{-self.motor_ratio:.9g}"/></fixed>'
        )

    def residual(self, ref: Reference) -> Array:
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
        q = ref.q[rows].copy()
        before = ref.dynamics.tips(q)[0]
        q[:, self.joint] += self.motor_ratio * q[:, self.other]
        return ref.dynamics.tips(q)[0] - before


def backlash(scene: Scene) -> Effect:
    """Play at a joint whose load changes sides, if there is one; a simulation finds its size."""
    load = scene.load()
    sides = np.minimum(np.mean(load > 0.0, axis=0), np.mean(load < 0.0, axis=0))
    loaded = scene.loaded()
    joint = next((j for j in loaded if sides[j] > 0.15), loaded[0])
    inertia = float(scene.ref.inertia[joint] - scene.ref.armature[joint])
    grease = float(f"{inertia * scene.rng.uniform(0.3, 1.0):.4g}")
    return Backlash(joint=joint, gap=scene.uniform(0.004, 0.02), grease=grease)


def elasticity(scene: Scene) -> Effect:
    """The locked link swings at 5 to 12 Hz, never where it would sag by more than 3 degrees."""
    ref = scene.ref
    body = ref.inertia - ref.armature
    loaded = scene.loaded()
    share = body / ref.armature  # of a link that swings against a light rotor more is seen
    least = 0.1 if scene.sensors.tip else 0.6
    heaviest = max(scene.places, key=lambda j: share[j])
    joint = next((j for j in loaded if share[j] > least), heaviest)
    stiffness = body[joint] * (2.0 * np.pi * scene.uniform(5.0, 12.0)) ** 2
    load = float(np.max(np.abs(ref.tau[:, joint])))
    stiffness = max(stiffness, load / 0.05)
    ratio = scene.uniform(0.03, 0.12)
    damping = float(f"{2.0 * ratio * np.sqrt(stiffness * body[joint]):.4g}")
    compliance = 1.0 / float(f"{stiffness:.5g}")
    return Elasticity(joint=joint, compliance=compliance, damping=damping, softest=0.07 / load)


def joint_offset(scene: Scene) -> Effect:
    """An encoder's zero."""
    sign = scene.sign()
    return scene.somewhere(lambda j: JointOffset(joint=j, sign=sign))


def kinematic_error(scene: Scene) -> Effect:
    """A length, a twist or both; what an encoder's zero or a slide along an axis does is left."""
    rng, arm = scene.rng, scene.ref.arm
    kind = rng.choice(3, p=[0.5, 0.25, 0.25])
    raw_shift, raw_turn = rng.normal(size=3), rng.normal(size=3)

    def make(j: int) -> Effect:
        R = arm.joints[j].T_parent_joint[:3, :3]
        own, parent = R @ arm.joints[j].axis, arm.joints[max(j - 1, 0)].axis
        shift, turn = across(raw_shift, own, parent), R.T @ across(raw_turn, own, parent)
        shift = 0.005 * shift if kind != 1 else np.zeros(3)
        turn = 0.01 * turn if kind != 0 else np.zeros(3)
        return KinematicError(joint=j, shift=np.round(shift, 6), turn=np.round(turn, 6))

    places = [j for j in scene.places if j > 0] or [1]
    return scene.somewhere(make, places)


def across(vector: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """A unit vector without the parts along two axes."""
    axes = np.linalg.svd(np.column_stack([first, second]))
    span = axes[0][:, : int(np.sum(axes[1] > 1e-2))]
    rest = vector - span @ (span.T @ vector)
    return rest / np.linalg.norm(rest)


def coupling(scene: Scene) -> Effect:
    """A joint moved too by its neighbour's motor."""
    sign = scene.sign()

    def make(k: int) -> Effect:
        return Coupling(joint=k, other=k - 1 if k > 0 else 1, sign=sign)

    return scene.somewhere(make, [k for k in scene.places if k > 0] or [0])
