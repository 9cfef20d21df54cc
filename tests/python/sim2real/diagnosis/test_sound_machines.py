"""What ordinary machines are not to be told: limits that hums reach, one-way friction, springs."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("numba", reason="pip install 'pdoik[bench]'")

from bench.sim2real.machines import build
from bench.sim2real.machines.background import in_background
from bench.sim2real.machines.plan import WorldSpec
from pdoik.sim2real import diagnose, load_study
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.effects.drives import OF_REPORTED, is_cut
from pdoik.sim2real.identify import identify
from pdoik.sim2real.motion import Balances, Place, Prepared, prepare
from pdoik.sim2real.regression import Fit, Term, background, friction_at, term_of
from sim2real_identified import named

ONE_WAY = CATALOGUE["asymmetric_friction"]
SPRING = CATALOGUE["position_dependent_spring"]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """A sound machine of four joints, and the truth of it."""
    folder = tmp_path_factory.mktemp("machine") / "study"
    truth = build.make_study(folder, WorldSpec(seed=20018, faults=(), robot="random4"))
    return folder / "study.yaml", truth


@pytest.fixture(scope="module")
def machine(made: tuple[Path, dict[str, Any]]) -> Prepared:
    return prepare(load_study(made[0]))


def term(balances: Balances, effect: str, j: int, shape: tuple[float, ...] = ()) -> Term:
    made = term_of(balances, CATALOGUE[effect], Place(joints=(j,)), shape)
    assert made is not None
    return made


def with_torque(balances: Balances, part: Term, *sizes: float) -> Balances:
    """As if the machine had this, too."""
    other = Balances(balances.motions, balances.thresholds)
    for key, column in part.columns.items():
        other.residual[key] = balances.residual[key] + column @ np.array(sizes)
    return other


def test_a_sound_machine_is_told_nothing_that_it_has_not(
    made: tuple[Path, dict[str, Any]],
) -> None:
    study, truth = made
    findings = json.loads(diagnose(study).to_json())["findings"]
    assert len(findings) > 5
    assert [each["effect"] for each in findings if not in_background(each, truth)[0]] == []


@pytest.mark.parametrize("strong", [False, True])
def test_friction_that_differs_between_directions_is_named_only_where_it_is_strong(
    machine: Prepared, strong: bool
) -> None:
    """While a joint moves an offset says the same, and is the plainer name: the other is listed."""
    b = machine.fit
    one_way = term(b, ONE_WAY.id, 0)
    if strong:
        level = float(np.sqrt(np.mean(friction_at(Fit(*background(b)), 0) ** 2)))
        b = with_torque(b, one_way, level, 0.0)
    _, found = identify(replace(machine, fit=b), lambda *said: None)
    listed = {
        (rival.term.effect, rival.term.place.joints)
        for rivals in found.rivals.values()
        for rival in rivals
    }
    if strong:
        assert (ONE_WAY.id, (0,)) in named(found) | listed
    else:
        assert all(effect != ONE_WAY.id for effect, _ in named(found))


@pytest.mark.parametrize("share", [0.3, 0.5, 0.9])
def test_a_level_far_below_what_a_joint_needs_is_no_limit(machine: Prepared, share: float) -> None:
    motions = machine.fit.motions
    torque = np.concatenate([np.abs(m.tau[:, 1]) for m in motions])
    shape = (OF_REPORTED, float(np.quantile(torque, share)))
    assert not CATALOGUE["torque_saturation"].plausible(motions, Place(joints=(1,)), shape)


def test_a_limit_is_what_is_needed_where_more_is_asked() -> None:
    rng = np.random.default_rng(0)
    time = np.arange(0.0, 20.0, 0.004)
    asked = 12.0 * np.sin(1.3 * time) + 3.0 * np.sin(3.1 * time)
    needed = np.clip(asked, -10.0, 10.0) + rng.normal(0.0, 0.1, len(time))
    assert is_cut(asked, needed, 10.0, 0.5)
    hum = np.where(np.abs(time - 10.0) < 0.5, 9.0 * np.sin(60.0 * time), 0.0)
    gentle = 0.6 * asked
    assert not is_cut(gentle + hum, gentle, 10.0, 0.5)
    assert not is_cut(asked, needed + rng.normal(0.0, 3.0, len(time)), 10.0, 0.5)
