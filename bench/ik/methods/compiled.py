"""The compiled peers of ../peers: local searches, thrown away where they touch an obstacle."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from bench.ik.experiment import Arm
from bench.ik.methods.problem import Answer, Problem, Terms


class CompiledPeer:
    """A peer library. It restarts at random until an answer is clear of obstacles, or time is up.

    Args:
        arm: Its hulls must each be on one link.
        terms: As the library can.
        libraries: The folder that `build_peers` gives.

    Raises:
        ValueError: The library does not know such terms.
    """

    name: str
    language: str = "C++"
    file: ClassVar[str]

    def __init__(self, arm: Arm, terms: Terms, *, libraries: Path) -> None:
        try:
            self._peer = arm.peer(
                libraries / self.file,
                occupancy_yaml=arm.robot.occupancy.to_yaml(),
                goal=terms.goal,
                position_tolerance=terms.position_tolerance,
                rotation_tolerance=terms.rotation_tolerance,
                max_time=terms.max_time,
                seed=terms.seed,
            )
        except RuntimeError as error:
            raise ValueError(str(error)) from error

    def solve(self, problem: Problem) -> Answer:
        """Solve it, timed inside C++ with the copy of the points."""
        answer = self._peer.solve(problem.T_base_tip, problem.q0, problem.points)
        return Answer(
            q=answer.q,
            claimed=answer.success,
            time=answer.time,
            iterations=answer.iterations,
            evaluations=answer.evaluations,
            restarts=answer.restarts,
        )


class PinocchioLm(CompiledPeer):
    """Levenberg-Marquardt with held limits on Pinocchio's kinematics, 5- and 6-DoF."""

    name = "LM on Pinocchio"
    file = "libpdoik_peer_pinocchio_lm.so"


class KdlLma(CompiledPeer):
    """KDL's ChainIkSolverPos_LMA, whole poses only."""

    name = "KDL LMA"
    file = "libpdoik_peer_kdl_lma.so"
