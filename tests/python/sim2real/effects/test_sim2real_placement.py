"""A joint that sits elsewhere: improved URDF and simulation put it where the finding says."""

from __future__ import annotations

from importlib.resources import files

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pin = pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import (  # noqa: E402
    Estimate,
    Finding,
    Model,
    export_urdf,
)

MOVED = {"dx": 0.002, "dy": 0.011, "dz": -0.004, "rx": 0.004, "ry": -0.003, "rz": 0.002}


def test_a_joint_elsewhere_is_put_there_by_urdf_and_simulation() -> None:
    text = (files("pdoik") / "robots" / "panda.urdf").read_text()
    joints = tuple(f"panda_joint{k}" for k in range(1, 8))
    estimates = {
        name: Estimate(value=v, std=0.0, interval95=(v, v), unit="-") for name, v in MOVED.items()
    }
    finding = Finding(effect="kinematic_error", joints=("panda_joint3",), parameters=estimates)
    model = Model(joints=joints, robot=text, tip="panda_link8", findings=(finding,))

    true = pin.buildModelFromXML(text)
    at = true.getJointId("panda_joint3")
    place = true.jointPlacements[at].copy()  # turned by a quarter against its parent
    place.translation += np.array([MOVED["dx"], MOVED["dy"], MOVED["dz"]])
    place.rotation = place.rotation @ pin.exp3(np.array([MOVED["rx"], MOVED["ry"], MOVED["rz"]]))
    true.jointPlacements[at] = place

    improved = pin.buildModelFromXML(export_urdf(model).text)
    stepper = model.stepper()
    for q in np.random.default_rng(0).uniform(-1.5, 0.0, (5, 7)):
        data = [each.createData() for each in (true, improved)]
        for each, state in zip((true, improved), data, strict=True):
            pin.framesForwardKinematics(each, state, q)
        tip = true.getFrameId("panda_link8")
        expected = data[0].oMf[tip].homogeneous
        assert data[1].oMf[tip].homogeneous == pytest.approx(expected, abs=1e-9)
        simulated = stepper.tip_poses(q[None])[0]
        assert simulated[:3] == pytest.approx(expected[:3, 3], abs=1e-9)
