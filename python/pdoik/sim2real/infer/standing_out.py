"""Joints that stand out: they leave more than others, or their friction changes more.

Catalogue laws are approximations, so that every joint of a real machine keeps some residue, in
proportion to its friction most of all. One that keeps several times what its friction makes likely
has something of its own, whether or not anybody knows what. Every bearing is another one from day
to day, by ten percent or so; one that differs by several times as much warms up or runs dry: its
size is no constant, and what is said of it is a mean.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.friction import FrictionDrift
from ..findings import MOST_EQUIVALENTS, Equivalent, Finding, JointFit, Residue
from ..identify import Identified
from ..motion import Key, Prepared
from ..regression import Fit, friction_at, spread_between
from ..thresholds import DiagnosisThresholds, Thresholds


def with_outstanding(
    prepared: Prepared, state: Identified, joints: Mapping[str, JointFit], ordinary: Fit
) -> dict[str, JointFit]:
    """The joints with what stands out marked, by the recordings to fit alone.

    `ordinary` is the fit of all that every machine has.
    """
    result = dict(joints)
    for j, ratio in _outstanding(prepared, state, ordinary).items():
        name = prepared.study.joints[j]
        fit = result[name]
        result[name] = replace(fit, residue=replace(fit.residue or Residue(), outstanding=ratio))
    return result


def _outstanding(prepared: Prepared, state: Identified, ordinary: Fit) -> dict[int, float]:
    """What a joint leaves over what its friction makes likely, by the same of the others."""
    least, believed = prepared.study.thresholds.diagnosis, prepared.study.thresholds.priors
    shares = _shares(prepared, state, ordinary)
    found = {}
    for j, share in shares.items():
        others = [each for i, each in shares.items() if i != j]
        usual = max(float(np.median(others)), believed.usual_residue) if others else 1.0
        ratio = share / usual
        alone = share > 1.0  # more than friction, noise and the model's error together
        if alone or (ratio > least.rare and share > believed.usual_residue):
            found[j] = ratio
    return found


def _shares(prepared: Prepared, state: Identified, fit: Fit) -> dict[int, float]:
    """What is left of each judged joint, over friction, noise and the model's own error.

    Nothing of a joint that is as quiet as its sensors are.
    """
    b, thresholds = prepared.fit, prepared.study.thresholds
    shares = {}
    for j in range(b.n):
        key: Key = ("torque", j)
        if key not in state.fit.design or not b.excited[j] or not len(state.fit.rows[key]):
            continue
        left = float(np.sqrt(np.mean(state.fit.residual(key) ** 2))) * state.balances.sigma[key]
        quiet = thresholds.diagnosis.quiet * b.floor[key]
        tau = np.concatenate([m.borne[:, j] for m in b.motions])
        model = thresholds.priors.of_the_model * float(np.sqrt(np.mean(tau**2)))
        friction = float(np.sqrt(np.mean(friction_at(fit, j) ** 2)))
        usual = float(np.linalg.norm([friction, quiet, model]))
        shares[j] = left / usual if left > quiet else 0.0
    return shares


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
