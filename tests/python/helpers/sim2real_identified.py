"""What is identified in balances that a test made in memory."""

from __future__ import annotations

from pathlib import Path

from pdoik.sim2real import Estimate
from pdoik.sim2real.identify import Identified, Posterior, estimates, identify
from pdoik.sim2real.motion import Balances, Prepared
from pdoik.sim2real.regression import Fit
from pdoik.sim2real.study import Study

BODIES = 0.01  # share within which the tests' models are right


def identified(balances: Balances) -> Identified:
    """Causes in balances of a study that tells nothing else."""
    first = balances.motions[0]
    study = Study(
        folder=Path(),
        robot=None,
        joints=tuple(f"j{k + 1}" for k in range(balances.n)),
        recordings=tuple(motion.recording for motion in balances.motions),
        split="by the test",
        thresholds=balances.thresholds,
    )
    prepared = Prepared(
        study=study, body=first.body, cutoff=first.cutoff, fit=balances, validate=None
    )
    return identify(prepared, lambda *said: None)[1]


def ordinary_fit(balances: Balances) -> Fit:
    """All that every machine has, and nothing that is anomalous."""
    posterior = Posterior.of(balances)
    return posterior.fit_of(posterior.begun(BODIES).model)


def figure(fit: Fit, effect: str, j: int) -> Estimate:
    """The first figure of an effect at a joint."""
    (term,) = (t for t in fit.terms if t.effect == effect and t.place.joints == (j,))
    return next(iter(estimates(fit, (term,), 0)[0].values()))


def named(state: Identified) -> set[tuple[str, tuple[int, ...]]]:
    """What is claimed, and at which joints."""
    return {(term.effect, term.place.joints) for term in state.accepted}
