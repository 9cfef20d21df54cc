"""Which worlds a campaign is of."""

from __future__ import annotations

import zlib
from collections.abc import Iterable

import numpy as np

from bench.sim2real.legged.spec import BACKGROUNDS, HEALTHY, KINDS, ROBOTS, Spec


def plan(
    seed: int,
    count: int,
    robots: Iterable[str] = ROBOTS,
    backgrounds: Iterable[str] = BACKGROUNDS,
) -> dict[str, Spec]:
    """Specs by names that tell nothing but their order.

    Robots and backgrounds take turns; with each, every fifth world or so has nothing hidden, and
    the kinds come one after the other in an order that the seed tells.
    """
    sorts = [(r, b) for r in robots for b in backgrounds]
    queues = {sort: _kinds(seed, *sort) for sort in sorts}
    specs = {}
    for k in range(count):
        robot, background = sorts[k % len(sorts)]
        queue = queues[robot, background]
        kind = queue[(k // len(sorts)) % len(queue)]
        specs[f"world{k:04d}"] = Spec(seed=seed + k, robot=robot, background=background, kind=kind)
    return specs


def _kinds(seed: int, robot: str, background: str) -> list[str]:
    """All kinds once, and as many healthy machines as there are sixths of the whole."""
    rng = np.random.default_rng([seed, zlib.crc32(f"{robot} {background}".encode())])
    kinds = [*KINDS, *[HEALTHY] * -(-len(KINDS) // 5)]
    return [str(kind) for kind in rng.permutation(kinds)]
