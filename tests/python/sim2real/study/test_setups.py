"""What a recording's entry says of how it was made is read, and its mistakes are said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from pdoik.errors import LoadError
from pdoik.sim2real.study import Payload, Setup, load_study
from studies import JOINTS, URDF, log, write_study

PAYLOAD: dict[str, Any] = {"link": "tool", "mass": 2.0, "com": [0.0, 0.0, 0.05]}
PD: dict[str, Any] = {"kp": [100, 50], "kd": [10, 5], "gravity_compensation": True}
WITHOUT_TOOL = URDF.format(mass=2).replace('<link name="tool"/>', "")


def written(folder: Path, told: dict[str, Any], **keys: Any) -> Path:
    """A study whose second recording says this of itself."""
    entries = [{"file": "a.csv"}, {"file": "b.csv", "role": "validate"} | told]
    return write_study(folder, **({"recordings": entries, "controller": PD} | keys))


def test_an_entry_says_all_it_may(tmp_path: Path) -> None:
    (tmp_path / "heavy.urdf").write_text(URDF.format(mass=3))
    told = {
        "robot": "heavy.urdf",
        "payload": PAYLOAD | {"inertia": [0.01, 0.02, 0.025]},
        "compensated": True,
        "controller": {"kp": {"shoulder": 40, "elbow": 20}, "torque_limit": [9, 8]},
        "session": "tuesday",
        "temperature": {"elbow": 31.5, "shoulder": "30"},
        "surface": "rubber",
    }
    study = load_study(written(tmp_path, told))
    assert set(study.setups) == {"b.csv"}
    setup = study.setup_of(study.validate[0])
    assert setup.robot == tmp_path / "heavy.urdf"
    assert setup.payload == Payload(
        link="tool", mass=2.0, com=(0.0, 0.0, 0.05), inertia=(0.01, 0.0, 0.02, 0.0, 0.0, 0.025)
    )
    assert setup.compensated
    assert setup.controller is not None
    assert setup.controller.kp.tolist() == [40, 20]
    assert setup.controller.kd.tolist() == [10, 5]  # the study's
    assert setup.controller.gravity_compensation
    assert setup.controller.torque_limit is not None
    assert setup.controller.torque_limit.tolist() == [9, 8]
    assert (setup.session, setup.surface) == ("tuesday", "rubber")
    assert setup.temperature is not None
    assert setup.temperature.tolist() == [30, 31.5]
    assert study.setup_of(study.fit[0]).is_plain
    assert study.shared_controller is None
    said = " ".join(study.notes)
    for each in ("heavy.urdf", "2 kg at tool (0, 0, 0.05)", "30, 31.5 deg C", "surface rubber"):
        assert f"b.csv: {each}" in said or each in said


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        ({"session": 3}, "3"),
        ({"session": "3"}, "3"),
        ({"session": "2026-11-23"}, "2026-11-23"),
        ({"session": yaml.safe_load("2026-11-23")}, "2026-11-23"),  # YAML makes it a day
        ({"surface": "wood"}, ""),
    ],
)
def test_a_session_is_text_a_number_or_a_day(
    tmp_path: Path, told: dict[str, Any], expected: str
) -> None:
    study = load_study(written(tmp_path, told))
    assert study.setups["b.csv"].session == expected


def test_one_temperature_is_that_of_all_joints(tmp_path: Path) -> None:
    setup = load_study(written(tmp_path, {"temperature": -5})).setups["b.csv"]
    assert setup.temperature is not None
    assert setup.temperature.tolist() == [-5.0, -5.0]


def test_six_numbers_are_an_inertia_with_products(tmp_path: Path) -> None:
    told = {"payload": PAYLOAD | {"inertia": [0.02, 0.001, 0.02, 0.002, 0.003, 0.02]}}
    payload = load_study(written(tmp_path, told)).setups["b.csv"].payload
    assert payload is not None
    expected = [[0.02, 0.001, 0.002], [0.001, 0.02, 0.003], [0.002, 0.003, 0.02]]
    assert payload.inertia_matrix.tolist() == expected


def test_parts_of_a_recording_were_made_as_the_whole(tmp_path: Path) -> None:
    path = write_study(tmp_path, {}, recordings=[{"file": "a.csv", "payload": PAYLOAD}])
    log().to_csv(tmp_path / "a.csv", index=False)
    study = load_study(path)
    assert study.split.startswith("by blocks")
    assert [study.setup_of(r).payload is not None for r in study.recordings] == [True, True]


def test_a_simulation_is_of_what_its_recording_held(tmp_path: Path) -> None:
    study = load_study(written(tmp_path, {"payload": PAYLOAD}, simulation=["b.csv"]))
    assert study.setup_of(study.simulation[0]).payload is not None


FAULTS: dict[str, tuple[dict[str, Any], str]] = {
    "unknown key": ({"payloads": PAYLOAD}, r"recordings\[1\]: unknown key 'payloads'.*'payload'"),
    "no robot": ({"robot": "havy.urdf"}, "b.csv: robot: no such file: .*nearest: 'heavy.urdf'"),
    "robot is no text": ({"robot": 3}, "b.csv: robot: expected text, got 3"),
    "other joints": ({"robot": "joints.urdf"}, "b.csv: joints.urdf: no joint 'elbow' that moves"),
    "other links": (
        {"robot": "links.urdf"},
        "b.csv: robot: joint 'elbow' moves link 'arm2', expected 'fore' as in arm.urdf",
    ),
    "other type": (
        {"robot": "slide.urdf"},
        "b.csv: robot: joint 'elbow' is prismatic, expected revolute as in arm.urdf",
    ),
    "no mapping": ({"payload": 2}, "b.csv: payload: expected 'key: value' lines, got 2"),
    "unknown key of payload": (
        {"payload": PAYLOAD | {"weight": 2}},
        "b.csv: payload: unknown key 'weight'",
    ),
    "no link": ({"payload": {"mass": 1, "com": [0, 0, 0]}}, "b.csv: payload: expected 'link:'"),
    "no mass": ({"payload": {"link": "tool", "com": [0, 0, 0]}}, "payload: expected 'mass:'"),
    "no com": ({"payload": {"link": "tool", "mass": 1}}, "b.csv: payload: expected 'com:'"),
    "unknown link": (
        {"payload": PAYLOAD | {"link": "tol"}},
        "b.csv: payload: link: arm.urdf has no link 'tol'; nearest: 'tool'",
    ),
    "link that stands": (
        {"payload": PAYLOAD | {"link": "base"}},
        "payload: link: 'base' is moved by no joint of the study, expected one of those after fore",
    ),
    "negative mass": (
        {"payload": PAYLOAD | {"mass": -1}},
        "b.csv: payload: mass: expected more than 0, got -1",
    ),
    "mass of nothing": ({"payload": PAYLOAD | {"mass": 0}}, "mass: expected more than 0, got 0"),
    "mass in words": (
        {"payload": PAYLOAD | {"mass": "2 kg"}},
        "b.csv: payload: mass: expected a number, got '2 kg'",
    ),
    "half a centre": (
        {"payload": PAYLOAD | {"com": [0, 0]}},
        "b.csv: payload: com has 2 entries, expected 3",
    ),
    "five inertias": (
        {"payload": PAYLOAD | {"inertia": [1, 1, 1, 0, 0]}},
        "inertia: expected a list of 3 moments, or of 6: xx xy yy xz yz zz, got",
    ),
    "no body's inertia": (
        {"payload": PAYLOAD | {"inertia": [1, 1, 3]}},
        r"b.csv: payload: inertia: no body has \[1, 1, 3\]; expected moments about its own centre",
    ),
    "negative inertia": ({"payload": PAYLOAD | {"inertia": [-1, 1, 1]}}, "inertia: no body has"),
    "unknown gain": (
        {"controller": {"kpp": [1, 1]}},
        "b.csv: controller: unknown key 'kpp'; nearest: 'kp'",
    ),
    "gains alone": ({"controller": [1, 1]}, r"b.csv: controller: expected 'key: value' lines, got"),
    "too few gains": ({"controller": {"kp": [1]}}, "b.csv: controller: kp has 1 entries"),
    "negative gains": ({"controller": {"kd": [1, -1]}}, "b.csv: controller: kd: .*-1 for elbow"),
    "compensated in words": (
        {"payload": PAYLOAD, "compensated": "yes please"},
        "b.csv: compensated: expected true or false, got 'yes please'",
    ),
    "nothing to compensate": (
        {"compensated": True},
        "b.csv: compensated: expected 'payload:' or 'robot:' with it",
    ),
    "nothing is compensated": (
        {
            "payload": PAYLOAD,
            "compensated": True,
            "controller": {"gravity_compensation": False},
        },
        "b.csv: compensated: expected a controller with 'gravity_compensation: true'",
    ),
    "list of sessions": ({"session": ["monday"]}, "b.csv: session: expected text or a number"),
    "session yes": ({"session": True}, "b.csv: session: expected text or a number, got True"),
    "temperature in words": ({"temperature": "warm"}, "temperature: expected a number, got 'warm'"),
    "too few temperatures": (
        {"temperature": [20]},
        "b.csv: temperature has 1 entries, expected 2: the study has 2 joints",
    ),
    "temperature of another joint": (
        {"temperature": {"wrist": 20}},
        "b.csv: temperature: unknown key 'wrist'",
    ),
    "temperature of one joint": (
        {"temperature": {"elbow": 20}},
        "b.csv: temperature: nothing for joint 'shoulder'",
    ),
    "too cold": ({"temperature": -300}, "temperature: expected degrees Celsius, got -300"),
    "surface": ({"surface": 3}, "b.csv: surface: expected text, got 3"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_wrong_with_an_entry_is_said(tmp_path: Path, fault: str) -> None:
    told, message = FAULTS[fault]
    text = URDF.format(mass=1)
    (tmp_path / "heavy.urdf").write_text(text)
    (tmp_path / "joints.urdf").write_text(text.replace('"elbow"', '"elbw"'))
    (tmp_path / "links.urdf").write_text(text.replace('"fore"', '"arm2"'))
    slide = text.replace('name="elbow" type="revolute"', 'name="elbow" type="prismatic"')
    (tmp_path / "slide.urdf").write_text(slide)
    with pytest.raises(LoadError, match=message):
        load_study(written(tmp_path, told))


def test_what_the_study_lacks_an_entry_cannot_change(tmp_path: Path) -> None:
    own = {"kp": [1, 1], "kd": [1, 1]}
    with pytest.raises(LoadError, match=r"b\.csv: controller: expected one of the study first"):
        load_study(written(tmp_path, {"controller": own}, controller=None))
    alone: dict[str, Any] = {"robot": None}
    with pytest.raises(LoadError, match=r"b\.csv: payload: expected a robot that holds it"):
        load_study(written(tmp_path, {"payload": PAYLOAD}, **alone))
    with pytest.raises(LoadError, match=r"b\.csv: robot: expected one of the study first"):
        load_study(written(tmp_path, {"robot": "arm.urdf"}, **alone))
    twice = [{"file": "b.csv", "session": 1}]
    with pytest.raises(LoadError, match=r"simulation \(b.csv\): session: is said of the recording"):
        load_study(written(tmp_path, {"session": 1}, simulation=twice))


def test_the_tip_must_be_on_the_other_robot_too(tmp_path: Path) -> None:
    flange = WITHOUT_TOOL[WITHOUT_TOOL.index('  <joint name="flange"') : -len("</robot>\n")]
    (tmp_path / "bare.urdf").write_text(WITHOUT_TOOL.replace(flange, ""))
    with pytest.raises(LoadError, match=r"b\.csv: bare\.urdf: no link 'tool' .the study's tip."):
        load_study(written(tmp_path, {"robot": "bare.urdf"}, tip="tool"))


def test_setups_of_a_study_made_in_python_are_checked(tmp_path: Path) -> None:
    study = load_study(written(tmp_path, {}))
    with pytest.raises(ValueError, match=r"setups: no recording 'c.csv', expected one of \['a.csv"):
        load_study(replace(study, setups={"c.csv": Setup()}))
    wrong = Setup(temperature=np.zeros(len(JOINTS) + 1))
    with pytest.raises(ValueError, match=r"b.csv: temperature is \(3,\), expected \(2,\)"):
        load_study(replace(study, setups={"b.csv": wrong}))
