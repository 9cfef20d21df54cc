"""R-TR and R-CG: distance-geometric IK by pymanopt's trust regions and conjugate gradients.

Settings are those of the paper's public implementation (utiasSTARS/graphik).
"""

from abc import ABC, abstractmethod
from time import perf_counter
from typing import Literal

import numpy as np
import pymanopt
from pymanopt.optimizers import ConjugateGradient, TrustRegions
from pymanopt.optimizers.optimizer import OptimizerResult

from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm
from bench.ik.methods.distance_geometry.cost import DistanceCost
from bench.ik.methods.distance_geometry.graph import DistanceGraph
from bench.ik.methods.distance_geometry.manifold import GramRank3
from bench.ik.methods.distance_geometry.obstacles import JointSpheres
from bench.ik.methods.distance_geometry.points import BASE, ArmPoints
from bench.ik.methods.distance_geometry.recover import align, angles, within_turns
from bench.ik.methods.problem import Answer, Problem, Terms

Start = Literal["bounds", "q0"]

OBSTACLE_SLACK = 1e-3  # how far a sphere may reach into an obstacle in a solved problem [m]
LIMIT_SLACK = 0.01  # of a joint's range


class DistanceGeometricSolver(ABC):
    """Riemannian optimization of a rank 3 distance matrix (Maric et al. 2021).

    The goal is the tip's position and its z, which must be the last joint's axis. Obstacle points
    keep away from the joints' points only; links between joints are not covered. Neighbouring axes
    that are skew, as the Panda's, may come out mirrored: the distances then fit and the answer
    does not.

    The `start` "bounds" embeds smoothed distance bounds, as the public implementation does, and
    takes from q0 the last joint's angle only; "q0" starts from the points of q0.

    Attributes:
        relaxed_joints: Joints whose limits distances do not tell exactly: a range of a turn or
            more (which loses nothing if it is 720 degrees), one not symmetric about an extreme of
            a distance, and the last joint, whose angle moves no point and is q0's. The others'
            hold as far as the cost is zero. Nothing is clamped: limits may come out violated.

    Raises:
        ValueError: The terms ask for all of the pose, or the arm has no such last axis.
    """

    name: str
    language = "Python (NumPy, pymanopt)"

    def __init__(self, arm: Arm, terms: Terms, start: Start = "bounds") -> None:
        if terms.goal != "axis":
            raise ValueError(f'goal is "{terms.goal}", distances take "axis" only')
        self._robot, self._terms, self._start = arm.robot, terms, start
        self._points = ArmPoints(arm)
        self._graph = DistanceGraph(self._points, arm.robot.lower, arm.robot.upper)
        self._spheres = JointSpheres(arm.robot, self._points)
        self._manifold = GramRank3(len(self._points.names))
        self.relaxed_joints = tuple(arm.robot.joint_names[k] for k in sorted(self._graph.relaxed))

    def solve(self, problem: Problem) -> Answer:
        """Solve it; the terms' time ends the optimization; about 1 ms more is spent besides."""
        begin = perf_counter()
        cost = self.cost(problem)
        with np.errstate(all="ignore"):  # pymanopt divides by zero when it has converged
            result = self._minimize(self._riemannian(cost), self._first(problem))
        found = align(result.point, self._points.zero[list(BASE)])
        lower, upper = self._robot.lower, self._robot.upper
        q = within_turns(
            angles(self._points, found, np.clip(problem.q0, lower, upper)), lower, upper
        )
        return Answer(
            q=q,
            claimed=self._is_solved(problem, q),
            time=perf_counter() - begin,
            iterations=int(result.iterations),
            evaluations=cost.evaluations,
        )

    def cost(self, problem: Problem) -> DistanceCost:
        """The problem as a cost of the points."""
        incidence = self._graph.incidence
        lower, upper = self._graph.ranges(self._points.goal(problem.T_base_tip))
        if len(problem.points):
            weights, least = self._spheres.bounds(problem.points)
            incidence = np.concatenate([incidence, weights])
            lower = np.concatenate([lower, least])
            upper = np.concatenate([upper, np.full(len(least), np.inf)])
        return DistanceCost(incidence, lower, upper)

    @abstractmethod
    def _minimize(self, riemannian: pymanopt.Problem, start: FloatArray) -> OptimizerResult:
        """Run pymanopt's optimizer."""

    def _riemannian(self, cost: DistanceCost) -> pymanopt.Problem:
        function = pymanopt.function.numpy(self._manifold)
        return pymanopt.Problem(
            self._manifold,
            function(lambda Y: cost(Y)),
            euclidean_gradient=function(cost.gradient),
            riemannian_hessian=function(
                lambda Y, Z: self._manifold.projection(Y, cost.hessian(Y, Z))
            ),
        )

    def _first(self, problem: Problem) -> FloatArray:
        if self._start == "q0":
            return self._points.positions(problem.q0)
        return self._graph.start(self._points.goal(problem.T_base_tip))

    def _is_solved(self, problem: Problem, q: FloatArray) -> bool:
        """Whether q is solved by its own test: goal, limits to 1 % of the range, balls to 1 mm."""
        T, goal = self._robot.fk(q), problem.T_base_tip
        z, z_goal = T[:3, 2], goal[:3, 2]
        angle = np.arctan2(np.linalg.norm(np.cross(z, z_goal)), z @ z_goal)
        slack = LIMIT_SLACK * (self._robot.upper - self._robot.lower)
        return bool(
            np.linalg.norm(T[:3, 3] - goal[:3, 3]) <= self._terms.position_tolerance
            and angle <= self._terms.rotation_tolerance
            and (q >= self._robot.lower - slack).all()
            and (q <= self._robot.upper + slack).all()
            and self._spheres.clearance(self._points.positions(q), problem.points)
            >= -OBSTACLE_SLACK
        )


class RiemannianTrustRegion(DistanceGeometricSolver):
    """R-TR of the paper: second order, with the exact Hessian."""

    name = "R-TR"

    def _minimize(self, riemannian: pymanopt.Problem, start: FloatArray) -> OptimizerResult:
        optimizer = TrustRegions(
            kappa=0.1,
            theta=1.0,
            max_iterations=3000,
            min_gradient_norm=0.5e-9,
            max_time=self._terms.max_time,
            verbosity=0,
        )
        # Points nearly in a plane make the Hessian so ill-conditioned that as many inner
        # iterations as unknowns, pymanopt's choice, are too few.
        return optimizer.run(riemannian, initial_point=start, maxinner=10_000)


class RiemannianConjugateGradient(DistanceGeometricSolver):
    """R-CG of the paper: first order."""

    name = "R-CG"

    def _minimize(self, riemannian: pymanopt.Problem, start: FloatArray) -> OptimizerResult:
        optimizer = ConjugateGradient(
            beta_rule="HagerZhang",
            orth_value=1e11,
            max_iterations=100_000,
            min_gradient_norm=1e-9,
            min_step_size=1e-10,
            max_time=self._terms.max_time,
            verbosity=0,
        )
        return optimizer.run(riemannian, initial_point=start)
