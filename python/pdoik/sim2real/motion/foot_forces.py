"""How high soles stand, what presses them, and when they slip: where the base's pose is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..study import Ground
from ..thresholds import FeetThresholds, NoiseThresholds
from .feet import FootMotion, force_by_position
from .free_rows import foot_directions
from .motion import Motion
from .signals import derivative, dilated, zero_phase

_STEEP = np.cos(np.radians(20.0))  # whose normal is lower than this is no sole that stands


def with_ground(
    motion: Motion,
    ground: Ground,
    noise: NoiseThresholds,
    limits: FeetThresholds,
    found: FloatArray | None = None,
) -> Motion:
    """The motion with all that its feet show of the ground.

    Args:
        motion: of a floating base.
        ground: as the user's simulator has it.
        noise: of the torques.
        limits: when a sole slips.
        found: (T, rows) torques that were found beyond the model's; none if None.
    """
    base = motion.base
    if base is None or not motion.feet:
        return motion
    loads = _loads(motion, noise, found)
    if loads is not None:
        motion = _with_loads(motion, loads)
    if base.position is None or base.rotation is None:
        return motion
    feet = []
    for foot in motion.feet:
        world = base.position + np.einsum("tij,tj->ti", base.rotation, foot.place)
        height = world[:, 2] - ground.height
        moving = np.einsum("tij,tj->ti", foot.jacobian, motion.dq) + np.cross(
            base.omega, foot.place
        )
        velocity = derivative(base.position, motion.period)
        velocity += np.einsum("tij,tj->ti", base.rotation, moving)
        velocity = zero_phase(velocity, 0.5 * motion.cutoff, motion.period)
        speed = np.linalg.norm(velocity[:, :2], axis=1)
        force = foot.force
        if force is not None:
            force = np.einsum("tij,tj->ti", base.rotation, force)
        pressed = foot.pressed
        if pressed is None and force is not None:
            pressed = force[:, 2]
        tilt = _tilt(foot, base.rotation)
        grip, slips = _grip(motion, foot, speed, force, ground, limits)
        feet.append(
            replace(
                foot,
                world=world,
                height=None if foot.foot.sole is None else height,
                tilt=tilt,
                rocks=_rocks(foot, tilt, limits),
                normal=pressed,
                grip=grip,
                slips=slips,
            )
        )
    return replace(motion, feet=tuple(feet))


def _tilt(foot: FootMotion, rotation: FloatArray) -> FloatArray | None:
    """Rise of its sole along the world's x and y, (T, 2), where it can be that of the ground."""
    if foot.upright is None or not foot.stands.any():
        return None
    normal = np.einsum("tij,tj->ti", rotation, foot.upright)
    if np.median(normal[foot.stands, 2]) < _STEEP:
        return None
    return np.asarray(-normal[:, :2] / np.maximum(normal[:, 2:], _STEEP))


def _rocks(foot: FootMotion, tilt: FloatArray | None, limits: FeetThresholds) -> tuple[bool, ...]:
    """Axes along which the sole of a standing foot follows no ground."""
    if tilt is None:
        return (True, True)
    return tuple(bool(each > limits.tilt) for each in tilt[foot.stands].std(axis=0))


def _with_loads(motion: Motion, loads: list[FloatArray]) -> Motion:
    """The motion with the torques of the likeliest foot forces, and their change by joints."""
    assert motion.body is not None
    pairs = list(zip(motion.feet, loads, strict=True))
    each = [force_by_position(foot, load[:, :3], motion.body.depth) for foot, load in pairs]
    by_feet = -np.sum(each, axis=0)
    before = motion.cache.get("dtau_dq by feet", 0.0)
    torques = [np.einsum("trk,tk->tr", foot.wrench, load) for foot, load in pairs]
    return replace(
        motion,
        feet=tuple(replace(foot, load=load) for foot, load in pairs),
        dtau_dq=motion.dtau_dq - before + by_feet,
        cache={
            **{name: each for name, each in motion.cache.items() if not name.startswith("play ")},
            "dtau_dq by feet": by_feet,
            "tau by feet": -np.sum(torques, axis=0),
        },
    )


def _grip(
    motion: Motion,
    foot: FootMotion,
    speed: FloatArray,
    force: FloatArray | None,
    ground: Ground,
    limits: FeetThresholds,
) -> tuple[FloatArray | None, NDArray[np.bool_]]:
    """Tangential force beyond what the simulator's friction gives, and when the sole slips."""
    nowhere = np.zeros(len(motion.time), dtype=np.bool_)
    if force is None or ground.friction is None:
        return None, nowhere
    around = int(0.3 / (motion.cutoff * motion.period)) + 1
    smear = int(1.0 / (motion.cutoff * motion.period)) + 1  # of the speed before it touched
    slips = ~dilated(~foot.stands, smear) & ~dilated(speed < limits.slipping, around)
    tangential = np.linalg.norm(force[:, :2], axis=1)
    return tangential - ground.friction * force[:, 2], slips


def _loads(
    motion: Motion, noise: NoiseThresholds, found: FloatArray | None
) -> list[FloatArray] | None:
    """What each foot takes, (T, 3 or 6): the likeliest by torques and base."""
    if motion.torque is None or motion.setup.held:
        return None
    left = motion.tau if found is None else motion.tau + found
    left = left.copy()
    left[:, : motion.n] -= np.nan_to_num(motion.torque)
    sizes = foot_directions(motion, noise).sizes(left)
    loads, first = [], 0
    for foot in motion.feet:
        last = first + foot.wrench.shape[2]
        loads.append(zero_phase(sizes[:, first:last], motion.cutoff, motion.period))
        first = last
    return loads
