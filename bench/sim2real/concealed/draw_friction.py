"""Random friction, sized against the noise."""

from __future__ import annotations

from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.effects_friction import Coulomb, Stribeck, Viscous
from bench.sim2real.concealed.effects_friction_laws import Asymmetric, Dahl, LoadDependent, Warming
from bench.sim2real.concealed.scene import Scene


def viscous(scene: Scene) -> Effect:
    """In proportion to speed."""
    return scene.somewhere(lambda j: Viscous(joint=j, gate=scene.gate_at(j)))


def coulomb(scene: Scene) -> Effect:
    """Half of them by MuJoCo's own dry friction."""
    native = bool(scene.rng.random() < 0.5)
    return scene.somewhere(lambda j: Coulomb(**scene.stick(j), native=native))


def stribeck(scene: Scene) -> Effect:
    """Beside a Coulomb level about as large."""
    speed, ratio = scene.uniform(0.05, 0.25), scene.uniform(0.6, 1.6)
    return scene.somewhere(lambda j: Stribeck(**scene.stick(j), speed=speed, coulomb_ratio=ratio))


def asymmetric(scene: Scene) -> Effect:
    """About a mean friction that leaves both directions positive."""
    share = 0.0 if scene.rng.random() < 0.4 else scene.uniform(0.1, 0.6)
    ratio, slope = scene.uniform(0.6, 1.5), scene.uniform(0.6, 1.5)
    figures = {"viscous_share": share, "coulomb_ratio": ratio, "viscous_ratio": slope}
    return scene.somewhere(lambda j: Asymmetric(**scene.stick(j), **figures))


def load_dependent(scene: Scene) -> Effect:
    """At a joint that carries load."""

    def make(j: int) -> Effect:
        return LoadDependent(**scene.stick(j), armature=float(scene.ref.armature[j]))

    return scene.somewhere(make, scene.loaded())


def presliding(scene: Scene) -> Effect:
    """Builds up over half a degree to four degrees."""
    way = scene.uniform(0.01, 0.07)
    return scene.somewhere(lambda j: Dahl(**scene.stick(j), displacement=way))


def drift(scene: Scene) -> Effect:
    """Warms up within a recording."""
    constant, ratio = scene.uniform(4.0, 12.0), scene.uniform(0.5, 1.5)
    figures = {"time_constant": constant, "coulomb_ratio": ratio}
    return scene.somewhere(lambda j: Warming(**scene.stick(j), **figures))
