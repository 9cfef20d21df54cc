"""What a user records before the diagnosis: paths among the obstacles, and an excitation."""

from __future__ import annotations

from pathlib import Path as Folder

import numpy as np
import numpy.typing as npt

from bench.sim2real.concealed import logger
from bench.sim2real.concealed.draft import Draft
from bench.sim2real.concealed.motion import STEP, Motion, Style, recording_motion
from bench.sim2real.concealed.study_files import joint_names, write_recording, write_study
from bench.sim2real.concealed.world import World
from bench.sim2real.loop.machine import run
from bench.sim2real.loop.path import motion_of, quintic

FloatArray = npt.NDArray[np.float64]

EXCITATIONS = (("sines", "reversals"), ("moves", "sines"), ("reversals", "moves"))
ROLES = ("fit", "fit", "validate")
SECONDS = 16.0  # of an excitation
CALM = 0.8  # rad/s, of moves from one part to the next
LOGGED = ["q", "dq", "q_des", "dq_des", "tau", "tau_cmd"]


def recorded_motion(
    draft: Draft, path: Motion, index: int, seconds: float, rng: np.random.Generator
) -> Motion:
    """A path, then an excitation of the empty cell."""
    kinds, pace = EXCITATIONS[index], (0.8, 0.9, 1.0)[index]
    excitation = recording_motion(draft.arm, rng, kinds, seconds, pace, Style())
    return motion_of(np.concatenate([path.q, _move(path.q[-1], excitation.q[0]), excitation.q]))


def _move(start: FloatArray, end: FloatArray) -> FloatArray:
    """From rest to rest."""
    duration = max(1.0, 1.9 * float(np.max(np.abs(end - start))) / CALM)
    s = quintic(np.arange(round(duration / STEP)) / round(duration / STEP))
    return np.asarray(start + s[:, None] * (end - start))


def write_commissioning(
    folder: Folder, draft: Draft, world: World, motions: list[Motion], seed: int, *, tip: bool
) -> None:
    """Run the motions on the true machine under PD control and write a study of what it logs."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng([seed, 11])
    for index, motion in enumerate(motions):
        simulation, truth = run(world, motion, rng, index)
        channels = logger.channels_of(truth, simulation)
        rows = logger.rows_of(channels, simulation)
        data = logger.measured(channels, simulation, rows)
        poses = logger.tip_poses(truth, simulation, rows) if tip else None
        write_recording(folder / f"rec{index + 1}.csv", data, LOGGED, poses, rng)
    control = draft.control
    study = {
        "robot": "robot.urdf",
        "tip": "tool",
        "joints": joint_names(draft.arm),
        "recordings": [
            {"file": f"rec{index + 1}.csv", "role": role} for index, role in enumerate(ROLES)
        ],
        "controller": {
            "type": "pd",
            "kp": control.kp.tolist(),
            "kd": control.kd.tolist(),
            "gravity_compensation": True,
            "period": control.period,
        },
        "rotor_inertia": draft.armature.tolist(),
    }
    if draft.believed is not draft.arm:
        study["trust"] = {"rigid_body": 0.1}
    write_study(folder, draft.believed, study)
