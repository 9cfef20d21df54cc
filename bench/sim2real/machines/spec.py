"""What a world is asked to be."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np

FIRST_PROOF_SEED = 2_000_000  # development uses seeds below 100 000


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldSpec:
    """A study to be made; the same spec gives the same bytes."""

    seed: int
    faults: tuple[str, ...] = ()  # of kinds.KINDS
    robot: str = "panda"

    def stream(self, purpose: str) -> np.random.Generator:
        """Random numbers for one purpose."""
        return np.random.default_rng([self.seed, zlib.crc32(purpose.encode())])
