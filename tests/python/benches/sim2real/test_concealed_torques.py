"""The worlds' torques against Pinocchio and the catalogue's equations, written out once more."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")

import pinocchio as pin
from scipy import signal

from concealed_judge import BOTH_SIDES, STEP, Judge, made, rms


@pytest.mark.parametrize("name", ["panda", "ur10", "h1_arm", "random3", "random7"])
def test_clean_torques_are_pinocchios_to_the_noise_floor(tmp_path: Path, name: str) -> None:
    judge, _ = made(tmp_path / "a", effect="clean", robot=name)
    for file in judge.files:
        motion, residual = judge.residual(file)
        assert np.all(rms(residual) < 0.4 * judge.noise)
        assert np.all(rms(motion["ddq"]) > 0.1)  # it did move


@pytest.mark.parametrize("seed", [3, 4, 5, 6])
def test_coulomb_friction_is_half_the_gap_between_directions(tmp_path: Path, seed: int) -> None:
    judge, truth = made(tmp_path / "a", effect="coulomb_friction", robot="random4", seed=seed)
    joint, level = judge.index(truth), truth.effects[0]["parameters"]["level"]
    forwards, backwards = [], []
    for file in judge.files:
        motion, residual = judge.residual(file)
        speed = motion["dq"][:, joint]
        steady = np.abs(motion["ddq"][:, joint]) < 1.0
        forwards.append(residual[(speed > 0.1) & steady, joint])
        backwards.append(residual[(speed < -0.1) & steady, joint])
    gap = np.median(np.concatenate(forwards)) - np.median(np.concatenate(backwards))
    assert gap == pytest.approx(2.0 * level, rel=0.04)


def extra_torque(effect: str, p: dict, motion: dict, joint: int, judge: Judge) -> np.ndarray:
    """The catalogue's equation for one joint, written out once more."""
    t, q, v, a, tau = (motion[key] for key in ("time", "q", "dq", "ddq", "tau"))
    t, q, v, a, tau = t, q[:, joint], v[:, joint], a[:, joint], tau[:, joint]
    side = np.sign(v)
    if effect == "viscous_friction":
        return p["coefficient"] * v
    if effect == "asymmetric_friction":
        return 0.5 * (p["level_difference"] * np.abs(side) + p["viscous_difference"] * np.abs(v))
    if effect == "friction_drift":
        return p["extra"] * np.exp(-t / p["time_constant"]) * side
    if effect == "coulomb_friction":
        return p["level"] * side
    if effect == "rotor_inertia":
        return p["inertia"] * a
    if effect == "torque_ripple":
        return p["amplitude"] * np.cos(p["harmonic"] * q + p["phase"])
    if effect == "position_dependent_spring":
        way = q - p["onset"]
        return p["stiffness"] * np.where((p["side"] == 0) | (p["side"] * way > 0), way, 0.0)
    if effect == "torque_gain":
        return tau * (1.0 - 1.0 / p["gain"])
    if effect == "torque_offset":
        return np.full_like(q, p["offset"])
    if effect == "load_dependent_friction":
        load = tau / (1.0 + p["coefficient"] * side * np.sign(tau)) - judge.armature[joint] * a
        return p["coefficient"] * np.abs(load) * side
    raise AssertionError(effect)


@pytest.mark.parametrize(
    "effect",
    [
        "viscous_friction",
        "asymmetric_friction",
        "friction_drift",
        "rotor_inertia",
        "torque_ripple",
        "position_dependent_spring",
        "torque_gain",
        "torque_offset",
        "load_dependent_friction",
    ],
)
def test_torques_obey_the_equation_with_the_truths_parameters(tmp_path: Path, effect: str) -> None:
    judge, truth = made(tmp_path / "a", effect=effect, robot="random3", seed=9)
    joint = judge.index(truth)
    for file in judge.files:
        motion, residual = judge.residual(file)
        model = sum(
            extra_torque(entry["effect"], entry["parameters"], motion, joint, judge)
            for entry in truth.effects
        )
        low_pass = signal.butter(3, BOTH_SIDES, fs=1.0 / STEP, output="sos")
        moving = np.abs(motion["dq"][:, joint]) > 0.05  # sign(dq) is another thing near rest
        before = residual[moving, joint]
        after = before - signal.sosfiltfilt(low_pass, model)[moving]
        assert np.std(before) + abs(np.mean(before)) > 2.0 * judge.noise[joint]
        assert np.median(np.abs(after)) < 0.3 * judge.noise[joint]


def test_a_push_is_a_force_on_the_link_in_its_window(tmp_path: Path) -> None:
    judge, truth = made(tmp_path / "a", effect="external_contact", robot="random5", size=20.0)
    push = truth.effects[0]
    (file,), (low, high) = push["recordings"], push["window"]
    motion, residual = judge.residual(file)
    inside = (motion["time"] > low + 0.4) & (motion["time"] < high - 0.4)
    outside = (motion["time"] < low - 0.4) | (motion["time"] > high + 0.4)
    name = "tool" if push["kind"] == "tip" else push["links"][0]
    force = np.array([push["parameters"][f"force_{axis}"] for axis in "xyz"])
    data, frame, expected = judge.model.createData(), judge.model.getFrameId(name), []
    for q in motion["q"][inside]:
        J = pin.computeFrameJacobian(judge.model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        expected.append(-J[:3].T @ force)
    assert np.all(rms(residual[outside]) < 0.5 * judge.noise)
    assert np.max(rms(residual[inside]) / judge.noise) > 5.0
    assert np.all(rms(residual[inside] - expected) < 0.8 * judge.noise)


def test_stribeck_friction_is_more_at_creeping_speed(tmp_path: Path) -> None:
    judge, truth = made(
        tmp_path / "a", effect="stribeck_friction", robot="random3", hide="corner", size=20.0
    )
    joint = judge.index(truth)
    stribeck, coulomb = (entry["parameters"] for entry in truth.effects)
    ratios = []
    for file in judge.files:
        motion, residual = judge.residual(file)
        speed = motion["dq"][:, joint]
        some = (np.abs(speed) > 0.02) & (np.abs(motion["ddq"][:, joint]) < 0.05)
        level = coulomb["level"] + stribeck["extra"] * np.exp(
            -((speed[some] / stribeck["speed"]) ** 2)
        )
        ratios.append(residual[some, joint] * np.sign(speed[some]) / level)
    assert np.median(np.concatenate(ratios)) == pytest.approx(1.0, abs=0.05)


def test_a_payload_is_the_body_the_truth_says(tmp_path: Path) -> None:
    judge, truth = made(tmp_path / "a", effect="payload", robot="panda")
    p = truth.effects[0]["parameters"]
    body = pin.Inertia(
        p["mass"],
        np.array([p["com_x"], p["com_y"], p["com_z"]]),
        np.diag([p["ixx"], p["iyy"], p["izz"]]),
    )
    loaded = judge.model.copy()
    loaded.inertias[7] = loaded.inertias[7] + body
    file = judge.files[0]
    assert np.max(rms(judge.residual(file)[1]) / judge.noise) > 3.0
    assert np.all(rms(judge.residual(file, loaded)[1]) < 0.4 * judge.noise)


def test_a_tilted_base_is_gravity_turned_as_the_truth_says(tmp_path: Path) -> None:
    judge, truth = made(tmp_path / "a", effect="gravity_direction", robot="iiwa14")
    p = truth.effects[0]["parameters"]
    R = pin.rpy.rpyToMatrix(p["tilt_x"], 0.0, 0.0) @ pin.rpy.rpyToMatrix(0.0, p["tilt_y"], 0.0)
    tilted = judge.model.copy()
    tilted.gravity.linear = R.T @ np.array([0.0, 0.0, -9.81])
    file = judge.files[0]
    assert np.max(rms(judge.residual(file)[1]) / judge.noise) > 3.0
    assert np.all(rms(judge.residual(file, tilted)[1]) < 0.4 * judge.noise)


def test_a_wrong_link_is_the_difference_the_truth_says(tmp_path: Path) -> None:
    judge, truth = made(tmp_path / "a", effect="link_inertial_error", robot="random5")
    p, k = truth.effects[0]["parameters"], int(truth.effects[0]["links"][0][4:])
    true = judge.model.copy()
    vector = true.inertias[k].toDynamicParameters()  # m, m c, Ixx Ixy Iyy Ixz Iyz Izz at origin
    keys = ["d_mass", *(f"d_first_moment_{a}" for a in "xyz")]
    keys += [f"d_i{a}" for a in ("xx", "xy", "yy", "xz", "yz", "zz")]
    vector = vector + np.array([p[key] for key in keys])
    true.inertias[k] = pin.Inertia.FromDynamicParameters(vector)
    file = judge.files[0]
    assert np.max(rms(judge.residual(file)[1]) / judge.noise) > 3.0
    assert np.all(rms(judge.residual(file, true)[1]) < 0.4 * judge.noise)
