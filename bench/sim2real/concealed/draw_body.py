"""Random bodies and surroundings, sized against the noise."""

from __future__ import annotations

import numpy as np

from bench.sim2real.concealed.effect import Effect, Gate
from bench.sim2real.concealed.effects_body import (
    Contact,
    GravityDirection,
    LinkError,
    Payload,
    RotorInertia,
)
from bench.sim2real.concealed.scene import Scene


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
    gate = Gate(
        kind="time", low=low, high=round(low + length, 2), edge=0.1, recordings=(recording,)
    )
    direction = rng.normal(size=3)
    return scene.sized(
        Contact(
            link=link,
            direction=direction / np.linalg.norm(direction),
            at_tip=link == n - 1 and bool(rng.random() < 0.5),
            gate=gate,
        )
    )
