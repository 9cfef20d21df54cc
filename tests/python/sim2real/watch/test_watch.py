"""A machine that is watched: the example's arm in MuJoCo, by the model of its diagnosis."""

from __future__ import annotations

import gc
import tracemalloc
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Alarm, Model, Watch, calibrated, model_of, predict
from pdoik.sim2real.model import body_of
from pdoik.sim2real.motion import zero_phase
from pdoik.sim2real.thresholds import WatchThresholds
from pdoik.sim2real.watch import Residuals, Rows, Windows, joined, with_floor
from watched import Columns, changed, log

SINCE = 12.0


@pytest.fixture(scope="module")
def model(examination: Any) -> Model:
    """As model.json has it: its floor is that of the recording held out."""
    made = Model.from_json(model_of(examination).to_json())
    assert made.healthy is not None
    assert made.healthy.held_out
    assert made.healthy.logs == ("friday.csv",)
    return made


def cut(columns: Columns, piece: int) -> list[Columns]:
    count = len(columns["time"])
    return [
        {name: each[at : at + piece] for name, each in columns.items()}
        for at in range(0, count, piece)
    ]


def told(model: Model, pieces: list[Columns]) -> list[Alarm]:
    watch = Watch(model)
    return [alarm for each in pieces for alarm in watch.feed(each)] + watch.end()


def test_the_residual_of_windows_is_that_of_the_whole_recording(
    model: Model, examination: Any
) -> None:
    recording = examination.prepared.study.validate[0]
    assert model.healthy is not None
    residuals = Residuals(model, model.healthy.position_noise, 2e-3)
    windows = Windows(3, residuals.cutoff)
    rows = Rows(time=recording.start + recording.time, q=recording.q, tau=recording.tau)
    cores = [residuals.rows(each) for each in [*windows.add(rows), *windows.end()]]
    rows_of_cores = joined(cores)
    whole = zero_phase(
        recording.tau - predict(model, recording), residuals.cutoff, recording.period
    )
    at = np.round((rows_of_cores.time - recording.start) / recording.period).astype(int)
    np.testing.assert_allclose(rows_of_cores.time - recording.start, recording.time[at], atol=1e-9)
    assert np.diff(at).max() <= 2 * 3  # nothing is left out between windows
    # `predict` filters what is smooth once more: where nothing jumps that changes little.
    difference = np.abs(rows_of_cores.residual - whole[at])
    smooth = rows_of_cores.moving
    floor = np.sqrt(np.mean(rows_of_cores.residual**2, axis=0, where=smooth))
    for j in range(3):
        assert np.quantile(difference[smooth[:, j], j], 0.95) < 0.35 * floor[j]


def test_nothing_is_told_of_a_healthy_arm(model: Model) -> None:
    assert told(model, [log(11, 60.0)]) == []


@pytest.mark.parametrize(
    ("kind", "joint", "effect", "figure", "value"),
    [
        ("friction", "elbow", "coulomb_friction", "level", 0.8),
        ("friction", "shoulder", "coulomb_friction", "level", 0.8),
        ("offset", "base", "torque_offset", "offset", 0.5),
        ("gain", "shoulder", "torque_gain", "gain", 0.15),
        ("load", "shoulder", "payload", "mass", 0.4),
    ],
)
def test_a_change_is_told_with_joint_time_and_cause(
    model: Model, kind: str, joint: str, effect: str, figure: str, value: float
) -> None:
    alarms = told(model, [changed(log(11, 60.0), kind, joint, SINCE)])
    first, last = alarms[0], alarms[-1]
    assert first.stage == "noticed"
    assert {alarm.number for alarm in alarms} == {1}  # one change is one alarm
    assert first.joint == joint or kind == "load"
    assert SINCE < first.told < SINCE + 2.0
    assert abs(last.onset - SINCE) < 0.5
    assert last.stage == "learnt"
    cause = next(each for each in last.causes if each.effect == effect)
    assert {each.effect for each in last.causes} <= {effect, "viscous_friction"}
    assert cause.joints == (() if kind == "load" else (joint,))
    assert cause.change[figure].value == pytest.approx(value, rel=0.15)
    assert effect in str(last).replace(" ", "_")


@pytest.mark.parametrize("piece", [1, 37, 1000])
def test_alarms_are_the_same_whatever_the_pieces(model: Model, piece: int) -> None:
    columns = changed(log(11, 60.0), "offset", "base", SINCE)
    columns = {name: each[:2400] for name, each in columns.items()}
    whole = told(model, [columns])
    assert len(whole) == 2
    assert [each.to_json() for each in told(model, cut(columns, piece))] == [
        each.to_json() for each in whole
    ]


def test_links_that_are_off_are_learnt_from_healthy_logs(model: Model, examination: Any) -> None:
    """The floor is that of the right model, and a healthy log is no alarm."""
    recording = examination.prepared.study.validate[0]
    body = body_of(model)
    heavier = {
        link: ten * factor
        for link, ten, factor in zip(
            body.links, body.inertial_parameters(), (1.0, 1.04, 0.96), strict=True
        )
    }
    off = replace(model, rigid_body={**model.rigid_body, **heavier})
    strict = replace(WatchThresholds(), bodies=1e-6)
    right, learnt, ignored = (
        calibrated(each, [recording], thresholds=limits).healthy
        for each, limits in ((model, None), (off, None), (off, strict))
    )
    assert right is not None
    assert learnt is not None
    assert ignored is not None
    worst = np.argmax(ignored.bias[:, 0])
    assert ignored.bias[worst, 0] > 3.0 * right.bias[worst, 0]
    assert (learnt.bias < 1.5 * right.bias + 0.005).all()
    assert told(replace(off, healthy=learnt), [log(12, 60.0)]) == []


def test_a_gap_and_a_rest_are_no_change(model: Model) -> None:
    columns = log(11, 60.0)
    keep = (columns["time"] < 10.0) | (columns["time"] > 17.3)
    gap = {name: each[keep] for name, each in columns.items()}
    gap["tau.base"][700:704] = np.nan
    gap["q.elbow"][900] += 0.3  # a faulty reading
    assert told(model, [gap]) == []
    still = {name: np.repeat(each[:1], 3000) for name, each in columns.items()}
    still["time"] = 0.01 * np.arange(3000)
    still["tau.elbow"] = still["tau.elbow"] + 0.7  # within dry friction any torque holds it
    assert told(model, [still]) == []


def test_memory_does_not_grow(model: Model) -> None:
    columns = log(11, 60.0)
    watch = Watch(model)
    held = []
    tracemalloc.start()
    for turn in range(5):  # two minutes are kept for the causes
        for each in cut(columns, 500):
            watch.feed({**each, "time": each["time"] + 60.0 * turn})
        gc.collect()  # cycles, which Python frees by itself later
        held.append(tracemalloc.get_traced_memory()[0])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert held[4] < 1.02 * held[3]
    assert peak < 60e6


def test_more_false_alarms_that_are_allowed_lower_the_threshold(model: Model) -> None:
    from pdoik.sim2real import Thresholds

    often = Watch(model, thresholds=Thresholds().changed({"watch.alarms_per_day": 100.0}))
    assert often.threshold == pytest.approx(Watch(model).threshold - np.log(100.0), abs=1.5)


def test_misuse_is_said(model: Model, examination: Any) -> None:
    with pytest.raises(ValueError, match="no robot description"):
        Watch(replace(model, robot=None))
    with pytest.raises(ValueError, match="no floor of healthy torques"):
        Watch(replace(model, healthy=None))
    columns = log(11, 60.0)
    with pytest.raises(ValueError, match=r"expected a column 'tau\.base'"):
        Watch(model).feed({k: v for k, v in columns.items() if not k.startswith("tau")})
    slow = {name: each[::8] for name, each in columns.items()}
    with pytest.raises(ValueError, match="rows a second, expected at least"):
        Watch(model).feed(slow)
    watch = Watch(model)
    watch.feed({name: each[:500] for name, each in columns.items()})
    with pytest.raises(ValueError, match="time runs backwards"):
        watch.feed({name: each[400:600] for name, each in columns.items()})
    recording = examination.prepared.study.validate[0]
    with pytest.raises(ValueError, match="expected torques"):
        calibrated(model, [replace(recording, tau=None)])
    still = replace(recording, q=np.repeat(recording.q[:1], len(recording.q), axis=0))
    with pytest.raises(ValueError, match="no joint moves for 5 s"):
        calibrated(model, [still])


def test_without_recordings_held_out_the_floor_is_that_of_those_fitted(
    model: Model, examination: Any
) -> None:
    study = examination.prepared.study
    fitted = with_floor(replace(model, healthy=None), replace(study, recordings=study.fit))
    assert fitted.healthy is not None
    assert not fitted.healthy.held_out
    assert fitted.healthy.logs == ("monday.csv", "tuesday.csv")
    short = replace(model, healthy=None)
    assert with_floor(short, replace(study, recordings=())).healthy is None
