"""Friction, drives and springs in a joint: their columns are their equations."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.effects.friction import bristle
from pdoik.sim2real.motion import Motion, Place
from sim2real_columns import added, torque
from sim2real_motions import moved, wave


def _fade(m: Motion, j: int, speed: float) -> np.ndarray:
    return np.exp(-((m.dq[:, j] / speed) ** 2))


def _sign(m: Motion, j: int) -> np.ndarray:
    return np.sign(m.dq[:, j])


Law = Callable[[Motion, int], np.ndarray]
LAWS: dict[str, tuple[dict[str, float], tuple[float, ...], Law]] = {
    "viscous_friction": ({"coefficient": 0.7}, (), lambda m, j: 0.7 * m.dq[:, j]),
    "coulomb_friction": ({"level": 1.3}, (), lambda m, j: 1.3 * _sign(m, j)),
    "stribeck_friction": (
        {"extra": 0.8, "speed": 0.2},
        (),
        lambda m, j: 0.8 * _sign(m, j) * _fade(m, j, 0.2),
    ),
    "asymmetric_friction": (
        {"level_difference": 0.6, "viscous_difference": -0.4},
        (),
        lambda m, j: 0.5 * (0.6 - 0.4 * np.abs(m.dq[:, j])),
    ),
    "load_dependent_friction": (
        {"coefficient": 0.12},
        (),
        lambda m, j: 0.12 * np.abs(torque(m)[:, j]) * _sign(m, j),
    ),
    "friction_drift": (
        {"extra": 0.9, "time_constant": 4.0},
        (),
        lambda m, j: 0.9 * np.exp(-m.time / 4.0) * _sign(m, j),
    ),
    "rotor_inertia": ({"inertia": 0.21}, (), lambda m, j: 0.21 * m.ddq[:, j]),
    "torque_offset": ({"offset": -0.5}, (), lambda m, j: np.full(len(m.time), -0.5)),
    "torque_gain": ({"gain": 1.2}, (), lambda m, j: 0.2 * m.tau[:, j]),
    "torque_ripple": (
        {"amplitude": 0.3, "phase": 0.7, "harmonic": 12.0},
        (),
        lambda m, j: 0.3 * np.cos(12.0 * m.q[:, j] + 0.7),
    ),
    "position_dependent_spring": (
        {"stiffness": 5.0, "onset": 0.4, "side": -1.0},
        (),
        lambda m, j: 5.0 * np.minimum(m.q[:, j] - 0.4, 0.0),
    ),
}


@pytest.mark.parametrize("effect", LAWS)
@pytest.mark.parametrize("j", range(3))
def test_an_effect_with_its_parameters_is_its_equation(motion: Motion, effect: str, j: int) -> None:
    values, shape, law = LAWS[effect]
    columns = added(effect, motion, Place(joints=(j,)), shape, **values)
    assert set(columns) == {("torque", j)}
    moving = np.abs(motion.dq[:, j]) > 0.02
    assert moving.mean() > 0.8
    assert columns["torque", j][moving] == pytest.approx(law(motion, j)[moving], abs=1e-9)


@pytest.mark.parametrize(("side", "kept"), [(0.0, 1.0), (1.0, 0.5), (-1.0, 0.5)])
def test_a_spring_pulls_towards_its_onset_on_its_side_only(
    motion: Motion, side: float, kept: float
) -> None:
    onset = float(np.median(motion.q[:, 1]))
    values = {"stiffness": 3.0, "onset": onset, "side": side}
    pull = added("position_dependent_spring", motion, Place(joints=(1,)), **values)["torque", 1]
    stretch = motion.q[:, 1] - onset
    acts = np.abs(pull) > 1e-12
    assert acts.mean() == pytest.approx(kept, abs=0.01)
    assert pull[acts] == pytest.approx(3.0 * stretch[acts], abs=1e-9)


@pytest.mark.parametrize("displacement", [0.004, 0.03, 0.3])
def test_dahls_state_is_the_solution_of_its_differential_equation(displacement: float) -> None:
    def rate(t: float, z: np.ndarray) -> np.ndarray:
        speed = wave(np.array([t]), 1, 1)[0, 0]
        return speed / displacement * (1.0 - z * np.sign(speed))

    time = 0.0005 * np.arange(8001)
    found = bristle(wave(time, 1)[:, 0], displacement)
    exact = solve_ivp(rate, (0, 4), [0.0], t_eval=time, max_step=2e-3, rtol=1e-9, atol=1e-9).y[0]
    assert found == pytest.approx(exact, abs=5e-3)
    assert np.abs(found).max() <= 1.0
    assert np.abs(exact).max() > 0.5


def test_dahls_state_does_not_depend_on_how_fast_the_path_is_run() -> None:
    q = wave(np.linspace(0, 5, 4001), 1)[:, 0]
    slower = np.interp(np.linspace(0, 1, 12001), np.linspace(0, 1, 4001), q)
    assert bristle(slower, 0.05)[::3] == pytest.approx(bristle(q, 0.05), abs=2e-3)


def test_saturation_is_what_is_missing_beyond_the_level(motion: Motion) -> None:
    assert motion.torque is not None
    assert motion.command is not None
    assert motion.law is not None
    sources = {
        (0.0, "torque"): motion.torque,
        (1.0, "drive"): motion.command,
        (2.0, "law"): motion.law,
    }
    for (kind, balance), asked in sources.items():
        level = float(np.quantile(np.abs(asked[:, 1]), 0.8))
        part = added("torque_saturation", motion, Place(joints=(1,)), (kind, level), level=level)
        given = np.clip(asked[:, 1], -level, level)
        # A drive gives less than it is told; a report that is clipped tells less than is given.
        sign = 1.0 if balance == "torque" else -1.0
        assert part[balance, 1] == pytest.approx(sign * (asked[:, 1] - given), abs=1e-12)
        assert np.mean(part[balance, 1] != 0.0) == pytest.approx(0.2, abs=0.01)


def test_a_rotor_within_half_a_percent_of_what_turns_anyway_is_a_trifle(tmp_path: Path) -> None:
    """A simulation's step alone makes so much: half of it times the damping."""
    motion, place = moved(tmp_path, 2, rotor=0.1), Place(joints=(1,))
    carried = 0.1 + float(np.mean(motion.mass_matrix[:, 1, 1]))
    rotor = CATALOGUE["rotor_inertia"]
    assert rotor.trifling({"inertia": 0.004 * carried}, motion, place)
    assert not rotor.trifling({"inertia": 0.006 * carried}, motion, place)
