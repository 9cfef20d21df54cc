"""Robots as people have them: URDF, xacro, MJCF, or the name of a description that is installed.

Comes in: a file, a name or text. Goes out: URDF text; a `Robot` of it, with hulls where asked for;
or a `RobotDescription`, which everything that reads a robot asks: its XML, its joints and links,
and the models that MuJoCo and Pinocchio make of it.
"""

from .facts import JointFacts, RobotFacts
from .load import load_given, load_robot
from .mjcf import model_of_mjcf
from .quiet_mujoco import quiet_mujoco
from .text import (
    Kind,
    RobotDescription,
    robot_facts,
    robot_file,
    shipped_name,
    urdf_file,
    urdf_text,
)
from .xml import (
    UrdfJoint,
    attribute,
    numbers,
    pose_of,
    rotation_of_rpy,
    tree_of,
    urdf_joints,
    xml_text,
)

__all__ = [
    "JointFacts",
    "Kind",
    "RobotDescription",
    "RobotFacts",
    "UrdfJoint",
    "attribute",
    "load_given",
    "load_robot",
    "model_of_mjcf",
    "numbers",
    "pose_of",
    "quiet_mujoco",
    "robot_facts",
    "robot_file",
    "rotation_of_rpy",
    "shipped_name",
    "tree_of",
    "urdf_file",
    "urdf_joints",
    "urdf_text",
    "xml_text",
]
