"""What is compared: per arm the problems, who solves them, and who says whether they are solved."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import ClassVar, NamedTuple

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm, PinocchioJudge
from bench.ik.judges.recheck import UrdfChain, recheck
from bench.ik.methods import Answer, Goal, Problem, Terms, make_method
from bench.ik.methods.ours import CONTACT_TOLERANCE, PdoikDefault
from bench.ik.scenes.objects import ObjectModel, Scene, random_scene

FINE, SHORT = 1e-6, 0.01  # of poses without obstacles: [m] and [rad], [s]
COARSE = 0.01  # the paper's [m] and [rad]
MAX_TIME = 60.0  # the paper's [s]
OBJECTS, LEAF = 9, 0.1  # of the paper's scenes [m]
BOXES = 9
POINTS_PER_EDGE = 3  # 27 points per box, 243 in all

# Solved from one start by that prototype, by goal and boxes, on targets and hulls of its own.
PROTOTYPE = {
    ("pose", 0): {"ur10": 0.91, "iiwa14": 0.94, "panda": 0.76},
    ("axis", 0): {"ur10": 0.89, "iiwa14": 0.97, "panda": 0.86},
    ("axis", BOXES): {"ur10": 0.82, "iiwa14": 0.95, "panda": 0.81},
}


class Compared(NamedTuple):
    """Problems and methods of one arm."""

    problems: list[Problem]
    methods: dict[str, Callable[[Problem], Answer]]
    confirms: Callable[[Problem, FloatArray], bool]  # whether a configuration solves it
    prototype: str = ""  # share that the prototype of the notes on the paper solved


class Experiment(NamedTuple):
    """A table, how many problems it has per arm, and what makes them of a generator."""

    title: str
    note: str
    count: int
    make: Callable[[Arm, int, np.random.Generator], Compared]


def plan(
    targets: int, scenes: int, models: Sequence[ObjectModel], source: str, libraries: Path
) -> Iterator[Experiment]:
    """All of them; some have targets without obstacles, some scenes."""
    yield Experiment(
        f"{targets} reachable poses per arm, {FINE:g} m and rad, {1e3 * SHORT:g} ms",
        "All start mid-range, then at random until solved or out of time; judged by Pinocchio.",
        targets,
        partial(with_peers, libraries),
    )
    yield Experiment(
        f"{scenes} scenes per arm: {OBJECTS} objects, 5-DoF goals, default options",
        f"Objects: {source}, scaled 1 to 3 times, voxel grid of {LEAF:g} m over the scene. "
        "The configuration that defines the target is clear. The cloud is set before timing.",
        scenes,
        partial(among_objects, models),
    )
    for goal, boxes in PROTOTYPE:
        count, points = (scenes, boxes * POINTS_PER_EDGE**3) if boxes else (targets, 0)
        yield Experiment(
            f"Algorithm IK from omega = 0: {6 if goal == 'pose' else 5}-DoF, {points} points",
            f"{count} targets per arm, {COARSE:g} m and rad, contact {CONTACT_TOLERANCE:g} m.",
            count,
            partial(paper_and_plain, libraries, goal, boxes),
        )


class _UntilTimeIsUp(PdoikDefault):
    changes: ClassVar = {"max_restarts": 1_000_000}  # time is the only limit, as for the peers


def with_peers(libraries: Path, arm: Arm, count: int, rng: np.random.Generator) -> Compared:
    """Random reachable poses without obstacles, all from mid-range; judged by Pinocchio."""
    q0 = arm.robot.mid_configuration()
    problems = [
        Problem(arm.robot.fk(arm.random_configuration(rng)), q0, near_q0=False)
        for _ in range(count)
    ]
    terms = {"position_tolerance": FINE, "rotation_tolerance": FINE, "max_time": SHORT}
    methods = {"pdoik": _UntilTimeIsUp(arm, Terms(goal="pose", **terms)).solve} | {
        name: make_method(name, arm, Terms(goal="pose", **terms, seed=1), libraries).solve
        for name in ("KDL LMA", "LM on Pinocchio")
    }
    judge = PinocchioJudge(arm, FINE)
    return Compared(problems, methods, lambda problem, q: judge(problem.T_base_tip, q))


def among_objects(
    models: Sequence[ObjectModel], arm: Arm, count: int, rng: np.random.Generator
) -> Compared:
    """The paper's first experiment with default options: axis goals among nine random objects.

    The configuration that defines the target is clear; plain NumPy checks the answers.
    """
    solver = pdoik.Solver(arm.robot, pdoik.Options(goal="axis", goal_axis="z"))
    chain = UrdfChain(arm.urdf, arm.robot.joint_names)

    def draw() -> Problem:
        q = arm.random_configuration(rng)
        T = arm.robot.fk(q)

        def is_clear(scene: Scene) -> bool:
            return solver.judge(T, q, obstacles=scene.cloud(LEAF)).clearance > 0

        return Problem(T, q, random_scene(rng, models, OBJECTS, is_clear).cloud(LEAF))

    def confirms(problem: Problem, q: FloatArray) -> bool:
        options, T = solver.options, problem.T_base_tip
        return recheck(chain, arm.robot, options, T, q, problem.points).confirms(options)

    return Compared([draw() for _ in range(count)], {"pdoik": _solve(solver)}, confirms)


def paper_and_plain(
    libraries: Path, goal: Goal, boxes: int, arm: Arm, count: int, rng: np.random.Generator
) -> Compared:
    """Algorithm IK from omega = 0, the library's and cpp/testing's; the library judges both."""
    asked = {
        "goal": goal,
        "position_tolerance": COARSE,
        "rotation_tolerance": COARSE,
        "clearance_tolerance": CONTACT_TOLERANCE,
        "max_time": MAX_TIME,
    }
    tight = pdoik.AugmentedLagrangianOptions(constraint_tolerance=CONTACT_TOLERANCE)
    options = pdoik.Options(method="paper", augmented_lagrangian=tight, **asked)
    solver = pdoik.Solver(arm.robot, options)
    hulls = arm.robot.occupancy.to_yaml()
    plain = arm.peer(libraries / "libpdoik_peer_plain.so", occupancy_yaml=hulls, **asked)
    methods = {
        "paper": _solve(solver),
        "plain scalar": lambda p: Answer.of(plain.solve(p.T_base_tip, obstacles=p.points)),
    }

    def draw() -> Problem:
        q = arm.random_configuration(rng)
        T = arm.robot.fk(q)
        return Problem(T, q, _boxes(lambda box: solver.judge(T, q, box).clearance > 0, boxes, rng))

    def confirms(problem: Problem, q: FloatArray) -> bool:
        return solver.judge(problem.T_base_tip, q, obstacles=problem.points).success

    shares = PROTOTYPE[goal, boxes]
    return Compared([draw() for _ in range(count)], methods, confirms, f"{shares[arm.name]:.2f}")


def _solve(solver: pdoik.Solver) -> Callable[[Problem], Answer]:
    return lambda problem: Answer.of(solver.solve(problem.T_base_tip, obstacles=problem.points))


def _boxes(
    is_clear: Callable[[FloatArray], bool], count: int, rng: np.random.Generator
) -> FloatArray:
    """Boxes of 6 to 30 cm where the paper puts obstacles, each clear, as points (N, 3) [m]."""
    edge = np.linspace(-1, 1, POINTS_PER_EDGE)
    lattice = np.stack(np.meshgrid(edge, edge, edge), axis=-1).reshape(-1, 3)
    boxes = [np.empty((0, 3))]
    while len(boxes) <= count:
        center = rng.uniform((-0.6, -0.6, 0.0), (0.6, 0.6, 1.2))
        box = center + rng.uniform(0.03, 0.15, 3) * lattice
        if is_clear(box):
            boxes.append(box)
    return np.concatenate(boxes)
