"""Causes of a study's mismatch by one posterior, linearised again where a cause asks for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from ..effects import CATALOGUE
from ..motion import Prepared
from ..regression import term_of
from .claims import identified
from .hypothesis import Hypothesis, anomalous
from .identified import Identified
from .posterior import Posterior, likeliest
from .relinearised import relinearised
from .weighing import State

_ROUNDS = 4  # numerics: of linearisation
_BEGIN, _END, _STEP = 0.18, 0.76, 0.06  # of the work reported as done
_FEW = 6  # causes after which one beginning is left

Tell = Callable[[str, str, float], None]


@dataclass(slots=True)
class _Progress:
    """Says what is taken, with a share of the work that grows: the rest is never known."""

    say: Tell
    share: float = _BEGIN

    def __call__(self, text: str) -> None:
        self.share += _STEP * (_END - self.share)
        self.say("name", text, self.share)


def identify(prepared: Prepared, say: Tell) -> tuple[Prepared, Identified]:
    """The causes, and the study as it is linearised at them."""
    chosen: list[Hypothesis] = []
    progress, rounds = _Progress(say), 0
    while True:
        posterior = Posterior.of(prepared.fit, progress)
        state = _likeliest(posterior, prepared, chosen)
        rounds += 1
        fit = posterior.fit_of(state.model)
        other = relinearised(prepared, fit) if rounds < _ROUNDS else None
        if other is None:
            return prepared, identified(posterior, state)
        progress("once more, linearised at what was found")
        prepared = other
        chosen = _anew(prepared, state)
        del posterior, state, fit  # room for the next


def _likeliest(posterior: Posterior, prepared: Prepared, chosen: list[Hypothesis]) -> State:
    """The likeliest state from two starts: a model as wrong as drawings are, and one nearly right.

    The likelier after a few causes goes on; at its end the other share is asked again.
    """
    believed = prepared.study.thresholds.priors
    given = prepared.study.trust.rigid_body
    most = believed.bodies if given is None else given
    shares = [most]
    if prepared.body is not None and most > believed.good_bodies:
        shares.append(believed.good_bodies)
    few = len(chosen) + _FEW
    begun = [posterior.grown(posterior.begun(share, chosen), few) for share in shares]
    state = posterior.grown(likeliest(begun))
    for share in shares:
        other = posterior.with_bodies(state, share)
        if share != state.ordinary.bodies and other.log_posterior > state.log_posterior:
            return posterior.grown(other)
    return state


def _anew(prepared: Prepared, state: State) -> list[Hypothesis]:
    """What was chosen, on other balances."""
    found = []
    for each in state.chosen:
        effect = CATALOGUE[each.term.effect]
        term = term_of(prepared.fit, effect, each.term.place, each.term.shape)
        if term is not None:
            fresh = anomalous(prepared.fit, term)
            found.append(replace(fresh, log_odds=each.log_odds))
    return found
