"""Sample configurations and count which links' hulls touch, and whether their meshes do."""

from __future__ import annotations

import copy
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
import numpy.typing as npt

import pdoik

from .._addresses import Packages
from ..occupancy_fit import load_geometry
from .meshes import Mesh, meet
from .report import ClearanceCount, Pair, PairCount, PairReport, Verdict

ALWAYS = 0.95  # of the samples, as in MoveIt's Setup Assistant
CLEARANCES = (0.0, -0.002, -0.004, -0.006)  # [m]
FloatArray = npt.NDArray[np.float64]


def sample_pairs(
    robot: pdoik.Robot,
    urdf: str | Path | Mapping[str, FloatArray] | None = None,
    packages: Packages = (),
    *,
    listed: Collection[Pair] = (),
    free: Sequence[npt.ArrayLike] = (),
    samples: int = 5000,
    seed: int = 0,
) -> PairReport:
    """Which pairs of links need no test, so that free configurations are free by the hulls too.

    Configurations are uniform within the limits. Pairs whose hulls never touch need no verdict.
    Of the others, those are ignored whose meshes meet always (in 95 % of the samples) or in no
    sample; a pair that is ignored as "Never" has met in less than 3 of `samples`
    configurations with 95 % certainty. All others are kept, however often their hulls touch
    in vain, so that no collision is missed: what helps there are closer hulls (`fit_occupancy`'s
    capsules), or a negative `Options.self_clearance` within what they stick out. The report says
    of each such clearance how many free samples are refused, and how many collisions missed.

    Without meshes only what hulls say is known: pairs that touch always, and at configurations
    that are known to be free.

    Args:
        robot: With its hulls; its own ignored pairs count as listed.
        urdf: The robot's description, a file or XML text, whose collision geometry the hulls
            hold; or that geometry, triangles (T, 3, 3) by link in its frame [m]; None for none.
        packages: As in `fit_occupancy`.
        listed: Pairs that are ignored in any case, such as an SRDF's.
        free: Configurations that are known to be free, each (n,).
        samples: How many configurations.
        seed: The same one gives the same answer.

    Raises:
        LoadError: The description or a mesh cannot be read.
        ValueError: The robot has no hulls, or there are no samples.
    """
    if not len(robot.occupancy):
        raise ValueError("robot has no occupancy, so no hulls that could touch")
    if samples < 1:
        raise ValueError(f"samples is {samples}, expected at least 1")
    meshes = None if urdf is None else _meshes(urdf, packages)
    given = {_pair(*links) for links in [*robot.ignored_pairs, *listed]}
    drawn = _configurations(robot, samples, seed)
    hulls_touch = [_touching(robot, q) for q in drawn]
    meshes_meet = [
        set() if meshes is None else _meeting(robot, meshes, q, pairs)
        for q, pairs in zip(drawn, hulls_touch, strict=True)
    ]
    hulls = Counter(pair for touching in hulls_touch for pair in touching)
    met = Counter(pair for meeting in meshes_meet for pair in meeting)
    at_rest = {pair for q in free for pair in _touching(robot, q)}
    adjacent = _adjacent(robot)

    def verdict(pair: Pair) -> Verdict:
        if pair in given:
            return "Listed"
        if pair in adjacent:
            return "Adjacent"
        if pair in at_rest:
            return "Default"
        if (hulls if meshes is None else met)[pair] >= ALWAYS * samples:
            return "Always"
        if meshes is not None and not met[pair]:
            return "Never"
        return "Kept"

    verdicts = {pair: verdict(pair) for pair in sorted({*hulls, *given, *at_rest, *adjacent})}
    kept = {pair for pair, word in verdicts.items() if word == "Kept"}
    is_free = [not kept & meeting for meeting in meshes_meet]
    refused = [bool(kept & touching) for touching in hulls_touch]
    flagged = sum(clear and no for clear, no in zip(is_free, refused, strict=True))
    ignored = sorted(verdicts.keys() - kept)
    clearances = () if meshes is None else _clearances(robot, ignored, drawn, is_free, refused)
    return PairReport(
        robot=robot.name,
        samples=samples,
        pairs=tuple(
            PairCount(
                links=pair,
                hulls=hulls[pair],
                meshes=None if meshes is None else met[pair],
                verdict=verdicts[pair],
            )
            for pair in verdicts
        ),
        free=None if meshes is None else sum(is_free),
        flagged=flagged,
        clearances=clearances,
    )


def _clearances(
    robot: pdoik.Robot,
    ignored: list[Pair],
    drawn: FloatArray,
    is_free: list[bool],
    refused: list[bool],
) -> tuple[ClearanceCount, ...]:
    """How much each clearance refuses and misses; hulls that do not touch are refused by none."""
    robot = copy.deepcopy(robot)
    robot.ignored_pairs = ignored
    solver = pdoik.Solver(robot, pdoik.Options(self_collision=True))
    goals = {tip: np.eye(4) for tip in robot.tip_links}
    at = np.flatnonzero(refused)
    distance = np.array([solver.judge(goals, drawn[k]).self_distance for k in at])
    clear = np.array(is_free, dtype=bool)[at]
    return tuple(
        ClearanceCount(
            clearance=clearance,
            flagged=int((clear & (distance < clearance)).sum()),
            missed=int((~clear & (distance >= clearance)).sum()),
        )
        for clearance in CLEARANCES
    )


def _pair(a: str, b: str) -> Pair:
    return (a, b) if a < b else (b, a)


def _adjacent(robot: pdoik.Robot) -> set[Pair]:
    """Links with hulls that at most one joint moves against each other."""
    occupancy = robot.occupancy
    links = {sphere[0] for sphere in occupancy.spheres}
    links |= {link for a, _, b, _, _ in occupancy.spheroids for link in (a, b)}
    links |= {capsule[0] for capsule in occupancy.capsules}
    pairs = [*combinations(sorted(links), 2)]
    start = _configurations(robot, 1, 0)[0]
    movers = Counter[Pair]()
    at_start = _between(robot, start, pairs)
    for joint in range(robot.dof):
        q = start.copy()
        q[joint] = np.clip(q[joint] + 0.1, robot.lower[joint], robot.upper[joint])
        q[joint] -= 0.1 * (q[joint] == start[joint])
        moved = _between(robot, q, pairs)
        movers.update(p for p in pairs if not np.allclose(at_start[p], moved[p], atol=1e-9))
    return {pair for pair in pairs if movers[pair] <= 1}


def _between(robot: pdoik.Robot, q: FloatArray, pairs: Collection[Pair]) -> dict[Pair, FloatArray]:
    """Where the second link of each pair is in the frame of the first, (4, 4)."""
    poses = {link: robot.fk(q, link) for link in {link for pair in pairs for link in pair}}
    return {(a, b): np.linalg.inv(poses[a]) @ poses[b] for a, b in pairs}


def _meshes(urdf: str | Path | Mapping[str, FloatArray], packages: Packages) -> dict[str, Mesh]:
    if not isinstance(urdf, Mapping):
        urdf = {link.name: link.triangles for link in load_geometry(urdf, packages)}
    return {link: Mesh(triangles) for link, triangles in urdf.items() if len(triangles)}


def _configurations(robot: pdoik.Robot, samples: int, seed: int) -> FloatArray:
    slides = np.array([kind == "prismatic" for kind in robot.joint_types])
    wide = np.where(slides, 1.0, np.pi)
    limited = np.isfinite(robot.lower) & np.isfinite(robot.upper)
    lower, upper = np.where(limited, robot.lower, -wide), np.where(limited, robot.upper, wide)
    return np.random.default_rng(seed).uniform(lower, upper, (samples, robot.dof))


def _touching(robot: pdoik.Robot, q: npt.ArrayLike) -> set[Pair]:
    """The pairs of links whose hulls touch, ignored ones included."""
    return {_pair(*links) for links in pdoik.pairs_touching_at(robot, q)}


def _meeting(
    robot: pdoik.Robot, meshes: dict[str, Mesh], q: FloatArray, touching: set[Pair]
) -> set[Pair]:
    """Those whose meshes meet; a link whose mesh is not known is taken to meet.

    Hulls hold the meshes, so no other pairs meet.
    """
    poses = {link: robot.fk(q, link) for pair in touching for link in pair}
    return {pair for pair in touching if _meet(meshes, poses, *pair)}


def _meet(meshes: dict[str, Mesh], poses: dict[str, FloatArray], a: str, b: str) -> bool:
    if a not in meshes or b not in meshes:
        return True
    return meet(meshes[a], meshes[b], np.linalg.inv(poses[a]) @ poses[b])
