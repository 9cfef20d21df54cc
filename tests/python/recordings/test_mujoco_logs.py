"""State logs of MuJoCo: vectors whose entries are counted by the model's addresses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from pdoik.errors import LoadError
from pdoik.recordings import Recording
from pdoik.sim2real.study import Study, load_study
from studies import write_study

mujoco = pytest.importorskip("mujoco")

MODEL = """<mujoco>
  <option timestep="0.01"/>
  <worldbody>
    <body name="box" pos="2 0 1"><freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" damping="1"/>
      <geom type="capsule" fromto="0 0 0 .4 0 0" size=".03" mass="2"/>
      <body name="lamp" pos=".2 0 0">
        <joint name="swivel" type="ball"/><geom size=".02" mass=".1" pos="0 0 -.1"/></body>
      <body name="fore" pos="0.4 0 0">
        <joint name="elbow" axis="0 1 0" damping="1"/>
        <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" mass="1"/>
        <body name="finger" pos="0.3 0 0">
          <joint name="slide" type="slide" axis="1 0 0" damping="5"/><geom size=".02" mass=".2"/>
        </body></body></body>
  </worldbody>
  <actuator>
    <motor name="m" joint="slide" gear="2"/>
    <position name="p" joint="elbow" kp="80" kv="4" gear="0.5"/>
    <velocity name="v" joint="shoulder" kv="20"/>
  </actuator>
</mujoco>
"""
JOINTS = ("elbow", "shoulder", "slide")


@pytest.fixture(scope="module")
def run() -> dict[str, np.ndarray]:
    """What a simulation of 6 s went through, as MuJoCo's users log it."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    fields = ("qpos", "qvel", "ctrl", "actuator_force", "qfrc_actuator")
    log: dict[str, list[Any]] = {name: [] for name in ("time", *fields, *JOINTS, "torque")}
    for k in range(600):
        t = k * 0.01
        data.ctrl[:] = [np.sin(4 * t), 0.3 * np.sin(3 * t), np.cos(2 * t)]
        mujoco.mj_forward(model, data)
        log["time"].append(data.time)
        for name in fields:
            log[name].append(getattr(data, name).copy())
        for joint in JOINTS:  # through MuJoCo's own access by name
            log[joint].append([data.joint(joint).qpos[0], data.joint(joint).qvel[0]])
        log["torque"].append([data.joint(joint).qfrc_actuator[0] for joint in JOINTS])
        mujoco.mj_step(model, data)
    return {name: np.array(values) for name, values in log.items()}


def study(folder: Path, file: str, model: str | None = MODEL, **keys: Any) -> Study:
    keys = {"joints": list(JOINTS), "recordings": [file]} | keys
    return load_study(write_study(folder, {}, model, **keys))


def check_run(recording: Recording, run: dict[str, np.ndarray]) -> None:
    rows = len(recording.time)
    states = np.stack([run[joint] for joint in JOINTS], axis=1)[:rows]
    assert recording.dq is not None
    assert recording.tau is not None
    assert np.allclose(recording.q, states[..., 0])
    assert np.allclose(recording.dq, states[..., 1])
    assert np.allclose(recording.tau, run["torque"][:rows])
    assert recording.tau_cmd is not None
    assert recording.q_des is not None
    assert recording.dq_des is not None
    ctrl = run["ctrl"][:rows]
    assert np.allclose(recording.tau_cmd[:, 2], 2 * ctrl[:, 0])  # a motor's gear
    assert np.allclose(recording.q_des[:, 0], ctrl[:, 1] / 0.5)  # of a length, gear times q
    assert np.allclose(recording.dq_des[:, 1], ctrl[:, 2])
    assert np.isnan(recording.q_des[:, 1:]).all()


VECTORS = ("qpos", "qvel", "ctrl", "actuator_force")


def test_vectors_of_an_npz_file_belong_to_the_models_joints(
    tmp_path: Path, run: dict[str, np.ndarray]
) -> None:
    np.savez(tmp_path / "a.npz", time=run["time"], **{name: run[name] for name in VECTORS})
    found = study(tmp_path, "a.npz")
    check_run(found.fit[0], run)
    notes = "\n".join(found.notes)
    assert "qpos[7] read as q.shoulder" in notes
    assert "qvel[6] read as dq.shoulder" in notes


def test_vectors_of_an_hdf5_file_belong_to_the_models_joints(
    tmp_path: Path, run: dict[str, np.ndarray]
) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name in ("time", "qpos", "qvel", "ctrl", "qfrc_actuator"):
            file[f"run/{name}"] = run[name]
    check_run(study(tmp_path, "a.h5").fit[0], run)


def test_columns_of_a_csv_file_belong_to_the_models_joints(
    tmp_path: Path, run: dict[str, np.ndarray]
) -> None:
    table = pd.DataFrame({"time": run["time"]})
    for name in VECTORS:
        for k in range(run[name].shape[1]):
            table[f"{name}_{k}"] = run[name][:, k]
    table.to_csv(tmp_path / "a.csv", index=False)
    check_run(study(tmp_path, "a.csv").fit[0], run)


def test_two_vectors_of_torques_ask_which_is_meant(
    tmp_path: Path, run: dict[str, np.ndarray]
) -> None:
    arrays = {name: run[name] for name in (*VECTORS, "qfrc_actuator")}
    np.savez(tmp_path / "a.npz", time=run["time"], **arrays)
    with pytest.raises(LoadError, match=r"'actuator_force.0.' and 'qfrc_actuator.11.' may both"):
        study(tmp_path, "a.npz")
    for vector in ("qfrc_actuator", "actuator_force"):
        columns = {"tau": f"{vector}[{{index}}]"}
        check_run(study(tmp_path, "a.npz", columns=columns).fit[0], run)


def test_vectors_of_another_model_are_not_guessed(
    tmp_path: Path, run: dict[str, np.ndarray]
) -> None:
    np.savez(tmp_path / "a.npz", time=run["time"], qpos=run["qpos"][:, :-1])
    with pytest.raises(LoadError, match=r"expected a column 'q.elbow'.*qpos.* 13 numbers"):
        study(tmp_path, "a.npz")
