"""Motions of a base that hangs, or stands on its feet, held against Pinocchio and MuJoCo alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yaml

from pdoik.recordings import Recording
from pdoik.sim2real import Diagnosis, Model, load_study
from pdoik.sim2real.propose import NothingToSettleError, Proposal, Wishes, propose
from pdoik.sim2real.study import Setup, Study
from propose_reports import one_way, write_report
from propose_reports import write_study as write_arm_study
from sim2real_floating import FEET, JOINTS, LEGS, Hidden, floating, recording, urdf, written

KP, KD = 150.0, 4.0
STAND = np.tile([0.0, 0.7, -1.3], len(LEGS))
WISHES = Wishes(seconds=6.0, effort=6, search=60.0, figures=True, acceleration=20.0)


def standing_model() -> mujoco.MjModel:
    """The robot on a floor, its feet balls, each joint a servo."""
    text = urdf().replace(
        '<robot name="tripod">',
        '<robot name="tripod"><mujoco><compiler fusestatic="false"/></mujoco>',
    )
    spec = mujoco.MjSpec.from_string(text)
    spec.option.timestep = 5e-4
    spec.body("trunk").add_freejoint()
    for geom in spec.geoms:
        geom.mass = 0.0
        geom.solref = [0.004, 1.0]
    floor = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[5.0, 5.0, 0.1])
    floor.friction = [0.7, 0.0, 0.0]
    for joint in JOINTS:
        servo = spec.add_actuator(name=joint, target=joint)
        servo.trntype, servo.biastype = mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtBias.mjBIAS_AFFINE
        servo.gainprm[0], servo.biasprm[1:3] = KP, [-KP, -KD]
    return spec.compile()


def run(
    sent: Callable[[float], np.ndarray], seconds: float, base: np.ndarray, q: np.ndarray
) -> dict[str, np.ndarray]:
    """What a run gives at 200 Hz after it has stood for a second; the lowest load of a foot."""
    model = standing_model()
    data = mujoco.MjData(model)
    at = np.array([model.joint(name).qposadr[0] for name in JOINTS])
    data.qpos[:7], data.qpos[at] = base, q
    rows: dict[str, list[np.ndarray]] = {}
    geoms = [
        [g for g in range(model.ngeom) if model.geom_bodyid[g] == model.body(f).id] for f in FEET
    ]
    force = np.zeros(6)
    for k in range(round((1.0 + seconds) / 5e-4)):
        time = k * 5e-4 - 1.0
        if k % 10 == 0:
            data.ctrl[:] = sent(max(time, 0.0))
            if time > -1e-9:
                load = np.zeros(len(FEET))
                for c in range(data.ncon):
                    mujoco.mj_contactForce(model, data, c, force)
                    load += [
                        force[0] * any(g in data.contact.geom[c] for g in own) for own in geoms
                    ]
                for name, value in (
                    ("q", data.qpos[at]),
                    ("tau", data.qfrc_actuator[at - 1]),
                    ("base", data.qpos[:7]),
                    ("q_des", data.ctrl),
                    ("load", load),
                ):
                    rows.setdefault(name, []).append(value.copy())
        mujoco.mj_step(model, data)
    return {name: np.array(values) for name, values in rows.items()}


def stood(name: str, seed: int) -> Recording:
    """It sways a little on its feet."""
    rng = np.random.default_rng(seed)
    phases = rng.uniform(0.0, 6.3, len(JOINTS))
    base = np.array([0.0, 0.0, 0.45, 1.0, 0.0, 0.0, 0.0])

    def sent(time: float) -> np.ndarray:
        return STAND + 0.03 * min(time, 1.0) * np.sin(2.0 * time + phases)

    made = run(sent, 7.0, base, STAND)
    time = 5e-3 * np.arange(len(made["q"]))
    noisy = made["tau"] + 0.05 * rng.standard_normal(made["tau"].shape)
    return Recording(
        name=name,
        role="fit",
        start=0.0,
        time=time,
        q=made["q"] + 2e-5 * rng.standard_normal(made["q"].shape),
        q_des=made["q_des"],
        tau=noisy,
        base=made["base"] + 1e-4 * rng.standard_normal(made["base"].shape),
        contact=made["load"],
        valid=np.ones(len(time), dtype=np.bool_),
        raw_period=5e-3,
        jitter=0.0,
    )


def reported(folder: Path, runs: list[Recording], **keys: object) -> Path:
    """A report of a study in files in which nothing was found."""
    (folder / "tripod.urdf").write_text(urdf())
    held = {each.name: Setup(held=each.contact is None) for each in runs}
    made = Study(
        folder=folder,
        robot=folder / "tripod.urdf",
        base=floating(),
        joints=JOINTS,
        recordings=tuple(runs),
        split="by the study",
        setups=held,
    )
    study = written(folder, made, **keys)
    report = folder / "report"
    report.mkdir()
    (report / "diagnosis.json").write_text(
        Diagnosis(verdict="no_mismatch", findings=(), joints={}).to_json()
    )
    Model.of_study(load_study(study), (), cutoff=15.0).save(report)
    return report


GAINS = {"type": "pd", "kp": [KP] * len(JOINTS), "kd": [KD] * len(JOINTS)}


@pytest.fixture(scope="module")
def hung(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a robot that hung, level, and moved its joints."""
    level = np.tile([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0], (1600, 1))
    runs = []
    for k in range(2):
        free = recording(f"run{k}", k, Hidden(), pose=True, imu=False, contact=False)
        body = pin.buildModelFromXML(urdf())
        data = body.createData()
        order = [body.joints[body.getJointId(name)].idx_v for name in JOINTS]
        dq = np.gradient(free.q, free.period, axis=0)
        ddq = np.gradient(dq, free.period, axis=0)
        tau = np.empty_like(free.q)
        for t in range(len(tau)):
            vectors = [np.zeros(body.nv) for _ in range(3)]
            for vector, values in zip(vectors, (free.q, dq, ddq), strict=True):
                vector[order] = values[t]
            tau[t] = pin.rnea(body, data, *vectors)[order]
        tau += 0.05 * np.random.default_rng(k).standard_normal(tau.shape)
        runs.append(replace(free, base=level, tau=tau))
    runs[1] = replace(runs[1], role="validate")
    return reported(tmp_path_factory.mktemp("hung"), runs, controller=GAINS)


@pytest.fixture(scope="module")
def on_feet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    runs = [stood("run0", 0), replace(stood("run1", 1), role="validate")]
    return reported(tmp_path_factory.mktemp("stood"), runs, controller=GAINS)


def gain(proposal: Proposal) -> float:
    """Mean log of how many times smaller errors are expected."""
    return float(np.mean([np.log(each.before / each.after) for each in proposal.figures]))


def test_a_hanging_robot_moves_within_limits_by_pinocchio(hung: Path) -> None:
    proposal = propose(hung, WISHES)
    body = pin.buildModelFromXML(urdf())
    data = body.createData()
    order = [body.joints[body.getJointId(name)].idx_v for name in JOINTS]
    time = np.arange(0.0, proposal.time[-1], 1e-2)
    q = proposal.at(time)
    dq = np.gradient(q, 1e-2, axis=0)
    ddq = np.gradient(dq, 1e-2, axis=0)
    assert np.abs(q).max() <= 3.0
    assert np.abs(dq).max() <= 0.7 * 30.0
    assert np.abs(ddq).max() <= 20.0 * 1.1
    tau = []
    for row in zip(q, dq, ddq, strict=True):
        vectors = [np.zeros(body.nv) for _ in range(3)]
        for vector, values in zip(vectors, row, strict=True):
            vector[order] = values
        tau.append(pin.rnea(body, data, *vectors)[order])
    inner = slice(20, -20)
    np.testing.assert_allclose(np.array(tau)[inner], proposal.torque[: len(tau)][inner], atol=0.5)
    assert any("must hang" in note for note in proposal.notes)
    assert all(each.after <= each.before for each in proposal.figures)


def test_the_proposed_motion_says_more_of_the_joints_than_a_random_one(hung: Path) -> None:
    assert gain(propose(hung, WISHES)) > gain(propose(hung, replace(WISHES, random=True)))


def test_a_standing_robot_stays_on_its_feet_in_another_simulation(on_feet: Path) -> None:
    proposal = propose(on_feet, WISHES)
    base = np.array([0.0, 0.0, 0.45, 1.0, 0.0, 0.0, 0.0])
    weight = 9.81 * float(standing_model().body_mass.sum())

    def sent(time: float) -> np.ndarray:
        return np.asarray(proposal.at(np.array([time]))[0])

    made = run(sent, 6.0, base, STAND)
    assert made["load"].min() > 0.05 * weight / len(FEET)
    assert made["base"][:, 2].min() > 0.7 * made["base"][0, 2]
    assert np.ptp(made["q"], axis=0).max() > 0.05  # it moves
    assert gain(proposal) > 0.05
    assert any("stayed up" in note for note in proposal.notes)


def test_what_cannot_be_checked_is_said(on_feet: Path, tmp_path: Path) -> None:
    runs = [stood("run0", 0), replace(stood("run1", 1), role="validate")]
    blind = reported(tmp_path, runs)
    with pytest.raises(ValueError, match="the study says no gains"):
        propose(blind, WISHES)
    flat = yaml.safe_load((tmp_path / "study.yaml").read_text())
    flat["base"]["feet"] = {foot: {"contact": "flat"} for foot in FEET}
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(flat | {"controller": GAINS}))
    with pytest.raises(ValueError, match="flat soles, whose size"):
        propose(blind, WISHES)
    with pytest.raises(NothingToSettleError, match="--figures"):
        propose(on_feet, replace(WISHES, figures=False))


def test_a_robot_that_stood_may_be_hung_up(on_feet: Path) -> None:
    proposal = propose(on_feet, replace(WISHES, base="hang", random=True))
    assert np.ptp(proposal.q, axis=0).max() > 0.2


def test_a_fixed_base_neither_hangs_nor_stands(tmp_path: Path) -> None:
    report = write_report(tmp_path, write_arm_study(tmp_path), one_way(1.0, "torque_offset"))
    with pytest.raises(ValueError, match="--base hang: the base of this robot is fixed"):
        propose(report, replace(WISHES, base="hang"))
