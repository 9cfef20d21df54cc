"""Balances of a robot whose base floats, against MuJoCo and finite differences."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.motion import Balances, Place, directions_of, prepare
from pdoik.sim2real.study import Setup, Study
from sim2real_floating import FEET, JOINTS, Hidden, recording, study

QUIET = 1e-6


def _left(balances: Balances) -> dict[tuple[str, int], float]:
    """Residuals in their noise, by balance."""
    return {
        key: balances.rms(key) / balances.sigma[key]
        for key in balances.keys
        if key[0] in ("torque", "base") and balances.mask[key].any()
    }


def test_what_mujoco_says_of_a_sound_machine_balances_to_its_noise(tmp_path: Path) -> None:
    balances = prepare(study(tmp_path, Hidden())).fit
    left = _left(balances)
    assert {("base", axis) for axis in range(6)} <= set(left)
    assert max(left.values()) < 1.3


def test_without_an_imu_the_pose_tells_of_the_base(tmp_path: Path) -> None:
    by_pose = prepare(_noiseless(tmp_path, Hidden(), runs=1, imu=False)).fit.motions[0].base
    by_imu = prepare(_noiseless(tmp_path, Hidden(), runs=1)).fit.motions[0].base
    assert by_pose is not None
    assert by_imu is not None
    assert by_imu.of_imu
    assert not by_pose.of_imu
    inner = slice(100, -100)
    assert np.abs((by_pose.omega - by_imu.omega)[inner]).max() < 0.01  # of up to 2 rad/s
    assert np.abs((by_pose.force - by_imu.force)[inner]).max() < 0.05  # of up to 15 m/s^2


def test_without_sensors_in_the_feet_less_is_judged_and_rightly(tmp_path: Path) -> None:
    with_ = prepare(study(tmp_path, Hidden(), runs=1)).fit
    without = prepare(study(tmp_path, Hidden(), runs=1, contact=False)).fit
    assert max(_left(without).values()) < 1.3
    judged = [sum(int(b.mask[k].sum()) for k in _left(b)) for b in (with_, without)]
    assert judged[1] <= judged[0]


def test_a_held_base_leaves_the_joints(tmp_path: Path) -> None:
    made = study(tmp_path, Hidden(), contact=False, runs=1)
    held = replace(made, setups={name: Setup(held=True) for name in made.setups})
    balances = prepare(held).fit
    assert not any(balances.mask["base", axis].any() for axis in range(6))
    # No sensor in the feet and a stand: they are in the air, so their forces are a mismatch.
    assert max(_left(balances).values()) > 3.0


def test_unknown_forces_are_taken_off_and_nothing_else() -> None:
    rng = np.random.default_rng(3)
    forces = rng.standard_normal((20, 9, 4))
    forces[10:, :, 2:] = 0.0  # two that do not act
    known = np.ones((20, 9), dtype=bool)
    known[5:, 3] = False
    usual = np.array([1e3, 1e3, 1e2, 1e2])
    for sigma in (rng.uniform(0.1, 3.0, 9), 10.0 ** np.linspace(-5.0, 1.0, 9)):
        found = directions_of(forces, usual, known, sigma)
        left = found.left() / sigma[:, None] * sigma
        white = np.where(known[:, :, None], forces / sigma[:, None], 0.0)
        assert np.abs(left @ white).max() < 1e-9 * np.abs(white).max()
        assert np.abs(left @ left - left).max() < 1e-10
        rank = np.trace(left, axis1=1, axis2=2)
        assert rank[:5] == pytest.approx(5.0, abs=1e-9)
        assert rank[5:10] == pytest.approx(4.0, abs=1e-9)
        assert rank[10:] == pytest.approx(6.0, abs=1e-9)
        # What is left, weighted, is what least squares leave that fit the forces at every sample.
        torque = rng.standard_normal(9)
        sizes, rest, *_ = np.linalg.lstsq(white[0], torque / sigma, rcond=None)
        assert np.sum((found.left()[0] @ torque / sigma) ** 2) == pytest.approx(rest[0], rel=1e-6)
        every = np.tile(torque, (20, 1))
        assert found.sizes(every)[0] == pytest.approx(sizes, rel=1e-3)
        likely = np.vstack([white[15], np.diag(1.0 / usual)])
        told = np.concatenate([np.where(known[15], torque / sigma, 0.0), np.zeros(4)])
        assert found.sizes(every)[15] == pytest.approx(np.linalg.lstsq(likely, told)[0], rel=1e-6)


def test_a_force_that_nothing_tells_is_none() -> None:
    """Two feet press against one another; no row feels it but by rounding."""
    forces = np.array([[[1.0, -1.0 + 1e-12], [2.0, -2.0], [0.5, -0.5]]])
    found = directions_of(forces, np.full(2, 100.0), np.ones((1, 3), dtype=bool), np.ones(3))
    assert np.abs(found.sizes(np.array([[1.0, 2.0, 0.7]]))).max() < 1.0


def test_rows_of_very_different_noise_hide_no_force(tmp_path: Path) -> None:
    """A log without noise, of a robot whose joints rest: its feet carry what they carry."""
    made = _noiseless(tmp_path, Hidden(), runs=1, contact=False)
    motion = prepare(made).fit.motions[0]
    sigma = 10.0 ** np.linspace(-5.0, 1.0, motion.rows)
    forces = np.concatenate([foot.wrench for foot in motion.feet], axis=2)
    known = np.ones((len(motion.time), motion.rows), dtype=bool)
    known[:, : motion.n - 2] = False
    carried = np.einsum("trk,k->tr", forces, np.linspace(-80.0, 120.0, forces.shape[2]))
    left = directions_of(forces, np.full(forces.shape[2], 100.0), known, sigma).left()
    assert np.abs(np.einsum("trs,ts->tr", left, carried) / sigma).max() < 3e-3
    assert np.abs(carried / sigma).max() > 1e6


@pytest.mark.parametrize(
    ("effect", "place", "shape", "hidden", "beta"),
    [
        ("payload", Place(link=len(JOINTS)), (), Hidden(payload=0.5), None),
        ("imu_offset", Place(), (), Hidden(acc=(0.05, -0.1, 0.08)), [0.05, -0.1, 0.08, 0, 0, 0]),
        ("imu_tilt", Place(), (), Hidden(tilt=(0.005, -0.01, 0.003)), [0.005, -0.01, 0.003]),
        ("joint_offset", Place(joints=(4,)), (0.02,), Hidden(offset={4: 0.02}), [0.02]),
        ("coulomb_friction", Place(joints=(2,)), (0.01,), Hidden(friction={2: 0.4}), [0.4]),
        ("rotor_inertia", Place(joints=(2,)), (), Hidden(rotor={2: 0.02}), [0.02]),
        ("torque_gain", Place(joints=(2,)), (0.0,), Hidden(gain={2: 1.02}), [0.02]),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_columns_are_what_is_hidden_in_a_recording(
    tmp_path: Path,
    effect: str,
    place: Place,
    shape: tuple[float, ...],
    hidden: Hidden,
    beta: object,
) -> None:
    balances = prepare(_noiseless(tmp_path, hidden, 1)).fit
    if beta is None:
        point = {"mass": 0.5, "com_x": 0.1, "com_y": 0.0, "com_z": 0.1}
        none = dict.fromkeys(("ixx", "ixy", "iyy", "ixz", "iyz", "izz"), 0.0)
        beta = CATALOGUE[effect].coefficients(point | none)[1]
    columns = balances.columns(CATALOGUE[effect], place, shape)
    assert any(key[0] == "base" for key in columns)
    sizes = np.sqrt(np.mean(balances.motions[0].tau ** 2, axis=0))
    for key, column in columns.items():
        mask = balances.mask[key]
        if key[0] not in ("torque", "base") or not mask.any():
            continue
        there, said = balances.residual[key][mask], (column @ np.asarray(beta))[mask]
        size = sizes[key[1] + len(JOINTS) * (key[0] == "base")]
        error, whole = np.sqrt(np.mean((there - said) ** 2)), np.sqrt(np.mean(there**2))
        assert error < 0.06 * whole + 5e-3 * size, key


def test_every_effect_has_columns_of_balances_that_exist(tmp_path: Path) -> None:
    motions = prepare(study(tmp_path, Hidden(), runs=1)).fit.motions
    (motion,) = motions
    known = {("torque", j) for j in range(len(JOINTS))}
    known |= {(balance, axis) for balance in ("base", "imu") for axis in range(6)}
    known |= {(balance, k) for balance in ("foot", "grip") for k in range(len(FEET))}
    seen = set()
    for effect in CATALOGUE.values():
        for place in effect.places(motions):
            for shape in effect.shapes(motions, place)[:1]:
                columns = effect.columns(motion, place, shape)
                assert set(columns) <= known, effect.id
                widths = {column.shape[1] for column in columns.values()}
                for column in columns.values():
                    assert column.shape == (len(motion.time), *widths)
                    assert np.isfinite(column).all(), effect.id
                if columns:
                    seen.add(effect.id)
                    assert effect.prior(*widths).shape == (*widths,)
    ground = {"ground_height", "ground_slope", "foot_softness", "foot_friction"}
    assert seen >= {"imu_tilt", "imu_offset", "payload", "coulomb_friction", *ground}
    assert "gravity_direction" not in seen


def test_friction_is_of_the_one_foot_that_slips_and_of_all_where_two_do(tmp_path: Path) -> None:
    (motion,) = prepare(study(tmp_path, Hidden(), runs=1)).fit.motions
    friction, never = CATALOGUE["foot_friction"], np.zeros(len(motion.time), dtype=np.bool_)
    assert len(motion.feet) >= 2
    for slipping, places in ((0, []), (1, [0]), (2, [None, 0, 1])):
        feet = tuple(
            replace(foot, grip=np.zeros(len(never)), slips=never | (k < slipping))
            for k, foot in enumerate(motion.feet)
        )
        found = friction.places([replace(motion, feet=feet)])
        assert [place.foot for place in found] == places


def test_what_presses_a_foot_is_what_mujoco_says(tmp_path: Path) -> None:
    (motion,) = prepare(_noiseless(tmp_path, Hidden(), 1)).fit.motions
    for foot in motion.feet:
        assert foot.force is not None
        assert foot.pressed is not None
        inner = slice(100, -100)
        size = np.linalg.norm(foot.force, axis=1)[inner]
        apart = np.abs(size - foot.pressed[inner])  # a stretched leg feels no force along it
        assert np.quantile(apart, 0.95) < 0.005 * foot.pressed.max()


def _noiseless(folder: Path, hidden: Hidden, runs: int, **kept: bool) -> Study:
    made = study(folder, hidden, runs=runs, **kept)
    plain = [
        replace(recording(each.name, k, hidden, noise=QUIET, **kept), role=each.role)
        for k, each in enumerate(made.recordings)
    ]
    return replace(made, recordings=tuple(plain))
