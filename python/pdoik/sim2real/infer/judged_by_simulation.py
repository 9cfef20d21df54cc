"""What only a simulation shows well, compared with simulations of the held-out recordings."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pdoik.errors import PdoikError

from ..confirm import Arm, Rollout, run_without
from ..findings import Evidence
from ..identify import Identified
from ..motion import Key, Prepared
from ..regression import TermKey, share_by_blocks


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedEvidence:
    """Evidence of terms that simulations confirmed."""

    terms: dict[TermKey, Evidence] = field(default_factory=dict)
    left: dict[Key, float] = field(default_factory=dict)  # root mean square, balance by balance


def judged_by_simulation(prepared: Prepared, state: Identified) -> SimulatedEvidence:
    """Evidence on held-out recordings; none where there are none, or the arm runs away."""
    doubtful = [t for t in state.accepted if t.key in state.confirmed]
    if prepared.validate is None or not doubtful:
        return SimulatedEvidence()
    terms, values = state.accepted, state.figures_simulated
    if values is None:
        return SimulatedEvidence()
    try:
        arm = Arm(prepared, state.fit, held_out=True)
        whole = arm.run(terms, values)
        evidence = {
            t.key: _evidence(arm, whole, run_without(arm, terms, values, t), {*t.columns})
            for t in doubtful
        }
    except (PdoikError, ValueError):
        return SimulatedEvidence()
    left = {
        key: float(np.sqrt(np.mean(each**2))) * arm.data.sigma[key]
        for key, each in whole.left.items()
    }
    return SimulatedEvidence(terms=evidence, left=left)


def _evidence(arm: Arm, whole: Rollout, without: Rollout, keys: set[Key]) -> Evidence:
    """Share of what simulations without a finding leave that goes with it, over blocks."""
    count = int(arm.data.block.max()) + 1
    gained, began = np.zeros(count), np.zeros(count)
    for key in keys & set(arm.rows):
        block = arm.data.block[arm.rows[key]]
        before, after = without.left[key] ** 2, whole.left[key] ** 2
        gained += np.bincount(block, before - after, minlength=count)
        began += np.bincount(block, before, minlength=count)
    return share_by_blocks(gained, began, 0)
