"""Channels that lie, and machines that only seem to have such."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import prepare
from pdoik.sim2real.channels import check_channels, factors_by_model
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify import estimates
from pdoik.sim2real.infer import at_bound
from pdoik.sim2real.motion import Place
from pdoik.sim2real.regression import Fit, term_of
from sim2real_channels import study


def test_rotors_that_nobody_told_of_are_no_factor_of_a_channel(tmp_path: Path) -> None:
    check = check_channels(prepare(study(tmp_path, (6.0, 4.0, 2.0), (1.0, 1.0, 1.0))))
    assert check.findings == ()
    assert not check.mended


@pytest.mark.parametrize("factor", [-1.0, 1000.0, 0.01, 9.81])
def test_a_wrong_sign_or_unit_is_found_beside_rotors_that_nobody_told_of(
    tmp_path: Path, factor: float
) -> None:
    check = check_channels(prepare(study(tmp_path, (0.6, 0.4, 0.2), (1.0, factor, 1.0))))
    (finding,) = check.findings
    assert (finding.effect, finding.joints) == ("sensor_gain", ("j2",))
    # A load that nobody told of could take a part of it: sign and order of size are what is sure.
    assert 0.6 < finding.values["gain"] / factor < 1.6
    assert check.mended


def test_a_joint_of_which_no_row_counts_has_no_factor(tmp_path: Path) -> None:
    balances = prepare(study(tmp_path, (0.6, 0.4, 0.2), (1.0, 9.81, 1.0))).fit
    assert set(factors_by_model(balances)) == {1}
    balances.mask["torque", 1][:] = False  # it rests wherever anything could be told
    assert 1 not in factors_by_model(balances)


def test_a_figure_on_its_bound_is_said_and_explains_nothing(tmp_path: Path) -> None:
    prepared = prepare(study(tmp_path, (0.0, 0.0, 0.0), (1.0, 3.4, 1.0)))
    gain = CATALOGUE["torque_gain"]
    term = term_of(prepared.fit, gain, Place(joints=(1,)), (0.0,))
    assert term is not None
    fit = Fit(prepared.fit, (term,))
    said = at_bound(fit, term, estimates(fit, (term,), 0)[0])
    assert "lies on a bound" in said  # 2.5 times at most
    assert "2.5" in said
    right = prepare(study(tmp_path, (0.0, 0.0, 0.0), (1.0, 1.4, 1.0)))
    term = term_of(right.fit, gain, Place(joints=(1,)), (0.0,))
    assert term is not None
    fit = Fit(right.fit, (term,))
    assert at_bound(fit, term, estimates(fit, (term,), 0)[0]) == ""
