"""A hobby servo with much that its simulator lacks: together it is found, alone nothing helps."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import mujoco
import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.recordings import Recording
from pdoik.sim2real import Thresholds
from pdoik.sim2real.simulators import (
    Experiment,
    Explained,
    ParameterId,
    Step,
    UserModel,
    explain,
    model_with,
    patched,
    simulated,
    step_of,
    user_model,
)
from sim2real_recordings import even_recording

LIMITS = Thresholds().simulators
PERIOD, FINE = 0.02, 2.5e-4  # of the log and of the machine [s]
MASS, ARM = 0.5, 0.25  # of a weight on a light rod [kg], [m]
TRUTH = {
    "kp": 6.0,  # [N m/rad]
    "filter": 0.1,  # [s]
    "damping": 0.74,  # [N m s/rad]
    "force_limit": 2.0,  # [N m]
    "frictionloss": 0.12,  # [N m]
    "armature": 0.02,  # [kg m^2]
    "delay": 0.03,  # [s]
}
MJCF = """<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <body name="arm">
      <joint name="joint" axis="0 1 0"/>
      <inertial pos="0 0 -0.25" mass="0.5" diaginertia="1e-3 1e-3 1e-3"/>
    </body>
  </worldbody>
  <actuator>
    <position name="servo" joint="joint" kp="8" kv="0.05" forcerange="-3 3"/>
  </actuator>
</mujoco>
"""


def user() -> UserModel:
    return user_model(MJCF, ("joint",), name="servo.xml")


def machine(seconds: float, seed: int, role: str) -> Recording:
    """The servo, integrated here: friction grows with the load and falls with the speed."""
    rng = np.random.default_rng(seed)
    count = int(seconds / FINE)
    time = FINE * np.arange(count)
    held = np.floor(time / PERIOD) * PERIOD
    f, phase = rng.uniform(0.15, 0.9, 4), rng.uniform(0.0, 2 * np.pi, 4)
    wanted = 0.3 * np.sin(2 * np.pi * f * time[:, None] + phase).sum(axis=1)
    wanted += 0.7 * rng.uniform(-1.3, 1.3, count)[(time / 1.3).astype(int)]
    sent = np.interp(held - TRUTH["delay"], time, wanted)
    inertia = MASS * ARM**2 + 1e-3 + TRUTH["armature"]
    q, dq, smooth, path = sent[0], 0.0, sent[0], np.empty(count)
    for k in range(count):
        smooth += FINE / TRUTH["filter"] * (sent[k] - smooth)
        drive = np.clip(TRUTH["kp"] * (smooth - q), -TRUTH["force_limit"], TRUTH["force_limit"])
        load = MASS * 9.81 * ARM * np.sin(q)
        rubs = (TRUTH["frictionloss"] + 0.03 * abs(load)) * (
            1.0 + 0.3 * np.exp(-((dq / 0.15) ** 2))
        )
        torque = drive - TRUTH["damping"] * dq - load - rubs * np.tanh(dq / 0.01)
        dq += FINE * torque / inertia
        q += FINE * dq
        path[k] = q
    every = round(PERIOD / FINE)
    seen = np.round(path[::every] / 1.5e-3) * 1.5e-3
    log = even_recording(time[::every], q=seen[:, None], q_des=wanted[::every, None])
    return replace(log, role="fit" if role == "fit" else "validate", name=f"{role}.csv")


@cache
def found() -> tuple[Explained, Step]:
    fit, held = machine(30.0, 4, "fit"), machine(15.0, 5, "held")
    explained = explain(user(), [fit], [held], LIMITS)
    return explained, step_of(explained, "machine", LIMITS)


def test_the_patch_leaves_a_fiftieth_of_the_error() -> None:
    explained, step = found()
    error = [
        np.sqrt(np.mean((explained.held_out.measured - shown) ** 2))
        for shown in (explained.before, explained.after)
    ]
    assert error[0] > 0.3
    assert error[1] < 0.02 * error[0]
    assert step.verdict == "mismatch_explained"


def test_what_is_named_is_what_the_machine_has() -> None:
    _, step = found()
    named = {finding.effect: finding for finding in step.findings}
    assert {"filter", "damping", "delay"} <= named.keys() <= TRUTH.keys()
    for name, finding in named.items():
        assert finding.parameters[name].value == pytest.approx(TRUTH[name], rel=0.5), name
        assert finding.joints == ("joint",)


def test_a_smoothed_and_limited_drive_is_patched_in_mujocos_words() -> None:
    values = {
        ParameterId("filter", 0): 0.08,
        ParameterId("force_limit", 0): 1.7,
        ParameterId("damping", 0): 0.6,
    }
    patch = patched(user(), values)
    assert not patch.left_out
    assert 'timeconst="0.07' in patch.text  # the rest is the step between filter and force
    again = user_model(patch.text, ("joint",))
    assert again.model.actuator_forcerange[0].tolist() == [-1.7, 1.7]
    log = machine(6.0, 6, "fit")
    ours, theirs = simulated(user(), log, values), simulated(again, log, {})
    assert np.abs(ours.q - simulated(user(), log, {}).q).max() > 0.2
    np.testing.assert_allclose(ours.q[25:], theirs.q[25:], atol=8e-3)


def test_a_general_actuator_gets_a_filter_of_its_own() -> None:
    general = MJCF.replace(
        '<position name="servo" joint="joint" kp="8" kv="0.05" forcerange="-3 3"/>',
        '<general name="servo" joint="joint" gainprm="8" biastype="affine" biasprm="0 -8 -0.05"/>',
    )
    model = user_model(general, ("joint",))
    text = patched(model, {ParameterId("filter", 0): 0.05, ParameterId("force_limit", 0): 2.5}).text
    compiled = mujoco.MjSpec.from_string(text).compile()
    assert compiled.actuator_dyntype[0] == int(mujoco.mjtDyn.mjDYN_FILTEREXACT)
    assert compiled.actuator_dynprm[0, 0] == pytest.approx(0.05 - 0.001, abs=1e-4)
    assert compiled.actuator_forcelimited[0]
    own = user_model(text, ("joint",))
    assert model_with(own, {ParameterId("filter", 0): 0.02}).actuator_dynprm[0, 0] == 0.02


def test_a_filter_has_seen_what_came_before_a_run() -> None:
    """Runs that begin in the midst of a motion, against one that begins at its start."""
    log = machine(6.0, 7, "fit")
    values = {ParameterId("filter", 0): 0.1, ParameterId("delay", 0): 0.02}
    shown = simulated(user(), log, values)
    q = np.zeros_like(shown.q)
    q[:] = shown.q
    again = replace(log, q=q)
    experiment = Experiment(user(), [again], length=1.0, warm=0.3)
    assert np.abs(experiment.run(values) - experiment.measured).max() < 0.02
