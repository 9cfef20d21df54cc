"""Studies of robots whose base floats, as users write them, and what they forget."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.errors import LoadError
from pdoik.sim2real import Watch
from pdoik.sim2real.model import Model, predict
from pdoik.sim2real.study import load_study
from sim2real_floating import FEET, IMU_PLACE, IMU_TURN, JOINTS, RADIUS, Hidden, study, written

BASE = {"feet": list(FEET)}


def _study(folder: Path, **kept: bool) -> Callable[..., Path]:
    made = study(folder, Hidden(), runs=1, seconds=3.0, **kept)
    return lambda **keys: written(folder, made, **keys)


def test_a_study_in_files_is_the_one_made_in_python(tmp_path: Path) -> None:
    made = study(tmp_path, Hidden(), runs=1, seconds=3.0)
    read = load_study(written(tmp_path, made))
    assert read.joints == JOINTS
    assert read.base is not None
    assert read.base.link == "trunk"
    assert np.allclose(read.base.imu_position, IMU_PLACE)
    assert np.allclose(read.base.imu_rotation, IMU_TURN.as_matrix())
    assert [(foot.link, foot.sole, foot.flat) for foot in read.base.feet] == [
        (foot, RADIUS, False) for foot in FEET
    ]
    for one, other in zip(read.recordings, made.recordings, strict=True):
        for channel in ("base", "gyro", "acc", "contact"):
            said, given = getattr(one, channel), getattr(other, channel)
            if channel == "base":
                given = given.copy()
                given[:, 3:] /= np.linalg.norm(given[:, 3:], axis=1, keepdims=True)
            assert np.allclose(said, given, atol=1e-9), channel


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"base": {"feet": ["a_toe"]}}, "no link 'a_toe'"),
        ({"base": {"feet": {"a_foot": {"contact": "round"}}}}, "expected point or flat"),
        ({"base": {"link": "a_hip"}}, "expected 'trunk'"),
        ({"base": {"imu": {"position": [0, 0]}}}, "imu: position has 2 entries"),
        ({"base": {"ground": {"friction": -1}}}, "at least 0"),
        ({"base": {"hands": []}}, "unknown key 'hands'"),
        ({"base": BASE, "robot": None}, "base: expected a robot"),
    ],
)
def test_a_base_that_cannot_be_is_refused(
    tmp_path: Path, keys: dict[str, object], said: str
) -> None:
    with pytest.raises(LoadError, match=said):
        load_study(_study(tmp_path)(**keys))


def test_a_base_of_which_nothing_tells_is_asked_for(tmp_path: Path) -> None:
    with pytest.raises(LoadError, match=r"nothing tells how it moved; record gyro\.x"):
        load_study(_study(tmp_path, imu=False, pose=False)())


def test_half_a_pose_is_none(tmp_path: Path) -> None:
    path = _study(tmp_path)()
    log = tmp_path / "run0.csv"
    log.write_text(log.read_text().replace("base.qx", "quaternion_x", 1))
    with pytest.raises(LoadError, match=r"missing: base\.qx"):
        load_study(path)


def test_a_free_joint_needs_a_base(tmp_path: Path) -> None:
    path = _study(tmp_path)(base=None)
    robot = tmp_path / "tripod.urdf"
    free = (
        '<link name="world"/><joint name="root" type="floating"><parent link="world"/>'
        '<child link="trunk"/></joint></robot>'
    )
    robot.write_text(robot.read_text().replace("</robot>", free))
    with pytest.raises(LoadError, match="say 'base:' in the study and record how it moved"):
        load_study(path)


def test_a_held_base_is_told_and_needs_the_key(tmp_path: Path) -> None:
    made = study(tmp_path, Hidden(), runs=1, seconds=3.0, imu=False, pose=False)
    held = [
        {"file": f"{each.name}.csv", "role": each.role, "base": "held"} for each in made.recordings
    ]
    read = load_study(written(tmp_path, made, recordings=held))
    assert all(read.setup_of(each).held for each in read.recordings)
    with pytest.raises(LoadError, match="expected 'base:' in the study first"):
        load_study(written(tmp_path, made, recordings=held, base=None))


def test_what_cannot_be_run_yet_says_so(tmp_path: Path) -> None:
    made = study(tmp_path, Hidden(), runs=1, seconds=3.0)
    model = Model.from_json(Model.of_study(made).to_json())
    assert model.base == "trunk"
    for wanted in (
        model.stepper,
        model.simulator,
        lambda: predict(model, made.recordings[0]),
        lambda: Watch(model),
    ):
        with pytest.raises(ValueError, match=r"the base of this model, link 'trunk', floats"):
            wanted()
