"""What the experiments share: arms, an independent judge, jobs, and methods taking turns."""

import importlib
import subprocess
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any, Self

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.common.commands import console, show, write_report
from bench.common.descriptions import shipped
from bench.common.peer_library import Peer, PeerSetup

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
    def builtin(cls, name: str) -> Self:
        """The built-in robot of this name in the paper's hulls, which are all that peers know.

        Without capsules nothing keeps it off itself by default, which peers do not do either.
        """
        robot = pdoik.Robot.builtin(name)
        wide = robot.occupancy
        robot.occupancy = pdoik.Occupancy(spheres=wide.spheres, spheroids=wide.spheroids)
        return cls(name=name, robot=robot, urdf=shipped(name))

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

    def __init__(self, arm: Arm, tolerance: float) -> None:
        self._pin: Any = importlib.import_module("pinocchio")
        self._model = self._pin.buildModelFromUrdf(str(arm.urdf))
        self._data = self._model.createData()
        self._tip = self._model.getFrameId(arm.tip_link)
        self._tolerance = tolerance + 1e-9  # [m] and [rad]

    def __call__(self, T_base_tip: FloatArray, q: FloatArray) -> bool:
        """Whether q solves it, up to rounding."""
        self._pin.framesForwardKinematics(self._model, self._data, q)
        gap = self._data.oMf[self._tip].actInv(self._pin.SE3(T_base_tip))
        low, high = self._model.lowerPositionLimit, self._model.upperPositionLimit
        return bool(
            np.linalg.norm(gap.translation) <= self._tolerance
            and np.linalg.norm(self._pin.log3(gap.rotation)) <= self._tolerance
            and (q >= low - 1e-12).all()
            and (q <= high + 1e-12).all()
        )


def take_turns(
    methods: Mapping[str, Callable[[Any], Any]],
    problems: Sequence[Any],
    advance: Callable[[int], object],
) -> dict[str, list[Any]]:
    """All problems by all methods, in turns of BLOCK, so that what disturbs one disturbs all."""
    for method in methods.values():
        for problem in problems[:WARM_UP]:
            method(problem)
    outcomes: dict[str, list[Any]] = {name: [] for name in methods}
    for begin in range(0, len(problems), BLOCK):
        for name, method in methods.items():
            outcomes[name] += [method(problem) for problem in problems[begin : begin + BLOCK]]
            advance(len(problems[begin : begin + BLOCK]))
    return outcomes


def blocks(
    total: int, size: int, common: Mapping[str, Any], **axes: Iterable[Any]
) -> dict[str, dict[str, Any]]:
    """A campaign's jobs: of all that the axes name, `size` consecutive problems out of `total`.

    The first problems of all come first, and of these the last axis changes fastest.
    """
    return {
        "-".join([*(str(word).replace(" ", "_") for word in key[::-1]), f"{first:04d}"]): {
            **common,
            **dict(zip(axes, key, strict=True)),
            "first": first,
            "count": min(size, total - first),
        }
        for first in range(0, total, size)
        for key in product(*axes.values())
    }


def output_of(command: Sequence[object], what: str, **more: Any) -> str:
    """What a program prints.

    Raises:
        RuntimeError: It failed.
    """
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False, **more)
    if done.returncode != 0:
        raise RuntimeError(f"{what}: status {done.returncode} {done.stderr.strip()}")
    return done.stdout


def tell(out: Path, text: str, shown: str = "", name: str = "tables", also: str = "") -> None:
    """Write a campaign's report, print it or what is to be shown of it, and say where all is."""
    write_report(out / f"{name}.md", text)
    show(shown or text)
    console.print(f"tables: {out}/{name}.md{also}; trials: trials.parquet")
