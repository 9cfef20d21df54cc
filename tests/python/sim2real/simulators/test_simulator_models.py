"""The user's MJCF as it is: its runs, its patch, and models that cannot be used."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.errors import LoadError
from pdoik.sim2real import Controller, SimulationError, Simulator, Study, Thresholds
from pdoik.sim2real.simulators import (
    Climb,
    Experiment,
    ParameterId,
    UserModel,
    baseline,
    description_of,
    explain,
    model_with,
    parameters_of,
    patched,
    scales_of,
    simulated,
    terms_of,
    user_model,
)
from sim2real_recordings import even_recording
from sim2real_robots import arm_urdf
from sim2real_simulators import JOINTS, MJCF, PERIOD, commands, log, stepped

LIMITS = Thresholds().simulators


@cache
def user() -> UserModel:
    return user_model(MJCF, JOINTS, name="arm.xml")


def test_runs_are_those_of_mujoco_itself() -> None:
    """A long run against a plain loop over mj_step, once the guess of its first speed is over."""
    dense = user_model(MJCF.replace("0.002", "0.0025"), JOINTS)
    _, q_des = commands(4.0, 5)
    plain, torque = stepped(q_des, step=0.0025)
    ours = simulated(dense, replace(log(4.0, 5), q=plain), {})
    assert ours.tau is not None
    np.testing.assert_allclose(ours.q[300:], plain[300:], atol=1e-5)
    np.testing.assert_allclose(ours.tau[300:], torque[300:], atol=1e-3)


def test_lines_are_differences_of_models() -> None:
    """Half a step and a fifth of another way, against lines that were laid by one step forward."""
    experiment = Experiment(user(), [log(4.0, 3)])
    parameter_ids = [
        parameter_id for term in terms_of(user()) for parameter_id in term.parameter_ids
    ]
    climb = Climb(experiment, parameters_of(user(), parameter_ids, scales_of(experiment, {})))
    shown = climb.run(climb.start)
    J = climb.lines(climb.start, shown, np.ones(len(climb.start), dtype=bool))
    for i, parameter in enumerate(climb.parameters):
        if not J[i].any():
            assert parameter.parameter_id.property == "force_limit"
            continue
        step = np.zeros(len(climb.start))
        step[i] = 2e-3
        change = climb.run(climb.start + step) - shown
        error = np.abs(change - 2e-3 * J[i]).max()
        assert error < 0.1 * np.abs(change).max() + 1e-9, parameter.parameter_id


def test_coordinates_give_the_users_values_and_back() -> None:
    parameter_ids = [
        parameter_id for term in terms_of(user()) for parameter_id in term.parameter_ids
    ]
    for each in parameters_of(
        user(), parameter_ids, scales_of(Experiment(user(), [log(4.0, 3)]), {})
    ):
        value = baseline(user(), each.parameter_id)
        if value < 1e8:  # a limit that is there
            assert each.value(each.start) == pytest.approx(value, rel=1e-12, abs=1e-12)
        x = each.start + 0.3
        assert each.x_of(each.value(x)) == pytest.approx(x, rel=1e-9)
        slope = (each.value(x + 1e-6) - each.value(x - 1e-6)) / 2e-6
        assert each.slope(x) == pytest.approx(slope, rel=1e-6)


def test_trees_that_do_not_touch_are_turned_together() -> None:
    two = MJCF.replace(
        "</worldbody>",
        '<body name="other" pos="0 1 0"><joint name="alone" axis="0 1 0"/>'
        '<geom size="0.1" mass="1" pos="0.2 0 0" contype="0" conaffinity="0"/></body></worldbody>',
    ).replace("</actuator>", '<position joint="alone" kp="50" kv="2"/></actuator>')
    assert len(set(user_model(two, (*JOINTS, "alone")).trees())) == 2
    tied = two.replace(
        "</mujoco>", '<equality><joint joint1="alone" joint2="wrist"/></equality></mujoco>'
    )
    assert len(set(user_model(tied, (*JOINTS, "alone")).trees())) == 1


VALUES = {
    ParameterId("damping", 0): 0.9,
    ParameterId("frictionloss", 1): 0.55,
    ParameterId("armature", 2): 0.02,
    ParameterId("kp", 0): 101.0,
    ParameterId("kp", 1): 70.0,
    ParameterId("kv", 2): 0.5,
    ParameterId("ref", 1): 0.05,
    ParameterId("mass", 1): 1.3,
    ParameterId("mass", 2): 0.5,
    ParameterId("com_x", 2): 0.07,
    ParameterId("stiffness", 0): 3.0,
    ParameterId("spring_torque", 0): -1.2,
    ParameterId("kp_factor", -1): 0.9,
    ParameterId("gain_factor", -1): 0.8,
    ParameterId("gain_factor", 1): 0.7,
}


def test_a_patched_file_is_the_candidate_and_otherwise_as_it_was() -> None:
    patch = patched(user(), VALUES)
    assert not patch.left_out
    model = mujoco.MjSpec.from_string(patch.text).compile()
    wanted = model_with(user(), VALUES)
    for name in (
        *("dof_damping", "dof_frictionloss", "dof_armature", "qpos0", "jnt_range"),
        *("actuator_gainprm", "actuator_biasprm", "actuator_forcerange"),
        *("jnt_stiffness", "qpos_spring"),
        *("body_mass", "body_ipos", "body_inertia", "body_pos", "dof_invweight0"),
    ):
        np.testing.assert_allclose(
            getattr(model, name), getattr(wanted, name), rtol=1e-9, atol=1e-12, err_msg=name
        )
    before, after = MJCF.splitlines(), patch.text.splitlines()
    assert len(before) == len(after)
    changed = {old.strip()[:40] for old, new in zip(before, after, strict=True) if old != new}
    assert changed == {
        line.strip()[:40]
        for line in before
        if any(
            part in line
            for part in ('name="shoulder"', 'name="elbow"', 'name="wrist"', "<inertial", '"hand"')
        )
        or "servo" in line
        or 'joint="elbow"' in line
    }


def test_a_damping_ratio_keeps_the_gains_that_it_had() -> None:
    """MuJoCo works them out from the inertias, which the patch changes."""
    ratio = user_model(MJCF.replace('kp="80" kv="3"', 'kp="80" dampratio="1"'), JOINTS)
    values = {ParameterId("armature", 0): 0.2}
    text = patched(ratio, values).text
    model = mujoco.MjSpec.from_string(text).compile()
    np.testing.assert_allclose(
        model.actuator_biasprm, model_with(ratio, values).actuator_biasprm, rtol=1e-9
    )


def test_a_load_brings_the_inertia_of_a_body_that_is_welded_on() -> None:
    """Against MuJoCo's own mass matrix and gravity of an arm with a small ball in its hand."""
    spec = mujoco.MjSpec.from_string(MJCF)
    at, load = np.array([0.15, 0.04, -0.02]), 0.4
    ball = spec.body("hand").add_body(name="ball", pos=at)
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[1e-4, 0, 0], mass=load)
    truth = spec.compile()
    model, k = user().model, user().body_of(2)
    mass, centre = float(model.body_mass[k]), model.body_ipos[k]
    together = (mass * centre + load * at) / (mass + load)
    values = {ParameterId("mass", 2): mass + load}
    values |= {
        ParameterId(f"com_{axis}", 2): float(x) for axis, x in zip("xyz", together, strict=True)
    }
    candidate = model_with(user(), values)
    for q in ([0.3, -0.6, 0.9], [1.2, 0.4, -1.1]):
        found = []
        for each in (truth, candidate):
            data = mujoco.MjData(each)
            data.qpos[:] = q
            mujoco.mj_forward(each, data)
            inertia = np.zeros((3, 3))
            mujoco.mj_fullM(each, data, inertia)
            found.append((inertia, data.qfrc_bias.copy()))
        np.testing.assert_allclose(found[1][0], found[0][0], rtol=1e-5, atol=1e-7)
        np.testing.assert_allclose(found[1][1], found[0][1], rtol=1e-6)


def test_held_torques_are_those_of_a_loop_that_reads_and_holds(tmp_path: Path) -> None:
    """A PD law at 5 ms on fine physics, by a plain loop over mj_step."""
    (tmp_path / "arm.urdf").write_text(arm_urdf(2))
    time = np.arange(0.0, 3.0, PERIOD)
    q_des = 0.4 * np.sin(2.0 * np.pi * np.outer(time, [0.5, 0.9])) + [0.3, -0.2]
    controller = Controller(
        kp=np.array([300.0, 120.0]),
        kd=np.array([20.0, 8.0]),
        gravity_compensation=False,
        period=PERIOD,
    )
    joints, rotors = ("joint1", "joint2"), np.array([0.05, 0.05])
    commanded = even_recording(time, q=q_des, q_des=q_des)
    study = Study(
        folder=tmp_path,
        robot=tmp_path / "arm.urdf",
        joints=joints,
        recordings=(commanded,),
        split="by the study",
        controller=controller,
        rotor_inertia=rotors,
    )
    model = description_of(study)
    assert model is not None
    plain = mujoco.MjSpec.from_string(str(model.source)).compile()
    plain.actuator_gainprm[:], plain.actuator_biasprm[:] = 0.0, 0.0
    plain.opt.timestep = 2.5e-4
    data, q = mujoco.MjData(plain), []
    data.qpos[:] = q_des[0]
    for wanted in q_des:
        q.append(data.qpos.copy())
        torque = controller.kp * (wanted - data.qpos) - controller.kd * data.qvel
        data.qfrc_applied[:] = torque
        mujoco.mj_step(plain, data, 20)
    machine = even_recording(time, q=np.array(q), q_des=q_des)
    experiment = Experiment(model, [machine])
    as_it_is = np.abs(experiment.run({}) - experiment.measured)[:, :2]
    experiment.allow_for_step({})
    held = np.abs(experiment.run({}) - experiment.measured)[:, :2]
    assert np.median(held) < 0.1 * np.median(as_it_is)


def test_a_patched_file_moves_as_the_candidate() -> None:
    recording = log(4.0, 7)
    values = {**VALUES, ParameterId("delay", 0): 0.006}
    again = user_model(patched(user(), values).text, JOINTS)
    ours, theirs = simulated(user(), recording, values), simulated(again, recording, {})
    assert np.abs(ours.q - simulated(user(), recording, {}).q).max() > 0.05
    np.testing.assert_allclose(ours.q[20:], theirs.q[20:], atol=1e-3)


def test_a_floating_base_is_refused_with_what_to_do() -> None:
    text = MJCF.replace('<body name="upper">', '<body name="upper"><freejoint name="root"/>')
    text = text.replace('<joint name="shoulder" axis="0 1 0" range="-170 170"/>', "")
    text = text.replace('<position name="servo1" joint="shoulder" kp="120" kv="4"/>', "")
    with pytest.raises(LoadError, match=r"'root' lets body 'upper' float.*base fixed"):
        user_model(text, ("elbow",))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('joint="elbow" kp', 'joint="wrist" kp', r"'elbow' needs a position actuator"),
        (
            '<position joint="elbow" kp="80" kv="3"/>',
            '<position joint="elbow" kp="80" name="a"/><position joint="elbow" kp="8" name="b"/>',
            r"'elbow' has several position actuators \(a, b\)",
        ),
        (
            'name="elbow"',
            'name="ellbow"',
            r"MuJoCo cannot read|no joint 'elbow'; nearest: 'ellbow'",
        ),
        ("<worldbody>", "<worldboddy>", "MuJoCo cannot read it"),
    ],
)
def test_models_that_do_not_fit_are_named(old: str, new: str, said: str) -> None:
    with pytest.raises(LoadError, match=said):
        user_model(MJCF.replace(old, new), JOINTS)


def test_a_simulator_that_explodes_is_named_with_joint_and_time() -> None:
    wild = MJCF.replace('kp="120" kv="4"', 'kp="120" kv="900"').replace("implicitfast", "Euler")
    model = user_model(wild.replace('forcerange="-80 80"', ""), JOINTS, name="wild.xml")
    with pytest.raises(SimulationError, match=r"wild.xml is unstable .* at \d\.\d+ s joint '\w+'"):
        simulated(model, log(4.0, 1), {})


def run_away(text: str, said: str) -> None:
    fit, judge = log(5.0, 1), log(4.0, 2, role="validate")
    with pytest.raises(SimulationError, match=said):
        explain(user_model(text, JOINTS, name="wild.xml"), [fit], [judge], LIMITS)


def test_a_simulator_whose_joints_leave_is_named() -> None:
    """Commands of the wrong sign push an arm away, at bounded speed."""
    away = MJCF.replace(
        'gainprm="15" biastype="affine" biasprm="0 -15 -0.3"',
        'gainprm="15" biastype="affine" biasprm="0 6 -1.5"',
    )
    run_away(away, r"wild.xml (runs away|is unstable) under the commands of run.csv.*'wrist'")


def test_a_simulator_whose_step_shakes_it_is_named() -> None:
    """Too much damping for an explicit step, held in bounds by the drive's limit."""
    shaking = MJCF.replace('kp="120" kv="4"', 'kp="120" kv="3000"').replace("implicitfast", "Euler")
    run_away(shaking, r"timestep is 2 ms: try a shorter one")


def test_motors_follow_the_studys_controller_as_a_loop_outside_would() -> None:
    motors = MJCF.replace("implicitfast", "Euler").replace(
        '<position name="servo1" joint="shoulder" kp="120" kv="4"/>',
        '<motor name="servo1" joint="shoulder" gear="5" ctrlrange="-2 2"/>',
    )
    recording = log(3.1, 5, noise=0.0)
    controller = Controller(
        kp=np.array([120.0, 1.0, 1.0]), kd=np.array([4.0, 0.0, 0.0]), gravity_compensation=False
    )
    model = user_model(motors, JOINTS, controller=controller)
    ours = simulated(model, recording, {})
    spec = mujoco.MjSpec.from_string(motors)
    plain = spec.compile()
    data = mujoco.MjData(plain)
    assert recording.q_des is not None
    data.qpos[:] = recording.q[0]
    q = []
    for k in range(1500):
        if k % 5 == 0:  # two samples are five steps
            q.append(data.qpos.copy())
        at = k * 2e-3 + np.array([0.0, 1e-3])  # a step that spans two samples gets their mean
        wanted = recording.q_des[(at / PERIOD + 1e-6).astype(int)].mean(axis=0)
        torque = 120.0 * (wanted[0] - data.qpos[0]) - 4.0 * data.qvel[0]
        data.ctrl[:] = (torque / 5.0, wanted[1], wanted[2])
        mujoco.mj_step(plain, data)
    settled = slice(150, 300)  # the guess of the first speed is over
    np.testing.assert_allclose(ours.q[: 2 * len(q) : 2][settled], np.array(q)[settled], atol=1e-4)
    assert np.ptp(ours.q[300:, 0]) > 0.2


def test_a_urdf_under_a_controller_moves_as_in_the_diagnosis_own_simulation(tmp_path: Path) -> None:
    """Desired speeds and gravity compensation are fed forward, whatever the candidate is."""
    (tmp_path / "arm.urdf").write_text(arm_urdf(2))
    time = np.arange(0.0, 4.0, PERIOD)
    q_des = 0.4 * np.sin(2.0 * np.pi * np.outer(time, [0.5, 0.9])) + [0.3, -0.2]
    commanded = even_recording(
        time, q=q_des, q_des=q_des, dq_des=np.gradient(q_des, PERIOD, axis=0)
    )
    controller = Controller(
        kp=np.array([300.0, 120.0]),
        kd=np.array([20.0, 8.0]),
        gravity_compensation=True,
        period=1e-3,
    )
    joints, rotors = ("joint1", "joint2"), np.array([0.05, 0.05])
    theirs = Simulator(tmp_path / "arm.urdf", joints, controller, rotors).replay(commanded)
    study = Study(
        folder=tmp_path,
        robot=tmp_path / "arm.urdf",
        joints=joints,
        recordings=(theirs,),
        split="by the study",
        controller=controller,
        rotor_inertia=rotors,
    )
    model = description_of(study)
    assert model is not None
    ours = simulated(model, theirs, {})
    settled = time > 1.0
    assert np.abs(q_des - theirs.q)[settled].max() > 0.01
    np.testing.assert_allclose(ours.q[settled], theirs.q[settled], atol=2e-3)
    assert ours.tau is not None
    assert theirs.tau is not None
    np.testing.assert_allclose(ours.tau[settled], theirs.tau[settled], atol=1.0)
