"""Friction that differs from recording to recording by more than that of the other joints.

Every bearing is another one from day to day, by ten percent or so. One that differs by several
times as much warms up or runs dry: its size is no constant, and what is said of it is a mean.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.friction import FrictionDrift
from ..findings import MOST_EQUIVALENTS, Equivalent, Finding
from ..motion import Key
from ..regression import Fit, friction_at, spread_between
from ..thresholds import DiagnosisThresholds, Thresholds


def spreads_of(fit: Fit) -> dict[int, float]:
    """Each joint's change of friction between recordings, as a share of the friction.

    The standard deviation beyond what the errors of each recording's figure make; of joints whose
    friction two recordings or more show.
    """
    b = fit.balances
    found = {}
    for j in range(b.n):
        key: Key = ("torque", j)
        if key not in fit.design or not b.excited[j]:
            continue
        rows = fit.rows[key]
        left, friction = fit.residual(key) * b.sigma[key], friction_at(fit, j)
        each = [
            _scale(left[at], friction[at], b.block[rows[at]], b.thresholds.diagnosis)
            for at in (b.recording[rows] == k for k in range(len(b.motions)))
        ]
        known = np.array([pair for pair in each if pair is not None])
        if len(known) >= 2:
            blocks = len(np.unique(b.block[rows]))
            found[j] = spread_between(known[:, 0], known[:, 1] ** 2, blocks - len(known)).std
    return found


def changing(spreads: Mapping[int, float], thresholds: Thresholds) -> dict[int, float]:
    """The joints that stand out, and by how much their friction differs."""
    found = {}
    for j, spread in spreads.items():
        others = [each for i, each in spreads.items() if i != j]
        usual = max(float(np.median(others)), thresholds.priors.usual_change) if others else np.inf
        if spread > thresholds.diagnosis.rare * usual:
            found[j] = spread
    return found


def with_changes(
    finding: Finding, joints: tuple[str, ...], changes: Mapping[int, float]
) -> Finding:
    """A friction's finding says so too where the friction is no constant."""
    ours = [j for j in changes if finding.joints == (joints[j],)]
    if not ours or CATALOGUE[finding.effect].family != "friction":
        return finding
    if finding.effect == FrictionDrift.id:
        return finding
    said = f" It differs between recordings by {100 * changes[ours[0]]:.2g} % (standard deviation)."
    drift = Equivalent(effect=FrictionDrift.id, joints=finding.joints)
    others = tuple(each for each in finding.equivalents if each != drift)
    return replace(
        finding,
        statement=finding.statement + said,
        equivalents=(drift, *others)[:MOST_EQUIVALENTS],
    )


def _scale(
    left: FloatArray, friction: FloatArray, block: NDArray[np.intp], limits: DiagnosisThresholds
) -> tuple[float, float] | None:
    """The share by which friction is larger in one recording, its error; None where unseen.

    What is constant may as well be the torque's zero: a joint that moves one way shows nothing.
    """
    varying = friction - friction.mean() if len(friction) else friction
    power, blocks = float(varying @ varying), np.unique(block)
    least = limits.shown * float(friction @ friction)
    if len(blocks) < limits.change_blocks or power <= least:
        return None
    share = float(varying @ left) / power
    rest = left - left.mean() - share * varying
    by_block = np.bincount(block, varying * rest)  # rows of a block err alike
    return share, float(np.linalg.norm(by_block)) / power
