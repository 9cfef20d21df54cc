"""What a machine has beyond its user's simulator, found from commands and positions alone."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Thresholds
from pdoik.sim2real.simulators import Step, UserModel, explain, step_of, user_model
from sim2real_simulators import JOINTS, MJCF, log

LIMITS = Thresholds().simulators


@cache
def user() -> UserModel:
    return user_model(MJCF, JOINTS, name="arm.xml")


def step_with(
    change: Callable[[Any], None] | None, delay: float = 0.0, of: UserModel | None = None
) -> Step:
    fit = log(12.0, 1, change, delay=delay)
    judge = log(7.0, 2, change, name="judge.csv", role="validate", delay=delay)
    found = explain(of or user(), [fit], [judge], LIMITS)
    told = {parameter_id for term in found.kept for parameter_id in term.parameter_ids}
    assert set(found.patch) <= told, "the patch changes what nothing is said of"
    return step_of(found, "machine", LIMITS)


def more_damping(spec: Any) -> None:
    spec.joint("elbow").damping[0] = 1.1


def more_friction(spec: Any) -> None:
    spec.joint("elbow").frictionloss = 0.7


def heavier_rotor(spec: Any) -> None:
    spec.joint("shoulder").armature = 0.06


def weaker_gain(spec: Any) -> None:
    servo = spec.actuator("servo1")
    gain, bias = servo.gainprm, servo.biasprm
    gain[0], bias[1] = 96.0, -96.0
    servo.gainprm, servo.biasprm = gain, bias


def wrong_zero(spec: Any) -> None:
    spec.joint("elbow").ref = np.rad2deg(0.08)


def heavier_forearm(spec: Any) -> None:
    spec.body("fore").mass = 1.4


@pytest.mark.parametrize(
    ("change", "names", "joint", "truth"),
    [
        (more_damping, ("damping", "kv"), "elbow", 1.1),
        (more_friction, ("frictionloss",), "elbow", 0.7),
        (heavier_rotor, ("armature",), "shoulder", 0.06),
        (weaker_gain, ("kp",), "shoulder", 96.0),
        (wrong_zero, ("ref",), "elbow", 0.08),
        (heavier_forearm, ("mass", "payload"), "fore", 1.4),
    ],
)
def test_each_property_is_named_at_its_joint_with_its_size(
    change: Callable[[Any], None], names: tuple[str, ...], joint: str, truth: float
) -> None:
    step = step_with(change)
    (finding,) = step.findings
    assert finding.effect in names
    assert (*finding.joints, *finding.links) == (joint,)
    estimate = finding.parameters[names[0] if names[0] in finding.parameters else names[-1]]
    assert estimate.value == pytest.approx(truth, abs=4.0 * estimate.std + 0.01 * truth)
    assert estimate.std < 0.1 * truth
    assert finding.confidence > 0.75
    assert step.verdict == "mismatch_explained"


def test_a_delay_of_all_commands_is_one_finding() -> None:
    (finding,) = step_with(None, delay=0.012).findings
    assert finding.effect == "delay"
    assert finding.joints == JOINTS
    assert finding.parameters["delay"].value == pytest.approx(0.012, abs=5e-4)


def gains_times(kp: float, kv: float, joints: tuple[str, ...] = JOINTS) -> Callable[[Any], None]:
    def change(spec: Any) -> None:
        for servo in spec.actuators:
            if servo.target in joints:
                gain, bias = servo.gainprm, servo.biasprm
                gain[0] *= kp
                bias[1] *= kp
                bias[2] *= kv
                servo.gainprm, servo.biasprm = gain, bias

    return change


def test_gains_that_are_all_off_alike_are_one_finding() -> None:
    step = step_with(gains_times(0.8, 1.0))
    (finding,) = step.findings
    assert (finding.effect, finding.joints) == ("kp", JOINTS)
    assert finding.parameters["kp_factor"].value == pytest.approx(0.8, abs=0.01)
    changed = {each.parameter_id.index: each.after for each in step.changed}
    assert changed == pytest.approx({0: 96.0, 1: 64.0, 2: 12.0}, rel=0.02)


def test_drives_four_times_weaker_than_told_are_one_finding() -> None:
    """A torque constant takes kp and kv along; a line in the gain itself would end below zero."""
    step = step_with(gains_times(0.25, 0.25))
    (finding,) = step.findings
    assert (finding.effect, finding.joints) == ("gains", JOINTS)
    assert finding.parameters["gain_factor"].value == pytest.approx(0.25, abs=0.01)
    changed = {(c.parameter_id.property, c.parameter_id.index): c.after for c in step.changed}
    kp = {("kp", k): 0.25 * gain for k, gain in enumerate((120.0, 80.0, 15.0))}
    kv = {("kv", k): 0.25 * gain for k, gain in enumerate((4.0, 3.0, 0.3))}
    assert changed == pytest.approx(kp | kv, rel=0.04)


def test_gains_that_nobody_looked_up_are_found_from_far_away() -> None:
    """Fifty times too stiff and five times too damped: positions hardly change with anything."""
    stiff = MJCF
    for told, mistaken in (
        ('kp="120" kv="4"', 'kp="6000" kv="20"'),
        ('kp="80" kv="3"', 'kp="4000" kv="15"'),
        (
            'gainprm="15" biastype="affine" biasprm="0 -15 -0.3"',
            'gainprm="750" biastype="affine" biasprm="0 -750 -1.5"',
        ),
    ):
        stiff = stiff.replace(told, mistaken)
    step = step_with(None, of=user_model(stiff, JOINTS, name="stiff.xml"))
    changed = {(c.parameter_id.property, c.parameter_id.index): c.after for c in step.changed}
    for k, (kp, kv) in enumerate(((120.0, 4.0), (80.0, 3.0), (15.0, 0.3))):
        assert changed["kp", k] == pytest.approx(kp, rel=0.05)
        assert changed["kv", k] == pytest.approx(kv, rel=0.25)


PENDULUM = """<mujoco model="pendulum"><option timestep="0.002" integrator="implicitfast"/>
  <worldbody><body name="arm"><joint name="shoulder" axis="0 1 0" damping="0.3" armature="0.01"/>
    <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" mass="1.5"/></body></worldbody>
  <actuator><position joint="shoulder" kp="120" kv="4"/></actuator></mujoco>"""


def test_far_gains_of_a_machine_with_one_drive_are_its_own() -> None:
    """One joint has no factors of all joints; what was found far off stands in its own words."""
    told = PENDULUM.replace('kp="120" kv="4"', 'kp="6000" kv="20"')
    fit, judge = (
        log(seconds, seed, name=f"{role}.csv", role=role, mjcf=PENDULUM, joints=1)
        for seconds, seed, role in ((12.0, 1, "fit"), (7.0, 2, "validate"))
    )
    found = explain(user_model(told, ("shoulder",), name="pendulum.xml"), [fit], [judge], LIMITS)
    step = step_of(found, "machine", LIMITS)
    changed = {c.parameter_id.property: c.after for c in step.changed}
    assert {each.effect for each in step.findings} <= {"gains", "kp", "kv"}
    assert changed["kp"] == pytest.approx(120.0, rel=0.05)
    assert changed["kv"] == pytest.approx(4.0, rel=0.25)


def test_one_weak_drive_among_others_is_found() -> None:
    (finding,) = step_with(gains_times(0.3, 0.3, ("elbow",))).findings
    assert (finding.effect, finding.joints) == ("gains", ("elbow",))
    estimate = finding.parameters["gain_factor"]
    assert estimate.value == pytest.approx(0.3, abs=4.0 * estimate.std + 3e-3)


def test_a_spring_is_found_with_its_rest() -> None:
    def cable(spec: Any) -> None:
        spec.joint("elbow").stiffness[0] = 6.0
        spec.joint("elbow").springref = np.rad2deg(-0.5)

    (finding,) = step_with(cable).findings
    assert (finding.effect, *finding.joints) == ("spring", "elbow")
    assert finding.parameters["stiffness"].value == pytest.approx(6.0, rel=0.1)
    assert finding.parameters["spring_torque"].value == pytest.approx(-3.0, rel=0.1)


def test_two_causes_are_told_apart() -> None:
    def both(spec: Any) -> None:
        more_friction(spec)
        heavier_rotor(spec)

    step = step_with(both)
    found = {(f.effect, *f.joints): f.parameters[f.effect].value for f in step.findings}
    assert set(found) == {("frictionloss", "elbow"), ("armature", "shoulder")}
    assert found["frictionloss", "elbow"] == pytest.approx(0.7, rel=0.05)
    assert found["armature", "shoulder"] == pytest.approx(0.06, rel=0.05)


def test_of_a_machine_that_is_the_simulator_nothing_is_said() -> None:
    step = step_with(None)
    assert step.findings == ()
    assert step.changed == ()
    assert step.verdict == "no_mismatch"


def test_what_no_motion_can_part_is_an_equivalent() -> None:
    (finding,) = step_with(more_damping).findings
    assert {each.effect for each in finding.equivalents} & {"damping", "kv"}
