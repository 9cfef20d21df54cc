"""Recordings of real machines, from the shared material: what is known of them is found."""

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

import pdoik
from pdoik.sim2real import Diagnosis, Finding, diagnose

BESIDE = Path(__file__).resolve().parents[5] / "shared"
RECORDINGS = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings"
FRICTION = {
    "coulomb_friction",
    "viscous_friction",
    "presliding_hysteresis",
    "load_dependent_friction",
    "asymmetric_friction",
}


def shared(name: str) -> Path:
    folder = RECORDINGS / name
    if not folder.is_dir():
        pytest.skip(f"needs recordings/{name} from the shared material (PDOIK_SHARED or ../shared)")
    return folder


def diagnosed(folder: Path, **study: Any) -> Diagnosis:
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(study))
    return diagnose(path)


def listed(folder: Path, fit: tuple[str, ...], validate: tuple[str, ...] = ()) -> list[dict]:
    roles = [(name, "fit") for name in fit] + [(name, "validate") for name in validate]
    return [{"file": str(folder / f"{name}.csv"), "role": role} for name, role in roles]


def at(diagnosis: Diagnosis, joint: str) -> list[Finding]:
    return [finding for finding in diagnosis.findings if joint in finding.joints]


def check_findings(diagnosis: Diagnosis) -> None:
    """What any finding of a real machine owes its reader."""
    for finding in diagnosis.findings:
        assert finding.statement
        assert finding.evidence.channels
        assert finding.parameters
        for estimate in finding.parameters.values():
            low, high = estimate.interval95
            assert low <= estimate.value <= high
            assert np.isfinite([low, high, estimate.std]).all()
    weights = [finding.weight for finding in diagnosis.findings]
    assert weights == sorted(weights, reverse=True)


# UR10


@pytest.fixture(scope="module")
def ur10(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    folder = shared("ur10_unisa")
    names = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
    return diagnosed(
        tmp_path_factory.mktemp("ur10"),
        robot=str(Path(pdoik.__file__).parent / "robots" / "ur10.urdf"),
        joints=[f"{name}_joint" for name in names],
        recordings=[{"file": str(folder / "run1.csv")}],
    )


def test_friction_is_found_in_every_joint_of_the_ur10(ur10: Diagnosis) -> None:
    assert len(ur10.joints) == 6
    for joint in ur10.joints:
        found = {finding.effect for finding in at(ur10, joint)}
        assert found & FRICTION, joint
        for finding in at(ur10, joint):
            if finding.effect in ("coulomb_friction", "presliding_hysteresis"):
                assert finding.parameters["level"].interval95[0] > 0.0
    # The large joints rub more than the wrists.
    levels = {
        finding.joints[0]: finding.values["level"]
        for finding in ur10.findings
        if "level" in finding.values
    }
    large = [levels[f"{name}_joint"] for name in ("shoulder_pan", "shoulder_lift", "elbow")]
    small = [level for joint, level in levels.items() if "wrist" in joint]
    assert min(large) > max(small)


def test_smooth_friction_of_the_ur10_is_not_called_stribecks(ur10: Diagnosis) -> None:
    """A Stribeck term would help these data only with a negative coefficient."""
    assert "stribeck_friction" not in {finding.effect for finding in ur10.findings}


def test_every_joint_of_the_ur10_is_predicted_better_on_rows_held_out(ur10: Diagnosis) -> None:
    for joint, fit in ur10.joints.items():
        assert fit.excited
        assert fit.unit == "N m"
        assert fit.after < 0.5 * fit.before, joint
    assert ur10.verdict in ("mismatch_explained", "mismatch_partly_explained")
    assert any("by blocks" in note for note in ur10.notes)  # one recording only: it is said
    check_findings(ur10)


# SO-101


@pytest.fixture(scope="module")
def so101(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    folder = shared("so101_sage")
    fit = (
        *("chirp_sweep", "frequency_sweep", "pick_place", "random_waypoints", "slow_precision"),
        *("static_holding", "trapezoidal_profile"),
    )
    validate = ("multisine", "single_joint_elbow", "step_response")
    return diagnosed(
        tmp_path_factory.mktemp("so101"),
        joints=["rotation", "pitch", "elbow", "wrist_pitch", "wrist_roll", "jaw"],
        recordings=listed(folder, fit, validate),
    )


def test_the_servos_of_the_so101_follow_about_a_tenth_of_a_second_late(so101: Diagnosis) -> None:
    late = [f for f in so101.findings if f.effect in ("command_delay", "actuator_lag")]
    assert late
    after = {
        joint: f.values.get("delay", 0.0) + f.values.get("time_constant", 0.0)
        for f in late
        for joint in f.joints
    }
    assert 0.08 < after[late[0].joints[0]] < 0.2  # of most weight, and most joints
    assert all(0.05 < each < 0.25 for each in after.values())
    assert {"rotation", "pitch", "elbow", "wrist_pitch", "wrist_roll"} <= set(after)
    assert "late" in late[0].statement or "lag" in late[0].statement


def test_of_positions_alone_no_torque_is_claimed_and_it_is_said(so101: Diagnosis) -> None:
    assert not {f.effect for f in so101.findings} & (FRICTION | {"payload", "link_inertial_error"})
    said = " ".join(so101.notes)
    assert "no robot" in said
    assert "cannot be distinguished" in said
    assert {fit.unit for fit in so101.joints.values()} == {"rad"}


def test_the_so101_is_predicted_better_on_recordings_held_out(so101: Diagnosis) -> None:
    for joint, fit in so101.joints.items():
        assert fit.after < fit.before, joint
        assert "multisine" in fit.data
        assert "chirp" not in fit.data
    assert np.median([fit.after / fit.before for fit in so101.joints.values()]) < 0.75
    check_findings(so101)


# Double pendulum

LINK = (
    '<inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>'
    '<inertia ixx="1e-4" iyy="{about}" izz="{about}" ixy="0" ixz="0" iyz="0"/></inertial>'
)
PENDULUM = """<robot name="pendulum"><link name="base"/>
  <link name="upper">{upper}</link><link name="lower">{lower}</link>
  <joint name="joint1" type="continuous"><parent link="base"/><child link="upper"/>
    <axis xyz="0 -1 0"/></joint>
  <joint name="joint2" type="continuous"><parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 {length}"/><axis xyz="0 -1 0"/></joint></robot>
"""


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    folder = shared("dfki_double_pendulum")
    facts = yaml.safe_load((folder / "model_parameters.yml").read_text())
    links = []
    for k in ("1", "2"):  # inertias are about the joints
        mass, reach = facts[f"m{k}"], facts[f"r{k}"]
        about = facts[f"I{k}"] - mass * reach**2
        links.append(LINK.format(z=-reach, mass=mass, about=about))
    home = tmp_path_factory.mktemp("pendulum")
    text = PENDULUM.format(upper=links[0], lower=links[1], length=-facts["l1"])
    (home / "pendulum.urdf").write_text(text)
    return diagnosed(
        home,
        robot="pendulum.urdf",
        joints=["joint1", "joint2"],
        recordings=listed(folder, ("run1", "run2"), ("run3", "run4")),
    )


def test_friction_of_the_double_pendulum_is_named(pendulum: Diagnosis) -> None:
    for joint in ("joint1", "joint2"):
        found = {finding.effect for finding in at(pendulum, joint)}
        assert found & FRICTION, joint
        fit = pendulum.joints[joint]
        assert fit.excited
        assert fit.after < 0.75 * fit.before
        assert "run3.csv" in fit.data
    check_findings(pendulum)


def test_of_the_double_pendulum_it_is_said_what_was_done_and_what_is_left(
    pendulum: Diagnosis,
) -> None:
    assert pendulum.verdict == "mismatch_partly_explained"  # its reported torque is doubtful
    said = " ".join(pendulum.notes)
    for run in range(1, 5):
        assert f"run{run}.csv: resampled" in said
    assert "parted by the study" in said
    assert "torque is as the drives report it" in said
