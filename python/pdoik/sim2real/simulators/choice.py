"""Which properties differ, by evidence in one linearisation about the likeliest candidate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from pdoik.recordings import FloatArray

from ..identify import Model
from ..thresholds import SimulatorThresholds
from .candidates import Term, baseline
from .climb import Climb, hypothesis, linearised
from .drive_words import UNLIMITED
from .parameters import ORDINARY
from .property import EVERY
from .user_model import UserModel

MOST = 80  # moves
_QUICK = 2  # rounds of coefficients and noise where candidates are only compared
_UNLIKE = 0.3  # numerics: cosine below which two terms cannot stand for each other
_NEGATIVE = 0.1  # numerics: of what is believed of a coordinate, that lines may lead below zero
_ALIKE = 0.9  # numerics: cosine from which two terms may undo each other
_SAME = 0.999  # numerics: cosine from which two terms are one torque
_BOTH_BRAKE = {"kv", "damping"}  # one torque, unless a limit is reached
_FEW = 6  # rivals that are looked at, the most alike
_OF_ALL = {
    "kp_factor": {"kp"},
    "gain_factor": {"kp", "kv", "kp_factor"},
    "delay": {"delay", "filter"},
}
"""What one figure, of all joints or of both gains, may stand in the place of."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rival:
    """Another term that explains the same data as well as a chosen one."""

    term: Term
    probability: float  # of being the better one of the two
    same: bool  # the same torque under another name: no motion could decide


class Choice:
    """Sets of terms about one candidate; what is in none of them is as in the user's model."""

    def __init__(
        self,
        climb: Climb,
        x: FloatArray,
        terms: Sequence[Term],
        limits: SimulatorThresholds,
    ) -> None:
        shown = climb.run(x)
        every = np.ones(len(x), dtype=bool)
        J = climb.lines(x, shown, every)
        explained = np.einsum("prc,p->rc", J, x - climb.start)
        self.climb, self.limits, self.shown, self._x = climb, limits, shown, x
        self._data = linearised(climb, shown, explained, climb.independent(shown))
        self._hypotheses = [
            hypothesis(
                each, J[i], 0.0, each.std**-2, positive=each.kind == "gap" and each.start == 0.0
            )
            for i, each in enumerate(climb.parameters)
        ]
        self._free = np.array([each.kind != "gap" for each in climb.parameters])
        size = np.sqrt(np.einsum("prc,prc->p", J, J))
        self._like = np.einsum("prc,qrc->pq", J, J) / np.maximum(np.outer(size, size), 1e-300)
        self.terms = tuple(t for t in terms if all(size[i] > 0.0 for i in self.places([t])))
        anomalous = sum(not self._is_ordinary(term) for term in self.terms)
        self._anomalous = float(np.log(limits.false_alarms / max(anomalous, 1)))
        self._usual = float(np.log(limits.differs / (1.0 - limits.differs)))

    def places(self, terms: Sequence[Term]) -> list[int]:
        """Parameters of the terms, each once."""
        found = (
            self.climb.place[parameter_id] for term in terms for parameter_id in term.parameter_ids
        )
        return list(dict.fromkeys(found))

    def model(self, terms: Sequence[Term], like: Model | None = None, rounds: int = 40) -> Model:
        """The kernel's model of these terms."""
        chosen = [self._hypotheses[i] for i in self.places(terms)]
        return Model(self._data, chosen, like, rounds)

    def x_of(self, terms: Sequence[Term]) -> FloatArray:
        """The likeliest coordinates with these terms alone, (P,)."""
        x = self.climb.start.copy()
        places = self.places(terms)
        x[places] += self.model(terms).beta
        return np.where(self._free, x, np.maximum(x, 0.0))

    def std_of(self, terms: Sequence[Term]) -> FloatArray:
        """Standard errors of the coordinates of these terms, 0 of others, (P,)."""
        std = np.zeros(len(self.climb.start))
        std[self.places(terms)] = np.sqrt(self.model(terms).variances)
        return std

    def log_odds(self, terms: Sequence[Term]) -> float:
        """Log odds, before the data, that all of these terms differ."""
        each = (self._usual if self._is_ordinary(term) else self._anomalous for term in terms)
        return float(sum(each))

    def evidence(self, terms: Sequence[Term]) -> float:
        """Log probability of these terms, about the candidate, which has no others (Laplace)."""
        model = self.model(terms)
        scale = np.sqrt(model.precision[model.active])
        even = model.inverse[np.ix_(model.active, model.active)] * np.outer(scale, scale)
        narrowed = 0.5 * float(np.linalg.slogdet(even)[1])
        return self.climb.log(self._x, self.shown) + narrowed + self.log_odds(terms)

    def moves(self, term: Term) -> float:
        """How far the candidate has moved a term's coordinates, over what is believed of them."""
        at = self.places([term])
        return float(np.abs((self._x - self.climb.start)[at] / self.climb.std[at]).max())

    def _is_ordinary(self, term: Term) -> bool:
        return is_ordinary(self.climb.experiment.user, term)

    def chosen(self, start: Sequence[Term]) -> tuple[Term, ...]:
        """The likelier set of those that begin with some terms, and with none.

        Where many small changes undo each other, none of them can be dropped alone.
        """
        found = [self._climbed(terms) for terms in (self.without_doubles(start), ())]
        return max(found, key=self._log_posterior)

    def without_doubles(self, terms: Sequence[Term]) -> tuple[Term, ...]:
        """The terms, of several that are one torque only the one that moved most."""
        kept: list[Term] = []
        for term in sorted(set(terms) & set(self.terms), key=lambda each: -self.moves(each)):
            if not any(self._is_double(term, each) for each in kept):
                kept.append(term)
        return tuple(term for term in self.terms if term in kept)

    def _is_double(self, one: Term, other: Term) -> bool:
        return (
            one.indices == other.indices
            and {one.name, other.name} == _BOTH_BRAKE
            and self._likeness(one, other) > _SAME
        )

    def _log_posterior(self, terms: Sequence[Term]) -> float:
        return self.model(terms).log_evidence + self.log_odds(terms)

    def _climbed(self, start: Sequence[Term]) -> tuple[Term, ...]:
        """Terms are dropped and taken up as long as the posterior grows."""
        now = [term for term in start if term in self.terms]
        for _ in range(MOST):
            model = self.model(now, rounds=_QUICK)
            better = self._with_less(now, model) or self._with_one_more(now, model)
            if better is None:
                break
            now = better
        return tuple(now)

    def _with_less(self, terms: list[Term], model: Model) -> list[Term] | None:
        """The terms without those that the posterior keeps least; None if it keeps them all.

        What is left must be possible: no loss may become negative in their place.
        """
        possible = self._is_possible(terms, model)
        for some, keeps in sorted(self._keeps(terms, model), key=lambda pair: pair[1]):
            if keeps >= 0.0:
                break
            rest = [term for term in terms if term not in some]
            if not possible or self._is_possible(rest, self.model(rest, model, _QUICK)):
                return rest
        return None

    def _is_possible(self, terms: Sequence[Term], model: Model) -> bool:
        places = self.places(terms)
        low = np.array([-np.inf if self._free[i] else -self.climb.start[i] for i in places])
        return bool(np.all(model.beta >= low - _NEGATIVE * self.climb.std[places]))

    def _keeps(
        self, terms: Sequence[Term], model: Model
    ) -> Iterator[tuple[tuple[Term, ...], float]]:
        """Terms that may be left out together, and the log odds with which they are kept.

        Of terms that may be left out the ratio of evidence is the density of their coefficients at
        nothing, before the data and after (Dickey, Annals of Mathematical Statistics 42, 1971).
        Several of one joint may undo each other, and joints' own figures stand next to a
        common one: the data keep each of them, and not all.
        """
        places = self.places(terms)
        inverse = model.inverse
        alike = (pair for pair in combinations(terms, 2) if self._likeness(*pair) > _ALIKE)
        parts = [tuple(each for each in terms if stands_for(one, each)) for one in terms]
        for k in range(len(self.climb.experiment.user.joints)):
            own = tuple(term for term in terms if term.indices == {k})
            parts += [own, *(tuple(each for each in own if each != one) for one in own)]
        for some in (*((term,) for term in terms), *alike, *(part for part in parts if part)):
            at = [places.index(i) for i in self.places(some)]
            if not model.active[at].all():
                if len(some) == 1:
                    yield some, -np.inf
                continue
            spread, beta = inverse[np.ix_(at, at)], model.beta[at]
            scale = np.sqrt(model.precision[at])
            even = spread * np.outer(scale, scale)
            keeps = 0.5 * float(np.linalg.slogdet(even)[1] + beta @ np.linalg.solve(spread, beta))
            yield some, keeps + self.log_odds(some)

    def _with_one_more(self, now: list[Term], model: Model) -> list[Term] | None:
        before = model.log_evidence
        best, gain = None, 0.0
        taken = set(self.places(now))
        for term in self.terms:
            if set(self.places([term])) <= taken or any(
                stands_for(term, each) or stands_for(each, term) or self._is_double(term, each)
                for each in now
            ):
                continue
            after = self.model([*now, term], model, _QUICK).log_evidence
            if after - before + self.log_odds([term]) > gain:
                best, gain = [*now, term], after - before + self.log_odds([term])
        return best

    def rivals(self, chosen: Sequence[Term], term: Term) -> tuple[Rival, ...]:
        """Terms that explain the data as well in place of a chosen one, best first."""
        others = [each for each in chosen if each != term]
        model = self.model(chosen)
        mine = model.log_evidence + self.log_odds([term])
        alike = sorted(
            (each for each in self.terms if each not in chosen),
            key=lambda each: -self._likeness(each, term),
        )
        found = []
        for rival in alike[:_FEW]:
            likeness = self._likeness(rival, term)
            if likeness < _UNLIKE:
                break
            with_it = self.model([*others, rival], model, _QUICK).log_evidence
            same = likeness > _SAME
            # Of the same torque no more can be said than before the data.
            before = self.log_odds([term]) - self.log_odds([rival])
            worse = before if same else mine - with_it - self.log_odds([rival])
            if worse < self.limits.rival:
                probability = float(1.0 / (1.0 + np.exp(np.clip(worse, -50.0, 50.0))))
                found.append(Rival(term=rival, probability=probability, same=same))
        return tuple(sorted(found, key=lambda each: -each.probability))

    def _likeness(self, one: Term, other: Term) -> float:
        """The largest cosine between what their parameters show."""
        at = np.ix_(self.places([one]), self.places([other]))
        return float(np.abs(self._like[at]).max())


def is_ordinary(user: UserModel, term: Term) -> bool:
    """Whether every machine has more or less of it than its model says.

    A limit of torque is, where the model has one; few motions reach one that it does not have.
    """
    if len(term.parameter_ids) > 1 or term.name not in ORDINARY or term.indices == {EVERY}:
        return False
    return term.name != "force_limit" or baseline(user, term.parameter_ids[0]) < UNLIMITED


def stands_for(one: Term, other: Term) -> bool:
    """Whether a figure of all joints, or of both gains, says what another term says in part."""
    if one == other or len(one.parameter_ids) != 1 or one.parameter_ids[0].property not in _OF_ALL:
        return False
    if one.indices != {EVERY} and (
        one.indices != other.indices or one.parameter_ids[0].property == "delay"
    ):
        return False
    return all(
        parameter_id.property in _OF_ALL[one.parameter_ids[0].property]
        for parameter_id in other.parameter_ids
    )
