"""A joint that gives and rings: named though nobody tells its controller; no noise of a sensor."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("numba", reason="pip install 'pdoik[bench]'")

from bench.sim2real.machines.build import make_study
from bench.sim2real.machines.plan import spec_of
from pdoik.sim2real import diagnose, load_study
from pdoik.sim2real.channels import noisy_channels
from pdoik.sim2real.motion import prepare

SOFT, RINGING = 50112, 60024  # of an arm of three joints; a wave that shakes a UR10's shoulder


def test_a_soft_joint_is_named_where_nobody_tells_its_controller(tmp_path: Path) -> None:
    truth = make_study(tmp_path / "study", spec_of(SOFT))
    (fault,) = truth["faults"]
    assert fault["effect"] == "joint_elasticity"
    diagnosis = diagnose(tmp_path / "study" / "study.yaml")
    (found,) = (each for each in diagnosis.findings if each.effect == "joint_elasticity")
    assert found.joints == tuple(fault["joints"])
    low, high = found.parameters["stiffness"].interval95
    assert low < fault["parameters"]["stiffness"] < high
    assert found.evidence.with_others is not None
    assert found.evidence.with_others > 0.2


def test_what_shakes_a_joint_is_no_noise_of_its_sensors(tmp_path: Path) -> None:
    truth = make_study(tmp_path / "study", spec_of(RINGING))
    assert [each["effect"] for each in truth["faults"]] == ["strain_wave_error"]
    study = load_study(tmp_path / "study" / "study.yaml")
    assert noisy_channels(prepare(study), study) == ()
