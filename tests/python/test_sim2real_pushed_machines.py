"""A push that the friction of an ordinary machine, which nobody told, does not hide."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("numba", reason="pip install 'pdoik[bench]'")

from bench.machines import build
from bench.machines.spec import WorldSpec

from pdoik.sim2real import diagnose, load_study
from pdoik.sim2real.motion.prepare import prepare
from pdoik.sim2real.regression.background import background, left_on
from pdoik.sim2real.regression.fit import Fit
from pdoik.sim2real.select.contacts import contact_term


@pytest.fixture(scope="module")
def pushed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, object]]:
    folder = tmp_path_factory.mktemp("pushed") / "study"
    spec = WorldSpec(seed=9020, faults=("external_contact",), robot="random5")
    truth = build.make_study(folder, spec)
    (fault,) = truth["faults"]
    return folder / "study.yaml", fault


def test_a_push_is_found_where_and_when_it_was(pushed: tuple[Path, dict[str, object]]) -> None:
    study, fault = pushed
    (found,) = (f for f in diagnose(study).findings if f.effect == "external_contact")
    assert list(found.recordings) == fault["recordings"]
    assert found.links == ("link5",)
    assert found.window is not None
    begin, end = fault["window"]  # type: ignore[misc]
    assert begin - 0.3 < found.window[0] < found.window[1] < end + 0.3
    assert found.confidence > 0.75


def test_rows_that_say_the_same_make_no_push(pushed: tuple[Path, dict[str, object]]) -> None:
    noisy, terms = background(prepare(load_study(pushed[0])).fit)
    assert noisy.repeats > 2.0
    assert contact_term(Fit(noisy, terms)) is not None
    slower = noisy.with_noise({}, 1e3 * noisy.repeats)
    assert contact_term(Fit(slower, terms)) is None


def test_the_background_leaves_the_same_where_it_was_learnt(
    pushed: tuple[Path, dict[str, object]],
) -> None:
    noisy, terms = background(prepare(load_study(pushed[0])).fit)
    fit = Fit(noisy, terms)
    for key, left in left_on(noisy, fit).items():
        if key in fit.design:
            at = fit.rows[key]
            np.testing.assert_allclose(left[at] / noisy.sigma[key], fit.residual(key), atol=1e-6)
