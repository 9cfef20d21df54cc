"""Springs and play between motor and link: how far the link lags, and what that changes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.recordings import FloatArray
from pdoik.sim2real.effects.transmission import given_way, swing
from pdoik.sim2real.motion import Motion, Place
from sim2real_columns import added, tip_change, tips, torque
from sim2real_motions import INSIDE, PERIOD

FLANK = 2 * np.pi * 30.0  # as the module has it: the link's natural frequency on a flank [rad/s]


def test_a_link_that_lags_changes_torques_to_first_order_as_a_motion_that_lags(
    motion: Motion,
) -> None:
    omega = 2 * np.pi * 0.8
    lag = [1e-3 * omega**k * np.sin(omega * motion.time + k * np.pi / 2) for k in range(3)]
    found = motion.by_deflection(lag[0], 1)
    state = {name: getattr(motion, name).copy() for name in ("q", "dq", "ddq")}
    for values, each in zip(state.values(), lag, strict=True):
        values[:, 1] -= each
    expected = torque(motion, **state) - torque(motion)
    size = np.abs(expected).max()
    assert found[INSIDE] == pytest.approx(expected[INSIDE], abs=0.01 * size)
    assert size > 1e-3


@pytest.mark.parametrize("stiffness", [60.0, 2000.0, 1e5])
def test_a_link_on_a_spring_moves_as_its_two_inertias_do(stiffness: float) -> None:
    time = np.arange(0.0, 6.0, PERIOD)
    damping = 0.1 * np.sqrt(stiffness)

    def load(t: FloatArray) -> FloatArray:
        return 3.0 * np.sin(5.0 * t) + np.sin(23.0 * t)

    def inertia(t: FloatArray) -> FloatArray:
        return 2.0 + 0.8 * np.sin(t)

    def rates(t: float, state: FloatArray) -> list[float]:
        u, v = state
        return [v, (load(t) - damping * v - stiffness * u) / inertia(t)]

    start = [0.0, (3.0 * 5.0 + 23.0) / stiffness]  # as the spring follows the load
    exact = solve_ivp(rates, (0.0, 6.0), start, t_eval=time, rtol=1e-8, atol=1e-12).y[0]
    found = given_way(load(time), inertia(time), PERIOD, stiffness, damping)
    assert np.abs(found - exact).max() < 0.01 * np.abs(exact).max()


def test_an_elastic_joints_tip_gives_by_load_over_a_stiffness_that_is_large(
    motion: Motion,
) -> None:
    stiffness = 4e5
    found = added("joint_elasticity", motion, Place(joints=(1,)), stiffness=stiffness, damping=0.0)
    assert motion.body is not None
    q = motion.q.copy()
    q[:, 1] -= motion.load(1) / stiffness
    expected = tip_change(motion, motion.body, q)
    assert np.abs(tips(found) - expected).max() < 0.02 * np.abs(expected).max()
    assert np.abs(tips(found)).max() > 5e-6


@pytest.mark.parametrize("gap", [0.002, 0.02])
@pytest.mark.parametrize("load", [3.0, -0.4])
def test_under_constant_load_a_link_rests_on_the_flank_that_carries_it(
    gap: float, load: float
) -> None:
    inertia = 0.25
    lag = swing(np.full((1500, 1), load), np.array([inertia]), PERIOD, np.array([gap]))[:, 0]
    rest = np.sign(load) * gap / 2 + load / inertia / FLANK**2
    assert lag[-1] == pytest.approx(rest, rel=1e-4)
    assert np.abs(lag[200:] - rest).max() < 1e-3 * gap


@pytest.mark.parametrize("period", [0.002, 0.004, 0.008])
@pytest.mark.parametrize("seed", range(3))
def test_a_link_stays_within_its_play_but_for_what_the_flanks_give(
    period: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    time = period * np.arange(round(12.0 / period))
    phase = rng.uniform(0, 6, (3, 1, 4))
    load = sum(np.sin(w * time[:, None] + p) for w, p in zip((1.3, 3.1, 5.7), phase, strict=True))
    inertia = np.array([0.05, 0.1, 0.5, 2.0])
    gap = np.array([0.03, 0.01, 0.004, 0.001])
    lag = swing(load, inertia, period, gap)
    rate = np.abs(load / inertia).max(axis=0)
    # A link that crosses the play hits the flank at speed sqrt(2 a gap): the damper stops it.
    give = rate / FLANK**2 + np.sqrt(2 * rate * gap) / FLANK
    assert (np.abs(lag).max(axis=0) < gap / 2 + give).all()
    assert (np.abs(lag).max(axis=0) > gap / 2).all()
    assert (lag.min(axis=0) < -0.4 * gap).all()  # it does go to both sides
    assert (lag.max(axis=0) > 0.4 * gap).all()
    alone = swing(load[:, 2:3], inertia[2:3], period, gap[2:3])
    assert lag[:, 2] == pytest.approx(alone[:, 0], abs=1e-15)


def test_the_flight_through_the_play_is_the_differential_equations() -> None:
    gap, inertia = 0.2, 1.0
    time = PERIOD * np.arange(400)
    load = np.where(time < 0.2, 1.0, -1.0)[:, None]
    lag = swing(load, np.array([inertia]), PERIOD, np.array([gap]))[:, 0]
    start = np.argmax(load < 0) * PERIOD - PERIOD / 2
    flying = (time > start + 0.05) & (time < start + 0.5)
    fall = gap / 2 - 0.5 * (time[flying] - start) ** 2
    assert lag[flying] == pytest.approx(fall, abs=2e-3)


def test_play_of_a_joint_shows_at_the_tip_as_the_lag_of_its_link(motion: Motion) -> None:
    found = added("backlash", motion, Place(joints=(1,)), gap=0.011)
    assert motion.tip_jacobian is not None
    J = motion.tip_jacobian[:, :3, 1]
    lag = -np.sum(tips(found)[:, :3] * J, axis=1) / np.sum(J**2, axis=1)
    load = torque(motion)[:, 1]
    inertia = float(np.median(motion.mass_matrix[:, 1, 1]))
    loaded = np.abs(load) > 0.5 * np.abs(load).max()
    loaded[:50] = False  # it begins on the flank without leaning on it
    assert loaded.mean() > 0.3
    lean = np.sign(load) * 0.0055 + load / inertia / FLANK**2  # the flank gives a little
    assert lag[loaded] == pytest.approx(lean[loaded], abs=3e-4)
