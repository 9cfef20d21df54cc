"""Where the worlds' tips and links are: geometry by Pinocchio, play and elasticity by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")

import pinocchio as pin

from bench.sim2real.concealed.build import drawn
from bench.sim2real.concealed.draft import draft_of
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.concealed.world import Run, World
from concealed_judge import Judge, made, rms


def tips(judge: Judge, file: str) -> tuple[np.ndarray, np.ndarray]:
    """Positions of the joints and measured tips, (T, n) and (T, 3), some rows."""
    names = (judge.folder / file).read_text().split("\n", 1)[0].split(",")
    table = np.loadtxt(judge.folder / file, delimiter=",", skiprows=1)[::25]
    q = np.column_stack([table[:, names.index(f"q.{joint}")] for joint in judge.joints])
    return q, np.column_stack([table[:, names.index(f"tip.{axis}")] for axis in "xyz"])


def forward(model: object, q: np.ndarray) -> np.ndarray:
    data, frame, result = model.createData(), model.getFrameId("tool"), []
    for row in q:
        pin.framesForwardKinematics(model, data, row)
        result.append(data.oMf[frame].translation.copy())
    return np.array(result)


@pytest.mark.parametrize("effect", ["joint_offset", "joint_coupling", "kinematic_error"])
def test_tips_are_where_the_truths_geometry_has_them(tmp_path: Path, effect: str) -> None:
    seed = next(
        seed
        for seed in range(40)
        if draft_of(WorldSpec(seed=seed, effect=effect, robot="random4")).sensors.tip
    )
    judge, truth = made(tmp_path / "a", effect=effect, robot="random4", seed=seed)
    p, joint, model = truth.effects[0]["parameters"], judge.index(truth), judge.model.copy()
    q, measured = tips(judge, judge.files[0])
    before = measured - forward(model, q)
    if effect == "joint_offset":
        q[:, joint] += p["offset"]
    elif effect == "joint_coupling":
        q[:, joint] += p["ratio"] * q[:, judge.joints.index(truth.effects[0]["joints"][1])]
    else:
        place = model.jointPlacements[joint + 1]
        turn = pin.rpy.rpyToMatrix(p["rx"], p["ry"], p["rz"])
        shift = np.array([p["dx"], p["dy"], p["dz"]])
        model.jointPlacements[joint + 1] = pin.SE3(place.rotation @ turn, place.translation + shift)
    after = measured - forward(model, q)
    assert np.max(rms(before)) > 3.0 * truth.noise["tip"]
    assert np.all(rms(after) < 1.2 * truth.noise["tip"])


def test_a_link_with_backlash_stays_within_its_stops() -> None:
    draft = draft_of(WorldSpec(seed=2, effect="backlash", robot="random3"))
    (effect,) = drawn(draft)
    effect = replace(effect, gap=0.01)
    world = World(draft.arm, draft.armature, draft.control, draft.sensors, (effect,))
    runs = [Run(world, motion, 0, np.random.default_rng(0)) for motion in draft.motions]
    hinge = runs[0].model.joint(f"s{effect.joint}").qposadr[0]
    play = np.concatenate([run.simulate().qpos[:, hinge] for run in runs])
    assert np.max(np.abs(play)) < 0.005 + 3e-4
    assert np.min(play) < -0.0045
    assert np.max(play) > 0.0045


def test_an_elastic_joint_yields_by_its_load_over_its_stiffness() -> None:
    draft = draft_of(WorldSpec(seed=4, effect="joint_elasticity", robot="panda"))
    (effect,) = drawn(draft)
    world = World(draft.arm, draft.armature, draft.control, draft.sensors, (effect,))
    run = Run(world, draft.motions[0], 0, np.random.default_rng(0))
    rows = run.simulate()
    wound = rows.qpos[:, run.model.joint(f"s{effect.joint}").qposadr[0]]
    slow = np.max(np.abs(rows.dq), axis=1) < 0.02
    load = np.array([world.believed.gravity(q)[effect.joint] for q in rows.q[slow]])
    assert np.median(np.abs(wound[slow] * effect.stiffness + load)) < 0.1 * np.median(np.abs(load))
