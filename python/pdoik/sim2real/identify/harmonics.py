"""Harmonics of the joint's angle in the residual: where to look for torque ripple."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..effects import CATALOGUE
from ..motion.balances import Balances
from ..motion.place import Place
from ..regression.fit import Fit, Term, term_of
from ..study.recording import FloatArray

_LOWEST, _HIGHEST = 4, 300  # cycles per turn; fewer look like gravity
_TRIED = 2  # harmonics per joint that are worked out


def harmonic_terms(fit: Fit) -> list[Term]:
    """Effects of the strongest harmonics in what is left, for each joint that moves."""
    b, least = fit.balances, fit.balances.thresholds.identify
    effects = [each for each in CATALOGUE.values() if each.sought == "harmonics"]
    terms = []
    harmonics = np.arange(_LOWEST, _HIGHEST + 1)
    for j in range(b.n):
        key = ("torque", j)
        if key not in fit.design or not b.excited[j]:
            continue
        rows = fit.rows[key]
        if len(rows) < least.harmonic_rows:
            continue
        waves, count = _waves(b, j)
        count = np.maximum(count, float(least.harmonic_rows))
        power = 2.0 * np.abs(fit.residual(key) @ waves[rows]) ** 2 / count
        for i in np.argsort(power)[::-1][:_TRIED]:
            if power[i] > least.harmonic_power:
                shape = (float(harmonics[i]),)
                found = [term_of(b, each, Place(joints=(j,)), shape) for each in effects]
                terms += [term for term in found if term is not None]
    return terms


def _waves(b: Balances, j: int) -> tuple[NDArray[np.complex64], FloatArray]:
    """Harmonics of joint j's angle at every row, zero where the filter would take them, kept."""
    name = f"waves {j}"
    if name not in b.scratch:
        q = b.sampled([m.q[:, j] for m in b.motions])
        dq = b.sampled([m.dq[:, j] for m in b.motions])
        harmonics = np.arange(_LOWEST, _HIGHEST + 1)
        passes = np.abs(dq)[:, None] * harmonics < 2 * np.pi * b.motions[0].cutoff
        waves = np.exp(1j * q[:, None] * harmonics) * passes
        b.scratch[name] = (waves.astype(np.complex64), passes.sum(axis=0).astype(np.float64))
    return b.scratch[name]
