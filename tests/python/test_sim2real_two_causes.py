"""Causes that hide one another: feet's forces from a wrong torque, a rotor in a wrong link."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.motion.motion_noise import ImuNoise
from pdoik.sim2real.motion.place import Key, Place, Shape
from pdoik.sim2real.motion.prepare import Prepared, prepare
from pdoik.sim2real.motion.signals import derivative, zero_phase
from pdoik.sim2real.regression.fit import Fit, term_of
from pdoik.sim2real.regression.trial import Search, without
from pdoik.sim2real.select.feet_again import with_feet_again
from pdoik.sim2real.select.unspecific import without_unspecific
from sim2real_floating import Hidden, study

KNEE = 2


def found(prepared: Prepared, effect: str, place: Place, shape: Shape = ()) -> Search:
    """A search that has accepted this alone."""
    term = term_of(prepared.fit, CATALOGUE[effect], place, shape)
    assert term is not None
    start = Fit(prepared.fit, ())
    return Search(balances=prepared.fit, nuisance=(), fit=start.extended(term), start=start)


@pytest.mark.parametrize("gain", [0.75, 1.3])
def test_feet_press_by_what_a_motor_truly_gives(tmp_path: Path, gain: float) -> None:
    """Forces that follow from a reading that is wrong are wrong, and so is what goes by them."""
    prepared = prepare(study(tmp_path, Hidden(gain={KNEE: gain}), contact=False))
    first = found(prepared, "torque_gain", Place(joints=(KNEE,)), (0.0,))
    said: list[str] = []
    _, again = with_feet_again(prepared, first, lambda stage, text, share: said.append(text))
    assert any("feet" in text for text in said)
    assert [term.key for term in again.accepted] == [first.accepted[0].key]
    errors = [abs(1.0 + state.fit.beta[-1] - gain) for state in (first, again)]
    assert errors[1] < 0.005
    assert errors[0] > 3.0 * errors[1]


def test_forces_stay_where_nothing_goes_by_them(tmp_path: Path) -> None:
    prepared = prepare(study(tmp_path, Hidden(rotor={KNEE: 0.02})))
    first = found(prepared, "rotor_inertia", Place(joints=(KNEE,)))
    same, state = with_feet_again(prepared, first, lambda *said: pytest.fail(str(said)))
    assert same is prepared
    assert state is first


def test_a_rotor_and_a_heavy_trunk_are_no_wrong_thigh(tmp_path: Path) -> None:
    prepared = prepare(study(tmp_path, Hidden(rotor={KNEE - 1: 0.05}, payload=0.05)))
    (thigh,) = (k for k, name in enumerate(prepared.fit.motions[0].body.links) if name == "a_thigh")
    state = without_unspecific(found(prepared, "link_inertial_error", Place(link=thigh)))
    assert ("rotor_inertia", Place(joints=(KNEE - 1,))) in {term.key for term in state.accepted}
    assert all(term.place.link != thigh for term in state.accepted)


def test_a_wrong_body_stays(tmp_path: Path) -> None:
    prepared = prepare(study(tmp_path, Hidden(payload=0.5)))
    trunk = len(prepared.study.joints)
    state = found(prepared, "payload", Place(link=trunk))
    assert without_unspecific(state) is state


def test_an_imus_zeros_are_plain_beside_friction_that_nothing_explains_yet(tmp_path: Path) -> None:
    """They hardly show in the torques, which are most of what the search looks at."""
    zeros = (0.03, -0.02, 0.025)
    hidden = Hidden(gyro=zeros, friction=dict.fromkeys(range(9), 1.0))
    state = found(prepare(study(tmp_path, hidden)), "imu_offset", Place())
    trial = without(state, state.accepted[0])
    assert trial.significant
    assert state.fit.beta[-3:] == pytest.approx(zeros, abs=0.002)


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
