"""A gear that loses more one way than the other: the law by hand, in recordings diagnosed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import diagnose
from pdoik.sim2real.effects import CATALOGUE, parts_of
from pdoik.sim2real.simulation import HardFriction
from sim2real_effect_studies import Course, named, rubbing, study


def lossy(driving: float, driven: float, j: int = 1):  # type: ignore[no-untyped-def]
    def torque(course: Course) -> np.ndarray:
        tau, load, dq = course.tau.copy(), course.load[:, j], course.dq[:, j]
        share = np.where(load * dq > 0.0, driving, driven)
        tau[:, j] += share * np.abs(load) * np.sign(dq)
        return tau

    return torque


@pytest.mark.parametrize(("driving", "driven"), [(0.12, 0.35), (0.3, 0.1), (0.25, 0.02)])
def test_two_shares_are_measured_within_their_intervals_or_as_their_sum_and_difference(
    tmp_path: Path, driving: float, driven: float
) -> None:
    """Losses by the way of power are friction by load and a torque constant that is off."""
    diagnosis = diagnose(study(tmp_path, lossy(driving, driven)))
    assert {finding.joints for finding in diagnosis.findings} == {("j2",)}
    found = {finding.effect: finding for finding in diagnosis.findings}
    if "gear_efficiency" in found:
        assert set(found) == {"gear_efficiency"}
        for name, true in (("driving_loss", driving), ("driven_loss", driven)):
            low, high = found["gear_efficiency"].parameters[name].interval95
            assert low <= true <= high
            assert high - low < 0.2
    else:
        assert set(found) == {"load_dependent_friction", "torque_gain"}
        by_load, gain = found["load_dependent_friction"], found["torque_gain"]
        low, high = by_load.parameters["coefficient"].interval95
        assert low - 0.01 < (driving + driven) / 2 < high + 0.01
        assert gain.values["gain"] - 1.0 == pytest.approx((driving - driven) / 2, abs=0.02)
    assert diagnosis.verdict == "mismatch_explained"


def test_one_share_both_ways_is_friction_that_grows_with_load(tmp_path: Path) -> None:
    diagnosis = diagnose(study(tmp_path, lossy(0.2, 0.2)))
    (finding,) = diagnosis.findings
    assert (finding.effect, finding.joints) == ("load_dependent_friction", ("j2",))
    assert finding.values["coefficient"] == pytest.approx(0.2, rel=0.05)


def test_plain_friction_is_no_gears_loss(tmp_path: Path) -> None:
    diagnosis = diagnose(study(tmp_path, rubbing))
    assert named(diagnosis, "gear_efficiency") == []
    assert sorted(named(diagnosis, "coulomb_friction")) == [("j1",), ("j2",), ("j3",)]
    assert sorted(named(diagnosis, "viscous_friction")) == [("j1",), ("j2",), ("j3",)]


def test_the_level_of_friction_goes_with_the_way_of_power() -> None:
    values = {"driving_loss": 0.1, "driven_loss": 0.4}
    (part,) = parts_of("gear_efficiency", ["j"], values=values)
    assert isinstance(part, HardFriction)
    assert part.needs_load
    assert callable(part.level)
    for load, speed, level in ((5.0, 1.0, 0.5), (-5.0, -1.0, 0.5), (5.0, -1.0, 2.0), (-5, 1, 2)):
        assert part.level(0.0, 0.0, speed, load) == pytest.approx(level)


def test_it_is_more_complex_than_what_it_is_confused_with() -> None:
    effect = CATALOGUE["gear_efficiency"]
    assert all(CATALOGUE[each].complexity < effect.complexity for each in effect.confused_with)
