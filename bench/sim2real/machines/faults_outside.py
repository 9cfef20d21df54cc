"""Physics that no catalogue has a name for, nor a single variable that it depends on."""

from dataclasses import replace

import numpy as np
from scipy.signal import butter, sosfilt

from bench.sim2real.machines.fault import Fault, Log, Scene
from bench.sim2real.machines.figures import Array


def _tool(scene: Scene, figures: dict[str, float], **parameters: float) -> Fault:
    """Something at the tool, by figures of the whole machine."""
    return Fault(
        links=(scene.n - 1,),
        parameters=parameters,
        figures=lambda machine: machine.with_whole(**figures),
    )


def _joint(j: int, figures: dict[str, float], **parameters: float) -> Fault:
    return Fault(
        joints=(j,), parameters=parameters, figures=lambda machine: machine.with_joint(j, **figures)
    )


def _shaken(scene: Scene, low: float, high: float, most: float) -> float:
    """A mass that takes a share of the strongest drive's rated torque [kg]."""
    share = scene.size(low, high, most) * np.max(scene.machine.rated)
    return float(f"{share / 9.81 / scene.reach():.3g}")


def slosh(scene: Scene) -> Fault:
    """A tank half full at the tool."""
    mass, rate = _shaken(scene, 0.12, 0.3, 0.6), 2.0 * np.pi * scene.uniform(0.8, 2.0)
    figures = {"mode_mass": mass, "mode_rate": rate, "mode_loss": 0.05}
    return _tool(scene, {**figures, "mode_x": 0.0, "mode_y": 1.0, "mode_z": 0.0}, mass=mass)


def rattle(scene: Scene) -> Fault:
    """A part that is loose in its box."""
    mass, play = _shaken(scene, 0.1, 0.25, 0.6), scene.uniform(0.01, 0.03)
    figures = {"mode_mass": mass, "mode_rate": 100.0, "mode_loss": 0.2, "rattle": play}
    return _tool(scene, figures, mass=mass, play=play)


def spinning_tool(scene: Scene) -> Fault:
    """A grinder that runs."""
    fast = float(np.max(np.std(scene.dq, axis=0)))
    size = scene.size(0.1, 0.25, 0.8) * np.median(scene.machine.rated)
    spin = float(f"{size / max(fast, 0.1):.3g}")
    return _tool(scene, {"spin": spin}, spin=spin)


def brake_drag(scene: Scene) -> Fault:
    """A holding brake that touches now and then."""
    j = scene.joint()
    level = scene.rated(j, 0.15, 0.35)

    def braked(ticks: int, joints: int, rng: np.random.Generator) -> Array:
        touch, k = np.zeros((ticks, joints)), 0
        while k < ticks:
            k += int(rng.exponential(2500))
            length = int(rng.uniform(200, 1500))
            touch[k : k + length, j] = 1.0
            k += length
        return touch

    return replace(_joint(j, {"brake": level}, level=level), braked=braked)


def snag(scene: Scene) -> Fault:
    """A cable that is dragged along and stays where it was left."""
    j = scene.joint()
    level, reach = scene.rated(j, 0.12, 0.3), scene.uniform(0.25, 0.5)
    return _joint(j, {"snag": level, "snag_reach": reach}, level=level, reach=reach)


def slip(scene: Scene) -> Fault:
    """A clamp that gives way under load: the link is elsewhere afterwards."""
    j = scene.loaded()
    level = scene.quantile(scene.tau[:, j], 0.9, 0.95)
    return _joint(j, {"slip": level}, level=level)


def gusts(scene: Scene) -> Fault:
    """Air from a fan, or somebody who shakes the table."""
    share = scene.size(0.08, 0.2, 0.5) * np.max(scene.machine.rated)
    size = float(f"{share / scene.reach():.3g}")

    def push(recording: int, ticks: int, rng: np.random.Generator) -> Array:
        band = butter(2, [0.4, 4.0], btype="band", fs=1000.0, output="sos")
        noise = sosfilt(band, rng.normal(size=(ticks, 3)), axis=0)
        return np.asarray(size * noise / np.std(noise))

    return Fault(links=(scene.n - 1,), parameters={"force": size}, push=push)


def sag(scene: Scene) -> Fault:
    """A supply whose voltage falls as all drives pull together."""
    share = scene.size(0.25, 0.5, 0.8)
    fault = _tool(scene, {"sag": share}, share=share)
    return replace(fault, links=(), joints=tuple(range(scene.n)))


def crosstalk(scene: Scene) -> Fault:
    """A current sensor next to another motor's cable."""
    j = scene.joint()
    other = int(scene.rng.choice([k for k in range(scene.n) if k != j]))
    ratio = float(scene.machine.rated[j] / np.std(scene.tau[:, other]) * scene.size(0.1, 0.2, 0.6))

    def change(log: Log, rng: np.random.Generator) -> None:
        log["tau"][:, j] += ratio * log["tau"][:, other]

    return Fault(joints=(j,), parameters={"ratio": ratio}, log=change)


def glitches(scene: Scene) -> Fault:
    """An encoder that is a tooth off for moments."""
    j, tooth = scene.joint(), scene.size(0.03, 0.1, 0.4)

    def change(log: Log, rng: np.random.Generator) -> None:
        count = len(log["q"])
        for start in rng.integers(0, count, max(3, count // 400)):
            log["q"][start : start + rng.integers(1, 5), j] += tooth

    return Fault(joints=(j,), parameters={"tooth": tooth}, log=change)
