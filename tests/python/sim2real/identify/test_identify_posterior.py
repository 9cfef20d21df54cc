"""How the search over sets of causes ends, whatever it begins with, on an arm of two joints."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify import Hypothesis, Pool, Posterior, State, anomalous
from pdoik.sim2real.motion import Balances, Gate, Place, prepare
from pdoik.sim2real.regression import TermKey, term_of
from sim2real_known_causes import RIGHT, RUBS, SEVERAL, few_steps, several, study


def keys(state: State) -> set[TermKey]:
    return {each.key for each in state.chosen}


def size(state: State, hypothesis: Hypothesis) -> float:
    """Its first coefficient."""
    return float(state.model.beta[state.model.span(hypothesis)][0])


def assert_worth_it(posterior: Posterior, state: State) -> None:
    """That each cause pays its price beside all others."""
    for each in state.chosen:
        rest = [other for other in state.chosen if other is not each]
        odds = state.log_posterior - posterior.with_causes(state, rest).log_posterior
        assert odds > posterior.balances.thresholds.diagnosis.worth


def cause(posterior: Posterior, effect: str, j: int, code: float | None = None) -> Hypothesis:
    """An effect at a joint as it is first tried, of a variable."""
    b, place = posterior.balances, Place(joints=(j,))
    shapes = CATALOGUE[effect].shapes(b.motions, place)
    shape = next(s for s in shapes if code is None or s[0] == code)
    term = term_of(b, CATALOGUE[effect], place, shape)
    assert term is not None
    return anomalous(b, term)


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Balances:
    return prepare(study(tmp_path_factory.mktemp("several"), several)).fit


@pytest.fixture(scope="module")
def plain(mixed: Balances) -> tuple[Posterior, State]:
    posterior = Posterior.of(mixed, few_steps())
    return posterior, posterior.grown(posterior.begun(RIGHT))


def test_all_that_is_there_is_found_and_nothing_else(plain: tuple[Posterior, State]) -> None:
    posterior, state = plain
    assert keys(state) == SEVERAL
    assert_worth_it(posterior, state)


@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_candidates_does_not_matter(plain: tuple[Posterior, State], seed: int) -> None:
    posterior, state = plain
    order = np.random.default_rng(seed).permutation(len(posterior.pool.candidates))
    shuffled = Pool(posterior.data, [posterior.pool.candidates[k] for k in order])
    other = replace(posterior, pool=shuffled, tell=few_steps(), tried={})
    found = other.grown(other.begun(RIGHT))
    assert keys(found) == keys(state)
    assert found.log_posterior == pytest.approx(state.log_posterior, abs=0.5)
    pairs = zip(other.pool.scored(found.model), posterior.pool.scored(found.model), strict=True)
    assert all(a.log_odds == pytest.approx(b.log_odds, rel=1e-6, abs=1e-4) for a, b in pairs)


def test_the_order_of_recordings_does_not_matter(
    plain: tuple[Posterior, State], tmp_path: Path
) -> None:
    made = study(tmp_path, several)
    turned = replace(made, recordings=made.recordings[::-1])
    posterior = Posterior.of(prepare(turned).fit, few_steps())
    found, (_, state) = posterior.grown(posterior.begun(RIGHT)), plain
    assert keys(found) == keys(state)
    assert found.log_posterior == pytest.approx(state.log_posterior, abs=0.5)
    for each in state.chosen:
        (same,) = (h for h in found.chosen if h.key == each.key)
        assert same.term.shape == pytest.approx(each.term.shape, rel=0.02)
        assert size(found, same) == pytest.approx(size(state, each), rel=0.02)


@pytest.mark.parametrize("begun_with", [
    [("unknown", 1, 0.0)],
    [("asymmetric_friction", 1, None), ("unknown", 0, 3.0)],
    [("presliding_hysteresis", 0, None), ("unknown", 1, 2.0)],
])  # fmt: skip
def test_causes_go_when_better_ones_come(
    plain: tuple[Posterior, State], begun_with: list[tuple[str, int, float | None]]
) -> None:
    """A curve over positions explains what a spring does: until the spring is there."""
    posterior, state = replace(plain[0], tell=few_steps(), tried={}), plain[1]
    wrong = [cause(posterior, *each) for each in begun_with]
    found = posterior.grown(posterior.begun(RIGHT, wrong))
    assert keys(found) == SEVERAL
    assert found.log_posterior == pytest.approx(state.log_posterior, abs=1.0)
    assert_worth_it(posterior, found)


def test_a_wrong_cause_that_explains_much_is_worth_much_alone(
    plain: tuple[Posterior, State],
) -> None:
    """Or the tests of what goes would say nothing."""
    posterior, state = plain
    curve = cause(posterior, "unknown", 1, 0.0)
    alone = posterior.begun(RIGHT, [curve]).log_posterior
    assert alone > posterior.begun(RIGHT).log_posterior + 100.0
    assert alone < state.log_posterior - 100.0


def test_what_a_sound_machine_began_with_goes(tmp_path: Path) -> None:
    posterior = Posterior.of(prepare(study(tmp_path)).fit, few_steps())
    needless = [cause(posterior, "asymmetric_friction", 1), cause(posterior, "unknown", 0, 3.0)]
    for beginning in ([], needless):
        assert posterior.grown(posterior.begun(RIGHT, beginning)).chosen == ()


class Shedding(Posterior):
    """A search whose ordinary part, tuned, leaves no room for what was added to it."""

    def has_room(self, each: Hypothesis) -> bool:
        return each.term.effect != "stribeck_friction"

    def tuned(self, *given: Any) -> State:
        state = super().tuned(*given)
        return self.with_causes(state, [each for each in state.chosen if self.has_room(each)])


class SheddingParts(Shedding):
    """The same of what acts in a part, whose ends move as it is tried."""

    def has_room(self, each: Hypothesis) -> bool:
        return each.term.place.gate is None


def test_what_cannot_stay_is_not_tried_for_ever(mixed: Balances) -> None:
    posterior = Shedding.of(mixed, few_steps())
    state = posterior.grown(posterior.begun(RIGHT))
    assert ("position_dependent_spring", Place(joints=(1,))) in keys(state)


def test_a_part_that_cannot_stay_is_not_tried_for_ever(tmp_path: Path) -> None:
    def pushed(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        return 2.0 * (q > 0.13) * (q < 0.41) * np.array([1.0, 0.0])

    said: list[str] = []
    steps = few_steps()

    def tell(text: str) -> None:
        steps(text)
        said.append(text)

    posterior = SheddingParts.of(prepare(study(tmp_path, pushed)).fit, tell)
    state = posterior.grown(posterior.begun(RIGHT))
    assert all(each.term.place.gate is None for each in state.chosen)
    assert max(said.count(text) for text in said) < 6  # of its beginnings and last looks


def test_a_cause_is_the_same_wherever_its_part_ends(mixed: Balances) -> None:
    def part(low: float, of: str = "position") -> Hypothesis:
        place = Place(joints=(1,), gate=Gate(of=of, low=low, high=low + 0.5))
        effect = CATALOGUE["viscous_friction"]
        term = term_of(mixed, effect, place, effect.shapes(mixed.motions, place)[0])
        assert term is not None
        return anomalous(mixed, term)

    assert part(-0.4).key == part(0.0).key
    assert part(0.0).key != part(0.0, "time").key


@pytest.mark.parametrize("step", [1e-6, 0.005, 0.01, 0.03])
def test_friction_is_only_that_however_quickly_it_turns(tmp_path: Path, step: float) -> None:
    """Where the arm is so slow that much of its motion lies within the step."""
    rounded = study(tmp_path, lambda k, q, dq: RUBS[:2] * np.tanh(dq / step), slow=0.15)
    posterior = Posterior.of(prepare(rounded).fit, few_steps())
    state = posterior.grown(posterior.begun(RIGHT))
    assert state.chosen == ()
    friction = [h for h in state.model.hypotheses if h.term.effect == "coulomb_friction"]
    assert [size(state, each) for each in friction] == pytest.approx(RUBS[:2], rel=0.02)
