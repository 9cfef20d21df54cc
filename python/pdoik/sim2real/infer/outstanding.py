"""Joints that keep far more unexplained than the others: something that no named effect is.

Catalogue laws are approximations, so that every joint of a real machine keeps some residue, in
proportion to its friction most of all. One that keeps several times what its friction makes likely
has something of its own, whether or not anybody knows what.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..findings import JointFit, Residue
from ..identify import Identified
from ..motion import Key, Prepared
from ..regression import Fit, friction_at


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
