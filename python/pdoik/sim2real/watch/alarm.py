"""What is reported of a machine that has changed."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field

_SHOWN = 4  # figures of a cause on the terminal


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """Change of a parameter, with its standard deviation."""

    value: float
    std: float  # standard error
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """An effect that would explain what is seen since an onset."""

    effect: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    change: dict[str, Figure] = field(default_factory=dict)  # more than the model has
    worse: float = 0.0  # twice the log odds of the likeliest cause against it

    @property
    def where(self) -> str:
        """Joints or links."""
        return ", ".join(self.joints or self.links) or "the base"

    def __str__(self) -> str:
        """The cause in a few words."""
        clear = [pair for pair in self.change.items() if abs(pair[1].value) > 2.0 * pair[1].std]
        shown = [
            f"{name} {each.value:+.3g} +- {each.std:.1g} {each.unit}".rstrip()
            for name, each in clear[:_SHOWN]
        ]
        return f"{self.effect.replace('_', ' ')} at {self.where}: {', '.join(shown)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Alarm:
    """A change of the machine: at once when it is noticed, once more when its cause is learnt."""

    number: int  # the same for both
    stage: str  # "noticed" or "learnt"
    joint: str  # whose chart crossed
    onset: float  # when it began, on the log's clock [s]
    told: float  # when it is reported: time of the last row that it rests on [s]
    source: str  # the log
    causes: tuple[Cause, ...]  # that act together; () where none fits, or it is over
    instead: tuple[Cause, ...] = ()  # what fits as well as the first of these

    @property
    def confidence(self) -> float:
        """Probability of the first cause among all that fit; 0 where none does."""
        odds = [math.exp(-0.5 * each.worse) for each in self.instead]
        return 1.0 / (1.0 + sum(odds)) if self.causes else 0.0

    def to_json(self) -> str:
        """One line."""
        return json.dumps({"schema": "pdoik.alarm/1", **asdict(self)})

    def __str__(self) -> str:
        """One line for a terminal."""
        what = "; ".join(map(str, self.causes)) or (
            "no cause fits" if self.stage == "noticed" else "over, or no cause fits"
        )
        other = ", ".join(
            f"{each.effect.replace('_', ' ')} at {each.where}" for each in self.instead
        )
        other = f"  ({self.confidence:.0%}, or {other})" if other else ""
        where = f"{self.source}: " if self.source else ""
        return (
            f"{where}{self.told:.2f} s  alarm {self.number} {self.stage}  {self.joint} since"
            f" {self.onset:.2f} s  {what}{other}"
        )
