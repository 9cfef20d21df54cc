"""model.json, and the improved URDF and MJCF read back by MuJoCo and Pinocchio."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="needs the Python package mujoco")

import pdoik  # noqa: E402
from pdoik.errors import LoadError  # noqa: E402
from pdoik.recordings import Recording  # noqa: E402
from pdoik.sim2real import Estimate, Finding  # noqa: E402
from pdoik.sim2real.effects import CATALOGUE  # noqa: E402
from pdoik.sim2real.export import export_mjcf, export_urdf, write_exports  # noqa: E402
from pdoik.sim2real.model import (  # noqa: E402
    Model,
    load_model,
    predict,
    replay,
    robot_text,
)
from pdoik.sim2real.simulation import Inertial, Stepper  # noqa: E402
from pdoik.sim2real.study import Study  # noqa: E402
from sim2real_robots import MJCF, PENDULUM, arm_urdf, commands, pd  # noqa: E402

PANDA = Path(pdoik.__file__).parent / "robots" / "panda.urdf"
JOINTS = tuple(f"panda_joint{k}" for k in range(1, 8))


def found(
    effect: str, joints: tuple[str, ...] = (), links: tuple[str, ...] = (), **values: float
) -> Finding:
    parameters = {
        name: Estimate(value=value, std=0.1, interval95=(value - 0.2, value + 0.2), unit="SI")
        for name, value in values.items()
    }
    return Finding(effect=effect, joints=joints, links=links, parameters=parameters)


EXPRESSIBLE = (
    found("viscous_friction", ("panda_joint2",), coefficient=4.0),
    found("coulomb_friction", ("panda_joint2",), level=1.5),
    found("payload", (), ("panda_link7",), mass=1.5, com_x=0.02, com_z=0.1, ixx=0.01, iyy=0.01,
          izz=0.005),
    found("kinematic_error", ("panda_joint3",), dx=0.01, rz=0.02, rx=-0.01),
    found("joint_offset", ("panda_joint5",), offset=0.03),
)  # fmt: skip
MJCF_ONLY = (
    found("rotor_inertia", ("panda_joint4",), inertia=0.3),
    found("gravity_direction", (), (), tilt_x=0.02, tilt_y=0.05),
    found("position_dependent_spring", ("panda_joint6",), stiffness=3.0, onset=0.5, side=0.0),
)
NOT_SAID = (
    found("stribeck_friction", ("panda_joint2",), extra=0.5, speed=0.1),
    found("command_delay", JOINTS, delay=0.02),
)


def panda(findings: tuple[Finding, ...], **more: Any) -> Model:
    return Model(
        robot=PANDA.read_text(),
        joints=JOINTS,
        tip="panda_link8",
        findings=findings,
        rotor_inertia=np.zeros(7),
        **more,
    )


def same(a: Recording, b: Recording) -> bool:
    return a.q.tobytes() == b.q.tobytes()


def test_a_model_comes_back_from_its_file_as_it_was(tmp_path: Path) -> None:
    controller = pd(600.0, 40.0, 7, torque_limit=np.full(7, 80.0), period=0.002)
    rigid = {"panda_link3": np.array([3.0, 0.1, 0.1, -0.2, 0.09, 0, 0.08, 0, 0, 0.03])}
    model = panda(EXPRESSIBLE + NOT_SAID, controller=controller, rigid_body=rigid)
    path = model.save(tmp_path)
    assert path == tmp_path / "model.json"
    back = Model.load(path)
    assert back.to_json() == model.to_json() == Model.load(tmp_path).to_json()
    assert back.findings == model.findings
    run = commands(0.3, n=7, q_des=lambda t: np.outer(np.sin(4 * t), np.ones(7)))
    assert same(replay(back, run), replay(model, run))
    assert same(replay(back, run, findings=False), replay(replace(model, findings=()), run)) is (
        False
    )  # the rigid body's correction is a finding too
    before = replace(model, findings=(), rigid_body={})
    assert same(replay(back, run, findings=False), replay(before, run))
    assert not same(replay(back, run, findings=False), replay(back, run))
    assert len(load_model(path).stepper().parts) == len(model.parts()) > 8
    assert load_model(path).stepper(findings=False).parts == ()


def test_a_study_without_a_robot_keeps_its_findings_but_cannot_be_simulated(
    tmp_path: Path,
) -> None:
    study = Study(folder=tmp_path, robot=None, joints=("a",), recordings=(), split="")
    model = Model.of_study(study, (found("command_delay", ("a",), delay=0.1),))
    back = Model.load(model.save(tmp_path))
    assert back.findings == model.findings
    assert repr(back) == "Model of 1 joints with command_delay"
    with pytest.raises(ValueError, match="no robot description"):
        back.simulator()
    with pytest.raises(ValueError, match="no robot description"):
        export_mjcf(back)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.update(schema="pdoik.model/9"), r"schema: expected 'pdoik.model/1', got"),
        (lambda c: c.pop("findings"), "findings: the key 'findings' is missing"),
        (lambda c: c["controller"].update(kp=[1.0]), r"controller: expected 7 numbers"),
        (lambda c: c["controller"].update(type="mpc"), "controller: type: expected 'pd'"),
        (lambda c: c.update(gravity=[0, 1]), "gravity:"),
        (lambda c: c.update(robot=3), "robot: expected the text"),
        (lambda c: c["findings"][0].update(effect="magic"), "findings: no effect 'magic'"),
        (lambda c: c["findings"][0].update(parameters={}), "findings: .*'coefficient'"),
        (lambda c: c.update(rigid_body={"l": [1, 2]}), "rigid_body: expected 10 numbers"),
    ],
)
def test_a_file_that_is_no_model_says_what_is_wrong(
    change: Any, message: str, tmp_path: Path
) -> None:
    path = panda(EXPRESSIBLE, controller=pd(1.0, 1.0, 7)).save(tmp_path)
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))
    with pytest.raises(LoadError, match=f"model.json: {message}"):
        Model.load(path)


def test_a_file_that_is_not_there_or_not_json_says_so(tmp_path: Path) -> None:
    with pytest.raises(LoadError, match=r"model\.json"):
        Model.load(tmp_path)
    (tmp_path / "model.json").write_text("{")
    with pytest.raises(LoadError, match="not JSON"):
        Model.load(tmp_path)


def pose(q: np.ndarray, stepper: Stepper) -> np.ndarray:
    stepper.reset(q)
    return stepper.tip_pose


def test_the_improved_urdf_is_to_pinocchio_what_the_simulation_is() -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="needs the Python package pin")
    model = panda(EXPRESSIBLE + MJCF_ONLY + NOT_SAID)
    export = export_urdf(model)
    assert [each.split(" of ")[0].split(":")[0] for each in export.left_out] == [
        "rotor_inertia", "gravity_direction", "position_dependent_spring", "stribeck_friction",
        "command_delay",
    ]  # fmt: skip
    assert "stribeck_friction of panda_joint2: extra 0.5 SI, speed 0.1 SI" in export.text
    robot = pinocchio.buildModelFromXML(export.text)
    data = robot.createData()
    stepper = panda(EXPRESSIBLE).stepper()
    frictionless = panda(EXPRESSIBLE[2:]).stepper()
    rng = np.random.default_rng(0)
    for _ in range(5):
        q = rng.uniform(-1, 1, 7)
        pinocchio.framesForwardKinematics(robot, data, q)
        tip = data.oMf[robot.getFrameId("panda_link8")].homogeneous
        assert tip == pytest.approx(pose(q, stepper), abs=1e-9)
        frictionless.reset(q)
        M = pinocchio.crba(robot, data, q)
        full = np.empty((7, 7))
        mujoco.mj_fullM(frictionless.model, frictionless.data, full)
        assert np.triu(M) == pytest.approx(np.triu(full), abs=1e-9)
        gravity = pinocchio.computeGeneralizedGravity(robot, data, q)
        assert frictionless.data.qfrc_bias == pytest.approx(gravity, abs=1e-9)
    assert 'damping="4.0"' in export.text
    assert 'friction="1.5"' in export.text


def test_the_improved_urdf_is_to_mujoco_what_the_simulation_is() -> None:
    text = export_urdf(panda(EXPRESSIBLE)).text
    loaded = mujoco.MjModel.from_xml_string(text)
    stepper = panda(EXPRESSIBLE).stepper()
    assert loaded.dof_damping == pytest.approx(stepper.model.dof_damping, abs=1e-12)
    assert loaded.dof_frictionloss == pytest.approx(stepper.model.dof_frictionloss, abs=1e-12)
    assert loaded.dof_damping[1] == 4.0
    assert "Everything that was found is in here" in text


def test_the_improved_mjcf_moves_as_the_simulation_does() -> None:
    lag = found("actuator_lag", ("panda_joint1",), time_constant=0.02)
    drives = (
        found("torque_saturation", ("panda_joint2",), level=40.0),
        found("torque_gain", ("panda_joint3",), gain=1.2),
        found("torque_offset", ("panda_joint3",), offset=0.4),
        found("joint_elasticity", ("panda_joint2",), stiffness=5000.0, damping=5.0),
    )
    findings = EXPRESSIBLE[:4] + MJCF_ONLY + (lag, *drives)
    model = panda(findings, controller=None)
    model = replace(model, rotor_inertia=np.full(7, 0.1))
    export = export_mjcf(model)
    assert export.left_out == ()
    loaded = mujoco.MjModel.from_xml_string(export.text)
    data = mujoco.MjData(loaded)
    stepper = model.stepper()
    q0 = np.array([0.1, -0.3, 0.2, -1.5, 0.3, 1.2, 0.4])
    stepper.reset(q0)
    data.qpos[:] = stepper.data.qpos
    torque = np.array([1.0, -45.0, 2.0, 10.0, 0.5, 0.4, 0.1])
    data.act[:] = torque[0]  # ours begins settled at the first command
    for k in range(300):
        u = torque * (1 if k < 150 else -0.5)
        data.ctrl[:] = u
        mujoco.mj_step(loaded, data)
        stepper.step(u)
    assert np.abs(stepper.q - q0).max() > 0.05
    assert data.qpos == pytest.approx(stepper.data.qpos, abs=2e-3)


def test_what_mjcf_cannot_say_is_listed_in_it() -> None:
    both = (
        found("backlash", ("panda_joint1",), gap=0.01),
        found("joint_elasticity", ("panda_joint1",), stiffness=5000.0, damping=1.0),
    )
    export = export_mjcf(panda(NOT_SAID + both))
    assert [each.split(" of ")[0] for each in export.left_out] == [
        "stribeck_friction", "command_delay", "backlash",
    ]  # fmt: skip
    for each in export.left_out:
        assert each in export.text
    assert mujoco.MjModel.from_xml_string(export.text).nv == 8


def test_backlash_is_a_joint_with_stops_in_mjcf() -> None:
    export = export_mjcf(panda((found("backlash", ("panda_joint1",), gap=0.01),)))
    loaded = mujoco.MjModel.from_xml_string(export.text)
    play = loaded.joint("panda_joint1.play")
    assert play.range == pytest.approx([-0.005, 0.005])
    assert loaded.jnt_limited[play.id]


def test_an_mjcf_is_kept_without_its_shapes_and_improved_as_mjcf_only(tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(MJCF)
    text = robot_text(tmp_path / "robot.xml")
    kept = mujoco.MjModel.from_xml_string(text)  # needs no mesh
    assert kept.njnt == 2
    assert kept.dof_armature[0] == 0.1
    findings = (found("coulomb_friction", ("joint1",), level=1.5),)
    model = Model(robot=text, joints=("joint1",), findings=findings)
    paths = write_exports(model, tmp_path)
    assert [path.name for path in paths] == ["improved.xml"]
    improved = mujoco.MjModel.from_xml_path(str(paths[0]))
    assert improved.dof_frictionloss.tolist() == [0.5 + 1.5, 0.0]  # the user's and what was found
    assert improved.dof_armature[0] == 0.1
    with pytest.raises(ValueError, match="it is an MJCF, expected a URDF"):
        export_urdf(model)


def test_a_urdf_is_improved_as_both_and_keeps_what_it_had(tmp_path: Path) -> None:
    mesh = '<visual><geometry><mesh filename="package://no/where.dae"/></geometry></visual>'
    model = Model(robot=arm_urdf(1, extra=mesh), joints=("joint1",))
    paths = write_exports(model, tmp_path)
    assert [path.name for path in paths] == ["improved.xml", "improved.urdf"]
    assert "package://no/where.dae" in paths[1].read_text()


def test_corrected_inertials_take_the_place_of_the_robot_s() -> None:
    ten = Inertial.about_com(3.0, np.array([0.2, 0.0, 0.1]), 0.1 * np.eye(3)).ten()
    model = Model(robot=PENDULUM, joints=("joint1",), rigid_body={"link1": ten})
    improved = mujoco.MjModel.from_xml_string(export_mjcf(model).text)
    link = improved.body("link1")
    assert link.mass == pytest.approx(3.0)
    assert link.ipos == pytest.approx([0.2, 0.0, 0.1])
    urdf = mujoco.MjModel.from_xml_string(export_urdf(model).text)
    assert urdf.body_inertia[-1] == pytest.approx([0.1] * 3)


def test_inertias_of_no_body_are_those_of_the_nearest_and_said() -> None:
    flat = Inertial.about_com(2.0, np.array([0.3, 0, 0]), np.diag([0.01, 0.01, 0.05])).ten()
    model = Model(robot=PENDULUM, joints=("joint1",), rigid_body={"link1": flat})
    for export in (export_mjcf(model), export_urdf(model)):
        assert "link link1: the inertia that was found is no body's" in export.left_out[0]
        moments = np.sort(mujoco.MjModel.from_xml_string(export.text).body_inertia[-1])
        assert moments[0] + moments[1] >= moments[2] * (1.0 - 1e-9)


def test_of_friction_that_builds_up_the_files_have_the_level() -> None:
    bent = found("presliding_hysteresis", ("panda_joint2",), level=3.0, displacement=0.02)
    model = panda((replace(bent, shape=(0.02,)),))
    improved = mujoco.MjModel.from_xml_string(export_mjcf(model).text)
    assert improved.joint("panda_joint2").frictionloss == pytest.approx(3.0)
    urdf = mujoco.MjModel.from_xml_string(export_urdf(model).text)
    assert urdf.joint("panda_joint2").frictionloss == pytest.approx(3.0)
    for export in (export_mjcf(model), export_urdf(model)):
        (said,) = export.left_out
        assert "panda_joint2" in said
        assert "within 0.02 rad after a reversal, here at once" in said


@pytest.mark.parametrize("seed", range(30))
def test_the_improved_model_loads_whatever_was_found(seed: int) -> None:
    pytest.importorskip("pinocchio", reason="needs the Python package pin")
    from pdoik.sim2real.export import improved_mjcf, improved_urdf

    rng = np.random.default_rng(seed)
    links = tuple(f"panda_link{k}" for k in range(1, 8))
    names = [each.name for each in CATALOGUE["link_inertial_error"].parameters]
    scale = 10.0 ** rng.uniform(-3, 3)
    findings = [
        found("payload", links=links[-1:], mass=scale, com_x=rng.normal(), ixx=rng.normal()),
        found("coulomb_friction", JOINTS[:2], level=scale),
        found("joint_offset", JOINTS[3:4], offset=rng.normal()),
        found("gravity_direction", tilt_x=rng.normal(), tilt_y=rng.normal()),
    ]
    for k in rng.choice(7, 3, replace=False):
        changes = dict(zip(names, (scale * rng.standard_normal(10)).tolist(), strict=True))
        findings.append(found("link_inertial_error", links=links[k : k + 1], **changes))
    model = panda(tuple(findings))
    loaded = mujoco.MjModel.from_xml_string(improved_mjcf(model))
    assert (loaded.body_mass >= 0.0).all()
    mass, I = loaded.body_mass, np.sort(loaded.body_inertia, axis=1)  # noqa: E741
    assert (I[mass > 0.0, 0] + I[mass > 0.0, 1] >= I[mass > 0.0, 2] * (1.0 - 1e-6)).all()
    assert improved_urdf(model) is not None


def test_findings_go_with_another_description_and_corrections_by_as_much(tmp_path: Path) -> None:
    robot = tmp_path / "loaded.urdf"
    robot.write_text(PENDULUM.replace('mass value="2.0"', 'mass value="3.0"'))
    own = Inertial.about_com(2.0, np.array([0.3, 0.0, 0.0]), 0.05 * np.eye(3)).ten()
    friction = (found("coulomb_friction", ("joint1",), level=0.5),)
    model = Model(
        joints=("joint1",),
        robot=PENDULUM,
        findings=friction,
        rigid_body={"link1": own + np.eye(10)[0] * 0.25},
    )
    loaded = model.with_robot(robot)
    assert loaded.findings == friction
    assert loaded.robot is not None
    assert loaded.rigid_body["link1"][0] == pytest.approx(3.25)
    still = commands(2.0, q=0.0)
    before, after = (predict(each, still)[100, 0] for each in (model, loaded))
    assert after - before == pytest.approx(-1.0 * 9.81 * 0.3, rel=1e-3)
