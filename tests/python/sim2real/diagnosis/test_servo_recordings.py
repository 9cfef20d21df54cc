"""A real servo with a closed firmware, from the shared material: what is known of it is found."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import ControllerEstimate, Diagnosis, diagnose, load_study
from pdoik.sim2real.controllers import check_controllers
from pdoik.sim2real.motion import prepare

BESIDE = Path(__file__).resolve().parents[5] / "shared"
FOLDER = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings" / "bam_xl330"
MOTIONS = ("lift_and_drop", "sin_sin", "sin_time_square", "up_and_down")
MASS, LENGTH = 0.49, 0.1  # [kg], [m]
UNIT = 4096 / (2 * np.pi) / 256 / 1000  # duty per rad and unit of the firmware's gain
LOADS = {"link_inertial_error", "payload"}

SERVO = """<robot name="servo"><link name="base"/><link name="arm"><inertial>
<origin xyz="0 0 {z}"/><mass value="{mass}"/>
<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="joint1" type="continuous"><parent link="base"/><child link="arm"/>
<axis xyz="0 1 0"/></joint></robot>
"""


def study(home: Path, gain: int, mass: float = MASS, length: float = LENGTH, **keys: Any) -> Path:
    if not FOLDER.is_dir():
        pytest.skip("needs recordings/bam_xl330 from the shared material (PDOIK_SHARED)")
    (home / "servo.urdf").write_text(SERVO.format(z=-length, mass=mass))
    files = [str(FOLDER / f"kp{gain}_{name}.csv") for name in MOTIONS]
    content = {"robot": "servo.urdf", "joints": ["joint1"], "recordings": files, **keys}
    (home / "study.yaml").write_text(yaml.safe_dump(content))
    return home / "study.yaml"


def controller(path: Path) -> ControllerEstimate:
    """Of the one joint, without the rest of the diagnosis."""
    return check_controllers(prepare(load_study(path))).estimates[0]


@pytest.fixture(scope="module", params=[100, 400])
def as_it_is(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[int, Diagnosis]:
    gain = int(request.param)
    return gain, diagnose(study(tmp_path_factory.mktemp(f"servo{gain}"), gain))


def test_of_the_true_load_nothing_is_said(as_it_is: tuple[int, Diagnosis]) -> None:
    _, diagnosis = as_it_is
    assert not {finding.effect for finding in diagnosis.findings} & LOADS
    assert any(finding.effect == "load_dependent_friction" for finding in diagnosis.findings)


def test_the_firmwares_gain_is_found_and_where_the_drive_lets_go(
    as_it_is: tuple[int, Diagnosis],
) -> None:
    gain, diagnosis = as_it_is
    (estimate,) = diagnosis.controllers
    assert estimate.law == "pd"
    assert estimate.gains["kp"].value / UNIT == pytest.approx(gain, rel=0.01)
    assert estimate.explained > 0.999
    said = " ".join(diagnosis.notes)
    assert f"lets go in kp{gain}_lift_and_drop.csv" in said
    assert "a wrong mass looks like another torque per volt" in said


@pytest.mark.parametrize(("gain", "told"), [(100, 160), (100, 60), (400, 560), (400, 240)])
def test_a_firmware_gain_told_wrong_is_said_within_a_percent(
    tmp_path: Path, gain: int, told: int
) -> None:
    keys = {"type": "voltage", "kp": [told], "unit": [UNIT]}
    estimate = controller(study(tmp_path, gain, controller=keys))
    assert estimate.given_wrong["kp"] == pytest.approx(told * UNIT)
    assert estimate.gains["kp"].value / UNIT == pytest.approx(gain, rel=0.01)


@pytest.mark.parametrize(("gain", "other"), [(100, 400), (400, 100)])
@pytest.mark.parametrize(
    ("by_mass", "by_length"), [(1.0, 1.0), (1.4, 1.0), (0.6, 1.0), (1.0, 1.4), (1.0, 0.6)]
)
def test_with_the_drive_known_from_the_other_gain_the_length_is_said_within_5_percent(
    tmp_path: Path, gain: int, other: int, by_mass: float, by_length: float
) -> None:
    """The mass is not: the drive's torque per volt differs by 15 % between the two sessions."""
    drive = {name: [each.value] for name, each in controller(study(tmp_path, other)).drive.items()}
    keys = {"rotor_inertia": drive.pop("rotor_inertia"), "controller": {"type": "voltage", **drive}}
    mass, length = by_mass * MASS, by_length * LENGTH
    load = controller(study(tmp_path, gain, mass, length, **keys)).load
    assert length * load["length_factor"].value == pytest.approx(LENGTH, rel=0.05)
    assert mass * load["mass_factor"].value == pytest.approx(MASS, rel=0.2)
    low, high = load["mass_factor"].interval95
    assert low <= MASS / mass <= high


def test_of_a_drive_that_nobody_knows_the_length_is_bounded(tmp_path: Path) -> None:
    """Load and rotor swing alike whatever is told: a load that is too long is said, no other."""
    swings = []
    for by_mass, by_length in ((1.0, 1.0), (1.6, 1.0), (1.0, 0.6), (1.0, 1.6)):
        path = study(tmp_path, 400, by_mass * MASS, by_length * LENGTH)
        found = check_controllers(prepare(load_study(path)))
        swings.append(found.estimates[0].load["reduced_length"].value)
        assert ("it is too long" in " ".join(found.notes)) == (by_length > 1.4)
    assert np.ptp(swings) < 0.05 * np.mean(swings)
