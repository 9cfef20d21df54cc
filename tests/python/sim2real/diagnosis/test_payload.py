"""Recordings that were made otherwise: a known body held, another robot, other gains."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import (
    Diagnosis,
    Model,
    Study,
    diagnose,
    examine,
    export_urdf,
    load_study,
    predict,
    prepare,
)
from pdoik.sim2real.confirm import Arm
from pdoik.sim2real.effects.sensors import law_of_position
from pdoik.sim2real.evidence import replays_of
from pdoik.sim2real.model import held_part, simulator_in
from pdoik.sim2real.motion import RigidBody, motion_of
from pdoik.sim2real.simulation import GravityModel, Inertial, build_plant
from pdoik.sim2real.study import Payload, Setup
from sim2real_days import COM, JOINTS, KP, LINK, ROTORS, Run, torque, write_days
from sim2real_motions import CUTOFF, pd, recording, write_arm
from studies import MJCF, URDF

HALF = tuple(0.5 * each for each in KP)


def told(mass: float, **more: Any) -> dict[str, Any]:
    """An entry's payload."""
    return {"payload": {"link": LINK, "mass": mass, "com": list(COM)}} | more


def effects(diagnosis: Diagnosis) -> set[str]:
    return {each.effect for each in diagnosis.findings}


def mismatch(study: Study) -> float:
    """Of the joint whose torques differ most from the model's [N m]."""
    fit = prepare(study).fit
    return max(fit.rms(("torque", j)) for j in range(3))


def test_the_torques_of_a_known_body_are_those_of_mujoco(tmp_path: Path) -> None:
    robot = write_arm(tmp_path, 3)
    body = RigidBody(robot, JOINTS, None)
    held = body.holding(Payload(link=LINK, mass=1.3, com=COM))
    rng = np.random.default_rng(0)
    q, dq, ddq = rng.uniform(-2.0, 2.0, (3, 20, 3))
    assert np.allclose(held.torque(q, dq, ddq), torque(robot, q, dq, ddq, 1.3), atol=1e-6)
    assert np.allclose(body.torque(q, dq, ddq), torque(robot, q, dq, ddq), atol=1e-6)
    assert np.array_equal(held.inertial_parameters(), body.inertial_parameters())


def test_a_known_body_is_no_finding(tmp_path: Path) -> None:
    runs = [Run(), Run(mass=1.0, told=told(1.0)), Run(mass=2.0, role="validate", told=told(2.0))]
    found = diagnose(write_days(tmp_path, runs))
    assert found.verdict == "no_mismatch"
    assert found.findings == found.suspected == ()
    assert any("run1.csv: holds 1 kg at tool" in note for note in found.notes)


def test_the_same_body_is_a_finding_where_the_study_does_not_tell_of_it(tmp_path: Path) -> None:
    found = diagnose(write_days(tmp_path, [Run(mass=1.0), Run(mass=1.0, role="validate")]))
    assert effects(found) == {"payload"}
    assert found.findings[0].values["mass"] == pytest.approx(1.0, abs=0.02)


@pytest.fixture(scope="module")
def too_heavy(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Of a study that says 1.3 kg of what weighs 1 kg."""
    heavy = Run(mass=1.0, told=told(1.3))
    runs = [Run(), heavy, replace(heavy, role="validate")]
    path = write_days(tmp_path_factory.mktemp("heavy"), runs, commands=True, seconds=16.0)
    return examine(path)


def test_a_wrong_weight_is_said_of_the_body_and_of_the_recordings_that_hold_it(
    too_heavy: Any,
) -> None:
    (found,) = too_heavy.diagnosis.findings
    assert found.effect == "payload_error"
    assert found.recordings == ("run1.csv",)
    assert found.variant == "1.3 kg at tool (0.02, 0, 0.06)"
    assert "1.3 kg at tool" in found.statement
    low, high = found.parameters["d_mass"].interval95
    assert low < -0.3 < high < -0.25
    assert all(fit.after < 0.1 * fit.before for fit in too_heavy.diagnosis.joints.values())


def test_a_wrong_weight_is_simulated_with_the_body_only(too_heavy: Any) -> None:
    prepared = too_heavy.prepared
    study, findings = prepared.study, too_heavy.diagnosis.findings
    model = Model.of_study(study, findings)
    still = np.zeros((1, 3))
    q = np.array([[0.4, 0.7, -0.2]])
    for setup, mass in ((Setup(), 0.0), (study.setups["run1.csv"], 1.0)):
        plant = simulator_in(model, setup).stepper.plant
        heaviest = float(plant.model.body("tool").subtreemass[0])
        assert heaviest + float(plant.model.body("l3").mass[0]) == pytest.approx(
            1.0 + mass, abs=0.02
        )
    plain = predict(model, study.fit[0])
    assert np.allclose(plain, predict(model, study.fit[0], findings=False))
    assert "payload_error" in " ".join(export_urdf(model).left_out)
    assert np.abs(torque(study.robot, q, still, still, 1.0)).max() > 1.0  # it is felt
    back = Model.from_json(model.to_json())
    assert back.findings == findings


def test_recordings_are_replayed_with_what_they_held(too_heavy: Any) -> None:
    prepared, state = too_heavy.prepared, too_heavy.state
    model = Model.of_study(prepared.study, too_heavy.diagnosis.findings)
    (replay,), _ = replays_of(too_heavy, model)
    error = [np.abs(each - replay.recorded).max() for each in (replay.before, replay.after)]
    assert error[1] < 0.1 * error[0]
    arm = Arm(prepared, state.fit, steps=20_000)
    values = {name: e.value for name, e in too_heavy.diagnosis.findings[0].parameters.items()}
    wrong = arm.run(state.accepted, [dict.fromkeys(values, 0.0)])
    assert arm.run(state.accepted, [values]).cost < 0.1 * wrong.cost


@pytest.mark.parametrize("known", [True, False])
def test_gravity_compensation_knows_what_is_held_where_the_study_says_so(
    tmp_path: Path, known: bool
) -> None:
    runs = [
        Run(),
        Run(mass=1.0, compensated=1.0 if known else 0.0, told=told(1.0, compensated=known)),
        Run(role="validate"),
    ]
    study = load_study(write_days(tmp_path, runs, commands=True, torques=False))
    assert diagnose(study).verdict == "no_mismatch"  # torques are those of the law
    setups = {"run1.csv": replace(study.setups["run1.csv"], compensated=not known)}
    assert mismatch(replace(study, setups=setups)) > 10.0 * mismatch(study)
    simulator = simulator_in(Model.of_study(study), study.setups["run1.csv"])
    replayed = simulator.replay(study.fit[1])
    assert np.abs(replayed.q - study.fit[1].q).max() < 2e-3
    other = simulator_in(Model.of_study(study), setups["run1.csv"]).replay(study.fit[1])
    assert np.abs(other.q - study.fit[1].q).max() > 5e-3


def test_a_recording_may_have_gains_of_its_own(tmp_path: Path) -> None:
    own = {"controller": {"kp": list(HALF)}}
    runs = [Run(), Run(kp=HALF, told=own), Run(role="validate")]
    study = load_study(write_days(tmp_path, runs, commands=True, torques=False))
    controller = study.setups["run1.csv"].controller
    assert controller is not None
    assert controller.kp.tolist() == list(HALF)
    assert controller.kd.tolist() == study.controller.kd.tolist()  # type: ignore[union-attr]
    assert controller.gravity_compensation
    assert diagnose(study).verdict == "no_mismatch"
    assert mismatch(replace(study, setups={})) > 10.0 * mismatch(study)
    replayed = simulator_in(Model.of_study(study), study.setups["run1.csv"]).replay(study.fit[1])
    assert np.abs(replayed.q - study.fit[1].q).max() < 2e-3


def test_a_recording_may_be_of_another_robot(tmp_path: Path) -> None:
    path = write_days(tmp_path, [Run(), Run(mass=1.0), Run(mass=1.0, role="validate")])
    text = (tmp_path / "arm3.urdf").read_text()
    x, y, z = COM
    tool = f'<link name="tool"><inertial><origin xyz="{x} {y} {z}"/><mass value="1"/>'
    tool += '<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    (tmp_path / "loaded.urdf").write_text(text.replace('<link name="tool"/>', tool))
    content = path.read_text()
    for name in ("run1.csv", "run2.csv"):
        content = content.replace(f"file: {name}\n", f"file: {name}\n  robot: loaded.urdf\n")
    before = mismatch(load_study(path))
    path.write_text(content)
    study = load_study(path)
    assert before > 10.0 * mismatch(study)
    assert study.setups["run1.csv"].robot == tmp_path / "loaded.urdf"
    found = diagnose(study)
    assert found.verdict == "no_mismatch"
    assert found.findings == ()
    plant = simulator_in(Model.of_study(study), study.setups["run1.csv"]).stepper.plant
    assert float(plant.model.body_mass.sum()) == pytest.approx(2.0 + 1.5 + 1.0 + 1.0)


def test_moments_of_a_known_body_are_about_its_own_centre(tmp_path: Path) -> None:
    body = RigidBody(write_arm(tmp_path, 3), JOINTS, ROTORS)
    payload = Payload(
        link="l3", mass=2.0, com=(0.1, 0.0, 0.2), inertia=(0.02, 0.001, 0.03, 0.0, 0.0, 0.04)
    )
    joint, ten = body.carrier(payload)
    assert joint == 2
    inertial = Inertial.from_ten(ten)
    assert inertial.com == pytest.approx([0.1, 0.0, 0.2])
    assert np.allclose(inertial.inertia_about_com, payload.inertia_matrix)


def test_a_wrong_position_reaches_gravity_as_the_controller_knows_it(tmp_path: Path) -> None:
    body = RigidBody(write_arm(tmp_path, 3), JOINTS, ROTORS)
    held = body.holding(Payload(link=LINK, mass=2.0, com=COM))
    run, change = recording(body, 3, 4.0), 0.01
    columns = []
    for believed in (body, held):
        m = motion_of(run, held, pd(3), CUTOFF, np.full(3, 1e-14), believed=believed)
        columns.append(law_of_position(m, 1, np.full(len(m.q), change)))
    moved = m.q + np.array([0.0, change, 0.0])
    by_known = [each.gravity(moved) - each.gravity(m.q) for each in (body, held)]
    assert np.abs(by_known[1] - by_known[0]).max() > 0.05
    for i in range(3):
        own = columns[1]["law", i] - columns[0]["law", i]
        expected = (by_known[1] - by_known[0])[:, i]
        assert np.abs(np.abs(own[:, 0]) - np.abs(expected)).max() < 0.002


@pytest.mark.parametrize("text", [MJCF, URDF])
@pytest.mark.parametrize("link", ["upper", "fore"])
def test_model_and_simulation_hold_the_same_body(tmp_path: Path, text: str, link: str) -> None:
    path = tmp_path / ("arm.xml" if text is MJCF else "arm.urdf")
    path.write_text(text.format(mass=1).replace('pos="0.4 0 0"', 'pos="0.4 0 0" euler="20 0 40"'))
    payload = Payload(
        link=link, mass=1.5, com=(0.1, 0.03, 0.2), inertia=(0.01, 0, 0.01, 0, 0, 0.02)
    )
    joints = ("shoulder", "elbow")
    body = RigidBody(path, joints, None).holding(payload)
    simulated = GravityModel(path, joints, parts=[held_part(payload)])
    for q in np.random.default_rng(1).uniform(-2.0, 2.0, (5, 2)):
        assert body.gravity(q[None])[0] == pytest.approx(simulated(q.tolist()), abs=1e-9)
        inverse = build_plant(
            path, joints, [held_part(payload)], rotor_inertia=np.zeros(2)
        ).inverse_inertia(q)
        assert body.mass_diagonal(q) == pytest.approx(np.diag(np.linalg.inv(inverse)), rel=1e-6)
