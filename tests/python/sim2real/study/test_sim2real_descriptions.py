"""Descriptions as they are: massless and held joints, followers, floating bases, broken bodies."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pinocchio = pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.errors import LoadError  # noqa: E402
from pdoik.sim2real import examine, prepare, write  # noqa: E402
from pdoik.sim2real.effects import CATALOGUE  # noqa: E402
from pdoik.sim2real.study import load_study  # noqa: E402
from sim2real_channels import study  # noqa: E402
from studies import MJCF, URDF, log, write_study  # noqa: E402

FINGERS = """
  <link name="left"/><link name="right"/>
  <joint name="grip" type="prismatic"><parent link="tool"/><child link="left"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="5" velocity="1"/></joint>
  <joint name="follows" type="prismatic"><parent link="tool"/><child link="right"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.04" effort="5" velocity="1"/>
    <mimic joint="grip"/></joint>
</robot>"""


def notes_of(folder: Path, model: str) -> str:
    return "\n".join(load_study(write_study(folder, None, model)).notes)


def test_joints_that_the_study_does_not_list_are_said_to_be_held(tmp_path: Path) -> None:
    said = notes_of(tmp_path, URDF.format(mass=1).replace("</robot>", FINGERS))
    assert "not in the study, so held at zero: joint grip" in said
    assert "joint follows follows joint grip in the robot's description, but is held" in said


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_a_base_that_floats_is_refused(tmp_path: Path, kind: str) -> None:
    free = f"""<link name="world"/><joint name="free" type="{kind}">
      <parent link="world"/><child link="base"/></joint></robot>"""
    model = URDF.format(mass=1).replace("</robot>", free)
    with pytest.raises(LoadError, match="'free' lets float: say 'base:'"):
        load_study(write_study(tmp_path, None, model))


def test_a_base_that_floats_in_an_mjcf_is_refused_and_a_loose_cube_is_not(tmp_path: Path) -> None:
    plain = MJCF.format(mass=1)
    trunk = '<worldbody><body name="trunk"><freejoint name="free"/><geom size="0.1"/>'
    floating = plain.replace("<worldbody>", trunk).replace("</worldbody>", "</body></worldbody>")
    with pytest.raises(LoadError, match="'free' lets float: say 'base:'"):
        load_study(write_study(tmp_path, None, floating))
    cube = '<body name="cube"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body></worldbody>'
    loose = plain.replace("</worldbody>", cube)
    assert load_study(write_study(tmp_path, None, loose)).joints == ("shoulder", "elbow")


def test_a_wrist_without_mass_is_diagnosed_and_all_files_are_there(tmp_path: Path) -> None:
    examination = examine(write_study(tmp_path, None, URDF.format(mass=0)))
    assert any("joint elbow moves no mass" in note for note in examination.diagnosis.notes)
    write(tmp_path / "report", examination, quick=True)
    made = {path.name for path in (tmp_path / "report").iterdir()}
    assert made >= {"diagnosis.json", "model.json", "improved.xml", "improved.urdf", "report.html"}


def test_files_whose_names_differ_in_brackets_only_are_two_recordings(tmp_path: Path) -> None:
    logs = {"run (1).csv": log(), "run (2).csv": log(700.0), "c.csv": log(900.0)}
    prepared = prepare(load_study(write_study(tmp_path, logs)))
    assert [motion.since for motion in prepared.fit.motions] == [0.0, 0.0]


def test_parts_of_one_file_follow_one_another(tmp_path: Path) -> None:
    prepared = prepare(load_study(write_study(tmp_path, {"run (1).csv": log()})))
    (first,) = prepared.fit.motions
    assert prepared.validate is not None
    (last,) = prepared.validate.motions
    assert first.since == 0.0
    assert last.since == pytest.approx(0.7 * float(np.ptp(log()["time"])), rel=0.02)


@pytest.mark.parametrize(
    "seed", [pytest.param(k, marks=() if k < 3 else pytest.mark.long) for k in range(10)]
)
def test_whatever_is_broken_in_a_description_nothing_is_lost(
    tmp_path: Path, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # where MuJoCo would write its warnings
    rng = np.random.default_rng(seed)
    plain = study(tmp_path, (0.0, 0.1, 0.0), (1.0, 1.0, 1.0))
    assert plain.robot is not None
    root = ElementTree.parse(plain.robot).getroot()
    for link in root.findall("link"):
        inertial = link.find("inertial")
        mass = None if inertial is None else inertial.find("mass")
        inertia = None if inertial is None else inertial.find("inertia")
        if inertial is None or mass is None or inertia is None:
            continue
        kind = rng.integers(5)
        if kind == 0:
            link.remove(inertial)
        elif kind == 1:
            mass.set("value", "1e-9")
        elif kind == 2:
            for name in inertia.attrib:
                inertia.set(name, "0")
        elif kind == 3:
            inertia.set("izz", "5.0")  # breaks A + B >= C
    if not root.findall(".//mass"):
        pytest.skip("nothing left to weigh")
    plain.robot.write_text(ElementTree.tostring(root, encoding="unicode"))
    examination = examine(plain)
    for finding in examination.diagnosis.findings:
        for name, figure in finding.parameters.items():
            upper = {p.name: p.upper for p in CATALOGUE[finding.effect].parameters}
            assert figure.value < upper.get(name, np.inf)
    write(tmp_path / "report", examination, quick=True)
    made = {path.name for path in (tmp_path / "report").iterdir()}
    said = (tmp_path / "report" / "diagnosis.json").read_text()
    whole = {"diagnosis.json", "model.json", "improved.xml", "improved.urdf", "report.html"}
    assert made >= whole, re.findall('[^"]*could not be made[^"]*', said)
    assert not (tmp_path / "MUJOCO_LOG.TXT").exists()
    pinocchio.buildModelFromUrdf(str(tmp_path / "report" / "improved.urdf"))
    loaded = mujoco.MjModel.from_xml_path(str(tmp_path / "report" / "improved.xml"))
    assert (loaded.body_mass >= 0.0).all()
