"""The next motion: within limits by Pinocchio, from rest to rest, and telling rivals apart."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from pdoik.errors import LoadError
from pdoik.sim2real.propose import NothingToSettleError, Proposal, Wishes, propose
from propose_reports import (
    EFFORT,
    LEVEL,
    ROTORS,
    SPEED,
    bristles,
    friction,
    one_way,
    push,
    write_report,
    write_study,
)
from studies import URDF

WISHES = Wishes(effort=40, search=10.0, speed_share=0.6, torque_share=0.7, acceleration=6.0)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("propose")
    return write_report(folder, write_study(folder), friction("presliding_hysteresis"))


@pytest.fixture(scope="module")
def proposed(report: Path) -> Proposal:
    return propose(report, WISHES)


@pytest.fixture(scope="module")
def at_random(report: Path) -> Proposal:
    return propose(report, replace(WISHES, random=True))


def finely(proposal: Proposal) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Times, positions, speeds and accelerations of the rows' curve, by differences at 1 ms."""
    time = np.arange(0.0, proposal.time[-1], 1e-3)
    q = proposal.at(time)
    dq = np.gradient(q, 1e-3, axis=0)
    return time, q, dq, np.gradient(dq, 1e-3, axis=0)


@pytest.mark.parametrize("kind", ["proposed", "at_random"])
def test_a_motion_is_from_rest_to_rest_where_the_recordings_began(
    kind: str, request: pytest.FixtureRequest
) -> None:
    motion: Proposal = request.getfixturevalue(kind)
    _, q, dq, _ = finely(motion)
    assert motion.time[-1] == pytest.approx(20.0)
    assert np.allclose(dq[[0, -1]], 0.0, atol=1e-3)
    assert np.allclose(motion.dq[[0, -1]], 0.0, atol=1e-6)
    start = [0.3, -0.4 + 0.12 * np.sin(0.7)]
    assert np.allclose(q[0], start, atol=2e-3)
    assert np.allclose(q[-1], start, atol=2e-3)
    assert np.ptp(q, axis=0).max() > 0.05


@pytest.mark.parametrize("kind", ["proposed", "at_random"])
def test_limits_hold_by_pinocchio(
    kind: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    motion: Proposal = request.getfixturevalue(kind)
    _, q, dq, ddq = finely(motion)
    model = pin.buildModelFromXML(URDF.format(mass=1))
    data = model.createData()
    tau = np.array([pin.rnea(model, data, *row) for row in zip(q, dq, ddq, strict=True)])
    tau += np.array(ROTORS) * ddq + [0.0, LEVEL] * np.sign(dq)
    assert (np.abs(q) <= [3.0, 2.5]).all()
    assert np.abs(dq).max() <= 0.6 * SPEED * 1.02
    assert np.abs(ddq).max() <= 6.0 * 1.1  # the curve between rows
    assert (np.abs(tau) <= 0.7 * np.array(EFFORT)).all()


def left_of_sliding(proposal: Proposal) -> float:
    """Share of the elbow's dry friction that no bristles' friction explains, by NumPy alone."""
    _, q, dq, _ = finely(proposal)
    moving = np.abs(dq[:, 1]) > 2e-3
    truth = np.sign(dq[moving, 1])
    least = 1.0
    for width in (0.0012, 0.003, 0.008, 0.02, 0.05):
        A = np.column_stack([bristles(q[:, 1], width), dq[:, 1], np.ones(len(q))])[moving]
        rest = truth - A @ np.linalg.lstsq(A, truth, rcond=None)[0]
        least = min(least, float(rest @ rest / (truth @ truth)))
    return least


def test_the_proposed_motion_tells_friction_from_bristles_better_than_a_random_one(
    proposed: Proposal, at_random: Proposal
) -> None:
    (expected,), (other,) = proposed.prospects, at_random.prospects
    assert expected.finding == "Coulomb friction at joint elbow"
    name = "presliding hysteresis at joint elbow"
    ours, theirs = (
        next(each for each in some.rivalries if each.rival == name) for some in (expected, other)
    )
    assert ours.listed
    assert ours.ratio > 100.0
    assert ours.clear > 1.0
    assert ours.ratio > 1.3 * theirs.ratio
    assert expected.confidence > 0.9
    assert left_of_sliding(proposed) > left_of_sliding(at_random)


def test_what_is_expected_grows_with_the_friction(report: Path, tmp_path: Path) -> None:
    """Of a signal over noise: with half the friction, less, and a quarter of it at least."""
    folder = tmp_path
    finding = friction("presliding_hysteresis")
    level = finding.parameters["level"]
    half = replace(finding, parameters={"level": replace(level, value=0.5 * LEVEL)})
    weaker = write_report(folder, write_study(folder), half)
    wishes = replace(WISHES, random=True)
    ratios = [
        next(e for e in propose(each, wishes).prospects[0].rivalries if e.listed).if_own
        for each in (report, weaker)
    ]
    assert 0.25 * ratios[0] < ratios[1] < 0.9 * ratios[0]


def test_nothing_open_is_said(tmp_path: Path) -> None:
    sure = write_report(tmp_path, write_study(tmp_path), friction())
    with pytest.raises(NothingToSettleError, match="nothing to settle"):
        propose(sure, WISHES)


def test_what_happened_once_is_settled_by_no_motion(tmp_path: Path) -> None:
    report = write_report(tmp_path, write_study(tmp_path), push())
    with pytest.raises(NothingToSettleError, match="external contact: it happened once"):
        propose(report, WISHES)


def test_what_stays_listed_side_by_side_after_every_motion_is_settled_by_none(
    tmp_path: Path,
) -> None:
    """While it moves, friction that differs between the directions is a zero of its torque."""
    both = friction(), one_way(0.02, "torque_offset")
    report = write_report(tmp_path, write_study(tmp_path), *both)
    with pytest.raises(NothingToSettleError, match="asymmetric friction at joint elbow or torque"):
        propose(report, WISHES)


def test_what_one_motion_tells_is_no_such_pair(tmp_path: Path) -> None:
    """Friction that differs more, the quicker the joint, is no zero."""
    both = friction(), one_way(1.0, "torque_offset")
    proposal = propose(write_report(tmp_path, write_study(tmp_path), *both), WISHES)
    assert not proposal.hopeless
    assert not proposal.unsettled
    assert min(each.ratio for each in proposal.prospects) > 10.0


@pytest.mark.parametrize(
    ("missing", "option"), [('velocity="3"', "--max-speed"), ('effort="30"', "--max-torque")]
)
def test_a_limit_that_nobody_told_is_asked_for(missing: str, option: str, tmp_path: Path) -> None:
    study = write_study(tmp_path, URDF.replace(missing, missing.split("=")[0] + '="0"'))
    report = write_report(tmp_path, study, friction("presliding_hysteresis"))
    with pytest.raises(ValueError, match=f"no .* limit of .*elbow.*{option}"):
        propose(report, WISHES)
    told = replace(WISHES, random=True, max_speed=2.0, max_torque=20.0)
    assert np.abs(propose(report, told).dq).max() <= 0.6 * 3.0


def test_files_that_are_gone_are_named(report: Path, tmp_path: Path) -> None:
    study = write_study(tmp_path)
    other = write_report(tmp_path, study, friction("presliding_hysteresis"))
    moved = study.rename(tmp_path / "elsewhere.yaml")
    with pytest.raises(LoadError, match=r"study\.yaml any more: .*--study"):
        propose(other, WISHES)
    assert propose(other, replace(WISHES, random=True, study=moved)).joints == ("shoulder", "elbow")
    (other / "model.json").unlink()
    with pytest.raises(LoadError, match=r"model\.json: no such file"):
        propose(other, WISHES)


def test_bad_wishes_are_refused(report: Path) -> None:
    with pytest.raises(ValueError, match="2 s is too short"):
        Wishes(seconds=2.0)
    with pytest.raises(ValueError, match=r"elbow at 2\.9, outside of -2\.5 to 2\.5"):
        propose(report, replace(WISHES, start=np.array([0.0, 2.9])))
    with pytest.raises(ValueError, match="start has 3 numbers, expected 2"):
        propose(report, replace(WISHES, start=np.zeros(3)))
