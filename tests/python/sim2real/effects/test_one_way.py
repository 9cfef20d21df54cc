"""Friction that differs between the directions: of levels and slopes, or of levels alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.motion import Place, prepare
from sim2real_channels import study

EFFECT = CATALOGUE["asymmetric_friction"]


def test_levels_alone_are_the_first_of_both_and_cannot_be_moved(tmp_path: Path) -> None:
    (motion,) = prepare(study(tmp_path, (0.0,) * 3, (1.0,) * 3)).fit.motions
    place = Place(joints=(1,))
    both, level = EFFECT.shapes([motion], place)
    whole, alone = (EFFECT.columns(motion, place, shape)["torque", 1] for shape in (both, level))
    assert whole.shape[1] == 2
    assert np.array_equal(alone, whole[:, :1])
    assert EFFECT.free(level) == EFFECT.free(both) == []


@pytest.mark.parametrize("values", [{"level_difference": 0.4}, dict(EFFECT.example.values)])
def test_figures_go_round(values: dict[str, float]) -> None:
    shape, beta = EFFECT.coefficients(values)
    found = EFFECT.values(shape, beta)
    assert found == {name: values[name] for name in found}
    assert len(found) == len(beta)
    assert ("per rad/s" in EFFECT.statement("joint1", found)) == (len(found) == 2)
