"""Delays far below a sample are measured; what ticks and samples explain is not claimed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import Truth, WorldSpec
from pdoik.sim2real import Diagnosis, Estimate, diagnose
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.effects.drives import OF_POSITION, OF_TORQUE
from pdoik.sim2real.infer import blur, lateness, shared_by_all, widened
from pdoik.sim2real.motion import Balances, Place, prepare
from pdoik.sim2real.regression import Fit, Term, term_of
from pdoik.sim2real.study import load_study
from sim2real_motions import PERIOD, moved, pd, recording

TICK = 0.002  # [s]
COMMAND = recording(None, 3).time


def asked(time: np.ndarray, joint: int) -> np.ndarray:
    return 4.0 * np.sin(2 * np.pi * (0.7 + 0.2 * joint) * time) + np.sin(2 * np.pi * 2.3 * time)


def late_by(folder: Path, delays: tuple[float, float, float], tick: float | None = TICK) -> Fit:
    """Drives that give what they were told half a tick, and a delay, before."""
    noise = np.random.default_rng(5)
    given, told = np.zeros((len(COMMAND), 3)), np.zeros((len(COMMAND), 3))
    for j, delay in enumerate(delays):
        told[:, j] = asked(COMMAND, j)
        given[:, j] = asked(COMMAND - 0.5 * (tick or 0.0) - delay, j)
    given += 0.01 * noise.standard_normal(given.shape)
    motion = moved(folder, controller=pd(3, period=tick), tau=given, tau_cmd=told)
    return Fit(Balances([motion]), ())


def late_term(fit: Fit, j: int, delay: float) -> Term:
    term = term_of(fit.balances, CATALOGUE["command_delay"], Place(joints=(j,)), (OF_TORQUE, delay))
    assert term is not None
    return term


def test_holding_a_command_over_a_tick_is_no_delay(tmp_path: Path) -> None:
    fit = late_by(tmp_path, (0.0, 0.0, 0.0))
    for j in range(3):
        value, error = lateness(fit, j, OF_TORQUE)
        assert abs(value) < 4.0 * error + 0.02 * TICK
        assert error < 0.1 * TICK  # so that half a tick would be seen


@pytest.mark.parametrize("delay", [0.0006, 0.0015])
def test_a_delay_of_a_fraction_of_a_sample_is_measured(tmp_path: Path, delay: float) -> None:
    assert delay < PERIOD / 2
    fit = late_by(tmp_path, (0.0, delay, 0.0))
    value, error = lateness(fit, 1, OF_TORQUE)
    assert value == pytest.approx(delay, abs=4.0 * error + 0.03 * TICK)
    assert error < 0.1 * delay


def test_less_than_a_tick_in_all_joints_is_sampling_and_in_one_joint_is_not(tmp_path: Path) -> None:
    alone = late_by(tmp_path, (0.0, 0.0015, 0.0))
    term = late_term(alone, 1, 0.0015)
    assert not shared_by_all(alone.extended(term), term)
    together = late_by(tmp_path, (0.0015, 0.0015, 0.0015))
    terms = [late_term(together, j, 0.0015) for j in range(3)]
    assert all(shared_by_all(together.extended(*terms), term) for term in terms)


def test_more_than_a_tick_in_all_joints_is_a_delay(tmp_path: Path) -> None:
    fit = late_by(tmp_path, (0.003, 0.003, 0.003))
    term = late_term(fit, 0, 0.003)
    assert not shared_by_all(fit.extended(term), term)


def test_where_the_controllers_period_is_not_known_the_logs_stands_for_it(tmp_path: Path) -> None:
    known, unknown = late_by(tmp_path, (0.0, 0.0, 0.0)), late_by(tmp_path, (0.0, 0.0, 0.0), None)
    for effect in (CATALOGUE["command_delay"], CATALOGUE["actuator_lag"]):
        for shape in ((OF_TORQUE, 0.5 * PERIOD), (OF_POSITION, 0.5 * PERIOD)):
            assert not effect.negligible(known.balances.motions, shape)
            assert effect.negligible(unknown.balances.motions, shape)
            assert effect.negligible(known.balances.motions, (shape[0], 0.1 * TICK))
            wide = [blur(each.balances, shape) for each in (known, unknown)]
            assert wide[0] < 0.3 * wide[1]


def test_what_sampling_leaves_open_is_part_of_the_error(tmp_path: Path) -> None:
    fit = late_by(tmp_path, (0.0, 0.01, 0.0))
    term = late_term(fit, 1, 0.01)
    exact = Estimate(value=0.01, std=1e-7, interval95=(0.01 - 1e-7, 0.01 + 1e-7), unit="s")
    estimate = widened(fit.balances, term, {"delay": exact})["delay"]
    assert estimate.std == pytest.approx(blur(fit.balances, term.shape), rel=1e-3)
    assert estimate.interval95[1] - 0.01 == pytest.approx(1.96 * estimate.std, rel=1e-3)


def world(folder: Path, seed: int, effect: str, robot: str) -> tuple[Truth, Path]:
    hide = "plain" if effect == "clean" else "noise"
    spec = WorldSpec(seed=seed, effect=effect, hide=hide, robot=robot)
    return make_study(folder / "study", spec), folder / "study" / "study.yaml"


def test_a_simulated_machine_without_delay_shows_none(tmp_path: Path) -> None:
    """Held commands, torque averaged over the log's period, jitter, lost rows."""
    _, study = world(tmp_path, 8506, "clean", "random4")
    fit = Fit(prepare(load_study(study)).fit, ())
    for what, sharp in ((OF_POSITION, 4), (OF_TORQUE, 2)):
        found = [lateness(fit, j, what) for j in range(4)]
        by = blur(fit.balances, (what, 0.0))
        assert all(abs(value) < 3.5 * np.hypot(error, by) for value, error in found)
        assert sum(error < 2e-4 for _, error in found) >= sharp  # half a tick is 5e-4


def test_a_millisecond_and_a_half_is_named_at_a_log_of_four(tmp_path: Path) -> None:
    truth, study = world(tmp_path, 8161, "command_delay", "random2")
    hidden = truth.effects[0]
    assert hidden["parameters"]["delay"] == pytest.approx(0.0015)
    (finding,) = diagnose(study).findings
    assert finding.effect in ("command_delay", "actuator_lag")
    others = {each.effect for each in finding.equivalents}
    assert "command_delay" in {finding.effect} | others
    assert set(finding.joints) == set(hidden["joints"])
    (estimate,) = finding.parameters.values()
    assert estimate.std < 1e-4
    assert estimate.interval95[0] < 0.0015 < estimate.interval95[1]


def test_a_delay_of_all_joints_below_a_tick_is_left_to_sampling_and_said(tmp_path: Path) -> None:
    truth, study = world(tmp_path, 8152, "command_delay", "random3")
    assert len(truth.effects[0]["joints"]) == 3
    diagnosis: Diagnosis = diagnose(study)
    assert not diagnosis.findings
    assert any("explain it" in note for note in diagnosis.notes)
