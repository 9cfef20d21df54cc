"""What is within calibration is fitted and not told; what is claimed gains where nothing learns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Study
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify import as_trusted
from pdoik.sim2real.motion import Place, prepare
from pdoik.sim2real.regression import SCALE, SPEED, TRUST, ZERO, Fit, Tolerance, term_of, trusted
from sim2real_known_causes import NOISE, rubbing, several, study, told

Change = Callable[[np.ndarray], np.ndarray]


def commanded(made: Study, drive: Change = lambda x: x, speed: Change = lambda x: x) -> Study:
    """With the torques as they were asked for, and speeds as a sensor tells them."""
    rng, recordings = np.random.default_rng(5), []
    for each in made.recordings:
        assert each.tau is not None
        assert each.dq is not None
        asked = each.tau + NOISE * rng.standard_normal(each.tau.shape)
        recordings.append(replace(each, tau_cmd=drive(asked), dq=speed(each.dq)))
    return replace(made, recordings=tuple(recordings))


def first(by: float, of: Change) -> Change:
    """Only the first joint's, by a share of what the change makes of it."""
    return lambda x: x + by * of(x) * np.array([1.0, 0.0])


@pytest.mark.parametrize(
    ("drive", "speed"),
    [
        (first(0.01, lambda x: x), lambda x: x),
        (first(0.1, np.ones_like), lambda x: x),  # 1 % of what the joint bears
        (lambda x: x, first(0.003, lambda x: x)),
    ],
)
def test_what_is_within_calibration_is_no_news(
    tmp_path: Path, drive: Change, speed: Change
) -> None:
    diagnosis = told(commanded(study(tmp_path, rubbing), drive, speed))
    assert {each.effect for each in diagnosis.findings} == {"coulomb_friction"}
    assert diagnosis.suspected == ()


def test_what_is_far_beyond_calibration_is(tmp_path: Path) -> None:
    for effect, drive, speed in (
        ("torque_gain", first(-0.2, lambda x: x), lambda x: x),
        ("sensor_gain", lambda x: x, first(0.2, lambda x: x)),
    ):
        diagnosis = told(commanded(study(tmp_path, rubbing), drive, speed))
        (found,) = (each for each in diagnosis.findings if each.effect != "coulomb_friction")
        assert (found.effect, found.joints) == (effect, ("j1",))
        low, high = found.parameters["gain"].interval95
        assert low < (1.25 if effect == "torque_gain" else 1.2) < high


def test_tolerances_stand_in_their_own_balances(tmp_path: Path) -> None:
    (motion, *_) = prepare(commanded(study(tmp_path, rubbing))).fit.motions
    tolerance, place = Tolerance(), Place(joints=(1,))
    zero, scale, speed = (
        tolerance.columns(motion, place, (kind,)) for kind in (ZERO, SCALE, SPEED)
    )
    assert motion.command is not None
    np.testing.assert_array_equal(zero["drive", 1], 1.0)
    np.testing.assert_array_equal(scale["drive", 1][:, 0], motion.command[:, 1])
    np.testing.assert_array_equal(speed["velocity", 1][:, 0], motion.dq[:, 1])
    assert zero.keys() == scale.keys() == {("drive", 1)}
    assert speed.keys() == {("velocity", 1)}


def test_bodies_stay_where_they_are_while_a_cause_is_judged(tmp_path: Path) -> None:
    balances = prepare(study(tmp_path, several)).fit
    own = term_of(balances, CATALOGUE["viscous_friction"], Place(joints=(0,)), ())
    assert own is not None
    fit = Fit(balances, [*trusted(balances, 0.1), own])
    held = as_trusted(fit, ())
    assert [each.effect for each in held.terms] == ["viscous_friction"]
    assert any(each.effect == TRUST for each in fit.terms)
    for key in held.design:
        np.testing.assert_allclose(held.residual(key), fit.residual(key), atol=1e-6)


def test_a_cause_says_how_much_of_what_all_else_leaves_it_explains(tmp_path: Path) -> None:
    diagnosis = told(study(tmp_path, several, runs=4, held=2))
    spring = next(e for e in diagnosis.findings if e.effect == "position_dependent_spring")
    assert spring.evidence.with_others is not None
    assert 0.9 < spring.evidence.with_others <= 1.0
    assert spring.evidence.validation_gain < spring.evidence.with_others
