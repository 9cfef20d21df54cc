"""Harmonics of the joint's angle in the residual: where to look for torque ripple."""

from __future__ import annotations

import numpy as np

from .effects import CATALOGUE, Place
from .regression import Fit, Term, term_of

_LOWEST, _HIGHEST = 4, 300  # cycles per turn; fewer look like gravity
_TRIED = 2  # harmonics per joint that are worked out


def ripple_terms(fit: Fit) -> list[Term]:
    """Ripple of the strongest harmonics in what is left, for each joint that moves."""
    b = fit.balances
    effect = CATALOGUE["torque_ripple"]
    terms = []
    harmonics = np.arange(_LOWEST, _HIGHEST + 1)
    for j in range(b.n):
        key = ("torque", j)
        if key not in fit.design or not b.excited[j]:
            continue
        rows = fit.rows[key]
        if len(rows) < 50:
            continue
        left = fit.residual(key)
        q = b.sampled([m.q[:, j] for m in b.motions])[rows]
        dq = b.sampled([m.dq[:, j] for m in b.motions])[rows]
        cutoff = 2 * np.pi * b.motions[0].cutoff
        power = np.empty(len(harmonics))
        for i, h in enumerate(harmonics):
            seen = (np.abs(dq) * h < cutoff).astype(float)  # what the filter lets pass
            wave = np.exp(1j * h * q) * seen
            power[i] = 2.0 * np.abs(np.sum(left * wave)) ** 2 / max(seen.sum(), 50.0)
        for i in np.argsort(power)[::-1][:_TRIED]:
            if power[i] > 20.0:
                term = term_of(b, effect, Place(joints=(j,)), (float(harmonics[i]),))
                if term is not None:
                    terms.append(term)
    return terms
