"""Encoders' zeros, geometry, bodies, gravity, pushes: finite differences of the physics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

import pinocchio as pin

from pdoik.sim2real import Estimate
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.effects.contacts import ORIGIN
from pdoik.sim2real.motion import Balances, Motion, Place
from pdoik.sim2real.regression import Fit, term_of, to_second_order
from sim2real_columns import STEP, added, tip_change, tips, torque, torques
from sim2real_motions import moved


@pytest.mark.parametrize("j", range(3))
def test_an_encoders_zero_changes_torques_and_tip_as_a_turn_of_the_joint(
    motion: Motion, j: int
) -> None:
    unit = np.eye(3)[j]
    assert motion.body is not None
    small = torque(motion, q=motion.q + STEP * unit) - torque(motion, q=motion.q - STEP * unit)
    columns = CATALOGUE["joint_offset"].columns(motion, Place(joints=(j,)), (0.0,))
    columns = {key: column[:, 0] for key, column in columns.items()}
    assert torques(columns, 3) == pytest.approx(small / (2 * STEP), abs=1e-4)
    tip = tip_change(motion, motion.body, motion.q + STEP * unit) / STEP
    assert tips(columns) == pytest.approx(tip, abs=1e-4)
    whole = added("joint_offset", motion, Place(joints=(j,)), offset=0.3)
    expected = torque(motion, q=motion.q + 0.3 * unit) - torque(motion)
    assert torques(whole, 3) == pytest.approx(expected, abs=1e-9)
    assert tips(whole) == pytest.approx(
        tip_change(motion, motion.body, motion.q + 0.3 * unit), abs=1e-9
    )


@pytest.mark.parametrize("j", range(3))
def test_a_joint_elsewhere_changes_tip_and_torques_as_a_body_built_so(
    motion: Motion, j: int
) -> None:
    columns = CATALOGUE["kinematic_error"].columns(motion, Place(joints=(j,)), ())
    assert motion.body is not None
    for axis, unit in enumerate(STEP * np.eye(6)):
        each = {key: column[:, axis] for key, column in columns.items()}
        there, back = (motion.body.displaced(j, s * unit[:3], s * unit[3:]) for s in (1, -1))
        tip = tip_change(motion, there, motion.q) - tip_change(motion, back, motion.q)
        assert tips(each) == pytest.approx(tip / (2 * STEP), abs=1e-5)
        state = (motion.q, motion.dq, motion.ddq)
        change = there.torque(*state) - back.torque(*state)
        assert torques(each, 3) == pytest.approx(change / (2 * STEP), abs=5e-3)


@pytest.mark.parametrize("joints", [(1, 0), (0, 1), (2, 1), (1, 2)])
def test_one_motor_moving_two_joints_is_a_change_of_coordinates(
    motion: Motion, joints: tuple[int, int]
) -> None:
    k, j = joints

    def needed(ratio: float) -> np.ndarray:
        C = np.eye(3)
        C[k, j] = ratio
        return torque(motion, q=motion.q @ C.T, dq=motion.dq @ C.T, ddq=motion.ddq @ C.T) @ C

    place = Place(joints=joints)
    assert place in CATALOGUE["joint_coupling"].places([motion])
    found = added("joint_coupling", motion, place, ratio=1.0)
    difference = (needed(STEP) - needed(-STEP)) / (2 * STEP)
    # Rotors turn with their motors: nothing changes for them.
    assert torques(found, 3) == pytest.approx(difference, abs=1e-3)
    assert np.abs(motion.rotor(k)).max() > 0.1  # as much would be in it otherwise
    assert motion.body is not None
    q = motion.q.copy()
    q[:, k] += STEP * motion.q[:, j]
    assert tips(found) == pytest.approx(tip_change(motion, motion.body, q) / STEP, abs=1e-3)


@pytest.mark.parametrize("tilt", [(0.02, -0.03), (-0.15, 0.0), (0.0, 0.2)])
def test_a_tilted_base_is_gravity_turned_the_other_way(
    motion: Motion, tilt: tuple[float, float]
) -> None:
    found = added("gravity_direction", motion, Place(), tilt_x=tilt[0], tilt_y=tilt[1])
    R = Rotation.from_euler("y", tilt[1]) * Rotation.from_euler("x", tilt[0])
    assert motion.body is not None
    model = motion.body.model.copy()
    model.gravity.linear = R.inv().apply([0.0, 0.0, -9.81])
    data = model.createData()
    rows = zip(motion.q, motion.dq, motion.ddq, strict=True)
    change = np.array([pin.rnea(model, data, *row) for row in rows]) - torque(motion)
    size = max(abs(each) for each in tilt)
    left = np.abs(torques(found, 3) - change).max()
    assert left < size**2 * np.abs(change).max() / size  # to first order, and the cosine
    assert np.abs(change).max() > 0.1


@pytest.mark.parametrize("effect", ["payload", "link_inertial_error"])
def test_a_body_more_is_what_pinocchio_says_of_the_robot_with_it(
    motion: Motion, effect: str
) -> None:
    com, inertia = np.array([0.05, -0.08, 0.12]), np.diag([0.004, 0.006, 0.005])
    inertia[0, 1] = inertia[1, 0] = 0.001
    more = pin.Inertia(0.8, com, inertia)
    axes = ("ixx", "ixy", "iyy", "ixz", "iyz", "izz")
    link = 2 if effect == "payload" else 1
    if effect == "payload":
        values = {"mass": 0.8} | dict(zip(("com_x", "com_y", "com_z"), com, strict=True))
        values |= {a: inertia["xyz".index(a[1]), "xyz".index(a[2])] for a in axes}
    else:
        names = ["d_mass", *(f"d_first_moment_{a}" for a in "xyz"), *(f"d_{a}" for a in axes)]
        values = dict(zip(names, more.toDynamicParameters(), strict=True))
    found = added(effect, motion, Place(link=link), **values)
    assert motion.body is not None
    model = motion.body.model.copy()
    model.inertias[link + 1] += more
    data = model.createData()
    rows = zip(motion.q, motion.dq, motion.ddq, strict=True)
    change = np.array([pin.rnea(model, data, *row) for row in rows]) - torque(motion)
    assert torques(found, 3) == pytest.approx(change, abs=1e-9)
    assert np.abs(change).max() > 1.0


def test_a_push_is_held_by_the_torques_that_pinocchio_says(motion: Motion) -> None:
    force = np.array([4.0, -7.0, 2.5])
    assert motion.body is not None
    place = Place(link=1, recording="rec.csv", window=(3.0, 5.0))
    values = dict(zip(("force_x", "force_y", "force_z"), force, strict=True))
    found = torques(added("external_contact", motion, place, **values), 3)
    inside = (motion.time >= 3.0) & (motion.time < 5.0)
    assert not found[~inside].any()
    model = motion.body.model
    data = model.createData()
    none = pin.Force.Zero()
    expected = []
    for t in np.flatnonzero(inside):
        R = motion.body.joint_poses(motion.q[t : t + 1])[0, 1, :3, :3]
        pushed = [none, none, pin.Force(R.T @ force, np.zeros(3)), none]
        row = (motion.q[t], motion.dq[t], motion.ddq[t])
        expected.append(pin.rnea(model, data, *row, pushed) - pin.rnea(model, data, *row))
    assert found[inside] == pytest.approx(np.array(expected), abs=1e-9)
    other = Place(link=1, recording="another.csv", window=(3.0, 5.0))
    assert not torques(added("external_contact", motion, other, **values), 3).any()


def test_the_last_link_is_pushed_at_its_tip_or_at_its_origin(motion: Motion) -> None:
    assert motion.body is not None
    last = motion.body.last
    place = Place(link=last, recording=motion.recording.name, window=(-1.0, 99.0))
    force = np.array([3.0, -1.0, 2.0])
    values = dict(zip(("force_x", "force_y", "force_z"), force, strict=True))
    for shape, frame in (((), motion.tip), (ORIGIN, motion.body.links[last])):
        found = torques(added("external_contact", motion, place, shape, **values), 3)
        poses, jacobians = motion.body.poses_and_jacobians(motion.q, motion.body.frame(frame))
        assert found == pytest.approx(-np.einsum("tkn,k->tn", jacobians[:, :3], force), abs=1e-12)
        step = np.zeros_like(motion.q)
        step[:, 1] = 1e-6
        moved = motion.body.poses_and_jacobians(motion.q + step, motion.body.frame(frame))[0]
        work = (moved[:, :3, 3] - poses[:, :3, 3]) @ force / 1e-6  # virtual, of joint 2
        assert found[:, 1] == pytest.approx(-work, abs=1e-5)


def test_a_large_displacement_is_measured_beyond_first_order(tmp_path: Path) -> None:
    plain = moved(tmp_path, 3, tip=True)
    assert plain.body is not None
    true = {"dx": 0.01, "dy": -0.02, "dz": 0.0, "rx": 0.0, "ry": 0.08, "rz": -0.06}
    effect, place = CATALOGUE["kinematic_error"], Place(joints=(1,))
    exact = effect.exactly(plain, place, true)
    assert exact is not None
    assert plain.tip_error is not None
    error = plain.tip_error + np.hstack([exact["tip", axis] for axis in range(6)])
    balances = Balances([replace(plain, tip_error=error, torque=None)])
    term = term_of(balances, effect, place, ())
    assert term is not None
    fit = Fit(balances, [term])
    first = {
        name: Estimate(value=value, std=0.0, interval95=(value, value), unit="m")
        for name, value in effect.values((), fit.beta).items()
    }
    second = to_second_order(fit, term, first)
    off = [abs(first[name].value - value) for name, value in true.items()]
    assert max(off) > 5e-4
    for name, value in true.items():
        assert second[name].value == pytest.approx(value, abs=5e-5), name
        assert second[name].interval95[0] == pytest.approx(second[name].value)
