"""Figures of bodies that come out of a regression are those of bodies, at the least cost."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

import pinocchio as pin

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.effects.bodies import LinkInertials
from pdoik.sim2real.motion import Balances, Place
from pdoik.sim2real.regression import Fit, nearest, term_of, with_real_bodies
from pdoik.sim2real.simulation import Inertial
from sim2real_motions import moved


def pseudo_inertia(ten: np.ndarray) -> np.ndarray:
    """Pinocchio's 4x4 matrix of second moments."""
    return np.asarray(pin.PseudoInertia.FromDynamicParameters(ten).toMatrix())


def some_metric(rng: np.random.Generator) -> np.ndarray:
    A = rng.standard_normal((14, 10))
    return A.T @ A + 0.05 * np.eye(10)


@pytest.mark.parametrize("seed", range(6))
def test_the_nearest_body_is_as_near_as_slsqp_finds_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    metric, wanted = some_metric(rng), rng.standard_normal(10)
    wanted[0] = -1.0  # no body
    start = Inertial.from_ten(wanted).nearest_body().ten()
    found = nearest(wanted, metric, start)
    assert np.linalg.eigvalsh(pseudo_inertia(found))[0] > -1e-9

    def cost(x: np.ndarray) -> float:
        return float((x - wanted) @ metric @ (x - wanted))

    other = optimize.minimize(
        cost,
        start,
        method="SLSQP",
        constraints={"type": "ineq", "fun": lambda x: np.linalg.eigvalsh(pseudo_inertia(x))},
        options={"maxiter": 200},
    )
    allowed = other.x if np.linalg.eigvalsh(pseudo_inertia(other.x))[0] > -1e-6 else start
    assert cost(found) <= 1.002 * cost(allowed) + 1e-6


def test_what_is_a_body_already_stays_and_others_follow() -> None:
    rng = np.random.default_rng(1)
    A = rng.standard_normal((40, 12))
    normal = A.T @ A
    base = Inertial.about_com(2.0, np.array([0.1, 0.0, 0.2]), 0.02 * np.eye(3)).ten()
    beta = 1e-3 * rng.standard_normal(12)
    assert with_real_bodies(beta, normal, [(slice(0, 10), base)]) is beta
    beta[0] = -340.0
    moved_to = with_real_bodies(beta, normal, [(slice(0, 10), base)])
    assert Inertial.from_ten(base + moved_to[:10]).is_body
    free = np.array([10, 11])  # of least cost where the body is what it is
    gradient = normal[free] @ (moved_to - beta)
    np.testing.assert_allclose(gradient, 0.0, atol=1e-6 * np.abs(normal).max() * 340.0)


def test_a_regression_claims_no_impossible_link(tmp_path: Path) -> None:
    motion = moved(tmp_path, 2, seconds=20.0, tau_cmd=None, q_des=None, dq_des=None)
    assert motion.body is not None
    wrong = motion.regressor()[:, :, 1] @ np.array([-9.0, *[0.0] * 9])
    b = Balances([replace(motion, torque=motion.tau + wrong, cache={})])
    term = term_of(b, CATALOGUE[LinkInertials.id], Place(link=1), ())
    assert term is not None
    fit = Fit(b, [term])
    own = motion.body.inertial_parameters()[1]
    assert not Inertial.from_ten(own + fit.beta).is_body
    claimed = own + fit.constrained().beta
    assert np.linalg.eigvalsh(pseudo_inertia(claimed))[0] > -1e-9
    assert claimed[0] > 0.0


@pytest.mark.parametrize("mass", [-1e-310, 0.0, 1e-310, 1e-13])
def test_moments_without_a_mass_to_have_them_are_no_body(mass: float) -> None:
    """Their centre would be further away than a number can say."""
    wanted = Inertial(mass=mass, first_moment=np.array([0.1, 0.0, 0.2]), inertia=1e-3 * np.eye(3))
    assert not wanted.is_body
    near = wanted.nearest_body()
    assert near.is_body
    assert near.mass > 0.0
    assert np.isfinite(near.ten()).all()


@pytest.mark.parametrize("seed", range(20))
def test_what_is_a_body_has_moments_that_keep_the_triangle_inequality(seed: int) -> None:
    rng = np.random.default_rng(seed)
    moments = rng.uniform(0.1, 1.0, 3)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    about = turn @ np.diag(moments) @ turn.T
    body = Inertial.about_com(float(rng.uniform(0.5, 5.0)), rng.normal(size=3), about)
    assert body.is_body == bool(2.0 * moments.max() <= moments.sum())
