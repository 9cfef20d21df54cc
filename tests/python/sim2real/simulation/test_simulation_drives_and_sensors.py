"""Simulated delays, lags, limits and errors of what drives a joint and of what reads it."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="needs the Python package mujoco")

from pdoik.sim2real.effects import parts_of
from pdoik.sim2real.simulation import Simulator, Stepper
from sim2real_robots import ABOUT_PIVOT, LENGTH, MASS, PENDULUM, TURNTABLE, G, commands, parts, pd


@pytest.mark.parametrize("delay", [0.01, 0.0375])
def test_a_command_delay_shifts_the_motion_by_just_that(delay: float) -> None:
    def wave(t: np.ndarray) -> np.ndarray:
        return 0.3 * np.sin(6 * np.clip(t - 0.2, 0.0, None)) ** 2

    run = commands(2.0, period=5e-4, q_des=wave)
    controller = pd(400.0, 20.0)
    prompt = Simulator(TURNTABLE, ["joint1"], controller, timestep=5e-4).replay(run)
    late = Simulator(
        TURNTABLE, ["joint1"], controller, parts=parts("command_delay", delay=delay), timestep=5e-4
    ).replay(run)
    expected = np.interp(run.time - delay, run.time, prompt.q[:, 0])
    assert late.q[:, 0] == pytest.approx(expected, abs=2e-5)
    assert np.abs(prompt.q - late.q).max() > 5e-3


@pytest.mark.parametrize("effect", ["command_delay", "actuator_lag"])
def test_delays_and_lags_of_the_position_and_of_the_torque_are_not_the_same(effect: str) -> None:
    run = commands(3.0, q_des=lambda t: 0.3 * np.sin(3 * t), dq_des=lambda t: 0.9 * np.cos(3 * t))
    values = {{"command_delay": "delay", "actuator_lag": "time_constant"}[effect]: 0.01}
    of = {
        variant: Simulator(
            TURNTABLE,
            ["joint1"],
            pd(100.0, 8.0),
            parts=parts_of(effect, ["joint1"], values=values, variant=variant),
        ).replay(run)
        for variant in ("position", "torque")
    }
    plain = Simulator(TURNTABLE, ["joint1"], pd(100.0, 8.0)).replay(run)
    assert plain.dq is not None
    settled = plain.time > 0.5
    speed = plain.dq[settled]
    later = {
        variant: float(np.sum(speed * (plain.q - each.q)[settled]) / np.sum(speed**2))
        for variant, each in of.items()
    }
    assert later["torque"] < 0.3 * later["position"]  # the loop makes up for torque that is late
    if effect == "command_delay":
        assert later["position"] == pytest.approx(0.01, abs=1e-3)


def test_a_delayed_torque_command_acts_later() -> None:
    def step(t: np.ndarray) -> np.ndarray:
        return np.where(t >= 0.1 - 1e-9, 1.0, 0.0)

    run = commands(0.5, tau_cmd=step)
    added = parts("command_delay", delay=0.05)
    result = Simulator(TURNTABLE, ["joint1"], parts=added).replay(run, window=0.5)
    assert result.tau is not None
    assert result.time[np.argmax(result.tau[:, 0] > 0.5)] == pytest.approx(0.15, abs=1.1e-3)

    stepper = Stepper(TURNTABLE, ["joint1"], added)
    torques = []
    for u in step(run.time):
        stepper.step([u])
        torques.append(float(stepper.tau[0]))
    assert run.time[int(np.argmax(np.array(torques) > 0.5))] == pytest.approx(0.15, abs=1.1e-3)


def test_a_lagging_drive_answers_a_step_exponentially() -> None:
    run = commands(0.3, tau_cmd=lambda t: np.where(t > 0.0005, 2.0, 0.0))
    added = parts("actuator_lag", time_constant=0.04)
    result = Simulator(TURNTABLE, ["joint1"], parts=added).replay(run, window=0.3)
    since = np.clip(run.time - 1e-3, 0.0, None)  # of the step
    assert result.tau is not None
    assert result.tau[:, 0] == pytest.approx(2.0 * (1 - np.exp(-since / 0.04)), abs=1e-9)
    # What is exerted is what moves it: the integral of the answer.
    speed = 2.0 / ABOUT_PIVOT * (since - 0.04 * (1 - np.exp(-since / 0.04)))
    assert result.dq is not None
    assert result.dq[:, 0] == pytest.approx(speed, abs=1e-9)


def test_a_saturated_drive_gives_no_more_than_its_level() -> None:
    run = commands(1.0, q_des=0.5)
    added = parts("torque_saturation", level=3.0)
    result = Simulator(TURNTABLE, ["joint1"], pd(100.0, 5.0), parts=added).replay(run)
    assert result.tau is not None
    assert result.tau_cmd is not None
    assert np.abs(result.tau).max() == 3.0
    assert np.abs(result.tau_cmd).max() > 40.0
    start = result.time < 0.1
    assert result.q[start, 0] == pytest.approx(
        1.5 / ABOUT_PIVOT * result.time[start] ** 2, abs=1e-9
    )


def test_the_controller_s_own_limit_shows_in_the_command() -> None:
    run = commands(0.5, q_des=0.5)
    controller = pd(100.0, 5.0, torque_limit=np.array([4.0]))
    result = Simulator(TURNTABLE, ["joint1"], controller).replay(run)
    assert result.tau_cmd is not None
    assert np.abs(result.tau_cmd).max() == 4.0


@pytest.mark.parametrize(("gain", "offset"), [(1.25, 0.0), (1.0, 0.6), (0.8, -0.4)])
def test_a_drive_exerts_what_it_reports_less_its_error(gain: float, offset: float) -> None:
    run = commands(3.0, q=0.2, q_des=0.2)
    added = parts("torque_gain", gain=gain) + parts("torque_offset", offset=offset)
    result = Simulator(PENDULUM, ["joint1"], pd(900.0, 40.0), parts=added).replay(run)
    assert result.tau is not None
    true = -MASS * G * LENGTH * np.cos(result.q[-1, 0])
    assert result.tau[-1, 0] == pytest.approx(gain * true + offset, abs=1e-6)
    reported = Simulator(PENDULUM, ["joint1"], parts=added).replay(
        commands(1.0, q=result.q[-1, 0], tau=result.tau[-1, 0]), window=1.0
    )
    assert np.ptp(reported.q) < 1e-4  # what was reported holds it


def test_a_controller_with_a_period_holds_its_torque() -> None:
    run = commands(0.2, q_des=0.5)
    result = Simulator(TURNTABLE, ["joint1"], pd(20.0, 1.0, period=0.01)).replay(run)
    assert result.tau is not None
    changes = np.flatnonzero(np.diff(result.tau[:, 0]))
    assert (np.diff(changes) == 10).all()
    assert len(changes) > 15


def test_encoders_zeros_gains_and_late_logs_are_seen_by_what_reads_them() -> None:
    run = commands(2.0, q_des=lambda t: 0.3 * np.sin(3 * t), dq_des=lambda t: 0.9 * np.cos(3 * t))
    plain = Simulator(TURNTABLE, ["joint1"], pd(900.0, 40.0)).replay(run, tip=True)
    off = Simulator(
        TURNTABLE, ["joint1"], pd(900.0, 40.0), parts=parts("joint_offset", offset=0.1)
    ).replay(run, tip=True)
    assert off.q == pytest.approx(plain.q, abs=1e-9)  # about an upright axis zero is anywhere
    assert off.tip is not None
    yaw = 2 * np.arctan2(off.tip[:, 6], off.tip[:, 3])
    assert yaw == pytest.approx(off.q[:, 0] + 0.1, abs=1e-9)

    skew = parts_of("timestamp_skew", ["joint1"], values={"skew": 0.02}, variant="speed")
    late = Simulator(TURNTABLE, ["joint1"], pd(900.0, 40.0), parts=skew).replay(run)
    assert late.q == pytest.approx(plain.q, abs=0)
    assert late.dq is not None
    assert plain.dq is not None
    assert late.dq[20:] == pytest.approx(plain.dq[:-20], abs=1e-9)

    gain = parts_of("sensor_gain", ["joint1"], values={"gain": 2.0}, variant="torque")
    loud = Simulator(TURNTABLE, ["joint1"], pd(900.0, 40.0), parts=gain).replay(run)
    assert loud.q == pytest.approx(plain.q, abs=0)
    assert loud.tau == pytest.approx(2.0 * np.asarray(plain.tau), abs=1e-12)


@pytest.mark.parametrize(("variant", "channel"), [("position", "q"), ("speed", "dq")])
def test_what_is_wrong_in_the_log_alone_does_not_move_the_arm(variant: str, channel: str) -> None:
    run = commands(2.0, q_des=lambda t: 0.3 * np.sin(3 * t), dq_des=lambda t: 0.9 * np.cos(3 * t))
    plain, sensed, logged = (
        Simulator(
            TURNTABLE,
            ["joint1"],
            pd(100.0, 8.0),
            parts=parts_of("sensor_gain", ["joint1"], values={"gain": gain}, variant=of),
        ).replay(run, q0=np.zeros(1), dq0=np.zeros(1))
        for gain, of in ((1.0, variant), (1.2, variant), (1.2, f"logged {variant}"))
    )
    assert getattr(logged, channel) == pytest.approx(1.2 * getattr(plain, channel), abs=1e-9)
    assert logged.tau == pytest.approx(plain.tau, abs=1e-9)
    assert np.abs(np.asarray(sensed.tau) - np.asarray(plain.tau)).max() > 0.05
