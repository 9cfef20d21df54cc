"""What acts on a simulated joint, against formulas and SciPy's integration."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytest.importorskip("mujoco", reason="needs the Python package mujoco")

from pdoik.recordings import Recording
from pdoik.sim2real.effects import VARIABLES, parts_of, unknown_part
from pdoik.sim2real.simulation import JointTorque, Part, Simulator
from sim2real_robots import (
    ABOUT_PIVOT,
    LENGTH,
    MASS,
    MJCF,
    PENDULUM,
    TURNTABLE,
    G,
    arm_urdf,
    commands,
    parts,
    pd,
)

SPEED = 0.8
KNOTS = [-1.5, -1.0, 0.0, 1.0, 1.5]  # of an unnamed torque, whose outermost lines go on a little


def free_run(robot: str, q0: float, dq0: float, duration: float, *added: Part) -> Recording:
    """A single joint with no torque, from one recorded state."""
    run = commands(duration, tau_cmd=0.0, q=q0, dq=dq0)
    simulator = Simulator(robot, ["joint1"], parts=added, timestep=1e-3)
    return simulator.replay(run, window=duration)


def unknown(variable: str, lowest: float, highest: float, *values: float) -> tuple[Part, ...]:
    at_knots = {f"value_{k}": value for k, value in enumerate(values)}
    code = float(VARIABLES.index(variable))
    return parts("unknown", variable=code, lowest=lowest, highest=highest, **at_knots)


def swing(
    t: np.ndarray, q0: float, damping: float = 0.0, armature: float = 0.0, friction: float = 0.0
) -> np.ndarray:
    """A pendulum's angle by SciPy: gravity at horizontal angle q pulls with m g l cos q."""

    def rate(_: float, x: np.ndarray) -> list[float]:
        torque = MASS * G * LENGTH * np.cos(x[0]) - damping * x[1]
        torque -= friction * np.tanh(x[1] / 1e-2)
        return [x[1], torque / (ABOUT_PIVOT + armature)]

    solution = solve_ivp(rate, (0, t[-1]), [q0, 0.0], t_eval=t, rtol=1e-10, atol=1e-10)
    return np.asarray(solution.y[0])


@pytest.mark.parametrize(
    ("effect", "values", "expected"),
    [
        ("viscous_friction", {"coefficient": 0.0}, {}),
        ("viscous_friction", {"coefficient": 0.4}, {"damping": 0.4}),
        ("rotor_inertia", {"inertia": 0.1}, {"armature": 0.1}),
    ],
)
def test_a_pendulum_swings_as_scipy_integrates_it(
    effect: str, values: dict[str, float], expected: dict[str, float]
) -> None:
    run = free_run(PENDULUM, 0.3, 0.0, 3.0, *parts(effect, **values))
    # MuJoCo takes damping implicitly, which is exact to first order only.
    tolerance = 2e-3 if "damping" in expected else 1e-5
    assert run.q[:, 0] == pytest.approx(swing(run.time, 0.3, **expected), abs=tolerance)
    assert np.ptp(run.q) > 0.8


def test_an_mjcf_gives_its_links_armature_and_friction_and_nothing_else() -> None:
    run = free_run(MJCF, 0.3, 0.0, 2.0)
    expected = swing(run.time, 0.3, 0.3, 0.1, friction=0.5)  # the finger weighs 4 g
    assert run.q[:, 0] == pytest.approx(expected, abs=0.02)
    assert np.ptp(run.q) > 0.8


def test_dry_friction_slows_a_joint_evenly_and_then_holds_it() -> None:
    level, speed = 0.7, 2.0
    run = free_run(TURNTABLE, 0.0, speed, 1.5, *parts("coulomb_friction", level=level))
    expected = np.maximum(speed - level / ABOUT_PIVOT * run.time, 0.0)
    assert run.dq is not None
    assert run.dq[:, 0] == pytest.approx(expected, abs=2e-3)
    stop = speed * ABOUT_PIVOT / level
    assert np.ptp(run.q[run.time > stop + 0.02]) < 1e-6


def test_a_joint_at_rest_does_not_creep_under_less_torque_than_its_friction() -> None:
    run = commands(2.0, tau_cmd=0.99)
    simulator = Simulator(TURNTABLE, ["joint1"], parts=parts("coulomb_friction", level=1.0))
    assert np.abs(simulator.replay(run, window=2.0).q).max() < 1e-4
    simulator = Simulator(TURNTABLE, ["joint1"], parts=parts("coulomb_friction", level=0.9))
    assert np.abs(simulator.replay(run, window=2.0).q).max() > 0.1


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(
    ("added", "law"),
    [
        (parts("viscous_friction", coefficient=1.5), lambda t, q, dq: 1.5 * dq),
        (parts("coulomb_friction", level=1.5), lambda t, q, dq: 1.5 * np.sign(dq)),
        (
            parts("coulomb_friction", level=1.0) + parts("stribeck_friction", extra=0.8, speed=1.0),
            lambda t, q, dq: np.sign(dq) * (1.0 + 0.8 * np.exp(-(dq**2))),
        ),
        (
            parts("coulomb_friction", level=1.0)
            + parts("asymmetric_friction", level_difference=0.6, viscous_difference=0.4),
            lambda t, q, dq: np.sign(dq) + 0.3 + 0.2 * np.abs(dq),
        ),
        (
            parts("friction_drift", extra=1.2, time_constant=2.0),
            lambda t, q, dq: 1.2 * np.exp(-t / 2.0) * np.sign(dq),
        ),
        (
            parts("torque_ripple", amplitude=0.5, phase=0.4, harmonic=5.0),
            lambda t, q, dq: 0.5 * np.cos(5.0 * q + 0.4),
        ),
        (
            parts("position_dependent_spring", stiffness=0.7, onset=0.3, side=0),
            lambda t, q, dq: 0.7 * (q - 0.3),
        ),
        (
            parts("position_dependent_spring", stiffness=0.7, onset=0.9, side=1),
            lambda t, q, dq: 0.7 * np.maximum(q - 0.9, 0.0),
        ),
        (
            parts("position_dependent_spring", stiffness=0.7, onset=-0.9, side=-1),
            lambda t, q, dq: 0.7 * np.minimum(q + 0.9, 0.0),
        ),
        (
            parts("presliding_hysteresis", level=1.1, displacement=0.02),
            lambda t, q, dq: 1.1 * np.sign(dq) * (1.0 - np.exp(-np.abs(q) / 0.02)),
        ),
        (
            (unknown_part("joint1", "position", [-1.0, 0.0, 1.0], [0.5, 0.0, 1.0]),),
            lambda t, q, dq: np.interp(q, [-1.0, 0.0, 1.0], [0.5, 0.0, 1.0]),
        ),
        (
            unknown("speed", -1.0, 1.0, 1.0, 0.0, 0.5),
            lambda t, q, dq: np.interp(dq, [-1.0, 0.0, 1.0], [1.0, 0.0, 0.5]),
        ),
        (
            unknown("position and speed", -1.0, 1.0, 0.5, 0.5, 1.0, 0.1, 0.3, 0.1),
            lambda t, q, dq: np.sign(dq) * np.interp(q, KNOTS, [0.5, 0.5, 0.5, 1.0, 1.25])
            + dq * np.interp(q, KNOTS, [0.0, 0.1, 0.3, 0.1, 0.0]),
        ),
        (
            unknown("position and speed", -1.0, 1.0, -0.5, -0.5, 1.0, 0.0, 0.0, 0.0),
            lambda t, q, dq: np.tanh(dq / 0.02)
            * np.interp(q, KNOTS, [-0.5, -0.5, -0.5, 1.0, 1.75]),
        ),
        (
            unknown("clock", 0.3, 1.0, 0.5, -0.7),
            lambda t, q, dq: 0.5 * np.cos(0.6 * np.pi * t) - 0.7 * np.sin(0.6 * np.pi * t),
        ),
        (
            (JointTorque(joint="joint1", law=lambda t, q, dq, load: q * dq),),
            lambda t, q, dq: q * dq,
        ),
    ],
)  # fmt: skip
def test_a_joint_driven_at_even_speed_needs_the_torque_of_the_law(
    added: tuple[Part, ...], law: Any, direction: float
) -> None:
    acts = law(0.0, 2.0 * direction, 0.5 * direction) != 0.0  # springs with a side: on one only
    run = commands(3.0, q_des=lambda t: direction * SPEED * t, dq_des=direction * SPEED)
    simulator = Simulator(TURNTABLE, ["joint1"], pd(4000.0, 120.0), parts=added)
    result = simulator.replay(run, dq0=np.array([direction * SPEED]))
    assert result.tau is not None
    assert result.dq is not None
    ddq = np.gradient(result.dq[:, 0], run.period)
    settled = result.time > 0.3
    expected = law(result.time, result.q[:, 0], result.dq[:, 0])
    needed = expected + ABOUT_PIVOT * ddq
    assert result.tau[settled, 0] == pytest.approx(needed[settled], abs=0.02)
    assert (np.abs(expected).max() > 0.1) == acts


def test_load_dependent_friction_takes_its_share_of_what_the_gear_transmits() -> None:
    run = commands(2.0, q_des=lambda t: -0.2 * t, dq_des=-0.2)
    added = parts("load_dependent_friction", coefficient=0.2)
    result = Simulator(PENDULUM, ["joint1"], pd(4000.0, 120.0), parts=added).replay(run)
    assert result.tau is not None
    load = -MASS * G * LENGTH * np.cos(result.q[:, 0])  # held against gravity, moving upwards
    settled = result.time > 0.5
    assert result.tau[settled, 0] == pytest.approx(1.2 * load[settled], rel=5e-3)


def test_a_push_at_a_link_is_answered_by_the_joints_while_it_lasts() -> None:
    force, window = np.array([3.0, 0.0, 20.0]), (1.0, 3.0)
    values = dict(zip(("force_x", "force_y", "force_z"), force, strict=True))
    pushed = parts_of("external_contact", [], ["link2"], window, values)
    run = commands(4.0, n=2, q_des=0.0)
    robot, joints = arm_urdf(2), ["joint1", "joint2"]
    result = Simulator(robot, joints, pd(9000.0, 300.0, 2), parts=pushed).replay(run)
    free = Simulator(robot, joints, pd(9000.0, 300.0, 2)).replay(run)
    change = np.asarray(result.tau) - np.asarray(free.tau)
    # link2's origin is 2 LENGTH out along x: about y, r x F = (x, 0, 0) x F has y = -x F_z.
    q1 = result.q[2500, 0]
    lever = 2 * LENGTH * np.array([np.cos(q1), -np.sin(q1)])  # x, z
    moment = lever[1] * force[0] - lever[0] * force[2]
    sag = 9.81 * MASS * LENGTH * 4 * abs(q1 - free.q[2500, 0])
    assert change[2500, 0] == pytest.approx(-moment, abs=sag + 0.05)
    assert change[2500, 1] == pytest.approx(0.0, abs=sag + 0.05)
    assert change[900] == pytest.approx(0.0, abs=1e-9)
    assert change[-1] == pytest.approx(0.0, abs=1e-3)
    elsewhere = parts_of(
        "external_contact", [], ["link2"], window, values, recordings=["other.csv"]
    )
    untouched = Simulator(robot, joints, pd(9000.0, 300.0, 2), parts=elsewhere).replay(run)
    assert untouched.q == pytest.approx(free.q, abs=0)
