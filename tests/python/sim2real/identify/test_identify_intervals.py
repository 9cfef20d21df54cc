"""Whether intervals of the posterior hold the truth as often as they say, on a real arm's rows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify import Posterior, anomalous, estimates
from pdoik.sim2real.motion import Balances, Place
from pdoik.sim2real.regression import term_of
from sim2real_identified import BODIES
from sim2real_motions import moved

TRUE = {"coefficient": 0.7, "offset": -0.4, "stiffness": 2.0, "onset": 0.5}
NOISE = 0.6  # of each sample's torque [N m]
DAY = 0.1  # share by which friction is another one each day
DRAWS = 40


def repeated(folder: Path, colour: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, half widths and whether the truth is inside, (draws, parameters)."""
    motion = moved(folder, 2, seconds=30.0, tau_cmd=None, q_des=None, dq_des=None)
    joint, spring = Place(joints=(1,)), CATALOGUE["position_dependent_spring"]
    truth = motion.tau.copy()
    truth[:, 1] += TRUE["offset"]
    truth[:, 1] += TRUE["stiffness"] * np.maximum(motion.q[:, 1] - TRUE["onset"], 0.0)
    values, halves, inside = [], [], []
    for draw in range(DRAWS):
        rng = np.random.default_rng(draw)
        noise = rng.standard_normal(truth.shape)
        if colour:  # first-order, forgotten within a block
            for t in range(1, len(noise)):
                noise[t] = colour * noise[t - 1] + np.sqrt(1 - colour**2) * noise[t]
        torque = truth + NOISE * noise
        torque[:, 1] += (1.0 + DAY * rng.standard_normal()) * TRUE["coefficient"] * motion.dq[:, 1]
        b = Balances([replace(motion, torque=torque, cache={})])
        posterior = Posterior.of(b)
        beside = posterior.fit_of(posterior.begun(BODIES).model)
        term = term_of(b, spring, joint, (1.0, 0.45))
        assert term is not None
        moved_on = posterior.reshaped(beside, anomalous(b, term))
        fit = posterior.fit_of(posterior.begun(BODIES, [moved_on]).model)
        row = []
        for effect, names in (
            ("viscous_friction", ("coefficient",)),
            ("torque_offset", ("offset",)),
            (spring.id, ("stiffness", "onset")),
        ):
            (own,) = (t for t in fit.terms if t.effect == effect and t.place == joint)
            found = estimates(fit, (own,), draw)[0]
            row += [found[name] for name in names]
        values.append([e.value for e in row])
        halves.append([0.5 * (e.interval95[1] - e.interval95[0]) for e in row])
        inside.append(
            [e.interval95[0] <= TRUE[n] <= e.interval95[1] for n, e in zip(TRUE, row, strict=True)]
        )
    return np.array(values), np.array(halves), np.array(inside)


@pytest.mark.parametrize("colour", [pytest.param(0.0, marks=pytest.mark.long), 0.95])
def test_intervals_hold_the_truth_about_as_often_as_they_say(tmp_path: Path, colour: float) -> None:
    values, halves, inside = repeated(tmp_path, colour)
    assert inside.mean(axis=0) == pytest.approx(0.925, abs=0.0751)  # 85 to 100 %
    assert inside.mean() > 0.88
    spread = values.std(axis=0)
    # Neither a lucky centre nor a useless width.
    off = np.abs(values.mean(axis=0) - list(TRUE.values()))
    assert off == pytest.approx(0.0, abs=3.5 * spread.max() / np.sqrt(DRAWS))
    ratio = np.median(halves, axis=0) / (1.96 * spread)
    assert (ratio > 0.7).all()
    assert (ratio < 2.5).all()  # the arm's model is right; it might have been a little off
