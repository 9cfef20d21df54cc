"""The studies of a campaign: every effect by every way that suits it, and the decoys."""

from __future__ import annotations

from collections.abc import Iterator

from bench.sim2real.concealed.catalogue import EFFECTS, ways_of
from bench.sim2real.concealed.effects_outside import KINDS
from bench.sim2real.concealed.effects_sensor import LIES
from bench.sim2real.concealed.robots import NAMES
from bench.sim2real.concealed.spec import WorldSpec

CLEAN = ("plain", "plain", "feedback", "plain", "no_torque")  # ways in which nothing is hidden


def campaign(
    first_seed: int,
    *,
    plain: int = 5,
    per_way: int = 2,
    clean: int = 100,
    outside: int = 6,
    lying: int = 6,
    still: int = 20,
) -> Iterator[WorldSpec]:
    """Specs with seeds that count up from `first_seed`; robots take turns.

    `plain`, `per_way`, `outside` and `lying` are numbers per effect or kind.
    """
    plans: list[tuple[str, str]] = []
    for effect in EFFECTS:
        for way in ways_of(effect):
            plans += [(effect, way)] * (plain if way == "plain" else per_way)
    plans += [("clean", CLEAN[k % len(CLEAN)]) for k in range(clean)]
    plans += [(f"outside:{kind}", "plain") for kind in KINDS for _ in range(outside)]
    plans += [(f"lying:{kind}", "plain") for kind in LIES for _ in range(lying)]
    plans += [("still", "plain")] * still
    for index, (effect, way) in enumerate(plans):
        robot = NAMES[(7 * index + index // len(NAMES)) % len(NAMES)]
        yield WorldSpec(seed=first_seed + index, effect=effect, hide=way, robot=robot)
