"""pdoik study check: what recordings can show, held against textbooks and repeated noise."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from command_line import run
from pdoik.sim2real import CATALOGUE, Study, StudyCheck, check_study, load_study, prepare
from pdoik.sim2real.identify import all_else, recorded, remainder
from pdoik.sim2real.motion import Place, RigidBody, zero_phase
from pdoik.sim2real.regression import Fit, term_of
from sim2real_effect_studies import rubbing, study
from sim2real_motions import write_arm
from sim2real_recordings import even_recording
from studies import log, write_study

PERIOD, NOISE, ROTOR = 0.004, 0.05, np.array([0.05])
HERE = Place(joints=(0,))
SIMPLE = ("viscous_friction", "torque_offset", "rotor_inertia")


def swings(folder: Path, noise: np.ndarray, seconds: float = 24.0) -> Study:
    """One joint that swings, whose torque is the model's and a noise, (T,)."""
    robot = write_arm(folder, 1)
    time = PERIOD * np.arange(round(seconds / PERIOD))
    parts = [(0.9, 0.23, 0.3), (0.4, 0.61, 1.9)]
    q, dq, ddq = (
        sum(
            a * (2 * np.pi * f) ** order * np.sin(2 * np.pi * f * time + p + order * np.pi / 2)
            for a, f, p in parts
        )[:, None]
        for order in range(3)
    )
    tau = RigidBody(robot, ("j1",), ROTOR).dynamics(q, dq, ddq).tau + noise[: len(time), None]
    return Study(
        folder=folder,
        robot=robot,
        joints=("j1",),
        recordings=(replace(even_recording(time, q=q, tau=tau), name="a.csv"),),
        split="by the test",
        rotor_inertia=ROTOR,
    )


def white(seed: int, count: int = 12000) -> np.ndarray:
    return NOISE * np.random.default_rng(seed).standard_normal(count)


def error_of_coulomb(made: Study) -> float:
    """The standard error of a level, beside viscous friction, offset and rotor."""
    b = prepare(made).fit
    model = all_else(recorded(b, 0.0), ("coulomb_friction", (HERE,)), ("torque_gain", (HERE,)))
    column = b.columns(CATALOGUE["coulomb_friction"], HERE, (0.0,))
    return remainder(model, {key: values[:, 0] for key, values in column.items()}).error


def _shape(name: str, b) -> tuple[float, ...]:
    return CATALOGUE[name].asked(b.motions, HERE)[0]


def test_in_white_noise_a_level_has_the_error_of_plain_least_squares(tmp_path: Path) -> None:
    """The textbook's: sigma times the root of the inverse normal matrix, at the log's own rate."""
    made = swings(tmp_path, white(0))
    m = prepare(made).fit.motions[0]
    moving = np.convolve(m.still[:, 0], np.ones(2 * round(0.3 / (m.cutoff * PERIOD)) + 1), "same")
    dq = np.gradient(made.recordings[0].q[:, 0], PERIOD)
    ddq = np.gradient(dq, PERIOD)
    A = np.column_stack([np.sign(dq), dq, ddq, np.ones_like(dq)])[moving < 0.5]
    expected = NOISE * np.sqrt(np.linalg.inv(A.T @ A)[0, 0])
    # A floor of noise supposes a sharp filter, and rows that say the same do not.
    assert error_of_coulomb(made) == pytest.approx(1.1 * expected, rel=0.1)


def test_in_coloured_noise_a_level_scatters_by_its_error(tmp_path: Path) -> None:
    """Noise of 2 Hz and less is as strong in the band of the motion as white noise 8 times it."""
    levels, errors = [], []
    for seed in range(30):
        noise = zero_phase(6.0 * white(seed), 2.0, PERIOD)
        made = swings(tmp_path, noise)
        b = prepare(made).fit
        terms = [
            term_of(b, CATALOGUE[name], HERE, _shape(name, b))
            for name in (*SIMPLE, "coulomb_friction")
        ]
        levels.append(Fit(b, [t for t in terms if t is not None]).beta[-1])
        if seed < 5:
            errors.append(error_of_coulomb(made))
    assert np.mean(errors) == pytest.approx(np.std(levels), rel=0.35)


def test_sizes_grow_with_the_noise_and_shrink_with_time(tmp_path: Path) -> None:
    short = error_of_coulomb(swings(tmp_path, white(1), 24.0))
    long = error_of_coulomb(swings(tmp_path, white(1), 48.0))
    louder = error_of_coulomb(swings(tmp_path, 3.0 * white(1), 24.0))
    assert long == pytest.approx(short / np.sqrt(2.0), rel=0.2)
    assert louder == pytest.approx(3.0 * short, rel=0.05)


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> StudyCheck:
    return check_study(study(tmp_path_factory.mktemp("rubbing"), rubbing, 20.0))


def test_every_effect_has_a_size_or_a_reason_at_every_place(checked: StudyCheck) -> None:
    assert {each.effect for each in checked.effects} == {
        name for name, effect in CATALOGUE.items() if effect.sought != "last"
    }
    for each in checked.effects:
        assert (each.smallest is None) == bool(each.reason), each
        if each.smallest is not None:
            assert 0.0 < each.smallest < np.inf
    for name in ("coulomb_friction", "viscous_friction", "torque_offset", "torque_ripple"):
        assert [each.joint for each in checked.of(name)] == ["j1", "j2", "j3"]
        assert all(each.smallest is not None for each in checked.of(name))
    assert all(each.smallest < 1.2 for each in checked.of("coulomb_friction"))  # which was found


def test_what_is_missing_is_named(checked: StudyCheck) -> None:
    reasons = {each.effect: each.reason for each in checked.effects}
    assert "tip poses" in reasons["kinematic_error"]
    assert "known payload" in reasons["payload_error"]
    for name in ("command_delay", "actuator_lag", "torque_saturation"):
        assert "tau_cmd" in reasons[name], name
        assert "tau (or" not in reasons[name], name  # that is there


def test_motions_are_as_they_were_made(checked: StudyCheck) -> None:
    (fit, held) = checked.recordings
    assert (fit.role, held.role) == ("fit", "validate")
    assert fit.channels == ("q", "tau")
    assert fit.rate == pytest.approx(250.0)
    assert fit.length == pytest.approx(20.0, abs=0.01)
    assert fit.gaps == 0
    for joint in checked.joints:
        assert joint.judged
        assert joint.moving > 0.9
        assert joint.reversals > 3
        assert not joint.stands
        assert 0.5 < joint.upper - joint.lower < 3.0


def slow_log(turn: bool = True) -> pd.DataFrame:
    """The plane arm whose elbow goes one way only, or stands in two poses."""
    table = log(12.0)
    time = table["time"].to_numpy()
    one_way = -1.0 + 0.15 * time + 0.02 * np.sin(2.0 * time)
    two_poses = 0.5 * (time > 6.0) * np.minimum(time - 6.0, 1.0)
    q = one_way if turn else two_poses
    return table.assign(**{"q.elbow": q, "dq.elbow": np.gradient(q, time)})


def test_a_joint_that_never_reverses_shows_no_dry_friction(tmp_path: Path) -> None:
    said = check_study(write_study(tmp_path, {"a.csv": slow_log()}))
    (level,) = said.of("coulomb_friction", "elbow")
    (other,) = said.of("coulomb_friction", "shoulder")
    assert said.joints[1].reversals == 0
    assert "never reverses" in level.reason
    assert other.smallest is not None


def test_poses_in_which_a_joint_stands_are_told(tmp_path: Path) -> None:
    joint = check_study(write_study(tmp_path, {"a.csv": slow_log(turn=False)})).joints[1]
    np.testing.assert_allclose(joint.stands, (0.0, 0.5), atol=0.01)
    assert joint.moving < 0.3


def test_gaps_and_jitter_of_a_log_are_told(tmp_path: Path) -> None:
    table = log(12.0)
    table = table[(table.time < 5.0) | (table.time > 5.6)]
    rng = np.random.default_rng(0)
    table = table.assign(time=table.time + rng.uniform(-1e-3, 1e-3, len(table)))
    said = check_study(write_study(tmp_path, {"a.csv": table})).recordings
    assert sum(each.gaps for each in said) == 1
    assert max(each.longest_gap for each in said) == pytest.approx(0.6, abs=0.1)
    assert said[0].jitter == pytest.approx(0.08, abs=0.03)
    assert any("gap" in note for note in said[0].notes)


def without_torque() -> pd.DataFrame:
    table = log(10.0)
    return table[["time", *(name for name in table if name.startswith("q."))]]


def test_of_positions_alone_nothing_can_be_found_and_both_commands_say_so(tmp_path: Path) -> None:
    path = write_study(tmp_path, {"a.csv": without_torque()})
    said = check_study(path).unanswerable
    assert "nothing can be found" in said
    assert "tau" in said
    assert "q_des" in said
    checked = run("study", "check", path)
    assert checked.exit_code == 1, checked.output
    assert said in " ".join(checked.stdout.split())
    refused = run("diagnose", path, "--out", tmp_path / "report")
    assert refused.exit_code == 1, refused.output
    assert said in " ".join(refused.stderr.split())
    assert "--anyway" in refused.stderr
    assert not (tmp_path / "report" / "diagnosis.json").exists()
    ran = run("diagnose", path, "--out", tmp_path / "report", "--quick", "--anyway")
    assert ran.exit_code == 0, ran.output
    assert (tmp_path / "report" / "diagnosis.json").exists()


def test_too_little_motion_is_refused_with_what_would_be_enough(tmp_path: Path) -> None:
    table = log(10.0)
    for joint in ("shoulder", "elbow"):
        for channel in ("q", "dq"):
            table[f"{channel}.{joint}"] *= 0.02
    said = check_study(write_study(tmp_path, {"a.csv": table})).unanswerable
    assert "no joint moves enough" in said
    assert "0.05 rad" in said


@pytest.fixture(scope="module")
def example_check(example_study: Path) -> StudyCheck:
    return check_study(load_study(example_study))


def test_a_study_that_can_answer_is_not_refused(
    checked: StudyCheck, example_check: StudyCheck
) -> None:
    assert checked.unanswerable == ""
    assert example_check.unanswerable == ""


def test_the_command_prints_and_writes_what_python_returns(
    example_study: Path, example_check: StudyCheck, tmp_path: Path
) -> None:
    said = example_check
    invocation = run("study", "check", example_study, "--json", tmp_path / "check.json")
    assert invocation.exit_code == 0, invocation.output
    content = json.loads((tmp_path / "check.json").read_text())
    assert content["schema"] == "pdoik.study_check/1"
    assert len(content["effects"]) == len(said.effects)
    for written, each in zip(content["effects"], said.effects, strict=True):
        assert written["effect"] == each.effect
        assert written["smallest"] == pytest.approx(each.smallest)
    rows = [line.split() for line in invocation.stdout.splitlines()]
    (row,) = [words for words in rows if words[:2] == ["coulomb", "friction"]]
    sizes = [each.smallest for each in said.of("coulomb_friction")]
    np.testing.assert_allclose([float(word) for word in row[4:]], sizes, rtol=0.06)
    for name in ("monday.csv", "shoulder", "reversals", "needs tip poses"):
        assert name in invocation.stdout
