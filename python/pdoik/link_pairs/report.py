"""What sampling says of each pair of links, and the SRDF that follows."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal
from xml.sax.saxutils import quoteattr

from .._files import write_whole

Pair = tuple[str, str]
Verdict = Literal["Listed", "Adjacent", "Default", "Always", "Never", "Kept"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PairCount:
    """A pair of links that are adjacent or whose hulls touched in some sample.

    Verdicts are the Setup Assistant's reasons: "Adjacent" (joined by one joint at most, and never
    tested), "Always" touching, "Never" (the hulls touch, the meshes in no sample), "Default"
    (touching in a configuration that is known to be free); "Listed" by the caller; all others are
    "Kept".
    """

    links: Pair
    hulls: int  # samples in which the hulls touch
    meshes: int | None  # ... and the meshes meet; None without meshes
    verdict: Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class ClearanceCount:
    """What `Options.self_clearance` costs and spares, the ignored pairs left out."""

    clearance: float  # [m]
    flagged: int  # free samples that the hulls refuse
    missed: int  # samples in which meshes meet that the hulls let pass


@dataclass(frozen=True, slots=True, kw_only=True)
class PairReport:
    """Pairs, and what is left to the hulls when those that need no test are ignored."""

    robot: str
    samples: int
    pairs: tuple[PairCount, ...]
    free: int | None  # samples in which no meshes meet but those of ignored pairs
    flagged: int  # of the free ones (of all without meshes), those in which hulls touch
    clearances: tuple[ClearanceCount, ...] = ()  # 0 first; empty without meshes

    @property
    def ignored(self) -> list[Pair]:
        """Pairs for Robot.ignored_pairs, sorted."""
        return sorted(pair.links for pair in self.pairs if pair.verdict != "Kept")

    @property
    def flagged_share(self) -> float:
        """Share of free configurations that the hulls refuse; of all without meshes."""
        counted = self.samples if self.free is None else self.free
        return self.flagged / counted if counted else 0.0

    def to_srdf(self) -> str:
        """An SRDF with the ignored pairs, for `load_srdf_pairs` and MoveIt."""
        judged = "hulls alone" if self.free is None else "hulls and meshes"
        of = "configurations" if self.free is None else "free configurations"
        lines = [
            '<?xml version="1.0"?>',
            f"<!-- Sampled {self.samples} times by {judged}: the hulls refuse"
            f" {100 * self.flagged_share:.2f} % of {of}. -->",
            f"<robot name={quoteattr(self.robot)}>",
        ]
        reason = {pair.links: pair.verdict for pair in self.pairs}
        lines += [
            f"  <disable_collisions link1={quoteattr(a)} link2={quoteattr(b)}"
            f' reason="{"User" if reason[a, b] == "Listed" else reason[a, b]}"/>'
            for a, b in self.ignored
        ]
        return "\n".join([*lines, "</robot>", ""])

    def write(self, path: str | Path) -> None:
        """Write the SRDF whole or not at all."""
        write_whole(path, self.to_srdf())
