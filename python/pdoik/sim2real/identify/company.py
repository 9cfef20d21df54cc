"""Which hypotheses may be in one model: a finer law replaces an ordinary one; one law of a kind."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..effects import CATALOGUE
from ..effects.drives import TorqueGain
from ..regression import DAYS, Term
from .hypothesis import Hypothesis
from .model import Model
from .ordinary import OF_DAYS, OF_JOINTS, Ordinary


def _takes_place(law: Hypothesis, part: Hypothesis) -> bool:
    """Whether a law is a finer one of an ordinary friction's kind, which is then not there."""
    return (
        part.ordinary
        and part.term.effect in (DAYS, OF_DAYS)
        and part.term.place == law.term.place
        and CATALOGUE[law.term.effect].one_of == CATALOGUE[OF_DAYS].one_of
    )


def with_ordinary(ordinary: Ordinary, chosen: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
    """Ordinary physics and what is chosen, but for parts whose place a finer law takes."""
    parts = [
        part for part in ordinary.hypotheses() if not any(_takes_place(law, part) for law in chosen)
    ]
    return (*parts, *chosen)


def wider(model: Model, law: Hypothesis) -> Model:
    """A model with a cause more, in the place of what it is a finer law of."""
    gone = [part for part in model.hypotheses if _takes_place(law, part)]
    return (model.without(*gone) if gone else model).with_(law)


def has_shape(hypothesis: Hypothesis) -> bool:
    term = hypothesis.term
    effect = CATALOGUE[term.effect]
    return term.place.gate is not None or bool(effect.free(term.shape))


def of_torque(hypothesis: Hypothesis) -> bool:
    return all(balance == "torque" for balance, _ in hypothesis.term.columns)


def is_ordinary(term: Term) -> bool:
    """Whether the model has it anyway: a torque's zero, but not that of the report alone."""
    if term.effect not in OF_JOINTS or term.effect == TorqueGain.id:
        return False
    return term.place.gate is None and not CATALOGUE[term.effect].variant(term.shape)


def fits_with(hypothesis: Hypothesis, chosen: Iterable[Hypothesis]) -> bool:
    """Whether a cause may join others: one law of a kind at a joint, one body at a link."""
    effect, place = CATALOGUE[hypothesis.term.effect], hypothesis.term.place
    for other in chosen:
        same = other.term.effect == effect.id and other.term.place.joints == place.joints
        if same and place.gate is not None and other.term.place.gate is not None:
            return False  # a law that comes and goes many times is another law
        if other.term.place != place:
            continue
        there = CATALOGUE[other.term.effect]
        if effect.one_of and effect.one_of == there.one_of:
            return False
        if effect.is_body and there.is_body:
            return False
        if there.id in effect.instead or effect.id in there.instead:
            return False
    return True
