"""Each effect hidden alone in a world of bench/sim2real/concealed is named, placed and measured."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.catalogue import EFFECTS
from bench.sim2real.concealed.spec import Truth, WorldSpec
from pdoik.sim2real import Diagnosis, Finding, diagnose

SEEDS = dict.fromkeys(EFFECTS, 11) | {"joint_elasticity": 12}

# Figures that are compared one by one, or as a vector where they are joined; else only the name.
FIGURES: dict[str, tuple[str, ...]] = {
    "viscous_friction": ("coefficient",),
    "coulomb_friction": ("level",),
    "stribeck_friction": ("extra", "speed"),
    "asymmetric_friction": ("level_difference", "viscous_difference"),
    "load_dependent_friction": ("coefficient",),
    "presliding_hysteresis": ("level", "displacement"),
    "friction_drift": ("extra", "time_constant"),
    "rotor_inertia": ("inertia",),
    "payload": ("mass", "com_x com_y com_z"),
    "link_inertial_error": ("d_mass", "d_first_moment_x d_first_moment_y d_first_moment_z"),
    "gravity_direction": ("tilt_x tilt_y",),
    "external_contact": ("force_x force_y force_z",),
    "torque_gain": ("gain",),
    "torque_offset": ("offset",),
    "torque_saturation": ("level",),
    "torque_ripple": ("amplitude", "harmonic", "phase"),
    "position_dependent_spring": ("stiffness", "onset", "side"),
    "command_delay": ("delay",),
    "actuator_lag": ("time_constant",),
    "joint_elasticity": ("stiffness",),
    "joint_offset": ("offset",),
    "kinematic_error": ("dx dy dz", "rx ry rz"),
    "joint_coupling": ("ratio",),
    "timestamp_skew": ("skew",),
    "backlash": ("gap",),
    "sensor_gain": ("gain",),
    "sensor_noise": ("std",),
}
USUAL = (
    "coulomb_friction",
    "asymmetric_friction",
    "payload",
    "external_contact",
    "torque_gain",
    "torque_offset",
    "command_delay",
)
"""One of each kind but play, of which test_rollouts is; the others are long, together."""
NEAR = 0.15  # of a figure's own size
AS_GOOD = ({"command_delay", "actuator_lag"}, {"payload", "link_inertial_error"})


def world(folder: Path, effect: str, seed: int, robot: str = "random3") -> tuple[Truth, Diagnosis]:
    spec = WorldSpec(seed=seed, effect=effect, hide="plain", robot=robot)
    truth = make_study(folder / "study", spec, folder / "truth")
    return truth, diagnose(folder / "study" / "study.yaml")


def first(truth: Truth, diagnosis: Diagnosis) -> Finding:
    """The finding of most weight that is not what comes beside the hidden effect."""
    company = [(e["effect"], set(e["joints"])) for e in truth.effects if e["role"] == "beside"]
    others = [f for f in diagnosis.findings if (f.effect, set(f.joints)) not in company]
    assert others, diagnosis.verdict
    return others[0]


def names(finding: Finding) -> set[str]:
    """What the finding says, or cannot tell from it."""
    said = {finding.effect, *(each.effect for each in finding.equivalents)}
    return said.union(*(pair for pair in AS_GOOD if pair & said))


def size(values: dict[str, Any], figure: str) -> np.ndarray:
    return np.array([float(values[name]) for name in figure.split()])


@pytest.mark.parametrize(
    "effect",
    [pytest.param(e, marks=() if e in USUAL else pytest.mark.long) for e in EFFECTS],
)
def test_what_was_hidden_is_named_placed_and_measured(tmp_path: Path, effect: str) -> None:
    truth, diagnosis = world(tmp_path, effect, SEEDS[effect])
    hidden = truth.effects[0]
    finding = first(truth, diagnosis)
    assert effect in names(finding), finding.statement
    assert set(finding.joints) == set(hidden["joints"]) or finding.effect in AS_GOOD[1]
    if hidden["links"]:
        assert set(finding.links) == set(hidden["links"])
    assert diagnosis.verdict in ("mismatch_explained", "mismatch_partly_explained")
    assert finding.statement
    assert finding.evidence.channels
    if finding.effect == effect:
        for figure in FIGURES[effect]:
            found, true = size(finding.values, figure), size(hidden["parameters"], figure)
            assert np.linalg.norm(found - true) < NEAR * np.linalg.norm(true), figure
    if effect == "external_contact":
        assert finding.window == pytest.approx(hidden["window"], abs=0.3)
        assert set(finding.recordings) <= set(hidden["recordings"])
    if effect == "kinematic_error":
        return  # the tip's pose alone shows it
    residuals = [diagnosis.joints[j] for j in hidden["joints"]] or list(diagnosis.joints.values())
    assert all(each.after <= 1.1 * max(each.before, each.noise_floor) for each in residuals)


def test_every_effect_of_the_worlds_is_tried() -> None:
    assert set(FIGURES) == set(SEEDS) == set(EFFECTS)


@pytest.mark.parametrize("seed", [1, 2, *(pytest.param(k, marks=pytest.mark.long) for k in (3, 4))])
def test_a_machine_that_is_as_its_model_has_no_mismatch(tmp_path: Path, seed: int) -> None:
    truth, diagnosis = world(tmp_path, "clean", seed)
    assert truth.effects == ()
    assert diagnosis.findings == ()
    assert diagnosis.verdict == "no_mismatch"
    for each in diagnosis.joints.values():
        assert each.excited
        assert each.after == pytest.approx(each.before, rel=0.1)  # ordinary physics is fitted
        assert each.before < 1.6 * each.noise_floor


@pytest.mark.parametrize("seed", [2, pytest.param(3, marks=pytest.mark.long)])
def test_physics_that_no_effect_describes_has_no_name_but_a_place(
    tmp_path: Path, seed: int
) -> None:
    truth, diagnosis = world(tmp_path, "outside:quadratic_drag", seed)
    (joint,) = truth.effects[0]["joints"]
    unnamed = [f for f in diagnosis.findings if f.effect == "unknown"]
    assert [f.joints[0] for f in unnamed] == [joint]
    assert "speed" in unnamed[0].statement
    assert unnamed[0].evidence.validation_gain > 0.2
    assert diagnosis.verdict in ("mismatch_unexplained", "mismatch_partly_explained")
    assert diagnosis.joints[joint].after < 0.7 * diagnosis.joints[joint].before


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_of_a_joint_that_never_moved_nothing_is_said(tmp_path: Path, seed: int) -> None:
    truth, diagnosis = world(tmp_path, "still", seed)
    assert truth.still
    for joint in truth.still:
        assert not diagnosis.joints[joint].excited
        assert not any(joint in f.joints for f in diagnosis.findings)
    assert diagnosis.verdict == "cannot_tell"
    assert any(truth.still[0] in note and "moved too little" in note for note in diagnosis.notes)


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_a_torque_of_the_wrong_sign_is_the_channels_fault(tmp_path: Path, seed: int) -> None:
    truth, diagnosis = world(tmp_path, "lying:tau_sign", seed)
    (joint,) = truth.effects[0]["joints"]
    (finding,) = diagnosis.findings
    assert finding.effect == "sensor_gain"
    assert finding.joints == (joint,)
    assert finding.values["gain"] == pytest.approx(-1.0, abs=0.02)
    assert "wrong sign" in finding.statement
    assert finding.evidence.channels == ("tau",)
    assert diagnosis.joints[joint].after < 2.0 * diagnosis.joints[joint].noise_floor


def test_a_joint_whose_torque_nobody_recorded_does_not_hide_anothers_friction(
    tmp_path: Path,
) -> None:
    spec = WorldSpec(seed=11, effect="coulomb_friction", hide="plain", robot="random3")
    folder = tmp_path / "study"
    (hidden,) = make_study(folder, spec, tmp_path / "truth").effects
    (joint,) = hidden["joints"]
    other = next(name for name in ("joint1", "joint3") if name != joint)
    for path in folder.glob("*.csv"):
        lines = [line.split(",") for line in path.read_text().splitlines()]
        names = (f"tau.{other}", f"tau_cmd.{other}")
        gone = [i for i, name in enumerate(lines[0]) if name in names]
        assert gone
        kept = [",".join(v for i, v in enumerate(line) if i not in gone) for line in lines]
        path.write_text("\n".join(kept) + "\n")
    diagnosis = diagnose(folder / "study.yaml")
    (finding,) = diagnosis.findings
    assert (finding.effect, finding.joints) == ("coulomb_friction", (joint,))
    assert finding.values["level"] == pytest.approx(hidden["parameters"]["level"], rel=NEAR)


def test_a_load_on_an_arm_whose_base_leans_is_told_from_the_leaning(tmp_path: Path) -> None:
    """What a load weighs along each axis depends on how far the base leans, and the reverse."""
    spec = WorldSpec(seed=2157, effect="payload", hide="second", robot="random2")
    truth = make_study(tmp_path / "study", spec)
    found = {each.effect: each for each in diagnose(tmp_path / "study" / "study.yaml").findings}
    load, leaning = truth.effects
    assert leaning["effect"] == "gravity_direction"
    assert set(found) == {"link_inertial_error", "gravity_direction"}
    for name, tilt in leaning["parameters"].items():
        assert found["gravity_direction"].values[name] == pytest.approx(tilt, abs=5e-3)
    body = found["link_inertial_error"]  # of two joints no motion shows the mass itself
    assert [each.effect for each in body.equivalents][:1] == ["payload"]
    for axis in "yz":
        moment = load["parameters"]["mass"] * load["parameters"][f"com_{axis}"]
        assert body.values[f"d_first_moment_{axis}"] == pytest.approx(moment, rel=0.1)
