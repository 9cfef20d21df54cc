"""The machine: a Panda of the generator's, its controller and sensors, what is concealed in it."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

import pdoik
from bench.sim2real.concealed.draft import Draft, draft_of, misjudged
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.concealed.world import Run, World
from bench.sim2real.frame.arm import Array, urdf
from bench.sim2real.loop.cell import Clearance

EVERY = 10  # ticks between two at which the clearance is measured


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """Where the true machine was, tick by tick."""

    tip: Array  # (K, 3) true positions [m]
    clearance: Array  # (K / EVERY,) of the true links [m]


def machine(seed: int, model_error: float = 0.0) -> Draft:
    """Rotors, controller and sensors as the generator draws them.

    The control law is always PD with gravity compensation and commanded speeds. The believed arm's
    inertial figures are wrong by about `model_error`, relative.
    """
    spec = WorldSpec(seed=seed, effect="clean", robot="panda")
    draft = draft_of(spec)
    believed = misjudged(draft.arm, model_error, spec.stream("misjudged"))
    control = replace(draft.control, gravity_compensation=True, knows_speed=True)
    sensors = replace(draft.sensors, dq=True, tau_cmd=True)
    return replace(draft, believed=believed, control=control, sensors=sensors)


def believed_robot(draft: Draft) -> pdoik.Robot:
    """The generator's URDF in the solver, with the hulls of pdoik's own Panda."""
    return robot_of(urdf(draft.believed))


def robot_of(text: str) -> pdoik.Robot:
    """A URDF of the generator's names with the Panda's hulls."""
    robot = pdoik.Robot.from_urdf(text, tip_link="tool")
    hulls = pdoik.Robot.builtin("panda").occupancy
    robot.occupancy = pdoik.Occupancy(
        spheroids=[(renamed(a), u, renamed(b), v, size) for a, u, b, v, size in hulls.spheroids]
    )
    return robot


def renamed(link: str) -> str:
    """The generator's name of a link of pdoik's Panda."""
    number = link.removeprefix("panda_link")
    return "base" if number == "0" else f"link{number}"


def clean_world(draft: Draft) -> World:
    return World(draft.arm, draft.armature, draft.control, draft.sensors, ())


def outcome(simulation: Run, clearance: Clearance) -> Outcome:
    """True tip positions, and clearances, from MuJoCo's kinematics of the true machine."""
    model, data, truth = simulation.model, simulation.data, simulation.simulate()
    tip = np.empty((len(truth.time), 3))
    gaps = []
    bodies = {f"link{k + 1}": model.body(f"b{k}").id for k in range(simulation.world.arm.n)}
    for row, qpos in enumerate(truth.qpos):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        tip[row] = data.site_xpos[0]
        if row % EVERY == 0:
            gaps.append(
                clearance({"base": np.eye(4)} | {k: _pose(data, b) for k, b in bodies.items()})
            )
    return Outcome(tip=tip, clearance=np.array(gaps))


def _pose(data: mujoco.MjData, body: int) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = data.xmat[body].reshape(3, 3), data.xpos[body]
    return T
