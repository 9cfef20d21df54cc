"""What the experiments share: arms, random targets, an independent judge, methods taking turns."""

from __future__ import annotations

import importlib
import importlib.resources
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np
import numpy.typing as npt

import pdoik
from bench.common.peer_library import Peer, PeerSetup
from bench.common.timings import Solve

FloatArray = npt.NDArray[np.float64]
Goal = Literal["pose", "axis"]
Problem = TypeVar("Problem")
Advance = Callable[[int], None]

ARMS = ("panda", "ur10", "iiwa14")
BLOCK = 50  # problems that a method solves before the next one has its turn
WARM_UP = 20  # problems that every method solves once beforehand, not counted


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm:
    """A built-in robot and its description."""

    name: str
    robot: pdoik.Robot
    urdf: Path

    @classmethod
    def builtin(cls, name: str) -> Arm:
        """The built-in robot of this name in the paper's hulls, which are all that peers know.

        Without capsules nothing keeps it off itself by default, which peers do not do either.
        """
        urdf = Path(str(importlib.resources.files("pdoik") / "robots" / f"{name}.urdf"))
        robot = pdoik.Robot.builtin(name)
        wide = robot.occupancy
        robot.occupancy = pdoik.Occupancy(spheres=wide.spheres, spheroids=wide.spheroids)
        return cls(name=name, robot=robot, urdf=urdf)

    @property
    def tip_link(self) -> str:
        return self.robot.tip_links[0]

    def random_configuration(self, rng: np.random.Generator) -> FloatArray:
        """Uniform within the limits, (n,) [rad]."""
        return rng.uniform(self.robot.lower, self.robot.upper)

    def peer(self, library: Path, **setup: Any) -> Peer:
        """A peer for this arm; `setup` as PeerSetup has it."""
        complete = PeerSetup(urdf=self.urdf, tip_link=self.tip_link, **setup)
        return Peer(library, complete, self.robot.dof)


class PinocchioJudge:
    """Says by Pinocchio's kinematics whether a configuration reaches a pose within the limits."""

    def __init__(self, arm: Arm, position_tolerance: float, rotation_tolerance: float) -> None:
        self._pin: Any = importlib.import_module("pinocchio")
        self._model = self._pin.buildModelFromUrdf(str(arm.urdf))
        self._data = self._model.createData()
        self._tip = self._model.getFrameId(arm.tip_link)
        self._position_tolerance = position_tolerance + 1e-9
        self._rotation_tolerance = rotation_tolerance + 1e-9

    def __call__(self, T_base_tip: FloatArray, q: FloatArray) -> bool:
        """Whether q solves it, up to rounding."""
        self._pin.framesForwardKinematics(self._model, self._data, q)
        gap = self._data.oMf[self._tip].actInv(self._pin.SE3(T_base_tip))
        low, high = self._model.lowerPositionLimit, self._model.upperPositionLimit
        return bool(
            np.linalg.norm(gap.translation) <= self._position_tolerance
            and np.linalg.norm(self._pin.log3(gap.rotation)) <= self._rotation_tolerance
            and (q >= low - 1e-12).all()
            and (q <= high + 1e-12).all()
        )


def take_turns(
    methods: Mapping[str, Callable[[Problem], Solve]], problems: Sequence[Problem], advance: Advance
) -> dict[str, list[Solve]]:
    """All problems by all methods, in turns of BLOCK, so that what disturbs one disturbs all."""
    for method in methods.values():
        for problem in problems[:WARM_UP]:
            method(problem)
    solves: dict[str, list[Solve]] = {name: [] for name in methods}
    for begin in range(0, len(problems), BLOCK):
        for name, method in methods.items():
            solves[name] += [method(problem) for problem in problems[begin : begin + BLOCK]]
            advance(len(problems[begin : begin + BLOCK]))
    return solves
