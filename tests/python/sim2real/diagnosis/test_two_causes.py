"""Causes that hide one another: feet's forces from a wrong torque, a rotor in a wrong link."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify import Identified, estimates, identify, relinearised
from pdoik.sim2real.motion import (
    ImuNoise,
    Key,
    Place,
    Prepared,
    Shape,
    derivative,
    prepare,
    zero_phase,
)
from pdoik.sim2real.regression import Fit, term_of
from sim2real_floating import Hidden, study
from sim2real_identified import figure, named

KNEE = 2


def fitted(prepared: Prepared, effect: str, place: Place, shape: Shape = ()) -> Fit:
    """This alone."""
    term = term_of(prepared.fit, CATALOGUE[effect], place, shape)
    assert term is not None
    return Fit(prepared.fit, [term])


def identified(prepared: Prepared) -> tuple[Identified, list[str]]:
    """What is identified, and what was said meanwhile."""
    said: list[str] = []
    return identify(prepared, lambda stage, text, share: said.append(text))[1], said


@pytest.mark.parametrize("gain", [pytest.param(0.75, marks=pytest.mark.long), 1.3])
def test_feet_press_by_what_a_motor_truly_gives(tmp_path: Path, gain: float) -> None:
    """Forces that follow from a reading that is wrong are wrong, and so is what goes by them."""
    prepared = prepare(study(tmp_path, Hidden(gain={KNEE: gain}), contact=False))
    first = fitted(prepared, "torque_gain", Place(joints=(KNEE,)), (0.0,))
    other = relinearised(prepared, first)
    assert other is not None
    again = fitted(other, "torque_gain", Place(joints=(KNEE,)), (0.0,))
    errors = [abs(1.0 + fit.beta[-1] - gain) for fit in (first, again)]
    assert errors[1] < 0.005
    assert errors[0] > 3.0 * errors[1]
    state, said = identified(prepared)
    assert any("linearised" in text for text in said)
    assert named(state) == {("torque_gain", (KNEE,))}
    low, high = figure(state.fit, "torque_gain", KNEE).interval95
    assert low < gain < high


def test_forces_stay_where_nothing_goes_by_them(tmp_path: Path) -> None:
    prepared = prepare(study(tmp_path, Hidden(rotor={KNEE: 0.02})))
    assert relinearised(prepared, fitted(prepared, "rotor_inertia", Place(joints=(KNEE,)))) is None


def test_a_rotor_and_a_heavy_trunk_are_no_wrong_thigh(tmp_path: Path) -> None:
    prepared = prepare(study(tmp_path, Hidden(rotor={KNEE - 1: 0.05}, payload=0.05)))
    (thigh,) = (k for k, name in enumerate(prepared.fit.motions[0].body.links) if name == "a_thigh")
    state, _ = identified(prepared)
    assert ("rotor_inertia", (KNEE - 1,)) in named(state)
    assert all(term.place.link != thigh for term in state.accepted)
    low, high = figure(state.fit, "rotor_inertia", KNEE - 1).interval95
    assert low < 0.05 < high


def test_a_wrong_trunk_is_found_with_its_mass(tmp_path: Path) -> None:
    state, _ = identified(prepare(study(tmp_path, Hidden(payload=0.5))))
    (body,) = (term for term in state.accepted if term.place.link is not None)
    assert body.effect == "payload"
    low, high = estimates(state.fit, (body,), 0)[0]["mass"].interval95
    assert low < 0.5 < high


def test_an_imus_zeros_are_plain_beside_friction(tmp_path: Path) -> None:
    """They hardly show in the torques, which are most of what is looked at."""
    zeros = (0.03, -0.02, 0.025)
    hidden = Hidden(gyro=zeros, friction=dict.fromkeys(range(9), 1.0))
    state, _ = identified(prepare(study(tmp_path, hidden)))
    frictions = {("coulomb_friction", (j,)) for j in range(9)}
    assert named(state) == frictions | {("imu_offset", ())}
    (offset,) = (term for term in state.accepted if term.effect == "imu_offset")
    assert state.fit.beta_of(offset)[3:6] == pytest.approx(zeros, abs=0.002)


def test_beside_a_pose_an_accelerometer_says_its_zero_by_itself(tmp_path: Path) -> None:
    """Slowly, where a pose's second derivative has next to no noise: no body is needed for it."""
    zeros = (0.1, -0.15, 0.3)
    b = prepare(study(tmp_path, Hidden(acc=zeros))).fit
    for axis, zero in enumerate(zeros):
        key: Key = ("imu", 3 + axis)
        rows = b.residual[key][b.mask[key]]
        assert len(rows) > 20
        assert rows.mean() == pytest.approx(zero, abs=0.01)
        assert b.sigma[key] < 0.02


@pytest.mark.parametrize("cutoff", [1.0, 8.0])
def test_a_poses_noise_is_what_its_derivatives_have_of_it(cutoff: float) -> None:
    rng, period = np.random.default_rng(3), 4e-3
    turns, moves, gyro, acc = (1e-3, 5e-4, 4e-3, 0.05)
    noise = ImuNoise(
        pose=np.repeat([turns, moves], 3) ** 2 * 2.0 * period,
        imu=np.repeat([gyro, acc], 3) ** 2 * 2.0 * period,
    )
    white = rng.standard_normal((200_000, 4)) * [turns, moves, gyro, acc]
    rates = derivative(white[:, :1], period) + white[:, 2:3]
    felt = derivative(derivative(white[:, 1:2], period), period) + white[:, 3:4]
    left = zero_phase(np.hstack([rates, felt]), cutoff, period, noisy=True)[500:-500].std(axis=0)
    expected = np.sqrt(noise.variance(cutoff)[[0, 3]])
    assert left == pytest.approx(expected, rel=0.2)
    at = noise.band()[[0, 3]]
    assert turns * 2 * np.pi * at[0] == pytest.approx(gyro)
    assert moves * (2 * np.pi * at[1]) ** 2 == pytest.approx(acc)


def test_what_soles_sink_in_by_anyway_is_a_trifle(tmp_path: Path) -> None:
    (motion,) = prepare(study(tmp_path, Hidden(), runs=1)).fit.motions
    softness, highest = CATALOGUE["foot_softness"], 0.0
    for foot in motion.feet:
        assert foot.normal is not None
        highest = max(highest, float(foot.normal.max()))
    for sinks, trifling in ((0.5e-3, True), (3e-3, False)):
        assert softness.trifling({"compliance": sinks / highest}, motion, Place()) == trifling
