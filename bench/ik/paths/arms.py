"""The arms of these rows, where they work, and what judges them: made once per process."""

import re
from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple

import pdoik
from bench.ik.lines import jobs_of
from bench.ik.soak.judge import Judge
from bench.ik.soak.robots import RobotSpec, builtin_spec

ARMS = ("panda", "ur10", "iiwa14", "torso")
LIFT, MOUNT = 0.5, 0.35  # of the torso, and where it has the arm when it is down [m]
COLUMN = ("torso_lift", (0.0, 0.0, 0.1), (0.0, 0.0, 0.22), 0.08, 0.0)  # what holds the arm
_TORSO = """
  <link name="torso_base"/>
  <link name="torso_lift"/>
  <joint name="torso_joint" type="prismatic">
    <parent link="torso_base"/><child link="torso_lift"/>
    <axis xyz="0 0 1"/><limit lower="0" upper="{lift}" effort="100" velocity="0.2"/>
  </joint>
  <joint name="torso_mount" type="fixed">
    <parent link="torso_lift"/><child link="panda_link0"/>
    <origin xyz="0 0 {mount}"/>
  </joint>
</robot>"""


by_arm = partial(jobs_of, arm=ARMS)


class Place(NamedTuple):
    """Where an arm works with ease, in cylinder coordinates of its base [m]."""

    radius: tuple[float, float]
    height: tuple[float, float]
    size: float  # of what it does there, as a share of a Panda's


PLACES = {
    "panda": Place((0.38, 0.58), (0.2, 0.55), 1.0),
    "ur10": Place((0.5, 0.85), (0.1, 0.7), 1.4),
    "iiwa14": Place((0.42, 0.6), (0.2, 0.6), 1.0),
    "torso": Place((0.38, 0.58), (0.4, 1.15), 1.0),
}


@cache
def spec_of(arm: str) -> RobotSpec:
    """A shipped arm; or `torso`, a Panda on a column that lifts it."""
    if arm != "torso":
        return builtin_spec(arm)
    panda = builtin_spec("panda")
    text = re.sub(r"</robot>\s*$", _TORSO.format(lift=LIFT, mount=MOUNT), panda.description())
    capsules = [*panda.capsules, COLUMN]
    pairs = [*panda.ignored_pairs, ("torso_lift", "panda_link1")]
    return replace(panda, name="", urdf=text, capsules=capsules, ignored_pairs=pairs)


@cache
def robot_of(arm: str) -> pdoik.Robot:
    """The library's."""
    return spec_of(arm).make()


@cache
def judge_of(arm: str) -> Judge:
    """Pinocchio's kinematics, and the capsules of its description; no link has anything else."""
    judge = Judge(spec_of(arm), robot_of(arm).joint_names)
    assert judge.swept.all()
    return judge
