"""Studies of real machines are drafted from their logs alone, and checked."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import yaml

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

import pdoik
from command_line import run
from pdoik.sim2real import draft_study, load_study

BESIDE = Path(__file__).resolve().parents[5] / "shared"
RECORDINGS = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings"
ROBOTS = Path(pdoik.__file__).parent / "robots"
SO101 = ("rotation", "pitch", "elbow", "wrist_pitch", "wrist_roll", "jaw")
MOST_LOGS = 2  # of a folder that are checked
LINK = """<link name="{0}"><inertial><origin xyz="0 0 -0.1"/><mass value="0.4"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def chain(*joints: str) -> str:
    """Links one after the other, each turned by a joint: as good as any for what is read."""
    text = '<robot name="chain"><link name="base"/>'
    for k, joint in enumerate(joints):
        parent = f"{joints[k - 1]}_link" if k else "base"
        text += LINK.format(f"{joint}_link") + (
            f'<joint name="{joint}" type="continuous"><parent link="{parent}"/>'
            f'<child link="{joint}_link"/><origin xyz="0 0 -0.2"/><axis xyz="0 1 0"/></joint>'
        )
    return text + "</robot>"


def description(folder: str, home: Path) -> Path:
    """A URDF whose joints are called as in the logs."""
    path = home / "robot.urdf"
    if folder == "ur10_unisa":
        path.write_text((ROBOTS / "ur10.urdf").read_text())
    elif folder == "panda_unisa":
        path.write_text((ROBOTS / "panda.urdf").read_text().replace("panda_joint", "fer_joint"))
    elif folder == "go2_hanging":
        from bench.common.descriptions import MissingDescriptionError, go2_urdf

        try:
            path.write_text(go2_urdf().read_text())
        except (MissingDescriptionError, OSError) as error:
            pytest.skip(f"the extra bench is not installed: {error}")
    else:
        names = {
            "so101_sage": SO101,
            "bam_xl330": ("joint1",),
            "dfki_double_pendulum": ("joint1", "joint2"),
        }
        path.write_text(chain(*names[folder]))
    return path


@pytest.mark.parametrize(
    ("folder", "torque"),
    [
        ("ur10_unisa", True),
        ("panda_unisa", True),
        ("dfki_double_pendulum", True),
        ("so101_sage", False),
        ("bam_xl330", False),
        ("go2_hanging", False),
    ],
)
def test_a_real_machines_logs_give_a_study_that_can_be_checked(
    folder: str, torque: bool, tmp_path: Path
) -> None:
    if not (RECORDINGS / folder).is_dir():
        pytest.skip(f"needs recordings/{folder} (PDOIK_SHARED or ../shared)")
    logs = sorted((RECORDINGS / folder).glob("*.csv"))
    robot = description(folder, tmp_path)
    draft = draft_study(robot, logs, folder=tmp_path)
    path = tmp_path / "study.yaml"
    path.write_text(draft.text)
    study = load_study(path)
    assert {each.file or each.name for each in study.recordings} == {each.name for each in logs}
    assert study.fit
    assert study.validate
    content = yaml.safe_load(draft.text)
    assert "units" not in content  # all of them are in SI
    assert sum(each["role"] == "validate" for each in content["recordings"]) == (len(logs) > 1)
    assert any(("measured" in each) == torque for each in draft.questions)
    if len(logs) > MOST_LOGS:
        draft = draft_study(robot, logs[:MOST_LOGS], folder=tmp_path)
        path.write_text(draft.text)
    checked = run("study", "check", path)
    assert checked.exit_code == 0, checked.output
    assert "Smallest size that would be seen" in checked.stdout
    for joint in content["joints"]:
        assert joint in checked.stdout
    friction = any(
        line.strip().startswith("coulomb friction") for line in checked.stdout.splitlines()
    )
    assert friction == (torque or folder == "bam_xl330")
