"""Why a watched machine has changed: causes, figures and odds by the kernel, against the truth."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Alarm, Model, Thresholds, Watch, model_of
from pdoik.sim2real.model import Healthy
from pdoik.sim2real.watch import Cause, OrdinaryToday, ResidualRows
from watched import Columns, changed, log

SINCE = 12.0
TRUTH = {
    ("friction", "elbow"): {"level": 0.8, "coefficient": 0.3},
    ("offset", "base"): {"offset": 0.5},
    ("gain", "shoulder"): {"gain": 0.15},
    ("load", "shoulder"): {"mass": 0.4},
}
EFFECTS = {
    "friction": {"coulomb_friction", "viscous_friction"},
    "offset": {"torque_offset"},
    "gain": {"torque_gain"},
    "load": {"payload"},
}


@pytest.fixture(scope="module")
def model(examination: Any) -> Model:
    return model_of(examination)


def alarms_of(model: Model, columns: Columns) -> list[Alarm]:
    watch = Watch(model)
    return watch.feed(columns) + watch.end()


@pytest.mark.parametrize(("kind", "joint"), TRUTH)
def test_figures_are_the_truth_within_their_errors(model: Model, kind: str, joint: str) -> None:
    alarms = alarms_of(model, changed(log(11, 30.0), kind, joint, SINCE))
    noticed, learnt = alarms[0], alarms[-1]
    assert {cause.effect for cause in learnt.causes} == EFFECTS[kind]
    figures = {name: each for cause in learnt.causes for name, each in cause.change.items()}
    for name, truth in TRUTH[kind, joint].items():
        # Beside the model's own error: its payload and friction are right to half a percent.
        error = np.hypot(figures[name].std, 0.01 * truth)
        assert abs(figures[name].value - truth) < 3.0 * error
        assert figures[name].std < 0.1 * truth
    assert learnt.confidence > 0.9
    assert 0.0 < noticed.confidence <= learnt.confidence


def test_confidence_is_the_share_of_what_fits() -> None:
    alarm = Alarm(
        number=1,
        stage="noticed",
        joint="a",
        onset=0.0,
        told=1.0,
        source="",
        causes=(Cause(effect="torque_gain", joints=("a",)),),
        instead=(Cause(effect="torque_offset", joints=("a",), worse=2.0 * np.log(4.0)),),
    )
    assert alarm.confidence == pytest.approx(0.8)
    assert "(80%, or torque offset at a)" in str(alarm)


def healthy() -> Healthy:
    ones = np.ones((1, 3))
    return Healthy(
        logs=("log",),
        held_out=True,
        position_noise=np.ones(1),
        seconds=np.full(1, 60.0),
        variance=np.array([[0.01, 0.0, 0.0, 0.0]]),
        friction=np.ones(1),
        friction_off=np.zeros((1, 2)),
        speed=np.ones(1),
        scale=ones,
        power=ones,
        density=0.1 * ones,
        bias=0.01 * ones,
        bodies_off=np.zeros(0),
        bodies_covariance=np.zeros((0, 0)),
    )


def rows(first: float, off: np.ndarray, today: OrdinaryToday) -> ResidualRows:
    """Five seconds of motion whose friction is `off` (2,) from the model's."""
    time = first + 0.03 * np.arange(166)
    speed = 1.5 * np.sin(time)
    noise = 0.1 * np.random.default_rng(round(first)).standard_normal(len(time))
    columns = np.zeros((len(time), 1, 3))
    columns[:, 0, 1] = np.sign(speed)
    features = np.ones((len(time), 1, 4))
    features[:, 0, 1] = speed**2
    known = today.friction[0]
    friction = np.sign(speed) * (off[0] - known[0]) + speed * (off[1] - known[1])
    return ResidualRows(
        time=time,
        step=0.03,
        residual=(friction + noise)[:, None],
        allowed=np.zeros((len(time), 1)),
        columns=columns,
        bodies=np.zeros((len(time), 1, 0)),
        features=features,
        moving=np.ones((len(time), 1), dtype=np.bool_),
    )


def test_todays_friction_is_learnt_from_rows_that_no_chart_doubts() -> None:
    today, truth = OrdinaryToday(healthy(), Thresholds().watch), np.array([0.08, -0.05])
    for k in range(12):
        first = 5.0 * k
        today.learn(rows(first, truth, today), np.full(1, first))
    std = np.sqrt(np.diag(today.friction_covariance(0)))
    assert (np.abs(today.friction[0] - truth) < 3.0 * std).all()
    assert (std < 0.02).all()
    learnt = today.friction.copy()
    for k in range(12, 24):  # the charts doubt all that comes after a minute
        today.learn(rows(5.0 * k, truth + 1.0, today), np.full(1, 60.0))
    np.testing.assert_allclose(today.friction, learnt, atol=0.01)
    assert len(today._waiting) <= 14  # memory is constant
    today.reset()
    assert not today.friction.any()
