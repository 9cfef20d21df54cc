"""Drives behind laws that nobody told: late beside the others, cut off, friction that changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("numba", reason="pip install 'pdoik[bench]'")

from bench.sim2real.machines import build
from bench.sim2real.machines.plan import WorldSpec
from pdoik.recordings import Recording
from pdoik.sim2real import Diagnosis, Finding, diagnose, load_study
from pdoik.sim2real.controllers import (
    CutOff,
    Feeds,
    Late,
    Strip,
    cut_off,
    gained_by,
    later_ones,
    law_of,
    pieces_of,
    strips_of,
)
from pdoik.sim2real.motion import prepare
from pdoik.sim2real.thresholds import ControllerThresholds
from sim2real_controlled import Cascade, Law, Pid, run

LIMITS = ControllerThresholds()
CUTOFF = 8.0  # [Hz]


@dataclass
class Voltage(Pid):
    """A PD law whose torque falls with speed; it must not be told the desired one."""

    stall: float = 3.0
    no_load: float = 3.0

    def __call__(self, time: float, error: float, speed_error: float, q: float) -> float:
        asked = super().__call__(time, error, speed_error, q)
        along = -speed_error / self.no_load
        most, least = self.stall * max(1.0 - along, 0.0), -self.stall * max(1.0 + along, 0.0)
        return float(np.clip(asked, least, most))


def coarse(recording: Recording) -> Recording:
    """Every third row, and encoders of 14 bit."""
    step = 2.0 * np.pi / 2.0**14
    part = slice(None, None, 3)
    changed = {
        name: getattr(recording, name)[part]
        for name in ("time", "q", "dq", "tau_cmd", "q_des", "dq_des", "valid")
        if getattr(recording, name) is not None
    }
    q = np.rint(changed["q"] / step) * step
    return replace(recording, **{**changed, "q": q, "raw_period": 3 * recording.raw_period})


def commanded_late(recording: Recording, time: float) -> Recording:
    """As if the law had acted on commands that were logged so much earlier."""
    assert recording.q_des is not None
    early = [np.interp(recording.time + time, recording.time, x) for x in recording.q_des.T]
    rates = [np.gradient(each, recording.time) for each in early]
    return replace(
        recording,
        q_des=np.stack(early, axis=1),
        dq_des=None if recording.dq_des is None else np.stack(rates, axis=1),
    )


def strips(make: Callable[[], Law], *, late: float = 0.0, aimed: bool = True) -> tuple[Strip, ...]:
    logs = [coarse(run(make(), seed=seed, seconds=12.0, aimed=aimed)) for seed in (1, 2)]
    if late:
        logs = [commanded_late(each, late) for each in logs]
    pieces = pieces_of(logs, 0, "tau_cmd", Feeds(None), LIMITS)
    return strips_of(pieces, CUTOFF, LIMITS)


def machine(**second: object) -> dict[int, tuple[Strip, ...]]:
    """Three joints of other laws each; the second may be late or lag."""
    lag, late = float(second.get("lag", 0.0)), float(second.get("late", 0.0))  # type: ignore[arg-type]
    return {
        0: strips(lambda: Pid(kp=60.0, kd=3.0)),
        1: strips(lambda: Pid(kp=40.0, kd=3.0, ki=40.0, lag=lag), late=late),
        2: strips(lambda: Cascade(kp=10.0, kv=4.0, ki=30.0)),
    }


def test_any_law_is_linear_in_the_motions_band() -> None:
    for own in machine().values():
        law = law_of(own)
        assert law.rss < 0.005 * law.target @ law.target


def test_a_joint_that_acts_on_late_commands_is_told_from_the_others() -> None:
    (late,) = later_ones(machine(late=0.06), LIMITS)
    assert (late.joint, late.of) == (1, "delay")
    assert late.time == pytest.approx(0.06, abs=0.006)
    assert late.support.agree == late.support.sessions == 2


def test_a_joint_whose_effort_lags_is_told_from_the_others() -> None:
    (late,) = later_ones(machine(lag=0.04), LIMITS)
    assert (late.joint, late.of) == (1, "lag")
    assert late.time == pytest.approx(0.04, abs=0.01)


def test_joints_that_are_all_alike_are_not_late() -> None:
    assert later_ones(machine(), LIMITS) == []
    alike = {j: strips(lambda: Pid(kp=60.0, kd=3.0), late=0.06) for j in range(3)}
    assert later_ones(alike, LIMITS) == []
    assert later_ones({0: strips(lambda: Pid(kp=60.0, kd=3.0), late=0.06)}, LIMITS) == []


def test_a_level_that_no_command_of_torque_shows_is_found() -> None:
    own = strips(lambda: Pid(kp=40.0, kd=3.0, limit=1.6))
    found = cut_off(0, own, LIMITS)
    assert isinstance(found, CutOff)
    assert found.no_load == np.inf
    assert found.level == pytest.approx(1.6, rel=0.05)
    assert gained_by(found, own, LIMITS).share > LIMITS.late_gain


def test_a_line_that_falls_with_speed_is_found() -> None:
    own = strips(lambda: Voltage(kp=60.0, kd=1.0, stall=3.2, no_load=1.9), aimed=False)
    found = cut_off(0, own, LIMITS)
    assert isinstance(found, CutOff)
    assert found.level == pytest.approx(3.2, rel=0.1)
    assert found.no_load == pytest.approx(1.9, rel=0.15)


def test_a_level_of_a_law_that_no_other_recording_bears_out_is_none() -> None:
    """One shows the law's part of the error, one that of speed: each alone is only a fit."""
    first, second = strips(lambda: Pid(kp=40.0, kd=3.0, limit=1.6))
    none = np.zeros_like(first.q)

    def cut(strip: Strip) -> Strip:
        asked = 40.0 * strip.error + 3.0 * strip.speed_error
        return replace(strip, effort=np.clip(asked, -1.6, 1.6))

    apart = (
        cut(replace(first, dq=none, dq_des=none, rate=none)),
        cut(replace(second, q=second.q_des)),
    )
    unasked = replace(LIMITS, followed_elsewhere=-1e9)
    for own, borne_out in (((cut(first), cut(second)), True), (apart, False)):
        assert isinstance(cut_off(0, own, unasked), CutOff)
        assert isinstance(cut_off(0, own, LIMITS), CutOff) == borne_out


def test_a_torque_that_merely_peaks_has_no_limit() -> None:
    for own in machine().values():
        assert cut_off(0, own, LIMITS) is None


def world(folder: Path, seed: int, fault: str) -> Path:
    faults = () if fault == "none" else (fault,)
    spec = WorldSpec(seed=seed, faults=faults, robot="random3")
    build.make_study(folder / "study", spec, folder / "truth")
    return folder / "study" / "study.yaml"


def of(diagnosis: Diagnosis, effect: str) -> Finding:
    (found,) = [each for each in diagnosis.findings if each.effect == effect]
    return found


@pytest.mark.long
def test_a_supply_with_too_little_voltage_is_named(tmp_path: Path) -> None:
    """12.7 N m at rest and nothing at 1.1 rad/s, a computed-torque law that nobody told."""
    diagnosis = diagnose(world(tmp_path, 9004, "torque_speed_limit"))
    found = of(diagnosis, "torque_speed_limit")
    assert found.joints == ("joint2",)
    for name, true in (("stall_torque", 12.7), ("no_load_speed", 1.1)):
        low, high = found.parameters[name].interval95
        assert low <= true <= high
        assert high - low < 0.5 * true
    assert found.support is not None
    assert found.evidence.channels == ("q_des", "tau")
    again = Diagnosis.from_json(diagnosis.to_json())
    assert of(again, "torque_speed_limit").values == found.values


@pytest.mark.long
def test_friction_that_is_another_one_each_time_says_so(tmp_path: Path) -> None:
    diagnosis = diagnose(world(tmp_path, 9005, "friction_drift"))
    (rubbing,) = [
        each
        for each in diagnosis.findings
        if each.effect == "coulomb_friction" and each.joints == ("joint3",)
    ]
    assert "friction_drift" in {each.effect for each in rubbing.equivalents}
    assert "between recordings" in rubbing.statement
    for each in diagnosis.findings:
        if each.joints != ("joint3",):
            assert "between recordings" not in each.statement


def test_what_a_model_feeds_forward_is_pinocchios(tmp_path: Path) -> None:
    prepared = prepare(load_study(world(tmp_path, 9004, "none")))
    body, (first, *_) = prepared.body, prepared.study.fit
    assert body is not None
    assert first.q_des is not None
    feed = Feeds(body).of(first)
    assert feed is not None
    rows = np.linspace(10, len(first.q) - 10, 7).astype(int)
    still = np.zeros((7, 3))
    np.testing.assert_allclose(feed.gravity[rows], body.gravity(first.q[rows]), atol=2e-2)
    for j in range(3):
        unit = np.zeros((7, 3))
        unit[:, j] = 1.0
        pulled = body.torque(first.q[rows], still, unit) - body.gravity(first.q[rows])
        np.testing.assert_allclose(feed.mass[rows, j], pulled[:, j], rtol=2e-2)
    assert Feeds(None).of(first) is None


def test_late_ones_are_plain_data() -> None:
    (late,) = later_ones(machine(late=0.06), LIMITS)
    assert isinstance(late, Late)
    assert late.explained > 0.95
