"""Torque that has no name: a function of one variable, made of hats."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE, VARIABLES, hats
from pdoik.sim2real.motion import Motion, Place


def test_hats_add_up_to_one_and_carry_any_straight_line() -> None:
    x = np.linspace(-1.0, 2.0, 301)
    columns = hats(x, -1.0, 2.0, 9)
    assert columns.sum(axis=1) == pytest.approx(1.0)
    knots = np.linspace(-1.0, 2.0, 9)
    assert columns @ (3.0 * knots - 1.0) == pytest.approx(3.0 * x - 1.0)
    assert hats(knots, -1.0, 2.0, 9) == pytest.approx(np.eye(9), abs=1e-12)
    beyond = np.array([-5.0, -1.5, 2.5, 9.0])  # lines go on for a quarter of the range
    line = 3.0 * np.clip(beyond, -1.75, 2.75) - 1.0
    assert hats(beyond, -1.0, 2.0, 9) @ (3.0 * knots - 1.0) == pytest.approx(line)


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
        "other load": 0.1 * motion.tau[:, i],
        "other position and speed": (1.0 + 0.3 * motion.q[:, i]) * np.sign(motion.dq[:, j]),
        "fine position": np.cos(20.0 * motion.q[:, j]),
        "fine position and speed": np.cos(8.0 * motion.q[:, j]) * motion.dq[:, j],
    }[name]
    inside = (motion.time > 0.2) & (motion.time < 9.8)
    beta = np.linalg.lstsq(columns["torque", j][inside], truth[inside], rcond=None)[0]
    left = columns["torque", j][inside] @ beta - truth[inside]
    assert np.std(left) < 0.05 * np.std(truth)
