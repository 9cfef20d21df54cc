"""Channels that lie, and machines that only seem to have such."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Study, prepare
from pdoik.sim2real.channels.check_channels import check_channels
from pdoik.sim2real.motion.rigid_body import RigidBody
from sim2real_motions import PERIOD, recording, wave, write_arm

SECONDS = 20.0
JOINTS = ("j1", "j2", "j3")


def study(folder: Path, rotor: tuple[float, ...], factor: tuple[float, ...]) -> Study:
    """An arm with rotors and dry friction that its description does not tell of."""
    robot = write_arm(folder, 3)
    body = RigidBody(robot, JOINTS, None)
    time = PERIOD * np.arange(round(SECONDS / PERIOD))
    q, dq, ddq = (wave(time, 3, order) for order in range(3))
    tau = body.dynamics(q, dq, ddq).tau + np.array(rotor) * ddq + 1.5 * np.tanh(dq / 0.01)
    tau = tau + 0.02 * np.random.default_rng(0).standard_normal(tau.shape)
    alone = {"tau_cmd": None, "q_des": None, "dq_des": None}
    logged = recording(body, 3, SECONDS, tau=tau * np.array(factor), **alone)
    return Study(
        folder=folder, robot=robot, joints=JOINTS, recordings=(logged,), split="by the test"
    )


def test_rotors_that_nobody_told_of_are_no_factor_of_a_channel(tmp_path: Path) -> None:
    check = check_channels(prepare(study(tmp_path, (6.0, 4.0, 2.0), (1.0, 1.0, 1.0))))
    assert check.findings == ()
    assert not check.mended


@pytest.mark.parametrize("factor", [-1.0, 1000.0, 0.01, 9.81])
def test_a_wrong_sign_or_unit_is_found_beside_rotors_that_nobody_told_of(
    tmp_path: Path, factor: float
) -> None:
    check = check_channels(prepare(study(tmp_path, (0.6, 0.4, 0.2), (1.0, factor, 1.0))))
    (finding,) = check.findings
    assert (finding.effect, finding.joints) == ("sensor_gain", ("j2",))
    # A load that nobody told of could take a part of it: sign and order of size are what is sure.
    assert 0.6 < finding.values["gain"] / factor < 1.6
    assert check.mended
