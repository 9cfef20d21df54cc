"""What each effect adds to the balances, against the physics that it stands for."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

import pinocchio as pin

from pdoik.sim2real.effects import CATALOGUE, Place
from pdoik.sim2real.effects.backlash import swing
from pdoik.sim2real.effects.presliding_hysteresis import bristle
from pdoik.sim2real.effects.unknown import VARIABLES, hats
from pdoik.sim2real.motion import Motion, motion_of
from pdoik.sim2real.rigid_body import RigidBody
from pdoik.sim2real.signals import derivative, shifted
from sim2real_motions import CUTOFF, INSIDE, PERIOD, moved, pd, recording, wave, write_arm

STEP = 1e-4


@pytest.fixture(scope="module")
def motion(tmp_path_factory: pytest.TempPathFactory) -> Motion:
    """Three joints, every channel."""
    folder = tmp_path_factory.mktemp("arm")
    return moved(folder, 3, tip=True, controller=pd(3), seconds=10.0)


def place_of(effect: str, motion: Motion, j: int = 1) -> Place:
    """A place in the middle of the arm."""
    places = CATALOGUE[effect].places([motion])
    return next(
        (p for p in places if p.joints[:1] == (j,) or p.link == j), places[-1] if places else None
    )


def added(
    effect: str, motion: Motion, place: Place, shape: tuple[float, ...] = (), **values: float
):  # type: ignore[no-untyped-def]
    """What an effect with these parameters adds to each balance, (T,) by key."""
    shape, beta = CATALOGUE[effect].coefficients(values, shape)
    columns = CATALOGUE[effect].columns(motion, place, shape)
    return {key: column @ beta for key, column in columns.items()}


def torque(motion: Motion, **changes: np.ndarray) -> np.ndarray:
    """Of the rigid body along the motion with other positions, speeds or accelerations."""
    state = {"q": motion.q, "dq": motion.dq, "ddq": motion.ddq} | changes
    assert motion.body is not None
    return motion.body.torque(**state)


def torques(columns: dict[Any, np.ndarray], n: int) -> np.ndarray:
    """Of all joints, (T, n)."""
    return np.stack([columns["torque", j] for j in range(n)], axis=1)


def tips(columns: dict[Any, np.ndarray]) -> np.ndarray:
    """All six axes, (T, 6)."""
    return np.stack([columns["tip", axis] for axis in range(6)], axis=1)


def tip_change(motion: Motion, body: RigidBody, q: np.ndarray) -> np.ndarray:
    """From the tip's pose along the motion to that of another body or motion, (T, 6)."""
    assert motion.body is not None
    here, _ = motion.body.poses_and_jacobians(motion.q, motion.body.frame("tool"))
    there, _ = body.poses_and_jacobians(q, body.frame("tool"))
    turned = Rotation.from_matrix(there[:, :3, :3] @ np.transpose(here[:, :3, :3], (0, 2, 1)))
    return np.hstack([there[:, :3, 3] - here[:, :3, 3], turned.as_rotvec()])


# Every effect


CHANNELS: dict[str, dict[str, Any]] = {
    "everything": {"tip": True, "controller": True},
    "torque and command": {"q_des": None, "dq_des": None},
    "torque only": {"dq": None, "tau_cmd": None, "q_des": None, "dq_des": None},
    "commands and gains only": {"tau": None, "tau_cmd": None, "dq": None, "controller": True},
    "commanded torque only": {"tau": None, "q_des": None, "dq_des": None},
    "positions only": {"tau": None, "tau_cmd": None, "dq": None, "dq_des": None},
}


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("which", CHANNELS)
def test_columns_are_finite_one_per_coefficient_and_of_balances_that_exist(
    tmp_path: Path, n: int, which: str
) -> None:
    options = dict(CHANNELS[which])
    if options.pop("controller", False):
        options["controller"] = pd(n)
    m = moved(tmp_path, n, seconds=6.0, **options)
    seen = set()
    for effect in CATALOGUE.values():
        for place in effect.places([m]):
            for shape in effect.shapes([m], place):
                columns = effect.columns(m, place, shape)
                seen |= {effect.id} if columns else set()
                widths = {column.shape[1] for column in columns.values()}
                assert len(widths) <= 1
                for (balance, channel), column in columns.items():
                    assert balance in ("torque", "drive", "law", "velocity", "tip", "servo")
                    assert 0 <= channel < (6 if balance == "tip" else n)
                    assert column.shape == (len(m.time), *widths)
                    assert np.isfinite(column).all(), (effect.id, place, shape)
                    if effect.fixed:
                        assert widths == {1}
                    assert effect.prior(*widths).shape == (*widths,)
                    assert (effect.bounds[0] <= effect.bounds[1]).all()
                assert len(effect.shape_bounds(shape)) == len(shape)
                assert all(low <= high for low, high in effect.shape_bounds(shape))
    least = {
        "everything": len(CATALOGUE) - (4 if n == 1 else 2),  # ripple and contact are looked for
        "torque and command": 20,
        "torque only": 16,
        "commands and gains only": 16,
        "commanded torque only": 16,
        "positions only": 3,
    }[which] - 2 * (n == 1)
    assert len(seen) >= least, sorted(set(CATALOGUE) - seen)


NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
SCALES = (1.0, 1e3, 100.0, 180.0 / np.pi, -1.0)  # as it is, milli, percent, degrees


@pytest.mark.parametrize("effect", sorted(set(CATALOGUE) - {"unknown"}))
@pytest.mark.parametrize("size", [0.0123, 0.234])
def test_the_statement_has_the_place_and_the_main_figure_in_it(effect: str, size: float) -> None:
    values = {p.name: size * (1 + 0.3 * i) for i, p in enumerate(CATALOGUE[effect].parameters)}
    values |= {"side": 1.0} if effect == "position_dependent_spring" else {}
    said = CATALOGUE[effect].statement("Joint seven", values)
    assert effect == "gravity_direction" or "Joint seven" in said
    numbers = np.array([float(each) for each in NUMBER.findall(said)])
    first = next(iter(values.values()))
    if effect == "external_contact":
        first = float(np.linalg.norm(list(values.values())))
    if effect == "kinematic_error":
        first = float(np.linalg.norm(list(values.values())[:3]))
    assert any(np.any(np.abs(numbers - s * first) < 0.04 * abs(s * first)) for s in SCALES), said
    assert CATALOGUE[effect].regime("Joint seven")


# Friction, drives and springs: the equation


def _fade(m: Motion, j: int, speed: float) -> np.ndarray:
    return np.exp(-((m.dq[:, j] / speed) ** 2))


def _sign(m: Motion, j: int) -> np.ndarray:
    return np.sign(m.dq[:, j])


Law = Callable[[Motion, int], np.ndarray]
LAWS: dict[str, tuple[dict[str, float], tuple[float, ...], Law]] = {
    "viscous_friction": ({"coefficient": 0.7}, (), lambda m, j: 0.7 * m.dq[:, j]),
    "coulomb_friction": ({"level": 1.3}, (), lambda m, j: 1.3 * _sign(m, j)),
    "stribeck_friction": (
        {"extra": 0.8, "speed": 0.2},
        (),
        lambda m, j: 0.8 * _sign(m, j) * _fade(m, j, 0.2),
    ),
    "asymmetric_friction": (
        {"level_difference": 0.6, "viscous_difference": -0.4},
        (),
        lambda m, j: 0.5 * (0.6 - 0.4 * np.abs(m.dq[:, j])),
    ),
    "load_dependent_friction": (
        {"coefficient": 0.12},
        (),
        lambda m, j: 0.12 * np.abs(torque(m)[:, j]) * _sign(m, j),
    ),
    "friction_drift": (
        {"extra": 0.9, "time_constant": 4.0},
        (),
        lambda m, j: 0.9 * np.exp(-m.time / 4.0) * _sign(m, j),
    ),
    "rotor_inertia": ({"inertia": 0.21}, (), lambda m, j: 0.21 * m.ddq[:, j]),
    "torque_offset": ({"offset": -0.5}, (), lambda m, j: np.full(len(m.time), -0.5)),
    "torque_gain": ({"gain": 1.2}, (), lambda m, j: 0.2 * m.tau[:, j]),
    "torque_ripple": (
        {"amplitude": 0.3, "phase": 0.7, "harmonic": 12.0},
        (),
        lambda m, j: 0.3 * np.cos(12.0 * m.q[:, j] + 0.7),
    ),
    "position_dependent_spring": (
        {"stiffness": 5.0, "onset": 0.4, "side": -1.0},
        (),
        lambda m, j: 5.0 * np.minimum(m.q[:, j] - 0.4, 0.0),
    ),
}


@pytest.mark.parametrize("effect", LAWS)
@pytest.mark.parametrize("j", range(3))
def test_an_effect_with_its_parameters_is_its_equation(motion: Motion, effect: str, j: int) -> None:
    values, shape, law = LAWS[effect]
    columns = added(effect, motion, Place(joints=(j,)), shape, **values)
    assert set(columns) == {("torque", j)}
    moving = np.abs(motion.dq[:, j]) > 0.02
    assert moving.mean() > 0.8
    assert columns["torque", j][moving] == pytest.approx(law(motion, j)[moving], abs=1e-9)


@pytest.mark.parametrize(("side", "kept"), [(0.0, 1.0), (1.0, 0.5), (-1.0, 0.5)])
def test_a_spring_pulls_towards_its_onset_on_its_side_only(
    motion: Motion, side: float, kept: float
) -> None:
    onset = float(np.median(motion.q[:, 1]))
    values = {"stiffness": 3.0, "onset": onset, "side": side}
    pull = added("position_dependent_spring", motion, Place(joints=(1,)), **values)["torque", 1]
    stretch = motion.q[:, 1] - onset
    acts = np.abs(pull) > 1e-12
    assert acts.mean() == pytest.approx(kept, abs=0.01)
    assert pull[acts] == pytest.approx(3.0 * stretch[acts], abs=1e-9)


@pytest.mark.parametrize("displacement", [0.004, 0.03, 0.3])
def test_dahls_state_is_the_solution_of_its_differential_equation(displacement: float) -> None:
    def rate(t: float, z: np.ndarray) -> np.ndarray:
        speed = wave(np.array([t]), 1, 1)[0, 0]
        return speed / displacement * (1.0 - z * np.sign(speed))

    time = 0.0005 * np.arange(8001)
    found = bristle(wave(time, 1)[:, 0], displacement)
    exact = solve_ivp(rate, (0, 4), [0.0], t_eval=time, max_step=2e-3, rtol=1e-9, atol=1e-9).y[0]
    assert found == pytest.approx(exact, abs=5e-3)
    assert np.abs(found).max() <= 1.0
    assert np.abs(exact).max() > 0.5


def test_dahls_state_does_not_depend_on_how_fast_the_path_is_run() -> None:
    q = wave(np.linspace(0, 5, 4001), 1)[:, 0]
    slower = np.interp(np.linspace(0, 1, 12001), np.linspace(0, 1, 4001), q)
    assert bristle(slower, 0.05)[::3] == pytest.approx(bristle(q, 0.05), abs=2e-3)


def test_saturation_is_what_is_missing_beyond_the_level(motion: Motion) -> None:
    assert motion.torque is not None
    assert motion.command is not None
    assert motion.law is not None
    sources = {
        (0.0, "torque"): motion.torque,
        (1.0, "drive"): motion.command,
        (2.0, "law"): motion.law,
    }
    for (kind, balance), asked in sources.items():
        level = float(np.quantile(np.abs(asked[:, 1]), 0.8))
        part = added("torque_saturation", motion, Place(joints=(1,)), (kind, level), level=level)
        given = np.clip(asked[:, 1], -level, level)
        # A drive gives less than it is told; a report that is clipped tells less than is given.
        sign = 1.0 if balance == "torque" else -1.0
        assert part[balance, 1] == pytest.approx(sign * (asked[:, 1] - given), abs=1e-12)
        assert np.mean(part[balance, 1] != 0.0) == pytest.approx(0.2, abs=0.01)


# Delays


def test_a_late_command_is_the_command_of_a_moment_ago(motion: Motion) -> None:
    d, controller = 0.0137, motion.controller
    assert controller is not None
    late_q, late_dq = (
        wave(motion.time + 0.01 - d, 3, k) - wave(motion.time + 0.01, 3, k) for k in (0, 1)
    )
    expected = controller.kp * late_q + controller.kd * late_dq
    for j in range(3):
        found = added("command_delay", motion, Place(joints=(j,)), (0.0, d), delay=d)
        assert set(found) == {("law", j)}
        assert found["law", j][INSIDE] == pytest.approx(expected[INSIDE, j], abs=5e-3)
        assert np.abs(expected).max() > 0.5
        assert motion.command is not None
        told = motion.command[:, j]
        found = added("command_delay", motion, Place(joints=(j,)), (1.0, d), delay=d)
        assert found["drive", j] == pytest.approx(shifted(told, d, PERIOD) - told, abs=1e-12)


def test_a_lagging_drive_satisfies_its_differential_equation(motion: Motion) -> None:
    T, place = 0.05, Place(joints=(2,))
    assert motion.command is not None
    told = motion.command[:, 2]
    change = added("actuator_lag", motion, place, (1.0, T), time_constant=T)["drive", 2]
    exerted = told + change
    left = T * derivative(exerted, PERIOD) + exerted - told
    assert np.abs(left[INSIDE]).max() < 2e-3 * np.abs(change).max()
    assert np.abs(change).max() > 0.1


def test_a_late_log_of_torque_or_speed_is_the_torque_or_speed_of_a_moment_ago(
    motion: Motion,
) -> None:
    assert motion.body is not None
    s = -0.021
    then = [wave(motion.time - s, 3, k) for k in range(3)]
    before = motion.body.dynamics(*then).tau - motion.tau
    found = added("timestamp_skew", motion, Place(joints=(1,)), (0.0, s), skew=s)
    assert found["torque", 1][INSIDE] == pytest.approx(before[INSIDE, 1], abs=2e-2)
    assert np.abs(before).max() > 0.5
    found = added("timestamp_skew", motion, Place(joints=(1,)), (1.0, s), skew=s)
    late = then[1][:, 1] - motion.dq[:, 1]
    assert found["velocity", 1][INSIDE] == pytest.approx(late[INSIDE], abs=2e-3)
    assert motion.controller is not None
    assert found["law", 1] == pytest.approx(motion.controller.kd[1] * found["velocity", 1])


# Encoders, geometry, bodies: finite differences of the physics


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


def test_a_position_that_reads_too_much_is_a_motion_that_was_smaller(motion: Motion) -> None:
    assert motion.body is not None

    def needed(b: float) -> np.ndarray:
        scale = np.array([1.0, 1.0 + b, 1.0])
        return torque(motion, q=motion.q * scale, dq=motion.dq * scale, ddq=motion.ddq * scale)

    columns = CATALOGUE["sensor_gain"].columns(motion, Place(joints=(1,)), (1.0,))
    columns = {key: column[:, 0] for key, column in columns.items()}
    difference = (needed(STEP) - needed(-STEP)) / (2 * STEP)
    assert torques(columns, 3) == pytest.approx(difference, abs=1e-3)
    q = motion.q * np.array([1.0, 1.0 + STEP, 1.0])
    assert tips(columns) == pytest.approx(tip_change(motion, motion.body, q) / STEP, abs=1e-3)
    found = added("sensor_gain", motion, Place(joints=(1,)), (1.0,), gain=1.25)
    assert found["velocity", 1] == pytest.approx((1 / 1.25 - 1) * motion.dq[:, 1])


def test_a_speed_that_reads_too_much_shows_in_speed_and_in_the_controllers_law(
    tmp_path: Path,
) -> None:
    right = moved(tmp_path, 2, controller=pd(2))
    speed = right.recording.dq
    assert speed is not None
    wrong = moved(tmp_path, 2, controller=pd(2), dq=speed * [1.0, 1.4])
    assert wrong.law is not None
    assert right.law is not None
    found = added("sensor_gain", right, Place(joints=(1,)), (0.0,), gain=1.4)
    assert found["velocity", 1][INSIDE] == pytest.approx(0.4 * speed[INSIDE, 1], abs=1e-3)
    by_law = (right.law - wrong.law)[INSIDE, 1]  # given less law: what the law lacks
    assert found["law", 1][INSIDE] == pytest.approx(by_law, abs=1e-2)


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


# Springs and play between motor and link


def test_a_link_that_lags_changes_torques_to_first_order_as_a_motion_that_lags(
    motion: Motion,
) -> None:
    omega = 2 * np.pi * 0.8
    lag = [1e-3 * omega**k * np.sin(omega * motion.time + k * np.pi / 2) for k in range(3)]
    found = motion.by_deflection(lag[0], 1)
    state = {name: getattr(motion, name).copy() for name in ("q", "dq", "ddq")}
    for values, each in zip(state.values(), lag, strict=True):
        values[:, 1] -= each
    expected = torque(motion, **state) - torque(motion)
    size = np.abs(expected).max()
    assert found[INSIDE] == pytest.approx(expected[INSIDE], abs=0.01 * size)
    assert size > 1e-3


def test_an_elastic_joints_tip_gives_by_load_over_stiffness(motion: Motion) -> None:
    stiffness = 4000.0
    found = added("joint_elasticity", motion, Place(joints=(1,)), stiffness=stiffness, damping=0.0)
    load = motion.transmitted(1)
    assert load is not None
    assert motion.body is not None
    q = motion.q.copy()
    q[:, 1] -= load / stiffness
    assert tips(found) == pytest.approx(tip_change(motion, motion.body, q), abs=2e-5)
    assert np.abs(tips(found)).max() > 5e-4


FLANK = 2 * np.pi * 30.0  # as the module has it: the link's natural frequency on a flank [rad/s]


@pytest.mark.parametrize("gap", [0.002, 0.02])
@pytest.mark.parametrize("load", [3.0, -0.4])
def test_under_constant_load_a_link_rests_on_the_flank_that_carries_it(
    gap: float, load: float
) -> None:
    inertia = 0.25
    lag = swing(np.full((1500, 1), load), np.array([inertia]), PERIOD, np.array([gap]))[:, 0]
    rest = np.sign(load) * gap / 2 + load / inertia / FLANK**2
    assert lag[-1] == pytest.approx(rest, rel=1e-4)
    assert np.abs(lag[200:] - rest).max() < 1e-3 * gap


@pytest.mark.parametrize("period", [0.002, 0.004, 0.008])
@pytest.mark.parametrize("seed", range(3))
def test_a_link_stays_within_its_play_but_for_what_the_flanks_give(
    period: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    time = period * np.arange(round(12.0 / period))
    phase = rng.uniform(0, 6, (3, 1, 4))
    load = sum(np.sin(w * time[:, None] + p) for w, p in zip((1.3, 3.1, 5.7), phase, strict=True))
    inertia = np.array([0.05, 0.1, 0.5, 2.0])
    gap = np.array([0.03, 0.01, 0.004, 0.001])
    lag = swing(load, inertia, period, gap)
    rate = np.abs(load / inertia).max(axis=0)
    # A link that crosses the play hits the flank at speed sqrt(2 a gap): the damper stops it.
    give = rate / FLANK**2 + np.sqrt(2 * rate * gap) / FLANK
    assert (np.abs(lag).max(axis=0) < gap / 2 + give).all()
    assert (np.abs(lag).max(axis=0) > gap / 2).all()
    assert (lag.min(axis=0) < -0.4 * gap).all()  # it does go to both sides
    assert (lag.max(axis=0) > 0.4 * gap).all()
    alone = swing(load[:, 2:3], inertia[2:3], period, gap[2:3])
    assert lag[:, 2] == pytest.approx(alone[:, 0], abs=1e-15)


def test_the_flight_through_the_play_is_the_differential_equations() -> None:
    gap, inertia = 0.2, 1.0
    time = PERIOD * np.arange(400)
    load = np.where(time < 0.2, 1.0, -1.0)[:, None]
    lag = swing(load, np.array([inertia]), PERIOD, np.array([gap]))[:, 0]
    start = np.argmax(load < 0) * PERIOD - PERIOD / 2
    flying = (time > start + 0.05) & (time < start + 0.5)
    fall = gap / 2 - 0.5 * (time[flying] - start) ** 2
    assert lag[flying] == pytest.approx(fall, abs=2e-3)


def test_play_of_a_joint_shows_at_the_tip_as_the_lag_of_its_link(motion: Motion) -> None:
    found = added("backlash", motion, Place(joints=(1,)), gap=0.011)
    assert motion.tip_jacobian is not None
    J = motion.tip_jacobian[:, :3, 1]
    lag = -np.sum(tips(found)[:, :3] * J, axis=1) / np.sum(J**2, axis=1)
    load = torque(motion)[:, 1]
    inertia = float(np.median(motion.mass_matrix[:, 1, 1]))
    loaded = np.abs(load) > 0.5 * np.abs(load).max()
    loaded[:50] = False  # it begins on the flank without leaning on it
    assert loaded.mean() > 0.3
    lean = np.sign(load) * 0.0055 + load / inertia / FLANK**2  # the flank gives a little
    assert lag[loaded] == pytest.approx(lean[loaded], abs=3e-4)


# What has no name


def test_hats_add_up_to_one_and_carry_any_straight_line() -> None:
    x = np.linspace(-1.0, 2.0, 301)
    columns = hats(x, -1.0, 2.0, 9)
    assert columns.sum(axis=1) == pytest.approx(1.0)
    knots = np.linspace(-1.0, 2.0, 9)
    assert columns @ (3.0 * knots - 1.0) == pytest.approx(3.0 * x - 1.0)
    assert hats(knots, -1.0, 2.0, 9) == pytest.approx(np.eye(9), abs=1e-12)
    outside = hats(np.array([-5.0, 9.0]), -1.0, 2.0, 9)  # held beyond the ends
    assert outside == pytest.approx(np.eye(9)[[0, 8]])


@pytest.mark.parametrize("name", [v for v in VARIABLES if v not in ("clock",)])
def test_an_unnamed_torque_is_a_function_of_its_variable_alone(motion: Motion, name: str) -> None:
    j, i = 1, 2
    place = Place(joints=(j, i) if name.startswith("other") else (j,))
    code = float(VARIABLES.index(name))
    shape = next(s for s in CATALOGUE["unknown"].shapes([motion], place) if s[0] == code)
    columns = CATALOGUE["unknown"].columns(motion, place, shape)
    assert set(columns) == {("torque", j)}
    truth = {
        "position": 2.0 + 0.5 * motion.q[:, j],
        "speed": 0.3 * motion.dq[:, j],
        "load": 0.1 * motion.tau[:, j],
        "time": 0.2 * motion.time - 1.0,
        "position and speed": 0.7 * np.sign(motion.dq[:, j]) + 0.1 * motion.dq[:, j],
        "other position": motion.q[:, i],
        "other speed": motion.dq[:, i] - 0.2,
    }[name]
    inside = (motion.time > 0.2) & (motion.time < 9.8)
    beta = np.linalg.lstsq(columns["torque", j][inside], truth[inside], rcond=None)[0]
    left = columns["torque", j][inside] @ beta - truth[inside]
    assert np.std(left) < 0.05 * np.std(truth)


# Motion


def test_a_motion_has_the_derivatives_of_its_positions_and_the_torques_of_its_body(
    motion: Motion,
) -> None:
    assert motion.body is not None
    for values, order, off in ((motion.q, 0, 1e-5), (motion.dq, 1, 1e-4), (motion.ddq, 2, 5e-3)):
        assert values[INSIDE] == pytest.approx(wave(motion.time, 3, order)[INSIDE], abs=off)
    assert motion.torque is not None
    assert motion.tau[INSIDE] == pytest.approx(motion.torque[INSIDE], abs=5e-3)
    assert motion.tip_error is not None
    assert motion.tip_error[INSIDE] == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize(
    ("missing", "source"),
    [
        ((), "tau"),
        (("tau",), "tau_cmd"),
        (("tau", "tau_cmd"), "law"),
        (("tau", "tau_cmd", "q_des"), ""),
    ],
)
def test_torque_is_what_was_measured_else_what_was_commanded_else_the_law(
    tmp_path: Path, missing: tuple[str, ...], source: str
) -> None:
    m = moved(tmp_path, 2, controller=pd(2), **dict.fromkeys(missing))
    assert m.source == source
    assert (m.torque is None) == (source == "")


def test_the_law_is_that_of_a_controller_with_gravity_limits_and_a_period(tmp_path: Path) -> None:
    names = ("j1", "j2")
    body = RigidBody(write_arm(tmp_path, 2), names, None)
    run = recording(body, 2)
    limit = np.array([1e9, 2.0])
    controller = pd(2, torque_limit=limit, period=0.008)
    m = motion_of(run, body, controller, CUTOFF, np.full(2, 1e-14))
    now = run.time - 0.004  # what is held over a period comes half of it late
    q, dq, q_des, dq_des = (wave(now + ahead, 2, k) for ahead in (0.0, 0.01) for k in (0, 1))
    asked = controller.kp * (q_des - q) + controller.kd * (dq_des - dq) + body.gravity(q)
    assert m.law is not None
    assert m.law[INSIDE] == pytest.approx(np.clip(asked, -limit, limit)[INSIDE], abs=1e-9)
    assert np.mean(np.abs(m.law[:, 1]) >= 2.0) > 0.01
