"""Our library of effects with the plainest search: forwards, by the Bayesian criterion.

No background, no held-out rows, no sessions left out, no simulation: what a stepwise regression on
the same columns would say.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.machines.rivals.finding import finding
from pdoik.sim2real import load_study
from pdoik.sim2real.motion.prepare import prepare
from pdoik.sim2real.regression.estimate import estimates
from pdoik.sim2real.regression.fit import Fit
from pdoik.sim2real.regression.screen import screen
from pdoik.sim2real.select.candidates import candidates

MOST = 40  # terms


def named_stepwise(study: Path) -> list[dict[str, Any]]:
    """Findings in the order in which they were taken."""
    prepared = prepare(load_study(study))
    balances = prepared.fit
    pool = candidates(balances)
    fit = Fit(balances, ())
    price = float(np.log(balances.count))
    while len(fit.terms) < MOST:
        taken = {t.key for t in fit.terms}
        screened = screen(fit, [t for t in pool if t.key not in taken])
        worth = [(gain - price * (t.width + len(t.shape)), t) for t, gain in screened]
        best = max(worth, key=lambda each: each[0], default=None)
        if best is None or best[0] <= 0.0:
            break
        fit = fit.extended(best[1])
    values = estimates(fit, fit.terms, 0)
    links = () if prepared.body is None else prepared.body.links
    return [
        finding(
            term.effect,
            [prepared.study.joints[j] for j in term.place.joints],
            [] if term.place.link is None else [links[term.place.link]],
            {name: asdict(each) for name, each in values[i].items()},
        )
        for i, term in enumerate(fit.terms)
    ]
