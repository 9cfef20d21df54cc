"""Effects: what is read from coefficients gives the coefficients back, and torques by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Estimate, Finding, Model, Recording, predict
from pdoik.sim2real.effects import CATALOGUE, VARIABLES
from sim2real_robots import PENDULUM, TURNTABLE, arm_urdf, commands

VARIANTS = {
    "actuator_lag": (0.0, 1.0),
    "command_delay": (0.0, 1.0),
    "sensor_gain": (0.0, 1.0, 2.0, 3.0),
    "timestamp_skew": (0.0, 1.0),
    "torque_gain": (0.0, 1.0, 2.0),
    "torque_offset": (0.0, 1.0, 2.0),
    "torque_saturation": (0.0, 1.0, 2.0),
    "torque_speed_limit": (1.0, 2.0),
}
ONE_ENTRY = {"sensor_gain", "torque_gain", "torque_offset"}
SHAPES = {
    "backlash": 1,
    "coulomb_friction": 1,
    "friction_drift": 1,
    "joint_elasticity": 2,
    "joint_offset": 1,
    "presliding_hysteresis": 1,
    "strain_wave_error": 1,
    "stribeck_friction": 1,
    "torque_ripple": 1,
}


@st.composite
def found(draw: st.DrawFn) -> tuple[str, tuple[float, ...], np.ndarray]:
    """An effect with a shape and admissible coefficients."""
    name = draw(st.sampled_from(sorted(CATALOGUE)))
    effect = CATALOGUE[name]
    positive = st.floats(0.001, 2.0)
    shape: tuple[float, ...] = tuple(draw(positive) for _ in range(SHAPES.get(name, 0)))
    if name in VARIANTS:
        shape = (draw(st.sampled_from(VARIANTS[name])),)
        shape += () if name in ONE_ENTRY else (draw(positive),)
        shape += (draw(positive),) if name == "torque_speed_limit" else ()
    if name == "position_dependent_spring":
        side = draw(st.sampled_from((-1.0, 0.0, 1.0)))
        shape = (side, draw(st.floats(-1.0, 1.0)) if side else 0.0)
    width = 9 if name == "unknown" else len(effect.bounds[0])
    if name == "unknown":
        code = draw(st.integers(0, len(VARIABLES) - 1))
        shape = (float(code), -draw(positive), draw(positive))
    if effect.fixed:
        return name, shape, np.ones(1)
    if name == "position_dependent_spring":
        width = 2 if shape[0] == 0.0 else 1
    lower, upper = (bound[:width] for bound in effect.bounds)
    if name == "unknown":
        lower, upper = np.full(width, -np.inf), np.full(width, np.inf)
    low, high = np.maximum(lower, -1.0), np.minimum(upper, 1.0)
    shares = np.array([draw(st.floats(0.1, 0.9)) for _ in range(width)])
    return name, shape, low + shares * (high - low)


@settings(max_examples=400, deadline=None)
@given(found())
def test_coefficients_give_back_the_values_they_were_read_from(
    case: tuple[str, tuple[float, ...], np.ndarray],
) -> None:
    name, shape, beta = case
    effect = CATALOGUE[name]
    values = effect.values(shape, beta)
    back_shape, back = effect.coefficients(values, shape)
    again = effect.values(back_shape, back)
    assert again == pytest.approx(values, rel=1e-9, abs=1e-12)
    assert back_shape == pytest.approx(shape, abs=1e-9)
    if name not in ("gravity_direction", "backlash"):  # one coefficient follows from the rest
        assert back == pytest.approx(beta, rel=1e-6, abs=1e-9)
    without, _ = effect.coefficients(values)  # of a finding that somebody wrote by hand
    assert len(without) == len(shape)
    assert effect.variant(shape) or name not in VARIANTS or name in ("torque_gain", "torque_offset")


def test_every_effect_says_where_it_comes_from_and_what_it_is() -> None:
    for name, effect in CATALOGUE.items():
        assert effect.id == name
        assert effect.equation
        assert effect.source
        assert effect.decided_by
        assert all(parameter.unit for parameter in effect.parameters)
        assert set(effect.confused_with) <= set(CATALOGUE), name


# Torque for a motion


def finding(effect: str, joints: tuple[str, ...], shape: tuple[float, ...] = (), **values: float):  # type: ignore[no-untyped-def]
    return Finding(
        effect=effect,
        joints=joints,
        parameters={
            name: Estimate(value=value, std=0.0, interval95=(value, value), unit="SI")
            for name, value in values.items()
        },
        shape=shape,
    )


def swinging(n: int = 1, period: float = 2e-3) -> Recording:
    return commands(
        6.0, period, n, q=lambda t: np.stack([0.6 * np.sin((2 + k) * t) for k in range(n)], axis=1)
    )


def test_the_torque_of_a_pendulum_is_inertia_gravity_and_what_was_found() -> None:
    run = swinging()
    found = (
        finding("viscous_friction", ("joint1",), coefficient=0.7),
        finding("rotor_inertia", ("joint1",), inertia=0.2),
        finding("torque_offset", ("joint1",), offset=-0.3),
        finding("command_delay", ("joint1",), (1.0, 0.05), delay=0.05),  # changes no torque
    )
    model = Model(joints=("joint1",), robot=PENDULUM, findings=found, cutoff=10.0)
    q, dq, ddq = (0.6 * f for f in (np.sin(2 * run.time), 2 * np.cos(2 * run.time),
                                    -4 * np.sin(2 * run.time)))  # fmt: skip
    plain = 0.23 * ddq - 2.0 * 9.81 * 0.3 * np.cos(q)
    inside = slice(250, -250)
    before = predict(model, run, findings=False)[:, 0]
    assert before[inside] == pytest.approx(plain[inside], abs=5e-3)
    after = predict(model, run)[:, 0]
    added = 0.7 * dq + 0.2 * ddq - 0.3
    assert (after - before)[inside] == pytest.approx(added[inside], abs=5e-3)


def test_faster_recordings_are_thinned_and_come_back_at_their_own_samples() -> None:
    model = Model(joints=("joint1",), robot=PENDULUM, cutoff=10.0)
    fine, coarse = swinging(period=5e-4), swinging(period=2e-3)
    slow, quick = predict(model, coarse), predict(model, fine)
    assert quick.shape == fine.q.shape
    assert quick[::4][200:-200] == pytest.approx(slow[200:-200], abs=2e-2)


def test_a_link_heavier_by_a_payload_needs_what_a_heavier_link_needs() -> None:
    run = swinging(2)
    joints = ("joint1", "joint2")
    payload = Finding(
        effect="payload",
        links=("link2",),
        parameters={
            name: Estimate(value=value, std=0.0, interval95=(value, value), unit="SI")
            for name, value in {
                "mass": 0.5, "com_x": 0.6, "com_y": 0.0, "com_z": 0.1, "ixx": 0.01, "ixy": 0.0,
                "iyy": 0.01, "ixz": 0.0, "iyz": 0.0, "izz": 0.01,
            }.items()
        },
    )  # fmt: skip
    held = """
      <joint name="fixed" type="fixed"><parent link="link2"/><child link="held"/>
        <origin xyz="0.6 0 0.1"/></joint>
      <link name="held"><inertial><mass value="0.5"/>
        <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
    </robot>"""
    heavier = arm_urdf(2).replace("</robot>", held)
    by_finding = predict(Model(joints=joints, robot=arm_urdf(2), findings=(payload,)), run)
    by_model = predict(Model(joints=joints, robot=heavier), run)
    assert by_finding == pytest.approx(by_model, abs=1e-6)


def test_corrected_links_are_the_robots_links_with_the_difference() -> None:
    run = swinging(2)
    joints = ("joint1", "joint2")
    plain = Model(joints=joints, robot=arm_urdf(2))
    ten = np.array([2.5, 0.7, 0.0, 0.0, 0.05, 0.0, 0.26, 0.0, 0.0, 0.26])
    heavier = arm_urdf(2)
    head, tail = heavier.rsplit('<mass value="2.0"/>', 1)
    com = ten[1] / ten[0]
    about = 0.26 - ten[0] * com**2
    tail = tail.replace('iyy="0.05"', f'iyy="{about}"').replace('izz="0.05"', f'izz="{about}"')
    head_link, origin = head.rsplit('xyz="0.3 0 0"', 1)
    heavier = f'{head_link}xyz="{com} 0 0"{origin}<mass value="2.5"/>{tail}'
    corrected = Model(joints=joints, robot=arm_urdf(2), rigid_body={"link2": ten})
    by_model = predict(Model(joints=joints, robot=heavier), run)
    assert predict(corrected, run) == pytest.approx(by_model, abs=1e-6)
    assert predict(corrected, run, findings=False) == pytest.approx(predict(plain, run), abs=1e-12)


def test_a_contact_pushes_in_its_window_of_its_recording_only() -> None:
    run = swinging()
    push = Finding(
        effect="external_contact",
        links=("link1",),
        recordings=("rec.csv",),
        window=(2.0, 3.0),
        parameters={
            f"force_{axis}": Estimate(value=f, std=0.0, interval95=(f, f), unit="N")
            for axis, f in zip("xyz", (0.0, 0.0, 5.0), strict=True)
        },
    )
    held = 'tip" type="fixed"><parent link="link1"/><child link="tip"/><origin xyz="0.6 0 0"/>'
    robot = PENDULUM.replace("</robot>", f'<link name="tip"/><joint name="{held}</joint></robot>')
    model = Model(joints=("joint1",), robot=robot, tip="tip", findings=(push,))
    change = (predict(model, run) - predict(model, run, findings=False))[:, 0]
    inside = (run.time >= 2.01) & (run.time < 2.99)
    assert not change[(run.time < 1.99) | (run.time > 3.01)].any()
    assert change[inside] == pytest.approx(5.0 * 0.6 * np.cos(run.q[inside, 0]), abs=1e-2)


def test_a_model_without_robot_or_with_other_joints_says_so() -> None:
    with pytest.raises(ValueError, match="no robot description, so no torque can be predicted"):
        predict(Model(joints=("joint1",)), swinging())
    with pytest.raises(ValueError, match="recording has 2 joints, the model has 1"):
        predict(Model(joints=("joint1",), robot=TURNTABLE), swinging(2))
    misspelt = finding("viscous_friction", ("jiont1",), coefficient=1.0)
    model = Model(joints=("joint1",), robot=TURNTABLE, findings=(misspelt,))
    with pytest.raises(ValueError, match="no joint 'jiont1', nearest: 'joint1'"):
        predict(model, swinging())


def test_importing_pdoik_or_its_command_line_does_not_import_what_the_extra_brings() -> None:
    import subprocess
    import sys

    program = (
        "import sys, pdoik, pdoik.cli;"
        "heavy = {'pinocchio', 'mujoco', 'pyarrow', 'rosbags', 'jinja2', 'pdoik.sim2real'};"
        "sys.exit(', '.join(heavy & set(sys.modules)) or None)"
    )
    subprocess.run([sys.executable, "-c", program], check=True, cwd=Path.cwd())
