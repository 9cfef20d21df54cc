"""A limit that is reached in few rows, or only in held-out recordings, is found and placed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from pdoik.sim2real import diagnose
from pdoik.sim2real.motion import FlatTop, Torques, flat_top, lagged, shifted

PERIOD, LEVEL, NOISE = 0.005, 10.0, 0.05
TIME = np.arange(0.0, 20.0, PERIOD)
SLOW = 7.0 * np.sin(2 * np.pi * 0.4 * TIME)
PEAKS = SLOW + sum(9.0 * np.exp(-(((TIME - t) / 0.06) ** 2)) for t in (5.3, 12.8, 15.3))
ONE_PEAK = SLOW + 9.0 * np.exp(-(((TIME - 5.3) / 0.1) ** 2))
RNG_SEED = 3


def noisy(given: np.ndarray, asked: np.ndarray) -> Torques:
    noise = NOISE * np.random.default_rng(RNG_SEED).standard_normal(len(given))
    return given + noise, asked, np.ones(len(given), dtype=bool), PERIOD


def clipped(asked: np.ndarray, level: float = LEVEL) -> Torques:
    return noisy(np.clip(asked, -level, level), asked)


def is_level(top: FlatTop | None) -> bool:
    return top is not None and abs(top.level - LEVEL) < 5.0 * top.std + 1e-3


def test_a_level_kept_on_several_occasions_is_a_flat_top() -> None:
    top = flat_top([clipped(PEAKS)])
    assert is_level(top)
    assert top is not None
    assert top.occasions == 3
    assert sum(top.rows) < 0.02 * len(TIME)  # rare


def test_one_long_occasion_is_enough_and_says_in_which_recording() -> None:
    top = flat_top([clipped(SLOW), clipped(ONE_PEAK)])
    assert is_level(top)
    assert top is not None
    assert top.occasions == 1
    assert top.rows[0] == 0 < top.rows[1]


@pytest.mark.parametrize("asked", [PEAKS, -PEAKS])
def test_limits_hold_on_both_sides(asked: np.ndarray) -> None:
    assert is_level(flat_top([clipped(asked)]))


@pytest.mark.parametrize(
    "given",
    [
        0.9 * PEAKS,
        lagged(PEAKS, 0.02, PERIOD),
        shifted(PEAKS, 0.02, PERIOD),
        PEAKS - 1.0 * np.tanh(50 * np.gradient(PEAKS)),
        SLOW,  # pushed by something else
        PEAKS,
    ],
    ids=["gain", "lag", "delay", "friction", "not told", "nothing wrong"],
)
def test_what_is_as_round_as_its_command_is_no_flat_top(given: np.ndarray) -> None:
    assert flat_top([noisy(given, PEAKS)]) is None


def test_a_level_that_is_exceeded_elsewhere_is_no_limit() -> None:
    late = TIME > 10.0
    given = np.where(late, PEAKS, np.clip(PEAKS, -LEVEL, LEVEL))
    assert flat_top([noisy(given, PEAKS)]) is None


def test_a_level_touched_once_for_a_moment_is_none() -> None:
    brief = SLOW + 9.0 * np.exp(-(((TIME - 5.6) / 0.015) ** 2))
    assert flat_top([clipped(brief, 8.0)]) is None


def test_a_limit_that_no_held_out_recording_reaches_is_named_and_said_to_be_so(
    tmp_path: Path,
) -> None:
    spec = WorldSpec(seed=8053, effect="torque_saturation", hide="noise", robot="random4")
    truth = make_study(tmp_path / "study", spec)
    diagnosis = diagnose(tmp_path / "study" / "study.yaml")
    (finding,) = diagnosis.findings
    assert finding.effect == "torque_saturation"
    assert set(finding.joints) == set(truth.effects[0]["joints"])
    assert any("fit recordings alone" in note for note in diagnosis.notes)
    estimate = finding.parameters["level"]
    assert abs(estimate.value - truth.effects[0]["parameters"]["level"]) < 3.0 * estimate.std


def test_a_limit_that_only_a_held_out_recording_reaches_is_told_with_where(tmp_path: Path) -> None:
    spec = WorldSpec(seed=5700, effect="torque_saturation", hide="plain", robot="random6")
    truth = make_study(tmp_path / "study", spec)
    study = tmp_path / "study" / "study.yaml"
    content = yaml.safe_load(study.read_text())
    for each in content["recordings"]:  # what reaches it for long is held out
        each["role"] = {"rec4.csv": "validate", "rec1.csv": "fit"}.get(each["file"], each["role"])
    study.write_text(yaml.safe_dump(content))
    (finding,) = diagnose(study).findings
    assert finding.effect == "torque_saturation"
    assert set(finding.joints) == set(truth.effects[0]["joints"])
    assert "rec4.csv" in finding.recordings
    assert not {"rec1.csv", "rec2.csv"} & set(finding.recordings)
    assert "held out" in finding.statement
