"""Ways of hiding: what each asks of the motions, the gate, the size, the model and the log."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.arm import Arm, Link
from bench.sim2real.concealed.catalogue import CORNERS, EFFECTS, WAYS, ways_of
from bench.sim2real.concealed.effect import Gate
from bench.sim2real.concealed.motion import Style, center
from bench.sim2real.concealed.spec import WorldSpec

OF_THE_BODY = (  # what errors of the model's inertias look like
    "payload",
    "link_inertial_error",
    "gravity_direction",
    "rotor_inertia",
    "torque_gain",
    "torque_offset",
    "joint_offset",
    "position_dependent_spring",
    "joint_coupling",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """How one study hides its effect."""

    places: tuple[int, ...]  # in random order; one only where the motion was made for it
    size: float
    gate: Gate
    style: Style
    corner: str
    tight: bool
    soft: bool  # a controller that bears late torques
    torque_logged: bool
    model_error: float  # relative, of all inertial figures


def plan(spec: WorldSpec, arm: Arm) -> Plan:
    """Checked, and drawn from the spec's own stream."""
    rng = spec.stream("hide")
    effect, way = spec.effect, spec.hide
    if way not in WAYS:
        raise ValueError(f"hide is {way!r}, expected one of {', '.join(WAYS)}")
    if effect in EFFECTS and way not in ways_of(effect):
        known = ", ".join(ways_of(effect))
        raise ValueError(f"hide is {way!r}, expected one of {known} for {effect}")
    places = tuple(int(j) for j in rng.permutation(arm.n))
    corner = str(rng.choice(CORNERS[effect])) if way == "corner" and effect in CORNERS else ""
    style, gate = Style(), Gate()
    if corner == "slow":
        places = places[:1]
        style = Style(slow=frozenset(places))
    elif corner == "position":
        gate = Gate(kind="position", low=float(rng.choice([0.0, 0.1, 0.65, 0.75])))
    elif corner == "time":
        gate = Gate(kind="time", low=float(np.round(rng.uniform(13.0, 15.5), 1)), high=1e9)
    if effect == "still" or way == "poor":
        places = places[:1]
        style = _still(spec, arm, places)
        if effect in OF_THE_BODY[:3] or effect in ("kinematic_error", "joint_offset"):
            style = _still(spec, arm, range(arm.n))
    low, high = (2.0, 3.5) if way == "noise" else (6.0, 25.0)
    size = spec.size or float(np.exp(rng.uniform(np.log(low), np.log(high))))
    return Plan(
        places=places,
        size=size,
        gate=gate,
        style=style,
        corner=corner,
        tight=way == "feedback",
        soft=way != "feedback" and rng.random() < (0.6 if effect == "actuator_lag" else 0.1),
        torque_logged=way != "no_torque",
        model_error=0.05 if way == "inertia" else 0.0,
    )


def _still(spec: WorldSpec, arm: Arm, joints: Iterable[int]) -> Style:
    """The same position in all recordings."""
    pose = center(arm, spec.stream("pose"))[0]
    return Style(still={j: float(pose[j]) for j in joints})


def misjudged(arm: Arm, error: float, rng: np.random.Generator) -> Arm:
    """The arm with every link's mass, centre of mass and inertia wrong by about `error`."""
    if error == 0.0:
        return arm
    for k, link in enumerate(arm.links):
        mass = link.mass * (1.0 + error * rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.2))
        com = link.com * (1.0 + error * rng.choice([-1.0, 1.0], 3) * rng.uniform(0.6, 1.2, 3))
        # second moments scale along each axis, so the inertia stays that of a body
        second = 0.5 * np.trace(link.inertia) * np.eye(3) - link.inertia
        scale = np.diag(np.sqrt(1.0 + error * rng.uniform(-1.2, 1.2, 3)))
        second = scale @ second @ scale
        inertia = np.trace(second) * np.eye(3) - second
        arm = arm.with_link(k, Link(mass=mass, com=com, inertia=inertia))
    return arm
