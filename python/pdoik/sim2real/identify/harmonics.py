"""Harmonics of the joint's angle in the residual: where to look for torque ripple."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Place
from ..regression import Fit, Term, term_of

_LOWEST, _HIGHEST = 3, 300  # cycles per turn; gravity has one, inertia two
_TRIED = 2  # harmonics per joint that are worked out
_BINS = 4096  # of a turn
_REACHES = np.geomspace(_LOWEST, _HIGHEST, 32)  # harmonics by which rows are distinguished by speed


def harmonic_terms(fit: Fit, joints: Sequence[int] | None = None) -> list[Term]:
    """Effects of the strongest harmonics in what is left, for each joint that moves, or some."""
    b, least = fit.balances, fit.balances.thresholds.diagnosis
    effects = [each for each in CATALOGUE.values() if each.sought == "harmonics"]
    terms = []
    for j in range(b.n) if joints is None else joints:
        key = ("torque", j)
        if key not in fit.design or not b.excited[j]:
            continue
        rows = fit.rows[key]
        if len(rows) < least.harmonic_rows:
            continue
        q = b.sampled([m.q[:, j] for m in b.motions])[rows]
        dq = b.sampled([m.dq[:, j] for m in b.motions])[rows]
        reach = 2.0 * np.pi * b.motions[0].cutoff / np.maximum(np.abs(dq), 1e-9)
        power = _powers(q, reach, fit.residual(key), least.harmonic_rows)
        for i in np.argsort(power)[::-1][:_TRIED]:
            if power[i] > least.harmonic_power:
                shape = (float(_LOWEST + i),)
                found = [term_of(b, each, Place(joints=(j,)), shape) for each in effects]
                terms += [term for term in found if term is not None]
    return terms


def _powers(q: FloatArray, reach: FloatArray, left: FloatArray, fewest: int) -> FloatArray:
    """Power of each harmonic of an angle, by the transforms of bins of it.

    Args:
        q: (N,) angles.
        reach: (N,) the highest harmonic that the filter lets pass at a row's speed.
        left: (N,) what is left.
        fewest: rows that count at least.
    """
    kind = np.searchsorted(_REACHES, reach, side="right") - 1
    seen = kind >= 0
    kind, at = kind[seen], np.rint(q[seen] * (_BINS / (2.0 * np.pi))).astype(np.intp) % _BINS
    size = len(_REACHES) * _BINS
    sums = np.bincount(kind * _BINS + at, weights=left[seen], minlength=size)
    waves = np.fft.rfft(sums.reshape(-1, _BINS), axis=1)[:, _LOWEST : _HIGHEST + 1]
    passes = np.arange(_LOWEST, _HIGHEST + 1) <= _REACHES[:, None]
    rows = np.bincount(kind, minlength=len(_REACHES)) @ passes
    found = np.abs(np.sum(waves * passes, axis=0)) ** 2
    return np.asarray(2.0 * found / np.maximum(rows, fewest), dtype=np.float64)
