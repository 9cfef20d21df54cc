"""What a log's samples and a controller's ticks leave open of a delay.

The law, or the command, is known at the log's samples and kept over the controller's period, half
of which is accounted for. Forty studies with nothing wrong show what remains, as a share of that
period: of a position's delay 0.013 root mean square and 0.06 at most where its own error is
small, of a torque's 0.08 and 0.22. What they cannot show is that a machine logs its command a
tick before it acts, or its torque a tick after: then all joints seem late by up to a period.
"""

from __future__ import annotations

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.drives import OF_POSITION, OF_TORQUE, CommandDelay, period_of
from ..findings import Estimate
from ..motion import Balances, Key, Place, Prepared
from ..regression import Fit, Term, described, effect_of, robust

_SMALL = 0.2  # of a period: the step of a derivative by the delay


def blur(b: Balances, shape: tuple[float, ...]) -> float:
    """Standard deviation that sampling gives a delay or a lag [s]."""
    first, by = b.motions[0], b.thresholds.priors
    period, known = period_of(first)
    of_kind = by.position_delay if shape[0] == OF_POSITION else by.torque_delay
    share = of_kind if known else by.unknown_delay
    return float(np.hypot(share * period, by.log_delay * first.recording.raw_period))


def widened(b: Balances, term: Term, values: dict[str, Estimate]) -> dict[str, Estimate]:
    """A delay's, lag's or skew's estimates with the error that sampling adds."""
    effect = CATALOGUE[term.effect]
    if not effect.blurred_by_sampling or b.motions[0].source == "":
        return values
    by = blur(b, term.shape if effect.is_delay else (OF_TORQUE,))
    return {name: each.wider(by) for name, each in values.items()}


def without_sampling(
    prepared: Prepared, fit: Fit, terms: tuple[Term, ...]
) -> tuple[tuple[Term, ...], list[str]]:
    """The terms that sampling does not explain, and what was left out, in words."""
    shared = [term for term in terms if shared_by_all(fit, term)]
    notes = [
        f"{described(prepared, term)}: {1e3 * term.shape[1]:.2g} ms, not more than a period and not"
        " different from what all joints show; sampling and the controller's period explain it, so"
        " it is not claimed."
        for term in shared
    ]
    return tuple(term for term in terms if term not in shared), notes


def shared_by_all(fit: Fit, term: Term) -> bool:
    """Whether a delay not clearly above a period is one that the other joints show as well.

    Or cannot be distinguished from such a one. Then the order in which a machine acts and logs
    explains it.
    """
    motions, limits = fit.balances.motions, fit.balances.thresholds.diagnosis
    if not effect_of(term).is_delay or motions[0].source == "":
        return False
    delay = abs(term.shape[1])
    if delay > period_of(motions[0])[0] + limits.sure * blur(fit.balances, term.shape):
        return False
    others = [t for t in fit.terms if not (effect_of(t).is_delay and t.shape[0] == term.shape[0])]
    bare = Fit(fit.balances, others)
    seen = []
    for j in range(fit.balances.n):
        if (j,) == term.place.joints or not fit.balances.excited[j]:
            continue
        value, error = lateness(bare, j, term.shape[0])
        if error < limits.delay_given * delay:
            seen.append(value)
    return not seen or float(np.median(seen)) > limits.most_of * delay


def lateness(fit: Fit, j: int, what: float) -> tuple[float, float]:
    """How late a joint's commands act given a fit, to first order, and its error [s].

    Infinite where no balance shows it.
    """
    b, effect = fit.balances, CATALOGUE[CommandDelay.id]
    place = Place(joints=(j,))
    if not effect.shapes(b.motions, place):
        return 0.0, np.inf
    step = _SMALL * period_of(b.motions[0])[0]
    late, early = (b.compute(effect, place, (what, sign * step)) for sign in (1.0, -1.0))
    slope = {key: (late[key] - early[key]) / 2 for key in late if key in early}
    if not slope:
        return 0.0, np.inf
    middle = {key: (late[key] + early[key]) / 2 for key in slope}
    wider = fit.extended(_term(effect.id, place, middle), _term("slope", place, slope))
    error = float(np.sqrt(robust(wider, wider.terms[-1])[0, 0]))
    return float(wider.beta[-1]) * step, error * step


def _term(effect: str, place: Place, columns: dict[Key, FloatArray]) -> Term:
    return Term(effect=effect, place=place, shape=(), columns=columns, prior=np.zeros(1))
