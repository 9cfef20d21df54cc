"""How flat soles are inclined while they stand, against Pinocchio."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pin = pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[bench]'")

from bench.sim2real.legged import build  # noqa: E402
from bench.sim2real.legged.spec import Spec  # noqa: E402
from pdoik.sim2real import load_study  # noqa: E402
from pdoik.sim2real.effects import CATALOGUE  # noqa: E402
from pdoik.sim2real.motion import (  # noqa: E402
    Motion,
    Place,
    Prepared,
    prepare,
    with_ground,
)
from pdoik.sim2real.regression import Fit, term_of  # noqa: E402

INNER = slice(200, -200, 150)  # samples that are looked at


@pytest.fixture(scope="module")
def inclined(tmp_path_factory: pytest.TempPathFactory) -> tuple[Prepared, dict[str, float]]:
    """An H1 that stands on a slope, and which."""
    folder = tmp_path_factory.mktemp("inclined")
    spec = Spec(seed=22, robot="h1", kind="ground_slope", seconds=3.0)
    build.make_study(folder / "study", spec, folder / "truth")
    (effect,) = json.loads((folder / "truth" / "study.json").read_text())["effects"]
    return prepare(load_study(folder / "study" / "study.yaml")), effect["parameters"]


def standing(prepared: Prepared) -> Motion:
    return next(m for m in prepared.fit.motions if m.base is not None and not m.setup.held)


def by_pinocchio(prepared: Prepared, motion: Motion, q: np.ndarray, at: int) -> np.ndarray:
    """Rise of every sole along the world's x and y at a sample, (feet, 2)."""
    assert motion.base is not None
    assert motion.base.rotation is not None
    model = pin.buildModelFromUrdf(
        str(prepared.study.folder / "robot.urdf"), pin.JointModelFreeFlyer()
    )
    data, full = model.createData(), pin.neutral(model)
    for j, name in enumerate(prepared.study.joints):
        full[model.joints[model.getJointId(name)].idx_q] = q[at, j]
    pin.framesForwardKinematics(model, data, full)
    found = []
    for foot in motion.feet:
        turn = data.oMf[model.getFrameId(foot.foot.link)].rotation
        normal = motion.base.rotation[at] @ turn[:, 2]
        found.append(-normal[:2] / normal[2])
    return np.array(found)


def test_soles_are_inclined_as_pinocchio_has_them(
    inclined: tuple[Prepared, dict[str, float]],
) -> None:
    prepared, _ = inclined
    motion = standing(prepared)
    for at in range(len(motion.time))[INNER]:
        mine = [foot.tilt[at] for foot in motion.feet if foot.tilt is not None]
        assert np.array(mine) == pytest.approx(by_pinocchio(prepared, motion, motion.q, at))


def test_a_joints_zero_tilts_soles_by_finite_differences(
    inclined: tuple[Prepared, dict[str, float]],
) -> None:
    prepared, _ = inclined
    motion, step = standing(prepared), 1e-6
    for j in range(motion.n):
        moved = motion.q.copy()
        moved[:, j] += step
        columns = motion.soles_by_joint(j)
        for at in range(len(motion.time))[INNER]:
            before = by_pinocchio(prepared, motion, motion.q, at)
            change = (by_pinocchio(prepared, motion, moved, at) - before) / step
            for k in range(len(motion.feet)):
                said = [columns["tilt", 2 * k + axis][at, 0] for axis in range(2)]
                assert said == pytest.approx(-change[k], abs=1e-5)


def test_a_slope_is_told_though_both_feet_stand_at_one_height(
    inclined: tuple[Prepared, dict[str, float]],
) -> None:
    """Feet side by side say nothing of a slope ahead by their heights; by how they lie, they do."""
    prepared, hidden = inclined
    b = prepared.fit
    assert any(key[0] == "tilt" and b.mask[key].any() for key in b.keys)
    slope = term_of(b, CATALOGUE["ground_slope"], Place(), ())
    assert slope is not None
    along_x, along_y, _ = Fit(b, [slope]).beta
    assert along_x == pytest.approx(-np.tan(hidden["tilt_y"]), abs=3e-3)
    assert along_y == pytest.approx(np.tan(hidden["tilt_x"]), abs=8e-3)


def test_a_sole_that_rocks_says_nothing(inclined: tuple[Prepared, dict[str, float]]) -> None:
    prepared, _ = inclined
    motion = standing(prepared)
    assert motion.base is not None
    assert motion.base.rotation is not None
    swing = 0.03 * np.sin(2.0 * np.pi * motion.time)
    about_x = np.tile(np.eye(3), (len(swing), 1, 1))
    about_x[:, 1, 1] = about_x[:, 2, 2] = np.cos(swing)
    about_x[:, 2, 1], about_x[:, 1, 2] = np.sin(swing), -np.sin(swing)
    base = replace(motion.base, rotation=about_x @ motion.base.rotation)
    assert prepared.study.base is not None
    limits = prepared.study.thresholds
    rocking = with_ground(
        replace(motion, base=base), prepared.study.base.ground, limits.noise, limits.feet
    )
    for k, foot in enumerate(rocking.feet):
        assert foot.stands.any()
        assert not foot.judged(("tilt", 2 * k + 1)).any()
        assert foot.judged(("tilt", 2 * k)).any()
