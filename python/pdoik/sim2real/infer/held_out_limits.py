"""Limits that only held-out recordings reach: found where they happened, and said to be so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..effects import CATALOGUE
from ..effects.drives import OF_COMMAND, TorqueSaturation, kinds, top_of
from ..findings import Estimate, Evidence, Finding
from ..motion import Balances, FlatTop, Place, Prepared
from ..regression import Fit, Found, Prediction, Term, finding_of, refined, term_of
from .event_support import event_support
from .events import only_held_out

_LIMIT = TorqueSaturation.id


def held_out_limits(prepared: Prepared, fit: Fit, prediction: Prediction) -> list[Found]:
    """Flat tops of joints that the fit recordings never drove to their limit.

    Held-out recordings choose nothing that could be learnt elsewhere; what only happens there can
    only be seen there, as a contact can. It is taken out of their residual.
    """
    found: list[Found] = []
    b = prepared.validate
    if b is None:
        return found
    of_level = b.thresholds.priors.discretisation
    limited = {t.place.joints for t in fit.terms if t.effect == _LIMIT}
    for j in range(b.n):
        if (j,) in limited:
            continue
        for kind in kinds(b.motions[0], j):
            top = top_of(b.motions, j, kind)
            if top is None:
                continue
            place = Place(joints=(j,))
            term = term_of(b, CATALOGUE[_LIMIT], place, (kind, top.level))
            if term is None:
                continue
            rest = prediction.rest(fit)
            term = refined(rest, term)
            share = _share(rest, term)
            if share < CATALOGUE[_LIMIT].least_of_rest:
                continue
            evidence = Evidence.once(share, "tau_cmd" if kind == OF_COMMAND else "q_des")
            level = term.shape[1]
            std = float(np.hypot(top.std, of_level * level))
            figures = {"level": Estimate.normal(level, std, "N m")}
            support = event_support(rest, term, Fit(b, ()))
            finding = finding_of(prepared, term, figures, (), evidence, support)
            finding = _where(finding, b, top)
            found.append((finding, (term,)))
            if finding.confidence >= b.thresholds.diagnosis.suspected:
                prediction.events.append((term, np.ones(1)))
            break
    return found


def _share(rest: Fit, term: Term) -> float:
    """Share of the mean square that was left on the rows in which the term acts."""
    gained = began = 0.0
    for key, column in term.columns.items():
        part = column[rest.rows[key], 0] / rest.balances.sigma[key]
        at = part != 0.0
        before = rest.target[key][at]
        gained += float(np.sum(before**2 - (before - part[at]) ** 2))
        began += float(np.sum(before**2))
    return float(np.clip(gained / max(began, 1e-12), 0.0, 1.0))


def _where(finding: Finding, b: Balances, top: FlatTop) -> Finding:
    """The finding with the recordings in which it happened: nothing else speaks for it."""
    names = tuple(m.recording.name for m, rows in zip(b.motions, top.rows, strict=True) if rows)
    return only_held_out(replace(finding, recordings=names), b.thresholds)
