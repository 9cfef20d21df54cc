"""Problems of the other rows, drawn by their code from their seeds, and their judges."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.common.descriptions import shipped
from bench.ik.goals import five, grasps, hands, regions
from bench.ik.goals.peers.body import Body, by_capsules
from bench.ik.goals.peers.judge import Judge
from bench.ik.goals.peers.problems import STARTS, STARTS_OF_HANDS, Answer, Peer, Region
from bench.ik.goals.world import POSITION, angle, random_in


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """Verdict on an answer, by Pinocchio and NumPy."""

    holds: bool  # all that is claimed of it
    solves: bool  # and it is what was wanted
    error: float = np.nan  # over the least, where one is left [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A question and how its answer is judged."""

    problem: str
    ask: Callable[[Peer], Answer]
    judge: Callable[[Answer], Verdict]


Cases = tuple[Body, Iterator[Case]]


def of_hands(job: Mapping[str, Any]) -> Cases:
    """Boxes of the row `hands`."""
    robot, urdf, tips, more = hands.two_arms()
    one, other = tips
    body = Body(robot=robot, urdf=urdf, tips=tips, table=hands.TABLE, **more)
    solver, judge = pdoik.Solver(robot, pdoik.Options(max_time=0.1, **more)), Judge(body)
    rng = np.random.default_rng([job["seed"], 3, job["index"], 0])
    drawn = _rng_of_starts(job)

    def case(box: hands.Box) -> Case:
        place, turn = box.slack
        asked = [
            Region(tip=one, T=box.middle, lower=-place, upper=place, turn=turn),
            Region(tip=other, T=box.grip, relative_to=one, tolerance=hands.GRIP),
        ]
        starts = _starts(drawn, body, judge, box.q0, STARTS_OF_HANDS)

        def verdict(answer: Answer) -> Verdict:
            holds = judge.holds(answer.q) and not hands.is_wrong(
                judge.kinematics, answer.q, one, other, box.grip, box.middle, place, turn
            )
            return Verdict(holds=holds, solves=holds)

        return Case(
            problem="two FR3 on one box", ask=lambda peer: peer.solve(asked, starts), judge=verdict
        )

    boxes = hands.boxes(rng, solver, judge.kinematics, tips, hands.table())
    return body, map(case, islice(boxes, job["count"]))


def of_regions(job: Mapping[str, Any]) -> Cases:
    """Targets of the row `regions`, kind by kind."""
    robot = by_capsules("panda")
    tip = robot.tip_links[0]
    body = Body(robot=robot, urdf=shipped("panda").read_text(), tips=(tip,))
    judge = Judge(body)
    rng, drawn = np.random.default_rng([job["seed"], 5, job["index"]]), _rng_of_starts(job)
    targets = []
    for _ in range(job["count"]):
        judge.kinematics.place(random_in(robot, rng))
        targets.append(judge.kinematics.link(tip).copy())

    def case(kind: str, T: FloatArray, starts: FloatArray) -> Case:
        asked = [region_of(kind, tip, T)]

        def verdict(answer: Answer) -> Verdict:
            holds = judge.holds(answer.q) and regions.is_met(kind, T, judge.kinematics.link(tip))
            return Verdict(holds=holds, solves=holds)

        return Case(problem=kind, ask=lambda peer: peer.solve(asked, starts), judge=verdict)

    begun = [_starts(drawn, body, judge) for _ in targets]
    return body, (
        case(kind, T, starts)
        for kind in regions.KINDS[1:]
        for T, starts in zip(targets, begun, strict=True)
    )


def region_of(kind: str, tip: str, T: FloatArray) -> Region:
    """What regions.goal_of says."""
    match kind:
        case "free axis":
            return Region(tip=tip, T=T, tilt=0.0)
        case "tilt of 5 degrees":
            return Region(tip=tip, T=T, tilt=float(regions.TILT))
        case "line":
            return Region(tip=tip, T=T, lower=(-regions.LINE, 0, 0), upper=(regions.LINE, 0, 0))
        case "plane":
            return Region(tip=tip, T=T, lower=(-np.inf, -np.inf, 0), upper=(np.inf, np.inf, 0))
        case "look":
            return Region(tip=tip, T=T, look=T[:3, 3] + 0.4 * T[:3, 2])
        case _:
            return Region(tip=tip, T=T)


def of_grasps(job: Mapping[str, Any]) -> Cases:
    """Scenes of the row `grasps`."""
    robot = by_capsules("panda")
    tip = robot.tip_links[0]
    rng, drawn = np.random.default_rng([job["seed"], 1, job["index"]]), _rng_of_starts(job)
    body = Body(
        robot=robot,
        urdf=shipped("panda").read_text(),
        tips=(tip,),
        self_collision=True,
        points=grasps.scene(rng),
    )
    judge = Judge(body)

    def case(choice: grasps.Choice) -> Case:
        asked = [Region(tip=tip, T=T) for T in choice.poses]
        starts = _starts(drawn, body, judge, robot.mid_configuration())

        def verdict(answer: Answer) -> Verdict:
            holds = judge.holds(answer.q) and grasps.is_had(
                judge.kinematics.link(tip), choice.poses[answer.index], judge.clearance()
            )
            return Verdict(holds=holds, solves=holds)

        return Case(
            problem=f"any of {grasps.GRASPS} grasps {choice.kind}",
            ask=lambda peer: peer.any_of(asked, starts),
            judge=verdict,
        )

    return body, map(case, islice(grasps.choices(rng, robot, body.points), job["count"]))


def of_five(job: Mapping[str, Any]) -> Cases:
    """Poses of the row `five`."""
    name = job["robot"]
    robot = five.arm(name)
    tip = robot.tip_links[0]
    body = Body(robot=robot, urdf=five.description(name), tips=(tip,))
    judge = Judge(body)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.01))
    rng = np.random.default_rng([job["seed"], 4, job["index"], five.ROBOTS.index(name)])
    drawn = _rng_of_starts(job)

    def case(_: int) -> Case:
        T = five.any_turn_at_a_place(robot, rng)
        least = five.best(robot, solver, T, rng)
        starts = _starts(drawn, body, judge)

        def verdict(answer: Answer) -> Verdict:
            holds = judge.holds(answer.q)
            at = judge.kinematics.link(tip)
            holds = holds and np.linalg.norm(at[:3, 3] - T[:3, 3]) <= POSITION + 1e-9
            excess = angle(at[:3, :3].T @ T[:3, :3]) / least - 1
            return Verdict(holds=holds, solves=holds and excess <= five.NEAR, error=excess)

        return Case(
            problem=f"{name}, position first",
            ask=lambda peer: peer.nearest(T, tip, starts),
            judge=verdict,
        )

    return body, map(case, range(job["count"]))


def _starts(
    rng: np.random.Generator,
    body: Body,
    judge: Judge,
    first: FloatArray | None = None,
    count: int = STARTS,
) -> FloatArray:
    """The same for all peers, (count, n); those that are drawn touch nothing."""
    starts = [] if first is None else [first]
    while len(starts) < count:
        q = random_in(body.robot, rng)
        if judge.holds(q):
            starts.append(q)
    return np.array(starts)


def _rng_of_starts(job: Mapping[str, Any]) -> np.random.Generator:
    return np.random.default_rng([job["seed"], 7, job["index"]])


CASES: Mapping[str, Callable[[Mapping[str, Any]], Cases]] = {
    "hands": of_hands,
    "grasps": of_grasps,
    "five": of_five,
    "regions": of_regions,
}
