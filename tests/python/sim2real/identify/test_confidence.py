"""How sure a finding is: by what speaks for it, and by how many machines have what it names."""

from __future__ import annotations

from dataclasses import fields, replace

import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Support, Thresholds
from pdoik.sim2real.identify import confidence_of, features

CAUSE = Support(
    log_odds=40.0,
    weight=0.3,
    gain=0.6,
    t=4.0,
    size=2.0,
    agree=3,
    sessions=4,
    blocks=20,
    left=1.0,
    rivals=0,
    had_by="few",
)
LIMITS = Thresholds()


def test_every_feature_has_a_weight() -> None:
    weights = {each.name for each in fields(LIMITS.confidence)}
    for support in (CAUSE, replace(CAUSE, log_odds=None), replace(CAUSE, event=True)):
        assert features(support).keys() <= weights


def test_what_speaks_for_a_cause_makes_it_surer() -> None:
    sure = confidence_of(LIMITS, CAUSE)
    assert sure < confidence_of(LIMITS, replace(CAUSE, log_odds=4e3))
    assert sure < confidence_of(LIMITS, replace(CAUSE, gain=0.95))
    assert sure > confidence_of(LIMITS, replace(CAUSE, gain=0.05)) > 0.5
    many, all_have_it = (replace(CAUSE, had_by=who) for who in ("many", "all"))
    assert sure < confidence_of(LIMITS, many) < confidence_of(LIMITS, all_have_it)


def test_what_happens_once_or_was_never_weighed_is_as_sure_as_its_gain() -> None:
    law = replace(CAUSE, log_odds=None)
    event = replace(CAUSE, event=True)
    for each in (law, event):
        assert confidence_of(LIMITS, each) < confidence_of(LIMITS, replace(each, gain=0.95))
        assert confidence_of(LIMITS, each) == confidence_of(LIMITS, replace(each, had_by="all"))
    assert confidence_of(LIMITS, event) < confidence_of(LIMITS, law)
    assert confidence_of(LIMITS, None) == LIMITS.confidence.unsupported
