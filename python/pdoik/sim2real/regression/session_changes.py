"""Friction that changes from session to session, as far as that is one cause's.

Of other effects a change is told and no more: a load, an encoder's zero or a drive's gain that
changes has a cause of its own, and so has what a law that is not quite right makes of other motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from ..effects import CATALOGUE
from ..study.recording import FloatArray
from .by_session import by_session, figure_by_session
from .fit import Fit, Term
from .random_effects import Spread, spread_between


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SessionChange:
    """A term's coefficients between sessions, one that does not change as zeros."""

    term: Term
    of_another: FloatArray  # (width,) standard deviation of a session that is not among these
    changes: FloatArray  # (S, width) of each session from the mean, as far as its data tell


def session_changes(fit: Fit) -> tuple[SessionChange, ...]:
    """Of the friction that changes between sessions by more than its errors.

    What changes by more than a share of itself may be several causes: it is left as it is.
    """
    sessions = by_session(fit)
    found = []
    for term, offset in zip(fit.terms, fit.offsets, strict=False):
        effect = CATALOGUE.get(term.effect)
        if not sessions or term.fixed or effect is None or effect.family != "friction":
            continue
        another, changes = np.zeros(term.width), np.zeros((len(sessions), term.width))
        for k in range(term.width):
            each = figure_by_session(sessions, itemgetter(int(offset) + k))
            spread = spread_between(each.values, each.variances, each.freedom)
            if _is_one_cause(fit, spread):
                another[k] = spread.of_another
                told = spread.std**2 / (spread.std**2 + each.variances)
                changes[:, k] = told * (each.values - spread.mean)
        if another.any():
            found.append(SessionChange(term=term, of_another=another, changes=changes))
    return tuple(found)


def _is_one_cause(fit: Fit, spread: Spread) -> bool:
    least = fit.balances.thresholds.figures
    usual = 0.0 < spread.std <= least.usual_spread * abs(spread.mean)
    return usual and spread.p <= least.spread_p
