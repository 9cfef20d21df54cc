"""Closing the loop: a diagnosis, fed forward, brings a machine's tip where it shall be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[bench,sim2real]'")
pytest.importorskip("coal", reason="pip install 'pdoik[bench,sim2real]'")

import pinocchio as pin

import pdoik
from bench.ik.judges.recheck import spheroid_distance
from bench.sim2real.frame.arm import urdf
from bench.sim2real.frame.motion import STEP
from bench.sim2real.frame.study_files import joint_names
from bench.sim2real.loop.cell import Cell, Clearance, Shape
from bench.sim2real.loop.feed_forward import commands
from bench.sim2real.loop.path import CLEARANCE
from bench.sim2real.loop.trial import Experiment, corrected_robot, diagnosed, tip_errors
from pdoik.sim2real import Controller, Estimate, Finding, Model

SEED = 3400


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def tips(text: str, q: np.ndarray) -> np.ndarray:
    """Positions of a URDF's tool by Pinocchio, (T, 3)."""
    model = pin.buildModelFromXML(text)
    data, frame, result = model.createData(), model.getFrameId("tool"), []
    for row in q:
        pin.framesForwardKinematics(model, data, row)
        result.append(data.oMf[frame].translation.copy())
    return np.array(result)


def finding(effect: str, joint: int, variant: str = "", **values: float) -> Finding:
    estimates = {
        name: Estimate(value=value, std=0.0, interval95=(value, value), unit="-")
        for name, value in values.items()
    }
    return Finding(
        effect=effect, joints=(f"joint{joint + 1}",), parameters=estimates, variant=variant
    )


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory: pytest.TempPathFactory) -> tuple[Experiment, Model]:
    return recorded_and_diagnosed("coulomb_friction", tmp_path_factory)


@pytest.fixture(scope="module")
def off_zero(tmp_path_factory: pytest.TempPathFactory) -> tuple[Experiment, Model]:
    return recorded_and_diagnosed("joint_offset", tmp_path_factory)


def recorded_and_diagnosed(effect: str, folders: Any) -> tuple[Experiment, Model]:
    experiment, folder = Experiment(SEED, effect), folders.mktemp(effect)
    experiment.record(folder, seconds=6.0)
    return experiment, diagnosed(folder)[1]


def believed(experiment: Experiment, findings: tuple[Finding, ...] = ()) -> Model:
    """The user's model with these findings."""
    draft = experiment.draft
    control = draft.control
    return Model(
        joints=tuple(joint_names(draft.arm)),
        robot=urdf(draft.believed),
        tip="tool",
        controller=Controller(
            kp=control.kp, kd=control.kd, gravity_compensation=True, period=control.period
        ),
        rotor_inertia=draft.armature,
        findings=findings,
    )


def test_friction_that_was_found_and_fed_forward_stops_leading_the_tip_astray(
    rubbing: tuple[Experiment, Model],
) -> None:
    experiment, model = rubbing
    (path,) = experiment.test_paths(1)
    ways = experiment.ways(model, path)
    error = {way: rms(tip_errors(experiment, path, run)) for way, (run, _) in ways.items()}
    assert error["given"] > 1e-3  # large enough to matter
    assert error["diagnosed"] < 0.3 * error["given"]
    assert error["floor"] < 1e-4  # the same commands do on a machine that is as its model says


def test_solutions_for_the_corrected_robot_reach_the_real_targets(
    off_zero: tuple[Experiment, Model],
) -> None:
    experiment, model = off_zero
    (path,) = experiment.test_paths(1)
    offsets = np.zeros(experiment.draft.arm.n)
    for effect in experiment.hidden:
        offsets[effect.joint] += effect.encoder_offset
    errors = []
    for robot in (experiment.robot, corrected_robot(model)):
        motion = path.motion(robot, experiment.cell)
        there = tips(urdf(experiment.draft.arm), motion.q[::100] + offsets)
        errors.append(np.linalg.norm(there - path.targets()[::100], axis=1).max())
    assert errors[0] > 2e-3
    assert errors[1] < errors[0] / 5


def test_a_path_keeps_to_its_targets_between_the_solutions_and_clear_of_the_shapes(
    rubbing: tuple[Experiment, Model],
) -> None:
    experiment, _ = rubbing
    (path,) = experiment.test_paths(1)
    motion, targets = path.motion(experiment.robot, experiment.cell), path.targets()
    assert len(motion.q) == len(targets)
    there = tips(urdf(experiment.draft.arm), motion.q[::25])
    assert np.linalg.norm(there - targets[::25], axis=1).max() < 1e-4
    speeds = np.array([joint.speed for joint in experiment.draft.arm.joints])
    assert (np.abs(motion.dq) < speeds).all()
    for q in motion.q[::200]:
        poses = {link: experiment.robot.fk(q, link) for link in experiment.robot.link_names}
        assert experiment.clearance(poses) > CLEARANCE - 0.01  # points stand for the shapes


def test_clearance_is_the_distance_of_a_spheroid_from_a_ball() -> None:
    rng = np.random.default_rng(SEED)
    foci = np.array([[0.0, 0.05, -0.1], [0.02, -0.04, 0.15]])
    hull = ("link1", tuple(foci[0]), "link1", tuple(foci[1]), 0.2)
    occupancy = pdoik.Occupancy(spheroids=[hull])
    for _ in range(20):
        direction = rng.normal(size=3)
        center = 0.6 * direction / np.linalg.norm(direction)
        ball = Shape(center=center, edges=np.full(3, 0.3), ball=True)
        gap = Clearance(occupancy, Cell(shapes=(ball,), cloud=np.zeros((0, 3))))
        expected = spheroid_distance(center[None], foci[0], foci[1], 0.2)[0] - 0.15
        assert gap({"link1": np.eye(4)}) == pytest.approx(expected, abs=1e-5)


def test_late_commands_are_sent_earlier_by_the_delay() -> None:
    experiment = Experiment(SEED, "command_delay")
    (path,) = experiment.test_paths(1)
    motion = path.motion(experiment.robot, experiment.cell)
    late = believed(experiment, (finding("command_delay", 2, "position", delay=0.03),))
    plain, early = commands(believed(experiment), motion), commands(late, motion)
    rows = round(0.03 / STEP)
    assert early.q[:-rows, 2] == pytest.approx(plain.q[rows:, 2], abs=1e-9)
    others = [j for j in range(experiment.draft.arm.n) if j != 2]
    assert early.q[:, others] == pytest.approx(plain.q[:, others], abs=1e-9)


@pytest.mark.parametrize("effect", ["joint_elasticity", "torque_gain", "actuator_lag"])
def test_the_truth_fed_forward_leaves_little(effect: str) -> None:
    experiment = Experiment(SEED, effect)
    lag = effect == "actuator_lag"
    truth = tuple(
        finding(effect, j, "torque" if lag else "", **hidden.parameters())
        for hidden in experiment.hidden
        for j in hidden.joints(experiment.draft.ref)
    )
    (path,) = experiment.test_paths(1)
    ways = experiment.ways(believed(experiment, truth), path)
    before, after = (rms(tip_errors(experiment, path, ways[w][0])) for w in ("given", "diagnosed"))
    assert after < 0.3 * before
