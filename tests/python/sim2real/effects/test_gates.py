"""Effects that act in a part of time or of a joint's positions only."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import Truth, WorldSpec
from pdoik.sim2real import Diagnosis, Estimate, Finding, diagnose
from pdoik.sim2real.effects import CATALOGUE, not_simulated, parts_of_finding
from pdoik.sim2real.motion import Gate, Motion, Place, columns_of
from pdoik.sim2real.regression import without_idle_gate
from pdoik.sim2real.simulation import Part, Simulator
from sim2real_robots import ABOUT_PIVOT, TURNTABLE, commands


def finding(effect: str, **values: float) -> Finding:
    parameters = {
        name: Estimate(value=value, std=0.0, interval95=(value, value), unit="")
        for name, value in values.items()
    }
    return Finding(effect=effect, joints=("joint1",), parameters=parameters)


@pytest.mark.parametrize("edge", [0.0, 0.3])
def test_a_gate_is_open_inside_and_its_edges_are_straight(edge: float) -> None:
    gate = Gate(of="position", low=-0.5, high=1.0, edge=edge)
    x = np.linspace(-2.0, 2.0, 4001)
    half = max(edge, 1e-9) / 2
    knots = [-0.5 - half, -0.5 + half, 1.0 - half, 1.0 + half]
    expected = np.interp(x, knots, [0.0, 1.0, 1.0, 0.0])
    clear = np.abs(np.abs(x - 0.25) - 0.75) > 1e-6
    assert gate.weight(x)[clear] == pytest.approx(expected[clear], abs=1e-9)
    assert [gate.weight_at(float(each)) for each in x] == pytest.approx(gate.weight(x).tolist())


@pytest.mark.parametrize("of", ["time", "position"])
def test_columns_are_the_effects_own_inside_the_gate_and_nothing_outside(
    motion: Motion, of: str
) -> None:
    x = motion.time if of == "time" else motion.q[:, 1]
    low, high = np.quantile(x, [0.3, 0.7])
    gate = Gate(of=of, low=float(low), high=float(high))  # type: ignore[arg-type]
    effect, place = CATALOGUE["viscous_friction"], Place(joints=(1,))
    plain = columns_of(effect, motion, place, ())["torque", 1]
    gated = columns_of(effect, motion, replace(place, gate=gate), ())["torque", 1]
    inside = (x > low) & (x < high)
    assert 0.2 < inside.mean() < 0.8
    np.testing.assert_array_equal(gated[inside], plain[inside])
    assert not gated[(x < low - 1e-9) | (x > high + 1e-9)].any()


def coasting(q0: float, dq0: float, parts: tuple[Part, ...]) -> tuple[np.ndarray, np.ndarray]:
    run = commands(2.0, tau_cmd=0.0, q=q0, dq=dq0)
    simulated = Simulator(TURNTABLE, ["joint1"], parts=parts, timestep=1e-3).replay(run, window=2.0)
    return simulated.time, simulated.q[:, 0]


def test_damping_behind_a_gate_slows_a_turntable_there_only() -> None:
    said = replace(finding("viscous_friction", coefficient=0.4), positions=(0.5, 1.0), edge=0.1)
    gate = said.gate
    assert gate is not None

    def rate(_: float, x: np.ndarray) -> list[float]:
        return [x[1], -0.4 * gate.weight_at(float(x[0])) * x[1] / ABOUT_PIVOT]

    time, q = coasting(0.0, 1.2, parts_of_finding(said))
    exact = solve_ivp(rate, (0.0, time[-1]), [0.0, 1.2], t_eval=time, rtol=1e-9, max_step=0.01)
    assert q == pytest.approx(exact.y[0], abs=2e-3)
    assert abs(q[-1] - 1.2 * time[-1]) > 0.1


def test_dry_friction_behind_a_gate_in_time_stops_a_turntable_from_then_on() -> None:
    said = replace(finding("coulomb_friction", level=0.5), window=(1.0, 9.0))
    time, q = coasting(0.0, 1.0, parts_of_finding(said))
    late = np.maximum(time - 1.0, 0.0)
    late = np.minimum(late, ABOUT_PIVOT / 0.5)  # at rest from there
    assert q == pytest.approx(time.clip(max=1.0) + late - 0.25 / ABOUT_PIVOT * late**2, abs=3e-3)


def test_what_no_part_of_the_simulation_can_gate_is_left_out_and_said() -> None:
    said = replace(finding("torque_gain", gain=1.2), window=(1.0, 2.0))
    assert not_simulated(said) == "torque gain in a part of the time only is not simulated"
    assert parts_of_finding(said) == ()
    assert not not_simulated(replace(said, window=None))


def test_a_gate_survives_the_file() -> None:
    said = replace(finding("coulomb_friction", level=0.5), positions=(-0.2, 0.4), edge=0.05)
    whole = Diagnosis(verdict="mismatch_explained", findings=(said,), joints={})
    assert Diagnosis.from_json(whole.to_json()).findings[0].gate == said.gate


def concealed(folder: Path, effect: str, seed: int, robot: str) -> tuple[Truth, Finding, int]:
    spec = WorldSpec(seed=seed, effect=effect, hide="corner", robot=robot)
    truth = make_study(folder / "study", spec)
    found = diagnose(folder / "study" / "study.yaml").findings
    assert found
    return truth, found[0], len(found)


def test_friction_that_begins_late_is_found_with_its_beginning(tmp_path: Path) -> None:
    truth, first, count = concealed(tmp_path, "viscous_friction", 8004, "random2")
    hidden = truth.effects[0]
    assert truth.corner == "time"
    assert (first.effect, list(first.joints), count) == (hidden["effect"], hidden["joints"], 1)
    assert first.window is not None
    assert first.window[0] == pytest.approx(hidden["window"][0], abs=0.1)
    true = hidden["parameters"]["coefficient"]
    assert first.values["coefficient"] == pytest.approx(true, rel=0.02)
    assert "Only after" in first.statement


def test_friction_in_some_positions_is_found_with_their_range(tmp_path: Path) -> None:
    truth, first, count = concealed(tmp_path, "coulomb_friction", 8014, "random2")
    hidden = truth.effects[0]
    assert truth.corner == "position"
    assert (first.effect, list(first.joints), count) == (hidden["effect"], hidden["joints"], 1)
    assert first.positions == pytest.approx(hidden["position_window"], abs=0.08)
    assert first.values["level"] == pytest.approx(hidden["parameters"]["level"], rel=0.03)


def test_friction_that_always_acts_gets_no_gate(tmp_path: Path) -> None:
    spec = WorldSpec(seed=11, effect="coulomb_friction", robot="random3")
    make_study(tmp_path / "study", spec)
    found = diagnose(tmp_path / "study" / "study.yaml").findings
    assert found
    assert all(each.window is None and each.positions is None for each in found)


def test_a_gate_that_is_open_in_every_recording_is_none() -> None:
    recording = SimpleNamespace(
        time=np.linspace(0.0, 9.0, 10), q=np.linspace(-1.0, 1.0, 10)[:, None]
    )
    study = SimpleNamespace(fit=[recording])
    for gate, idle in (
        (Gate(of="time", low=-2.3), True),
        (Gate(of="position", low=-1.02, high=1.02), True),
        (Gate(of="position", low=-1.02, high=0.9), False),
        (Gate(of="time", low=0.5), False),
    ):
        place = Place(joints=(0,), gate=gate)
        kept = without_idle_gate(place, study)  # type: ignore[arg-type]
        assert (kept.gate is None) == idle
