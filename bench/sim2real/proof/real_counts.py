"""What counts of a diagnosis of a real machine, and what must not be said of any.

A known fact takes a diagnosis and gives a `Told`. Causes that are there count as named or not,
figures and held-out residuals as in range or not, and findings that cannot be right as wrong or
needless.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any

from pdoik.sim2real.effects import CATALOGUE, VARIABLES

Content = Mapping[str, Any]
Finding = Mapping[str, Any]

SURE = 0.9  # confidence from which a finding's interval must not hold nothing
WORSE = 1e-3  # share by which a residual must grow to be called worse
ONE_SIZE = {"payload", "joint_elasticity", "strain_wave_error"} | {
    each.id for each in CATALOGUE.values() if each.size_first
}  # effects whose first parameter is their size; all parameters are, of others
INFINITE = 1e6  # a stiffness that does nothing; an interval down to 0 tells as little of it


NO_CRASH = "an answer, or a refusal in words"
NO_CONTRADICTION = f"no finding from {SURE:g} of confidence on whose interval holds nothing"
NONE_WORSE = "no joint worse on held-out rows"


@dataclass(frozen=True, slots=True)
class Count:
    """So many of so many."""

    hits: int = 0
    of: int = 0

    def __add__(self, other: "Count") -> "Count":
        return Count(self.hits + other.hits, self.of + other.of)

    def __str__(self) -> str:
        return f"{self.hits} of {self.of}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """What a diagnosis says of a known fact."""

    words: str
    agrees: bool
    needed: Count = Count()  # causes named, of those that are there
    figures: Count = Count()  # in range, of those given
    residuals: Count = Count()  # held out, in range
    wrong: frozenset[int] = frozenset()  # findings that cannot be right, by their place


Fact = Callable[[Content], Told]


@dataclass(frozen=True, slots=True, kw_only=True)
class Tally:
    """What counts of diagnoses, over the facts that are known."""

    needed: Count = Count()
    wrong: int = 0
    figures: Count = Count()
    residuals: Count = Count()
    agree: Count = Count()
    contradicted: int = 0
    worse: int = 0
    crashed: int = 0

    def __add__(self, other: "Tally") -> "Tally":
        return Tally(
            **{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)}
        )


def tally(outcomes: Iterable[Told], diagnosis: Content) -> Tally:
    """Counts of one diagnosis. A finding that two facts call wrong is wrong once."""
    outcomes = list(outcomes)
    return Tally(
        needed=sum((each.needed for each in outcomes), Count()),
        wrong=len(frozenset().union(*(each.wrong for each in outcomes))),
        figures=sum((each.figures for each in outcomes), Count()),
        residuals=sum((each.residuals for each in outcomes), Count()),
        agree=Count(sum(each.agrees for each in outcomes), len(outcomes)),
        contradicted=len(contradicted(diagnosis)),
        worse=len(worse(diagnosis)),
        crashed=int(crashed(diagnosis)),
    )


# What must not be, of any machine


def broken(diagnosis: Content) -> list[tuple[str, str]]:
    """What must not be said of any machine, and what was said instead."""
    crash = [str(diagnosis["verdict"])] if crashed(diagnosis) else []
    return [
        *((NO_CRASH, each) for each in crash),
        *((NO_CONTRADICTION, each) for each in contradicted(diagnosis)),
        *((NONE_WORSE, each) for each in worse(diagnosis)),
    ]


def contradicted(diagnosis: Content) -> list[str]:
    """Findings that are called sure while the interval of their size holds nothing."""
    return [
        f"{named(f)} at a confidence of {f['confidence']:.2f}"
        for f in diagnosis["findings"]
        if f["confidence"] >= SURE and holds_nothing(f)
    ]


def holds_nothing(finding: Finding) -> bool:
    """Whether every figure of its size may be that of an effect that is not there."""
    effect, parameters = CATALOGUE.get(finding["effect"]), finding["parameters"]
    chosen = {p.name for p in effect.parameters if p.chosen} if effect else set()
    names = [name for name in parameters if name not in chosen]
    if finding["effect"] == "unknown":
        sized = "size" in names  # of all values together, since there is such a figure
        names = ["size"] if sized else [name for name in names if name.startswith("value_")]
    elif finding["effect"] in ONE_SIZE:
        names = names[:1]
    nothing = dict(effect.example.nothing or {}) if effect and effect.example else {}
    spans = {name: parameters[name]["interval95"] for name in names}
    at = {name: value for name, value in nothing.items() if value < INFINITE}
    return bool(names) and all(
        low <= at.get(name, 0.0) <= high for name, (low, high) in spans.items()
    )


def worse(diagnosis: Content) -> list[str]:
    """Joints that held-out rows show to be predicted worse with what was found than without."""
    return [
        f"{name}: {each['before']:.3g} before, {each['after']:.3g} {each['unit']} after"
        for name, each in diagnosis["joints"].items()
        if each["after"] > (1.0 + WORSE) * each["before"]
    ]


def is_refusal(diagnosis: Content) -> bool:
    """Whether the study was refused by a message meant for its user."""
    words = str(diagnosis["verdict"]).split(": ")
    return words[0] == "error" and words[1] in ("LoadError", "UnanswerableError", "ValueError")


def crashed(diagnosis: Content) -> bool:
    """Whether there is no answer: a crash, or none in time."""
    return str(diagnosis["verdict"]).startswith("error: ") and not is_refusal(diagnosis)


def named(finding: Finding) -> str:
    """The finding's name and place."""
    of = ""
    if finding["effect"] == "unknown":
        of = f" of {VARIABLES[int(finding['parameters']['variable']['value'])]}"
    where = ", ".join((*finding["joints"], *finding["links"]))
    return f"{finding['effect']}{of}" + (f" at {where}" if where else "")
