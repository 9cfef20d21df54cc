"""Forces and moments on an H1's flat soles, from its torques alone, are MuJoCo's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.legged.build import make_study
from bench.sim2real.legged.spec import Spec
from pdoik.sim2real import load_study
from pdoik.sim2real.motion import prepare, zero_phase

INSIDE = slice(100, -100)
PITCHES = (2, 3, 4)  # hip, knee and ankle of a leg; hips that roll and yaw hardly move here


def test_what_presses_a_flat_sole_follows_from_the_torques(tmp_path: Path) -> None:
    folder = tmp_path / "study"
    world = make_study(folder, Spec(seed=3, robot="h1", seconds=4.0))
    motion, rows = prepare(load_study(folder / "study.yaml")).fit.motions[0], world.rows[0]
    assert motion.base is not None
    R = motion.base.rotation
    assert R is not None
    at = np.searchsorted(rows.time, motion.time[INSIDE])
    wrench = np.concatenate([rows.force, rows.moment], axis=2)[at]  # on each, in the world's axes
    weight = float(np.mean(wrench[:, :, 2].sum(axis=1)))
    total = np.zeros((len(at), 3))
    for k, foot in enumerate(motion.feet):
        assert foot.foot.flat
        assert foot.load is not None
        force, moment = (
            np.einsum("tij,tj->ti", R[INSIDE], foot.load[INSIDE, part])
            for part in (slice(0, 3), slice(3, 6))
        )
        true = zero_phase(wrench[:, k], motion.cutoff, motion.period)
        total += force - true[:, :3]
        moves = ~motion.still[INSIDE][:, [5 * k + i for i in PITCHES]].any(axis=1)
        assert moves.mean() > 0.3  # of joints at rest nothing is known, so of their forces neither
        error = np.hstack([force, moment])[moves] - true[moves]
        x, _, z, _, about_y, _ = np.sqrt(np.mean(error**2, axis=0)) / weight
        assert x < 0.02
        assert z < 0.1
        assert about_y < 0.005  # [m]: where on the sole it presses
    assert (np.sqrt(np.mean(total**2, axis=0)) < 0.01 * weight).all()
