"""Replays: where they start again, what drives them, that they repeat, what they add and skip."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="needs the Python package mujoco")

from pdoik.sim2real.effects import CATALOGUE, parts_of
from pdoik.sim2real.simulation import Simulator, Stepper
from sim2real_robots import PENDULUM, TURNTABLE, arm_urdf, commands, parts, pd


def test_windows_start_again_from_the_recording() -> None:
    truth = parts("viscous_friction", coefficient=2.0)
    q_des = commands(4.0, q=0.1, q_des=lambda t: 0.1 + 0.5 * np.sin(2 * t))
    recorded = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0), parts=truth).replay(q_des)
    whole = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0)).replay(recorded)
    short = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0)).replay(recorded, window=0.05)
    same = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0), parts=truth).replay(
        recorded, window=0.05
    )
    assert np.abs(short.q - recorded.q).max() < 0.5 * np.abs(whole.q - recorded.q).max()
    assert np.abs(short.q - recorded.q).max() > 1e-4
    assert same.q == pytest.approx(recorded.q, abs=1e-9)
    assert "every 0.05 s" in short.notes[0]


def test_without_a_controller_the_recorded_torque_drives_and_the_notes_say_so() -> None:
    run = commands(2.0, q=0.1, q_des=lambda t: 0.1 + 0.5 * np.sin(2 * t))
    recorded = Simulator(PENDULUM, ["joint1"], pd(150.0, 10.0)).replay(run)
    again = Simulator(PENDULUM, ["joint1"]).replay(recorded)
    assert again.q == pytest.approx(recorded.q, abs=1e-3)
    assert "open loop" in again.notes[0]
    assert "every 0.2 s" in again.notes[0]


def test_a_joint_that_a_recorded_torque_drives_away_is_put_back() -> None:
    run = commands(3.0, n=2, q_des=lambda t: np.stack([np.sin(2 * t), np.cos(3 * t) - 1], axis=1))
    joints = ["joint1", "joint2"]
    truth = parts("coulomb_friction", "joint2", level=8.0)
    rotors = np.array([0.1, 0.5])
    recorded = Simulator(arm_urdf(2), joints, pd(900.0, 60.0, 2), rotors, truth).replay(run)
    bare = Simulator(arm_urdf(2), joints, rotor_inertia=np.array([0.1, 0.0]))
    off = {
        held: np.abs(bare.replay(recorded, drift_reset=held).q - recorded.q).max(axis=0)
        for held in (False, True)
    }
    assert off[False][1] > 1.0
    assert 0.25 < off[True].max() < 0.6  # 0.3 rad, and what 4 ms more make of it
    assert bare.put_back["joint2"] > 2 * bare.put_back.get("joint1", 0)  # which it pulls along
    known = Simulator(arm_urdf(2), joints, rotor_inertia=rotors, parts=truth)
    held = known.replay(recorded, drift_reset=True)
    assert known.put_back == {}
    np.testing.assert_array_equal(held.q, known.replay(recorded).q)


def test_the_same_commands_give_the_same_motion_to_the_last_bit() -> None:
    run = commands(1.0, n=2, q_des=lambda t: np.stack([np.sin(3 * t), np.cos(2 * t) - 1], axis=1))
    added = (
        *parts("presliding_hysteresis", level=1.0, displacement=0.01),
        *parts("actuator_lag", "joint2", time_constant=0.01),
        *parts("coulomb_friction", "joint2", level=1.0),
    )
    make = lambda: Simulator(arm_urdf(2), ["joint1", "joint2"], pd(300.0, 20.0, 2), parts=added)  # noqa: E731
    simulator = make()
    first, second, third = simulator.replay(run), simulator.replay(run), make().replay(run)
    for other in (second, third):
        assert first.q.tobytes() == other.q.tobytes()
        assert np.asarray(first.tau).tobytes() == np.asarray(other.tau).tobytes()


def test_stepping_by_hand_is_what_a_replay_does() -> None:
    run = commands(1.0, tau_cmd=lambda t: np.sin(5 * t), q=0.2)
    added = (
        *parts("presliding_hysteresis", level=0.5, displacement=0.01),
        *parts("actuator_lag", time_constant=0.01),
    )
    whole = Simulator(PENDULUM, ["joint1"], parts=added).replay(run, window=1.0)
    stepper = Stepper(PENDULUM, ["joint1"], added)
    stepper.reset(run.q[0])
    for k in range(len(run.time) - 1):
        assert run.tau_cmd is not None
        assert stepper.q == pytest.approx(whole.q[k], abs=1e-12)
        stepper.step(run.tau_cmd[k])


def test_every_effect_of_the_table_has_its_parts() -> None:
    run = commands(0.1, n=2, q_des=0.0)
    for effect, known in CATALOGUE.items():
        if known.of_floating_base:  # no simulation here has a base that floats
            assert known.not_simulated({})
            continue
        values = known.example.values
        added = parts_of(effect, ["joint1", "joint2"], values=values)
        assert added or effect == "sensor_noise"
        simulator = Simulator(arm_urdf(2), ["joint1", "joint2"], pd(100.0, 10.0, 2), parts=added)
        assert np.isfinite(simulator.replay(run).q).all()


def test_rotors_that_a_model_lacks_are_added_where_the_controller_would_shake_it() -> None:
    run = commands(2.0, q_des=0.1)
    simulator = Simulator(TURNTABLE, ["joint1"], pd(1e4, 1e3, period=0.005))
    result = simulator.replay(run)
    assert result.q[-1, 0] == pytest.approx(0.1, abs=1e-3)
    assert "rotor inertias were added, in kg m^2: 5 of joint1" in result.notes[1]
    soft = Simulator(TURNTABLE, ["joint1"], pd(100.0, 10.0, period=0.001))
    assert len(soft.replay(run).notes) == 1


def test_meshes_that_nobody_has_are_not_needed() -> None:
    mesh = '<visual><geometry><mesh filename="package://no/where.dae"/></geometry></visual>'
    robot = arm_urdf(1, extra=mesh + mesh.replace("visual", "collision"))
    run = commands(0.5, q_des=0.3)
    with_mesh = Simulator(robot, ["joint1"], pd(100.0, 5.0)).replay(run)
    without = Simulator(PENDULUM, ["joint1"], pd(100.0, 5.0)).replay(run)
    assert with_mesh.q == pytest.approx(without.q, abs=0)
