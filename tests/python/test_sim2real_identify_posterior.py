"""How the search over sets of causes ends, whatever it begins with, on an arm of two joints."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify.hypothesis import Hypothesis, peculiar
from pdoik.sim2real.identify.pool import Pool
from pdoik.sim2real.identify.posterior import Posterior
from pdoik.sim2real.identify.weighing import State
from pdoik.sim2real.motion.balances import Balances
from pdoik.sim2real.motion.place import Place
from pdoik.sim2real.motion.prepare import prepare
from pdoik.sim2real.regression.fit import TermKey, term_of
from sim2real_known_causes import RIGHT, RUBS, SEVERAL, rubbing, several, study


def keys(state: State) -> set[TermKey]:
    return {each.key for each in state.chosen}


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Balances:
    return prepare(study(tmp_path_factory.mktemp("several"), several)).fit


@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_candidates_does_not_matter(mixed: Balances, seed: int) -> None:
    posterior = Posterior.of(mixed)
    plain = posterior.grown(posterior.begun(RIGHT))
    order = np.random.default_rng(seed).permutation(len(posterior.pool.candidates))
    shuffled = [posterior.pool.candidates[k] for k in order]
    other = replace(posterior, pool=Pool(posterior.data, shuffled), tried={})
    found = other.grown(other.begun(RIGHT))
    assert keys(found) == keys(plain) == SEVERAL
    assert found.log_posterior == pytest.approx(plain.log_posterior, abs=0.5)


def test_the_order_of_recordings_does_not_matter(tmp_path: Path) -> None:
    first = study(tmp_path, several)
    one = told(first)
    two = told(replace(first, recordings=first.recordings[::-1]))
    assert named(one.findings) == named(two.findings)
    assert len(one.findings) == 4
    for each in one.findings:
        (same,) = (f for f in two.findings if named([f]) == named([each]))
        for name, figure in each.parameters.items():
            assert same.parameters[name].value == pytest.approx(figure.value, abs=0.2 * figure.std)
            assert same.parameters[name].std == pytest.approx(figure.std, rel=0.2)


def cause(posterior: Posterior, effect: str, j: int, code: float | None = None) -> Hypothesis:
    """An effect at a joint as it is first tried."""
    b, place = posterior.balances, Place(joints=(j,))
    shapes = CATALOGUE[effect].shapes(b.motions, place)
    shape = next(s for s in shapes if code is None or s[0] == code)
    term = term_of(b, CATALOGUE[effect], place, shape)
    assert term is not None
    return peculiar(b, term)


def test_a_cause_goes_when_a_better_one_comes(mixed: Balances) -> None:
    """A curve over positions explains what a spring does: until the spring is there."""
    posterior = Posterior.of(mixed)
    curve = cause(posterior, "unknown", 1, code=0.0)
    state = posterior.begun(RIGHT, [curve])
    assert state.log_posterior > posterior.begun(RIGHT).log_posterior + 100.0
    assert keys(posterior.grown(state)) == SEVERAL


def test_a_cause_that_is_worth_nothing_does_not_stay(mixed: Balances) -> None:
    posterior = Posterior.of(mixed)
    needless = [cause(posterior, "asymmetric_friction", 1), cause(posterior, "unknown", 0, 3.0)]
    assert keys(posterior.grown(posterior.begun(RIGHT, needless))) == SEVERAL


