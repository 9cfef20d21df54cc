"""Vectors and poses as YAML and JSON files have them: as lists, or by component."""

from bench.ik.problems.solids import pose
from pdoik.scenes.values import numbers, read_pose, read_yaml, rotation

__all__ = ["numbers", "pose", "read_pose", "read_yaml", "rotation"]
