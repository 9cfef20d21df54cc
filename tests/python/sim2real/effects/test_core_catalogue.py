"""What holds for every effect: the shapes of its columns, and what it says in words."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from sim2real_motions import moved, pd

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
        # Ripple, a gear's waves, contact and noise are looked for otherwise; no torque is cut off,
        # and nothing known is held. Bases that float have their own test.
        "everything": len(CATALOGUE) - len(OF_FLOATING) - (8 if n == 1 else 6),
        "torque and command": 20,
        "torque only": 16,
        "commands and gains only": 16,
        "commanded torque only": 16,
        "positions only": 3,
    }[which] - 2 * (n == 1)
    assert len(seen) >= least, sorted(set(CATALOGUE) - seen)


OF_FLOATING = {each.id for each in CATALOGUE.values() if each.of_floating_base}  # test_floating
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
SCALES = (1.0, 1e3, 100.0, 180.0 / np.pi, -1.0)  # as it is, milli, percent, degrees


@pytest.mark.parametrize("effect", sorted(set(CATALOGUE) - OF_FLOATING - {"unknown"}))
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
