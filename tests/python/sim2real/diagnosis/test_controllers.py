"""Controllers nobody knows: laws from effort, wrong gains said, what cannot be told named."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from pdoik import LoadError
from pdoik.recordings import Recording
from pdoik.sim2real import (
    ControllerEstimate,
    Diagnosis,
    Model,
    diagnose,
    examine,
    load_study,
    model_of,
)
from pdoik.sim2real.controllers import Feeds, check_controllers, joint_law
from pdoik.sim2real.motion import prepare
from pdoik.sim2real.study import Controller, GivenController, Study
from pdoik.sim2real.thresholds import ControllerThresholds
from sim2real_controlled import Cascade, Law, Pid, Table, run, swing

PENDULUM = """<robot name="pendulum"><link name="base"/><link name="arm"><inertial>
<origin xyz="0 0 {z}"/><mass value="{mass}"/>
<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="joint1" type="continuous"><parent link="base"/><child link="arm"/>
<axis xyz="0 1 0"/></joint></robot>
"""


def law_of(make: Callable[[], Law], *, aimed: bool = True, **changes: str) -> ControllerEstimate:
    """Of two recordings, judged on a third; `aimed`: the law is told the desired speed."""
    recordings = [run(make(), seed=seed, aimed=aimed) for seed in (1, 2)]
    recordings.append(run(make(), seed=3, role="validate", aimed=aimed))
    if changes:
        (effort,) = changes.values()
        recordings = [replace(r, **{effort: r.tau_cmd}, tau_cmd=None) for r in recordings]
    *fit, judge = recordings
    return joint_law("joint1", 0, fit, [judge], Feeds(None), ControllerThresholds()).estimate


def check(estimate: ControllerEstimate, law: str, **true: float) -> None:
    assert estimate.law == law
    for name, value in true.items():
        low, high = estimate.gains[name].interval95
        assert low <= value <= high, (name, value, estimate.gains[name])
        assert high - low < 0.2 * abs(value), name
    assert estimate.explained > 0.98
    assert estimate.error < 0.1


def test_gains_of_a_pd_law_lie_in_their_intervals() -> None:
    estimate = law_of(lambda: Pid(kp=40.0, kd=3.0))
    check(estimate, "pd", kp=40.0, kd=3.0)
    assert estimate.unit == "N m"
    assert "validate3.csv" in estimate.data
    assert "delay" not in estimate.gains


def test_the_integral_of_a_pid_law_is_found_and_what_it_hides() -> None:
    check(law_of(lambda: Pid(kp=40.0, kd=3.0, ki=60.0)), "pid", kp=40.0, kd=3.0, ki=60.0)


def test_a_cascade_is_told_from_a_pid_law() -> None:
    estimate = law_of(lambda: Cascade(kp=10.0, kv=4.0, ki=30.0), aimed=False)
    check(estimate, "cascade", kp=10.0, kv=4.0, ki=30.0)


def test_a_cascade_that_is_told_the_desired_speed_is_a_pid_law() -> None:
    estimate = law_of(lambda: Cascade(kp=10.0, kv=4.0, ki=30.0))
    assert estimate.law == "pid"
    assert estimate.gains["kp"].value == pytest.approx(4.0 * 10.0 + 30.0, rel=0.02)
    assert estimate.gains["ki"].value == pytest.approx(10.0 * 30.0, rel=0.02)


def test_a_table_is_told_from_straight_gains() -> None:
    estimate = law_of(lambda: Table(near=80.0, far=20.0, knee=0.008, kd=3.0))
    assert estimate.law == "table"
    for error, effort in estimate.table:
        size = abs(error)
        true = np.sign(error) * (80.0 * min(size, 0.008) + 20.0 * max(size - 0.008, 0.0))
        assert effort == pytest.approx(true, abs=0.1)


def test_a_delay_and_a_limit_are_found() -> None:
    estimate = law_of(lambda: Pid(kp=40.0, kd=3.0, delay=12, limit=1.2))
    assert estimate.gains["delay"].value == pytest.approx(0.012, abs=1e-3)
    assert estimate.gains["limit"].value == pytest.approx(1.2, rel=0.03)
    assert estimate.gains["kp"].value == pytest.approx(40.0, rel=0.03)


def test_a_filter_is_found() -> None:
    estimate = law_of(lambda: Pid(kp=40.0, kd=3.0, lag=0.02))
    assert estimate.gains["time_constant"].value == pytest.approx(0.02, rel=0.1)
    assert estimate.gains["kp"].value == pytest.approx(40.0, rel=0.03)


def late_speed(recording: Recording, time: float) -> Recording:
    assert recording.dq is not None
    late = [np.interp(recording.time - time, recording.time, each) for each in recording.dq.T]
    return replace(recording, dq=np.stack(late, axis=1))


def test_a_speed_that_is_logged_late_is_told_from_other_gains() -> None:
    limits = ControllerThresholds()
    make = lambda seed: late_speed(run(Pid(kp=40.0, kd=3.0), seed=seed), 0.012)  # noqa: E731
    estimate = joint_law("joint1", 0, [make(1), make(2)], [make(3)], Feeds(None), limits).estimate
    assert estimate.law == "pd"
    assert estimate.gains["speed_delay"].value == pytest.approx(0.012, abs=1e-3)
    assert estimate.gains["kp"].value == pytest.approx(40.0, rel=0.02)
    assert estimate.gains["kd"].value == pytest.approx(3.0, rel=0.02)


def test_what_only_pulls_as_the_machine_itself_moves_is_no_law() -> None:
    """An effort that a mass asks for follows the commanded acceleration, and no error."""
    recordings = []
    for seed in (1, 2, 3):
        each = run(Pid(kp=40.0, kd=3.0), seed=seed)
        pulled = 0.5 * np.gradient(np.gradient(each.q, each.period, axis=0), each.period, axis=0)
        recordings.append(replace(each, tau_cmd=-pulled))
    *fit, judge = recordings
    estimate = joint_law("joint1", 0, fit, [judge], Feeds(None), ControllerThresholds()).estimate
    assert "kp" not in estimate.gains or estimate.gains["kp"].value > 0.0


def test_of_a_current_the_law_is_known_in_amperes() -> None:
    estimate = law_of(lambda: Pid(kp=40.0, kd=3.0), effort="current")
    check(estimate, "pd", kp=40.0, kd=3.0)
    assert estimate.gains["kp"].unit == "A/rad"


def test_no_law_is_believed_of_an_effort_that_follows_none() -> None:
    rng = np.random.default_rng(5)
    pieces = [run(Pid(kp=40.0, kd=3.0), seed=seed) for seed in (1, 2)]
    noisy = [replace(r, tau_cmd=rng.standard_normal(r.q.shape)) for r in pieces]
    estimate = joint_law("joint1", 0, noisy, [], Feeds(None), ControllerThresholds()).estimate
    assert estimate.law == ""
    assert not estimate.gains


def study_of(controller: Controller | None = None) -> Study:
    """Without a robot: three recordings of a PD law of 40 and 3."""
    recordings = [run(Pid(kp=40.0, kd=3.0), seed=seed) for seed in (1, 2)]
    judge = run(Pid(kp=40.0, kd=3.0), seed=3, role="validate")
    return Study(
        folder=Path(),
        robot=None,
        joints=("joint1",),
        recordings=(*recordings, judge),
        split="by the test",
        controller=controller,
    )


def test_a_wrong_told_gain_is_said_and_not_used() -> None:
    told = Controller(kp=np.array([56.0]), kd=np.array([3.0]))
    found = check_controllers(prepare(study_of(told)))
    assert found.estimates[0].given_wrong == {"kp": 56.0}
    assert "+40 %" in " ".join(found.notes)
    assert found.study.controller is not None
    assert found.study.controller.kp[0] == pytest.approx(40.0, rel=0.01)


def test_a_gain_is_not_wrong_because_one_recording_has_another() -> None:
    study = study_of(Controller(kp=np.array([56.0]), kd=np.array([3.0])))
    other = run(Pid(kp=56.0, kd=3.0), seed=2)
    recordings = (study.recordings[0], other, study.recordings[2])
    found = check_controllers(prepare(replace(study, recordings=recordings)))
    assert not found.estimates[0].given_wrong
    assert found.study.controller is study.controller


def test_right_told_gains_are_left_alone() -> None:
    told = Controller(kp=np.array([40.0]), kd=np.array([3.0]))
    found = check_controllers(prepare(study_of(told)))
    assert not found.estimates[0].given_wrong
    assert found.study.controller is told


def test_gains_that_were_not_told_come_from_the_estimate() -> None:
    unknown = replace(study_of(), told=GivenController(type="unknown"))
    found = check_controllers(prepare(unknown))
    assert found.study.controller is not None
    assert found.study.controller.kp[0] == pytest.approx(40.0, rel=0.01)
    assert found.study.controller.kd[0] == pytest.approx(3.0, rel=0.03)


def test_where_nobody_speaks_of_a_controller_its_law_is_said_and_not_used() -> None:
    found = check_controllers(prepare(study_of()))
    assert found.estimates[0].gains["kp"].value == pytest.approx(40.0, rel=0.01)
    assert found.study.controller is None


# Studies


def write(folder: Path, tables: dict[str, dict[str, np.ndarray]], **keys: object) -> Path:
    for name, table in tables.items():
        with (folder / name).open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(table)
            writer.writerows(np.stack(list(table.values()), axis=1).tolist())
    (folder / "pendulum.urdf").write_text(PENDULUM.format(z=-0.3, mass=1.0))
    content = {"robot": "pendulum.urdf", "joints": ["joint1"], "recordings": list(tables), **keys}
    (folder / "study.yaml").write_text(yaml.safe_dump(content))
    return folder / "study.yaml"


SWINGS = {f"swing{seed}.csv": swing(seed=seed) for seed in (1, 2, 3)}
LAWS = ("unknown", "pd", "pid", "cascade", "voltage", "table")


@pytest.mark.parametrize("kind", LAWS)
def test_a_controller_of_any_type_may_have_gains_that_are_not_known(
    tmp_path: Path, kind: str
) -> None:
    study = load_study(write(tmp_path, SWINGS, controller={"type": kind}))
    assert study.told is not None
    assert study.told.type == kind
    assert study.controller is None
    assert all(np.isnan(each).all() for each in study.told.gains.values())


def test_gains_may_be_null_and_in_the_drives_own_units(tmp_path: Path) -> None:
    controller = {"type": "voltage", "kp": [1200], "kd": [None], "unit": [0.0025]}
    study = load_study(write(tmp_path, SWINGS, controller=controller))
    assert study.told is not None
    assert study.told.gains["kp"].tolist() == [3.0]
    assert np.isnan(study.told.gains["kd"]).all()


@pytest.mark.parametrize(
    ("controller", "said"),
    [
        ({"type": "pdd"}, "type: expected one of unknown, pd, pid"),
        ({"type": "pd", "ki": [1]}, "unknown key 'ki'"),
        ({"type": "pid", "kp": [1, 2]}, "kp has 2 entries, expected 1"),
        ({"type": "pid", "kp": [-1]}, "expected none negative, got -1 for joint1"),
        ({"type": "voltage", "volts": 0}, "volts: expected more than 0"),
        ({"type": "voltage", "torque_per_volt": [0]}, "expected positive numbers"),
        ({"type": "table", "table": [[0, 1]]}, "two pairs"),
        ({"type": "table", "table": [[1, 1], [0, 2]]}, "errors that rise"),
        ("pd", "expected 'key: value' lines"),
    ],
)
def test_what_is_wrong_with_a_controller_is_said(
    tmp_path: Path, controller: object, said: str
) -> None:
    with pytest.raises(LoadError, match=said):
        load_study(write(tmp_path, SWINGS, controller=controller))


def test_duty_and_volts_are_read(tmp_path: Path) -> None:
    tables = {name: dict(table) for name, table in SWINGS.items()}
    for table in tables.values():
        table["duty.joint1"] = 100.0 * table["duty.joint1"]
        table["volts"] = 1000.0 * table["volts"]
    units = {"duty": "%", "volts": "mV"}
    study = load_study(write(tmp_path, tables, units=units))
    first = study.recordings[0]
    assert first.duty is not None
    assert np.abs(first.duty).max() <= 1.0
    assert first.voltage is not None
    assert np.allclose(first.voltage, 12.0)
    with pytest.raises(LoadError, match=r"is 'duty' in %\?.*units: \{duty: %\}"):
        load_study(write(tmp_path, tables, units={"volts": "mV"}))
    tables["swing1.csv"]["volts"] = 0.0 * tables["swing1.csv"]["volts"]
    with pytest.raises(LoadError, match="more than 0 V"):
        load_study(write(tmp_path, tables, units=units))


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    home = tmp_path_factory.mktemp("driven")
    return diagnose(write(home, SWINGS, controller={"type": "voltage", "kp": [5.0]}))


def test_a_voltage_driven_motor_is_found_beside_friction_and_rotor(driven: Diagnosis) -> None:
    (estimate,) = driven.controllers
    drive = estimate.drive
    assert drive["torque_per_volt"].value == pytest.approx(0.5, rel=0.03)
    assert drive["back_emf"].value == pytest.approx(0.4, rel=0.05)
    assert drive["rotor_inertia"].value == pytest.approx(0.02, rel=0.1)
    assert drive["supply_loss"].value < 0.05
    reduced = (0.09 + 0.02) / 0.3
    assert estimate.load["reduced_length"].value == pytest.approx(reduced, rel=0.02)
    said = " ".join(driven.notes)
    assert "lets go in swing1.csv" in said
    assert "a wrong mass looks like another torque per volt" in said


def test_a_firmware_gain_told_wrong_is_said(driven: Diagnosis) -> None:
    (estimate,) = driven.controllers
    assert estimate.gains["kp"].value == pytest.approx(3.0, rel=0.01)
    assert estimate.given_wrong == {"kp": 5.0}


def test_controllers_survive_the_json(driven: Diagnosis) -> None:
    assert Diagnosis.from_json(driven.to_json()).controllers == driven.controllers


@pytest.mark.parametrize(("by_mass", "by_length"), [(1.0, 1.0), (1.4, 1.0), (1.0, 1.4)])
def test_with_the_drive_known_mass_and_length_are_told_apart(
    tmp_path: Path, by_mass: float, by_length: float
) -> None:
    controller = {"type": "voltage", "torque_per_volt": [0.5], "back_emf": [0.4]}
    path = write(tmp_path, SWINGS, controller=controller, rotor_inertia=[0.02])
    robot = PENDULUM.format(z=-0.3 * by_length, mass=by_mass)
    (tmp_path / "pendulum.urdf").write_text(robot)
    found = check_controllers(prepare(load_study(path))).estimates[0].load
    assert by_mass * found["mass_factor"].value == pytest.approx(1.0, rel=0.05)
    assert by_length * found["length_factor"].value == pytest.approx(1.0, rel=0.05)


def test_a_replay_follows_a_voltage_drive_that_lets_go(tmp_path: Path) -> None:
    examination = examine(write(tmp_path, SWINGS, controller={"type": "voltage"}))
    study = examination.prepared.study
    model = Model.from_json(model_of(examination).to_json())
    there = model.simulator().replay(study.recordings[0])
    error = there.q - study.recordings[0].q
    assert np.sqrt(np.mean(error**2)) < 0.08


def test_without_effort_or_gains_it_is_said_what_can_be_told(tmp_path: Path) -> None:
    tables = {
        name: {key: values for key, values in table.items() if "duty" not in key and key != "volts"}
        for name, table in SWINGS.items()
    }
    told: list[str] = []
    examination = examine(
        write(tmp_path, tables, controller={"type": "unknown"}),
        tell=lambda stage, text, share: told.append(f"{stage}: {text}"),
    )
    first = next(text for text in told if text.startswith("controllers"))
    assert "What can be found: how late" in first
    assert "What cannot: torques, friction, masses" in first
    assert any("neither effort nor" in note for note in examination.diagnosis.notes)
