"""A robot for each place where joints stand that nobody moves: a set may say so by problem."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import pdoik
from bench.ik.problems.hulls import fitted_robot
from bench.ik.problems.judge import Judge
from bench.ik.problems.make import judges_of
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import Meshes, RobotFiles


@dataclass(frozen=True, slots=True)
class HeldRobot:
    """A robot whose other joints stand still.

    Attributes:
        robot: The solver's, with hulls; it ignores the pairs of links that the judge ignores.
        judge: Of its answers, in its order of joints.
        files: What both are made of.
    """

    robot: pdoik.Robot
    judge: Judge
    files: RobotFiles

    def searching(self) -> tuple[Judge, Judge]:
        """Judges that have to agree on a valid configuration."""
        return judges_of(self.files, self.robot.joint_names)


class HeldRobots:
    """Robots by where their joints are held; each is made once.

    Args:
        files: Of the robot.
        meshes: What the judges look at.
        hull_meshes: What the hulls hold.
    """

    def __init__(self, files: RobotFiles, meshes: Meshes, hull_meshes: Meshes) -> None:
        self._files, self._meshes, self._hull_meshes = files, meshes, hull_meshes
        self._made: dict[frozenset[tuple[str, float]], HeldRobot] = {}
        robot = pdoik.Robot.from_urdf(files.xml(), files.base, list(files.tips))
        self.joint_names: list[str] = robot.joint_names  # those that are moved

    def of(self, held: Mapping[str, float]) -> HeldRobot:
        """That of a problem."""
        files = self._files.standing(held, self.joint_names)
        key = frozenset(files.still.items())
        if key not in self._made:
            self._made[key] = self._make(files)
        return self._made[key]

    def groups(self, problems: Sequence[Problem]) -> Iterator[tuple[HeldRobot, list[Problem]]]:
        """The problems of each robot."""
        groups: dict[int, tuple[HeldRobot, list[Problem]]] = {}
        for problem in problems:
            held = self.of(problem.held)
            groups.setdefault(id(held), (held, []))[1].append(problem)
        yield from groups.values()

    def _make(self, files: RobotFiles) -> HeldRobot:
        robot = fitted_robot(files, self._hull_meshes)
        judge = Judge(files, self._meshes, robot.joint_names)
        may_touch = judge.left_out_pairs() & set(combinations(sorted(robot.link_names), 2))
        robot.ignored_pairs = sorted({*robot.ignored_pairs, *may_touch})
        return HeldRobot(robot, judge, files)


def given_by_user(files: RobotFiles, hold: Mapping[str, float]) -> RobotFiles:
    """The files with joints that stand where the user says.

    Raises:
        ValueError: The description has no such joint.
    """
    given = replace(files, told=hold)
    given.xml()  # which looks whether the joints are there
    return given
