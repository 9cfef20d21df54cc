"""The compiled peers of ../peers: local searches, thrown away where they touch an obstacle."""

from dataclasses import asdict
from pathlib import Path

from bench.ik.experiment import Arm
from bench.ik.methods.problem import Answer, Problem, Terms


class CompiledPeer:
    """A peer library. It restarts at random until an answer is clear of obstacles, or time is up.

    The arm's hulls must each be on one link; `libraries` is the folder that `build_peers` gives.

    Raises:
        ValueError: The library does not know such terms.
    """

    name: str
    language = "C++"
    file: str

    def __init__(self, arm: Arm, terms: Terms, *, libraries: Path) -> None:
        setup = asdict(terms)
        del setup["goal_axis"]  # peers know the tip's z
        try:
            self._peer = arm.peer(
                libraries / self.file, occupancy_yaml=arm.robot.occupancy.to_yaml(), **setup
            )
        except RuntimeError as error:
            raise ValueError(str(error)) from error

    def solve(self, problem: Problem) -> Answer:
        """Solve it, timed inside C++ with the copy of the points."""
        return Answer.of(self._peer.solve(problem.T_base_tip, problem.q0, problem.points))


class PinocchioLm(CompiledPeer):
    """Levenberg-Marquardt with held limits on Pinocchio's kinematics, 5- and 6-DoF."""

    name = "LM on Pinocchio"
    file = "libpdoik_peer_pinocchio_lm.so"


class KdlLma(CompiledPeer):
    """KDL's ChainIkSolverPos_LMA, whole poses only."""

    name = "KDL LMA"
    file = "libpdoik_peer_kdl_lma.so"
