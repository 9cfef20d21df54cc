"""A drive that gives less the faster it turns: MuJoCo stepped by the test, with the limit by hand.

The recordings are those of a PD loop written here, with commanded and delivered torques.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Diagnosis, Recording, Study, diagnose
from pdoik.sim2real.effects import CATALOGUE, parts_of
from pdoik.sim2real.motion import speed_torque_limit
from pdoik.sim2real.simulation import Drive, DriveChange, combine
from sim2real_effect_studies import named
from sim2real_recordings import even_recording
from sim2real_robots import arm_urdf

JOINTS = ("joint1", "joint2")
STALL, NO_LOAD = 34.0, 6.0  # [N m], [rad/s]
STEP, EVERY = 5e-4, 4  # [s], steps per logged sample
Limit = Callable[[float, float], float]


def by_speed(command: float, speed: float) -> float:
    """What a supply's voltage leaves: no more than the line, which falls along the torque."""
    side = 1.0 if command > 0.0 else -1.0
    return side * min(abs(command), max(STALL * (1.0 - side * speed / NO_LOAD), 0.0))


def at_a_level(command: float, speed: float) -> float:
    return float(np.clip(command, -24.0, 24.0))


def without(command: float, speed: float) -> float:
    return command


def run(limit: Limit, role: str, seed: int, rubs: bool = False, seconds: float = 20.0) -> Recording:
    """A PD loop in MuJoCo whose first joint's drive is limited, and what it logs."""
    model = mujoco.MjModel.from_xml_string(arm_urdf(2))
    model.opt.timestep = STEP
    model.dof_armature[:] = 0.05
    if rubs:
        model.dof_frictionloss[:] = 1.5
        model.dof_damping[:] = 0.8
    data = mujoco.MjData(model)
    rng = np.random.default_rng(seed)
    waves = [(0.55, 0.23 + 0.02 * seed, 0.3), (0.22, 0.9, 1.0 + seed), (0.05, 1.9, 2.0)]

    def aim(t: float, order: int) -> np.ndarray:
        total = np.array([1.2, -0.4]) if order == 0 else np.zeros(2)
        for amplitude, frequency, phase in waves:
            omega = 2 * np.pi * frequency * np.array([1.0, 1.3])
            turn = omega * t + phase * np.array([1.0, 2.0]) + order * np.pi / 2
            total = total + amplitude * omega**order * np.sin(turn)
        return total

    data.qpos[:], data.qvel[:] = aim(0.0, 0), aim(0.0, 1)
    rows = []
    for k in range(round(seconds / STEP)):
        mujoco.mj_forward(model, data)
        q, dq = data.qpos.copy(), data.qvel.copy()
        command = 300.0 * (aim(k * STEP, 0) - q) + 25.0 * (aim(k * STEP, 1) - dq)
        command += data.qfrc_bias
        given = np.array([limit(command[0], dq[0]), command[1]])
        data.qfrc_applied[:] = given
        if k % EVERY == 0:
            rows.append(np.concatenate([q, dq, given, command]))
        mujoco.mj_step(model, data)
    q, dq, given, command = np.split(np.array(rows), 4, axis=1)
    logged = even_recording(
        EVERY * STEP * np.arange(len(rows)),
        role=role,  # type: ignore[arg-type]
        q=q + 1e-6 * rng.standard_normal(q.shape),
        dq=dq + 1e-3 * rng.standard_normal(q.shape),
        tau=given + 0.05 * rng.standard_normal(q.shape),
        tau_cmd=command,
    )
    return replace(logged, name=f"{role}.csv")


def diagnosed(folder: Path, limit: Limit, rubs: bool = False) -> Diagnosis:
    robot = folder / "arm.urdf"
    robot.write_text(arm_urdf(2))
    recordings = (run(limit, "fit", 0, rubs), run(limit, "validate", 1, rubs))
    asked = np.abs(recordings[0].tau_cmd[:, 0]).max()  # type: ignore[index]
    assert limit is without or asked > 30.0
    study = Study(
        folder=folder,
        robot=robot,
        joints=JOINTS,
        recordings=recordings,
        split="by the test",
        rotor_inertia=np.full(2, 0.05),
    )
    return diagnose(study)


@pytest.mark.long
def test_stall_torque_and_no_load_speed_are_found(tmp_path: Path) -> None:
    diagnosis = diagnosed(tmp_path, by_speed)
    (finding,) = diagnosis.findings
    assert (finding.effect, finding.joints) == ("torque_speed_limit", ("joint1",))
    for name, true in (("stall_torque", STALL), ("no_load_speed", NO_LOAD)):
        low, high = finding.parameters[name].interval95
        assert low <= true <= high
        assert finding.values[name] == pytest.approx(true, rel=0.02)
    assert finding.variant == "command"
    assert diagnosis.verdict == "mismatch_explained"


def test_it_is_found_beside_friction(tmp_path: Path) -> None:
    diagnosis = diagnosed(tmp_path, by_speed, rubs=True)
    assert named(diagnosis, "torque_speed_limit") == [("joint1",)]
    assert named(diagnosis, "torque_saturation") == []
    assert {("joint1",), ("joint2",)} == set(named(diagnosis, "coulomb_friction"))


@pytest.mark.long
def test_a_limit_whatever_the_speed_is_plain_saturation(tmp_path: Path) -> None:
    diagnosis = diagnosed(tmp_path, at_a_level)
    (finding,) = diagnosis.findings
    assert (finding.effect, finding.joints) == ("torque_saturation", ("joint1",))
    assert finding.values["level"] == pytest.approx(24.0, rel=0.01)


@pytest.mark.long
def test_friction_alone_is_no_limit(tmp_path: Path) -> None:
    diagnosis = diagnosed(tmp_path, without, rubs=True)
    assert named(diagnosis, "torque_speed_limit") == []
    assert named(diagnosis, "torque_saturation") == []
    assert {("joint1",), ("joint2",)} == set(named(diagnosis, "coulomb_friction"))


def test_the_simulated_drive_gives_what_the_law_says() -> None:
    values = {"stall_torque": STALL, "no_load_speed": NO_LOAD}
    (part,) = parts_of("torque_speed_limit", ["joint1"], values=values)
    assert isinstance(part, DriveChange)
    drive = Drive(part, 1e-3)
    rng = np.random.default_rng(3)
    for command, speed in zip(rng.uniform(-90, 90, 200), rng.uniform(-8, 8, 200), strict=True):
        reported, exerted = drive(command, speed)
        assert reported == exerted == pytest.approx(by_speed(command, speed), abs=1e-12)
    both = combine([part, DriveChange(joint="joint1", limit=10.0)], "joint1")
    assert Drive(both, 1e-3)(90.0, 0.0)[0] == pytest.approx(10.0)
    assert Drive(both, 1e-3)(90.0, 0.9 * NO_LOAD)[0] == pytest.approx(0.1 * STALL)


@pytest.mark.parametrize("slope", [0.0, -0.5])
def test_a_line_is_a_line_only_where_it_falls(slope: float) -> None:
    time = 0.005 * np.arange(4000)
    speed, asked = 3.0 * np.sin(1.7 * time), 20.0 * np.sin(2.3 * time + 0.4)
    most = np.maximum(10.0 + slope * np.sign(asked) * speed, 0.0)
    given = np.sign(asked) * np.minimum(np.abs(asked), most)
    given += 0.02 * np.random.default_rng(0).standard_normal(len(time))
    top = speed_torque_limit([(given, asked, np.ones(len(time), dtype=bool), 0.005)], [speed])
    if slope == 0.0:
        assert top is None
    else:
        assert top is not None
        assert top.stall_torque == pytest.approx(10.0, rel=0.01)
        assert top.no_load_speed == pytest.approx(10.0 / -slope, rel=0.03)
    gain = speed_torque_limit(
        [(0.8 * asked, asked, np.ones(len(time), dtype=bool), 0.005)], [speed]
    )
    assert gain is None


def test_of_two_names_that_explain_the_same_the_simpler_wins() -> None:
    limit, plain = CATALOGUE["torque_speed_limit"], CATALOGUE["torque_saturation"]
    assert limit.complexity > plain.complexity
    assert plain.id in limit.confused_with
    assert limit.id in plain.confused_with
