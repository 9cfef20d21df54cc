"""What a world is asked to be, and what it turned out to be."""

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from bench.sim2real.frame.streams import stream

FIRST_PROOF_SEED = 1_000_000  # development uses seeds below 10 000


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldSpec:
    """A study to be made; the same spec gives the same bytes."""

    seed: int
    effect: str = "clean"  # an id of the catalogue, clean, still, outside:KIND or lying:KIND
    hide: str = "plain"
    robot: str = "panda"
    size: float | None = None  # multiple of the noise floor; None: drawn by the way of hiding

    def stream(self, purpose: str) -> np.random.Generator:
        return stream(self.seed, self.effect, self.hide, self.robot, purpose)


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """What was hidden; never in the study's folder."""

    spec: WorldSpec
    expected: str  # mismatch | no_mismatch | cannot_tell | unknown | lying_channel
    effects: tuple[dict[str, Any], ...]  # the one hidden first, then what stands before it
    joints: tuple[str, ...]  # the study's order, that of all lists below
    still: tuple[str, ...]  # joints that never move
    corner: str  # position | slow | time | own, where that is the way of hiding
    noise: dict[str, Any]
    wanted: float  # multiple of the noise floor that was asked for
    size: float  # the same, measured after simulation where it is seen best
    visibility: dict[str, Any] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        return {"schema": "pdoik.concealed/1", **asdict(self)}
