"""The robots: descriptions, drives, where their IMU sits, and what touches the ground."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from bench.common.descriptions import MissingDescriptionError, go2_urdf
from bench.sim2real.legged.spec import Array

REPOSITORY = Path(__file__).parents[3]
H1 = REPOSITORY / "cpp" / "robots" / "h1.urdf"


@dataclass(frozen=True, slots=True, kw_only=True)
class Pad:
    """A sphere of a foot, in the foot link's frame."""

    center: tuple[float, float, float]  # [m]
    radius: float  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """What its maker says. Arrays are in the order of `joints`, legs first as `feet` has them."""

    name: str
    urdf: Path
    base: str  # link
    joints: tuple[str, ...]
    leg_size: int  # joints of a leg; the first len(feet) * leg_size joints are the legs'
    feet: tuple[str, ...]  # links
    pads: tuple[Pad, ...]  # of each foot
    hips: Array  # (feet, 2) where the feet stand below the base: x, y in its frame [m]
    height: float  # of the base when it stands [m]
    rest: Array  # (n,) near which it stands [rad]
    stiffness: float  # of a foot on the ground [N/m]
    kp: Array  # (n,) [N m/rad]
    kd: Array  # (n,) [N m s/rad]
    rotor: Array  # (n,) at the joint [kg m^2]
    effort: Array  # (n,) [N m]
    load: Array  # (n,) torques that these motions ask for, roughly [N m]
    speed: Array  # (n,) speeds of these motions, roughly [rad/s]
    trunk: str  # link that carries loads
    heavy: tuple[str, ...]  # leg links whose mass is felt
    lower: Array  # (n,) [rad]
    upper: Array  # (n,) [rad]
    imu_position: tuple[float, float, float]  # in the base's frame [m]
    imu_rpy: tuple[float, float, float]  # [rad]

    @property
    def sole(self) -> float:
        """Distance from a foot link's frame down to the ground [m]."""
        return max(pad.radius - pad.center[2] for pad in self.pads)

    @property
    def n(self) -> int:
        return len(self.joints)

    @property
    def legs(self) -> list[slice]:
        k = self.leg_size
        return [slice(i * k, (i + 1) * k) for i in range(len(self.feet))]


def robot(name: str) -> Robot:
    return {"go2": _go2, "h1": _h1}[name]()


def has_go2() -> bool:
    try:
        return go2_urdf().is_file()
    except MissingDescriptionError:
        return False


@cache
def _go2() -> Robot:
    feet = ("FL", "FR", "RL", "RR")
    joints = tuple(f"{leg}_{part}_joint" for leg in feet for part in ("hip", "thigh", "calf"))
    return Robot(
        name="go2",
        urdf=go2_urdf(),
        base="base",
        joints=joints,
        leg_size=3,
        feet=tuple(f"{leg}_foot" for leg in feet),
        pads=(Pad(center=(0.0, 0.0, 0.0), radius=0.022),),
        hips=np.array([[0.1934, 0.142], [0.1934, -0.142], [-0.1934, 0.142], [-0.1934, -0.142]]),
        height=0.30,
        rest=np.array([0.0, 0.85, -1.65] * 4),
        stiffness=1.5e5,
        kp=np.array([70.0, 70.0, 80.0] * 4),
        kd=np.array([2.5, 2.5, 3.0] * 4),
        rotor=np.array([0.01, 0.01, 0.02] * 4),
        load=np.array([3.5, 4.0, 8.0] * 4),
        speed=np.array([0.8, 1.5, 2.0] * 4),
        trunk="base",
        heavy=tuple(f"{leg}_{part}" for leg in feet for part in ("thigh", "calf")),
        imu_position=(-0.02557, 0.0, 0.04232),
        imu_rpy=(0.0, 0.0, 0.0),
        **_limits(go2_urdf(), joints),
    )


_H1_LEG = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle")
_H1_ARM = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow")


@cache
def _h1() -> Robot:
    sides = ("left", "right")
    leg = tuple(f"{side}_{part}_joint" for side in sides for part in _H1_LEG)
    arm = tuple(f"{side}_{part}_joint" for side in sides for part in _H1_ARM)
    joints = (*leg, "torso_joint", *arm)
    kp_leg, kd_leg = [300.0, 600.0, 300.0, 400.0, 120.0], [8.0, 14.0, 8.0, 10.0, 4.0]
    kp_arm, kd_arm = [80.0, 80.0, 60.0, 60.0], [3.0, 3.0, 2.0, 2.0]
    rotor_leg, rotor_arm = [0.1, 0.1, 0.1, 0.12, 0.04], [0.03, 0.03, 0.02, 0.02]
    arms = [[0.2, 0.15 * side, 0.0, 0.8] for side in (1, -1)]
    sole = [(x, y, -0.05) for x in (-0.05, 0.17) for y in (-0.03, 0.03)]
    return Robot(
        name="h1",
        urdf=H1,
        base="pelvis",
        joints=joints,
        leg_size=5,
        feet=tuple(f"{side}_ankle_link" for side in sides),
        pads=tuple(Pad(center=center, radius=0.02) for center in sole),
        hips=np.array([[-0.02, 0.20286], [-0.02, -0.20286]]),
        height=0.98,
        rest=np.array([0.0, 0.0, -0.35, 0.7, -0.35] * 2 + [0.0] + arms[0] + arms[1]),
        stiffness=6e5,
        kp=np.array(kp_leg * 2 + [300.0] + kp_arm * 2),
        kd=np.array(kd_leg * 2 + [8.0] + kd_arm * 2),
        rotor=np.array(rotor_leg * 2 + [0.1] + rotor_arm * 2),
        load=np.array([6.0, 15.0, 15.0, 35.0, 12.0] * 2 + [8.0] + [5.0, 5.0, 2.0, 2.5] * 2),
        speed=np.array([0.5, 0.5, 0.6, 0.8, 0.5] * 2 + [0.8] * 9),
        trunk="torso_link",
        heavy=tuple(f"{side}_{part}_link" for side in sides for part in ("hip_pitch", "knee")),
        imu_position=(-0.04, 0.0, -0.02),
        imu_rpy=(0.0, 0.0, 1.5708),
        **_limits(H1, joints),
    )


def _limits(urdf: Path, joints: tuple[str, ...]) -> dict[str, Array]:
    """Effort, lower and upper, each (n,), as the URDF says."""
    elements = {e.attrib["name"]: e for e in ElementTree.parse(urdf).getroot().findall("joint")}
    limits = []
    for name in joints:
        element = elements[name].find("limit")
        if element is None:
            raise ValueError(f"{urdf}: joint {name} has no limit")
        limits.append(element.attrib)
    return {key: np.array([float(a[key]) for a in limits]) for key in ("effort", "lower", "upper")}
