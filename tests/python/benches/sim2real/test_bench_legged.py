"""Worlds of robots with a floating base: their physics by Pinocchio, their logs, their answers."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from scipy.spatial.transform import Rotation

pytest.importorskip("mujoco")
pytest.importorskip("pyarrow")
pin = pytest.importorskip("pinocchio")

from bench.sim2real.legged import build  # noqa: E402
from bench.sim2real.legged.machine import Machine  # noqa: E402
from bench.sim2real.legged.robots import has_go2, robot  # noqa: E402
from bench.sim2real.legged.run import Rows  # noqa: E402
from bench.sim2real.legged.score import is_sized, score  # noqa: E402
from bench.sim2real.legged.spec import (  # noqa: E402
    HEALTHY,
    KINDS,
    Spec,
    draw,
    specs_of,
)

go2 = pytest.param("go2", marks=pytest.mark.skipif(not has_go2(), reason="no example-robot-data"))
NAMES = [go2, "h1"]
SECONDS = 2.5


@pytest.fixture(scope="module")
def healthy() -> dict[str, build.Made]:
    """A short machine of each robot with nothing hidden."""
    names = ["h1", *(["go2"] if has_go2() else [])]
    return {name: build.made(Spec(seed=3, robot=name, seconds=SECONDS)) for name in names}


def residuals(machine: Machine, rows: Rows, k: int) -> tuple[np.ndarray, float]:
    """Balance of base and joints (6 + n,) at a row by Pinocchio, and the largest force in it."""
    kind = machine.robot
    model = pin.buildModelFromUrdf(str(kind.urdf), pin.JointModelFreeFlyer())
    data = model.createData()
    joints = [model.joints[model.getJointId(name)] for name in kind.joints]
    at, dof = [j.idx_q for j in joints], [j.idx_v for j in joints]
    q, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
    base, twist, change = rows.base[k], rows.twist[k], rows.acceleration[k]
    R = Rotation.from_quat(base[3:], scalar_first=True).as_matrix()
    q[:7] = base[[0, 1, 2, 4, 5, 6, 3]]
    v[:6] = [*(R.T @ twist[:3]), *twist[3:]]
    a[:6] = [*(R.T @ change[:3] - np.cross(v[3:6], v[:3])), *change[3:]]
    q[at], v[dof], a[dof] = rows.q[k], rows.dq[k], rows.ddq[k]
    left = pin.rnea(model, data, q, v, a)
    left[dof] += kind.rotor * rows.ddq[k] - rows.tau[k]
    for i, foot in enumerate(kind.feet):
        frame, world = model.getFrameId(foot), pin.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(model, data, q, frame, world)
        left -= J.T @ np.concatenate([rows.force[k, i], rows.moment[k, i]])
    return left, float(np.abs(rows.force[k]).max())


@pytest.mark.parametrize("name", NAMES)
def test_a_healthy_machine_balances_by_pinocchio(healthy: dict[str, build.Made], name: str) -> None:
    world = healthy[name]
    for take, rows in zip(world.takes, world.rows, strict=True):
        for k in range(50, len(rows.time), 173):
            left, largest = residuals(world.machine, rows, k)
            held = take.hold is not None
            assert np.abs(left[6:] if held else left).max() < 1e-3 * max(largest, 1.0)


@pytest.mark.parametrize("name", NAMES)
def test_the_imu_says_what_the_pose_does(healthy: dict[str, build.Made], name: str) -> None:
    world = healthy[name]
    kind = world.machine.robot
    turn = Rotation.from_euler("xyz", kind.imu_rpy)
    for take, rows in zip(world.takes, world.rows, strict=True):
        if take.motion != "stand":
            continue
        dt = rows.time[1]
        body = Rotation.from_quat(rows.base[:, 3:], scalar_first=True)
        place = rows.base[:, :3] + body.apply(kind.imu_position)
        second = (place[2:] - 2.0 * place[1:-1] + place[:-2]) / dt**2 + [0.0, 0.0, 9.81]
        seen = turn.inv().apply(body[1:-1].inv().apply(second))
        assert np.sqrt(np.mean((seen - rows.acc[1:-1]) ** 2)) < 0.1
        rate = (body[:-2].inv() * body[2:]).as_rotvec() / (2.0 * dt)
        assert np.abs(turn.inv().apply(rate) - rows.gyro[1:-1]).max() < 0.02


@pytest.mark.parametrize("name", NAMES)
def test_it_stays_up_and_its_feet_carry_it(healthy: dict[str, build.Made], name: str) -> None:
    world = healthy[name]
    weight = 9.81 * sum(build.legs_of(name).model.body_mass)
    for take, rows in zip(world.takes, world.rows, strict=True):
        if take.hold is not None:
            assert not rows.contact.any()
            assert np.ptp(rows.q, axis=0).min() > 0.02
            continue
        assert np.mean(rows.contact.sum(axis=1)) == pytest.approx(weight, rel=0.05)
        assert np.ptp(rows.base[:, 2]) < 0.2
    lifted = [r for t, r in zip(world.takes, world.rows, strict=True) if t.motion == "trot"]
    assert all(np.all(np.mean(r.contact < 1.0, axis=0) > 0.1) for r in lifted)


def test_the_truth_is_elsewhere(tmp_path: Path) -> None:
    spec = Spec(seed=5, robot="h1", kind="payload", seconds=1.0)
    folder = tmp_path / "studies" / spec.name
    with pytest.raises(ValueError, match="outside"):
        build.make_study(folder, spec, folder / "truth")
    build.make_study(folder, spec, tmp_path / "truth")
    truth = json.loads((tmp_path / "truth" / f"{spec.name}.json").read_text())
    assert truth["effects"][0]["effect"] == "payload"
    text = "".join(path.read_text() for path in folder.iterdir())
    assert "payload" not in text
    study = yaml.safe_load((folder / "study.yaml").read_text())
    roles = [each["role"] for each in study["recordings"]]
    assert roles.count("fit") >= 3
    assert roles.count("validate") >= 1
    feet = study["base"]["feet"]
    for each in study["recordings"]:
        columns = list(pd.read_csv(folder / each["file"], nrows=2).columns)
        expected = ["time"]
        for channel in ("q", "dq", "tau", "q_des", "tau_cmd"):
            expected += [f"{channel}.{joint}" for joint in study["joints"]]
        expected += [f"base.{axis}" for axis in ("x", "y", "z", "qw", "qx", "qy", "qz")]
        expected += [f"{sensor}.{axis}" for sensor in ("gyro", "acc") for axis in "xyz"]
        expected += [] if each.get("base") == "held" else [f"contact.{foot}" for foot in feet]
        assert columns == expected


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_changes_what_it_says(kind: str) -> None:
    """One figure of the machine, or one of its lists; the motions stay what they were."""
    spec = Spec(seed=7, robot="h1", kind=kind, background="dense")
    before = build.background(spec)
    scene = build.Scene(
        machine=before, rng=spec.stream(kind), peaks=lambda: np.full(before.robot.n, 10.0)
    )
    machine, hidden = build.DRAWS[kind](scene)
    assert hidden.effect == kind
    assert all(np.isfinite(value) for value in hidden.parameters.values())
    old, new = before.facts(), machine.facts()
    changed = {name for name in old if old[name] != new[name]} | (
        {"loads"} if machine.loads else set()
    )
    assert 1 <= len(changed) <= 2
    assert replace(spec, kind=HEALTHY).stream("motion0").random() == spec.stream("motion0").random()


def test_a_tilted_imu_and_a_soft_foot_are_felt() -> None:
    """Against the machine without them: what the sensors say differs as the figures say."""
    spec = Spec(seed=11, robot="h1", seconds=1.0)
    told, takes = build.background(spec), build.takes_of(spec)
    stand = takes[:1]
    soft = told.at("stiffness", [0, 1], 3e4)
    tilted = replace(told, imu_tilt=np.array([0.0, 0.05, 0.0]))
    (healthy,), (sunk,), (askew,) = (build.moved(spec, m, stand, 500) for m in (told, soft, tilted))
    weight = 9.81 * float(sum(build.legs_of("h1").model.body_mass))
    depth = 0.5 * weight * (1.0 / 3e4 - 1.0 / robot("h1").stiffness)
    assert np.mean(healthy.base[:, 2] - sunk.base[:, 2]) == pytest.approx(depth, rel=0.1)
    turned = Rotation.from_rotvec([0.0, 0.05, 0.0]).inv().apply(healthy.acc)
    assert np.abs(turned - askew.acc).max() < 1e-6


def test_a_campaign_has_every_kind_and_healthy_machines() -> None:
    specs = list(specs_of(0, 88).values())
    for sort in {(s.robot, s.background) for s in specs}:
        kinds = [s.kind for s in specs if (s.robot, s.background) == sort]
        assert set(kinds) == {HEALTHY, *KINDS}
        assert kinds.count(HEALTHY) * 6 >= len(kinds)
    kinds = [draw(seed).kind for seed in range(300)]
    assert 300 / 9 < kinds.count(HEALTHY) < 300 / 4


def finding(effect: str, value: float, **place: list[str]) -> dict[str, object]:
    """As a diagnosis has it."""
    figure = {"value": value, "interval95": [0.9 * value, 1.1 * value]}
    return {
        "effect": effect,
        "joints": [],
        "links": [],
        "confidence": 0.9,
        "equivalents": [],
        "parameters": {"level": figure},
        **place,
    }


def test_scores_tell_right_from_false() -> None:
    hidden = {
        "effect": "coulomb_friction",
        "joints": ["a"],
        "links": [],
        "feet": [],
        "parameters": {"level": 1.0},
    }
    spec = {"robot": "go2", "background": "plain", "kind": "coulomb_friction", "seed": 1}
    truth = {"spec": spec, "effects": [hidden], "mass": 15.0}

    def row(*findings: dict[str, object], background: str = "plain") -> dict[str, object]:
        said = {"findings": list(findings), "verdict": "mismatch_explained"}
        world = {**truth, "spec": {**spec, "background": background}}
        return score("w", world, {"diagnosis": said, "seconds": 1.0})

    good = finding("coulomb_friction", 1.05, joints=["a"])
    other = finding("coulomb_friction", 1.05, joints=["b"])
    unsure = {**good, "confidence": 0.5}
    assert (row(good)["named"], row(good)["sized"], row(good)["false"]) == (True, True, 0)
    assert (row(other)["named"], row(other)["false"]) == (False, 1)
    assert row(other, background="dense")["false"] == 0
    assert (row(unsure)["named"], row(unsure)["suspected"]) == (False, True)
    assert not row(finding("coulomb_friction", 2.0, joints=["a"]))["sized"]
    assert row(finding("payload", 3.0, links=["x"]), background="dense")["false"] == 1


@pytest.mark.parametrize(
    ("effect", "hidden", "said"),
    [
        ("ground_slope", {"tilt_x": -0.06, "tilt_y": -0.02}, {"slope_x": 0.02, "slope_y": -0.06}),
        ("foot_softness", {"stiffness": 8000.0}, {"compliance": 1.25e-4}),
        ("foot_friction", {"friction": 0.3}, {"change": -0.5}),
    ],
)
def test_figures_are_compared_in_the_words_of_findings(
    effect: str, hidden: dict[str, float], said: dict[str, float]
) -> None:
    truth = {"effect": effect, "parameters": hidden}
    near = {"value": 0.0, "interval95": [0.0, 0.0]}
    right = {key: {"value": 1.1 * v, "interval95": [v, v]} for key, v in said.items()}
    wrong = {key: {**near, "value": -v} for key, v in said.items()}
    assert is_sized({"parameters": right}, truth)
    assert not is_sized({"parameters": wrong}, truth)
