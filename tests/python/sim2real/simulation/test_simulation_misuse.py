"""What cannot be simulated is said, with the name of what is wrong."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="needs the Python package mujoco")

from pdoik.errors import LoadError
from pdoik.sim2real.effects import parts_of
from pdoik.sim2real.simulation import JointTorque, SimulationError, Simulator, Stepper
from sim2real_robots import MASS, PENDULUM, TURNTABLE, commands, pd

SLACK = {"stiffness": 0.0, "damping": 0.0}


def test_what_cannot_be_replayed_is_said() -> None:
    with pytest.raises(ValueError, match=r"rec.csv: nothing to replay.*no controller"):
        Simulator(PENDULUM, ["joint1"]).replay(commands(1.0, q_des=0.0))
    with pytest.raises(ValueError, match=r"nothing to replay.*got q$"):
        Simulator(PENDULUM, ["joint1"], pd(1.0, 1.0)).replay(commands(1.0))
    gaps = commands(1.0, q_des=lambda t: np.where(t > 0.5, np.nan, 0.0))
    with pytest.raises(ValueError, match=r"q_des.joint1 is needed"):
        Simulator(PENDULUM, ["joint1"], pd(1.0, 1.0)).replay(gaps)
    with pytest.raises(ValueError, match="window must be positive, got -1 s"):
        Simulator(PENDULUM, ["joint1"], pd(1.0, 1.0)).replay(commands(1.0, q_des=0.0), window=-1)
    with pytest.raises(ValueError, match=r"q0 has shape \(2,\), expected \(1,\)"):
        Simulator(PENDULUM, ["joint1"], pd(1.0, 1.0)).replay(
            commands(1.0, q_des=0.0), q0=np.zeros(2)
        )


def test_names_that_are_not_there_are_answered_with_the_nearest() -> None:
    with pytest.raises(ValueError, match="no joint 'joint_1', nearest: 'joint1'"):
        Simulator(PENDULUM, ["joint_1"])
    with pytest.raises(ValueError, match="no link 'lnk1', nearest: 'link1'"):
        Simulator(PENDULUM, ["joint1"], parts=parts_of("payload", [], ["lnk1"], None, {"mass": 1}))
    with pytest.raises(ValueError, match="no effect 'friction'"):
        parts_of("friction", ["joint1"])
    with pytest.raises(ValueError, match="coulomb_friction needs the parameter 'level', got lvl"):
        parts_of("coulomb_friction", ["joint1"], values={"lvl": 1.0})
    with pytest.raises(ValueError, match=r"stiffness of joint1 is 0\.0, expected more"):
        Stepper(PENDULUM, ["joint1"], parts_of("joint_elasticity", ["joint1"], values=SLACK))
    with pytest.raises(ValueError, match="torque has 2 entries, the robot has 1 joints"):
        Stepper(PENDULUM, ["joint1"]).step([0.0, 0.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot", "no XML"),
        ("<sdf/>", "expected a URDF or an MJCF"),
        ("<mujoco><worldbody><bod/></worldbody></mujoco>", "bod"),
        (PENDULUM.replace(f'mass value="{MASS}"', 'mass value="two"'), "inertial of link link1"),
    ],
)
def test_a_description_that_cannot_be_read_is_a_load_error(text: str, message: str) -> None:
    with pytest.raises(LoadError, match=message):
        Stepper(text, ["joint1"])


def test_links_that_no_body_can_be_are_simulated_with_the_nearest_and_massless_ones_noted() -> None:
    lost = parts_of("link_inertial_error", [], ["link1"], None, {"d_mass": -3.0})
    plant = Stepper(PENDULUM, ["joint1"], lost).plant
    assert any("link link1: its figures are no body's" in note for note in plant.notes)
    assert plant.model.body("link1").mass[0] > 0.0
    massless = '<robot name="r"><link name="a"/><link name="b"/><joint name="joint1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'  # noqa: E501
    stepper = Stepper(massless, ["joint1"])
    assert any("joint joint1 moves no inertia" in note for note in stepper.plant.notes)
    stepper.step([0.1])
    assert np.isfinite(stepper.q).all()


def test_a_robot_that_runs_away_is_stopped_with_the_joint_s_name() -> None:
    run = commands(20.0, q_des=0.1)
    away = JointTorque(joint="joint1", law=lambda t, q, dq, load: -50.0 * q - 10.0 * dq)
    with pytest.raises(SimulationError, match="joint joint1 first: its inertia in the model is"):
        Simulator(TURNTABLE, ["joint1"], pd(1.0, 1.0), parts=(away,)).replay(run)
