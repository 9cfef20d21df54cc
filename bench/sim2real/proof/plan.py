"""Which worlds are made, under which names, and what is asked of the diagnosis."""

from dataclasses import asdict, dataclass
from typing import Any

from bench.sim2real.concealed.catalogue import EFFECTS, campaign
from bench.sim2real.concealed.spec import FIRST_PROOF_SEED, WorldSpec
from bench.sim2real.frame import sealed
from bench.sim2real.frame.streams import stream
from bench.sim2real.proof.reach import ASKED

DEVELOPMENT_SEEDS = 10_000  # and below
QUICK_SEED = 2000
QUICK = (
    ("viscous_friction", "plain"),
    ("coulomb_friction", "second"),
    ("torque_offset", "noise"),
    ("payload", "feedback"),
    ("sensor_gain", "plain"),
    ("torque_gain", "poor"),
    ("clean", "plain"),
    ("outside:pump", "plain"),
    ("lying:tau_sign", "plain"),
    ("still", "plain"),
)
"""One world of each: friction, body, drive and channel, and every kind of decoy."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan(sealed.Plan):
    """The worlds of one run of the proof."""

    @property
    def proof(self) -> bool:
        """Whether these are the seeds that are run once per release."""
        return self.seed >= FIRST_PROOF_SEED

    def facts(self) -> dict[str, Any]:
        return {
            **sealed.Plan.facts(self),
            "catalogue": list(EFFECTS),
            "asked": [asdict(each) for each in ASKED],
            "split": "by the study: its roles fit and validate",
        }


def plan(seed: int | None = None, *, quick: bool = False, every: int = 1) -> Plan:
    """The campaign from a first seed, or some of it.

    Args:
        seed: first of the campaign; the proof's where it is None, or development's with `quick`.
        quick: a handful, for development.
        every: one study in so many, for development.
    """
    if seed is None:
        seed = QUICK_SEED if quick else FIRST_PROOF_SEED
    specs = list(campaign(seed))
    if seed < FIRST_PROOF_SEED and specs[-1].seed >= DEVELOPMENT_SEEDS:
        raise ValueError(
            f"seed is {seed}: development's {len(specs)} seeds lie below {DEVELOPMENT_SEEDS},"
            f" the proof's begin at {FIRST_PROOF_SEED}"
        )
    if seed >= FIRST_PROOF_SEED and (quick or every > 1):
        raise ValueError("the proof's seeds are run whole: quick or partial runs are development's")
    if quick:
        first = {(spec.effect, spec.hide): spec for spec in reversed(specs)}
        specs = [first[each] for each in QUICK]
    return Plan(seed=seed, specs=named(specs[::every], seed))


def named(specs: list[WorldSpec], seed: int) -> dict[str, WorldSpec]:
    """study0001 and so on, in an order that only the seed tells."""
    order = stream(seed, "names").permutation(len(specs))
    return {f"study{k + 1:04d}": specs[index] for k, index in enumerate(order)}
