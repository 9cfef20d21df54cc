"""What a diagnosis says, and its JSON (schema pdoik.diagnosis/1)."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Literal

from .motion import Gate

Verdict = Literal[
    "no_mismatch",
    "mismatch_explained",
    "mismatch_partly_explained",
    "mismatch_unexplained",
    "cannot_tell",
]
SCHEMA = "pdoik.diagnosis/1"
MOST_EQUIVALENTS = 3  # of a finding
ERRORS = 1.96
"""Standard errors from a value to an end of its 95 % interval."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A parameter's value with its standard error and 95 % interval, of the posterior."""

    value: float
    std: float
    interval95: tuple[float, float]  # of the mean over sessions, where the study gives sessions
    unit: str
    spread: float | None = None  # standard deviation from session to session; None: unknown
    spread_p: float | None = None  # probability of such differences if all sessions were alike

    @classmethod
    def normal(cls, value: float, std: float, unit: str) -> Estimate:
        """An estimate with the interval of a normal error."""
        interval = (value - ERRORS * std, value + ERRORS * std)
        return cls(value=value, std=std, interval95=interval, unit=unit)

    def wider(self, by: float) -> Estimate:
        """The estimate with one more standard error added to its own, each end as far as it was."""
        below, above = (math.hypot(end - self.value, ERRORS * by) for end in self.interval95)
        interval = (self.value - below, self.value + above)
        return replace(self, std=math.hypot(self.std, by), interval95=interval)

    def moved(self, value: float) -> Estimate:
        """The estimate at another value, its interval as wide."""
        low, high = self.interval95
        by = value - self.value
        return replace(self, value=value, interval95=(low + by, high + by))


@dataclass(frozen=True, slots=True, kw_only=True)
class Equivalent:
    """Another effect that would explain the same data as well."""

    effect: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()


HadBy = Literal["few", "many", "all"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Support:
    """What speaks for a finding: its odds, its size, what it gains on rows it was not learnt from.

    About four parts of the recordings to fit (recordings, or parts of them) are left out in turn.
    """

    weight: float  # its part of the balances over what they began with, root mean squares
    gain: float  # share of what all else leaves where it acts, sensors' noise apart
    t: float  # the gain over its standard error, by blocks
    size: float  # its part of a balance over what nothing explains there
    agree: int  # parts of the recordings in which it gains
    sessions: int  # parts that say anything of it
    blocks: int  # in which it acts
    left: float  # root mean square that nothing explains at its balances, over the noise
    rivals: int  # other names that do as well
    log_odds: float | None = None  # posterior, that it is there; None of laws and events
    had_by: HadBy = "few"  # machines that have its effect
    event: bool = False  # learnt and scored on halves of its own rows: it cannot repeat

    @property
    def odds(self) -> float:
        """The log odds; 0 of what was never compared with all else."""
        return self.log_odds or 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """How much a finding lowers the squared residual of recordings it was not fitted to."""

    validation_gain: float  # share of the mean square residual, 0 to 1
    interval95: tuple[float, float]
    channels: tuple[str, ...] = ()  # the columns it rests on
    with_others: float | None = None  # the same of what all else leaves where it acts

    @classmethod
    def once(cls, share: float, *channels: str) -> Evidence:
        """Evidence of what was seen once: there is nothing to take an interval from."""
        return cls(validation_gain=share, interval95=(share, share), channels=channels)


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One cause of the mismatch, by name."""

    effect: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    recordings: tuple[str, ...] = ()
    window: tuple[float, float] | None = None  # of the recordings' time in which it acts [s]
    begins: tuple[str, float] | None = None  # recording and time [s] since when it acts
    positions: tuple[float, float] | None = None  # of the joint between which it acts [rad], [m]
    edge: float = 0.0  # of window or positions, over which it comes and goes [s], [rad], [m]
    regime: str = ""
    statement: str = ""
    parameters: dict[str, Estimate] = field(default_factory=dict)
    equivalents: tuple[Equivalent, ...] = ()
    decided_by: str = ""
    evidence: Evidence = Evidence(validation_gain=0.0, interval95=(0.0, 0.0))
    support: Support | None = None  # None where nothing can be left out: events, channels
    weight: float = 0.0  # share of the mismatch by which findings are ordered, without judge data
    confidence: float = 1.0  # probability that the effect is there, as calibrated
    held_out_only: bool = False  # an event that was seen in held-out recordings alone
    variant: str = ""  # what it is of, where the effect may be of several: torque, speed, position
    shape: tuple[float, ...] = ()  # the nonlinear parameters behind it, as its effect has them

    @property
    def values(self) -> dict[str, float]:
        """The parameters without their errors."""
        return {name: estimate.value for name, estimate in self.parameters.items()}

    @property
    def gate(self) -> Gate | None:
        """Part of time or of positions outside which it does nothing, of what sits at joints."""
        if self.positions is not None:
            low, high = self.positions
            return Gate(of="position", low=low, high=high, edge=self.edge)
        if self.window is not None and self.joints:
            return Gate(of="time", low=self.window[0], high=self.window[1], edge=self.edge)
        return None


@dataclass(frozen=True, slots=True, kw_only=True)
class Residue:
    """What of a joint nothing explains: by which variable it is seen most."""

    of: str = ""  # speed, position, load, time; "" where none of them explains much of it
    share: float = 0.0  # of its mean square that goes with this variable
    outstanding: float = 0.0  # times the others' rest relative to friction; 0: usual


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFit:
    """Root mean square residual of a joint on data that nothing was fitted to."""

    before: float
    after: float
    noise_floor: float
    unit: str
    data: str  # the recordings it was measured on
    excited: bool  # whether the joint moved enough to be judged
    spread: float = 0.0  # root mean square that friction's changes may leave in a session
    residue: Residue | None = None  # None where the joint is explained, or was not judged


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerEstimate:
    """The law of a joint's controller, as commands, motion and effort show it."""

    joint: str
    law: str  # pd, pid, cascade, table; "" where none is believed
    effort: str = ""  # channel it was estimated from; "" where none was logged
    unit: str = ""  # of the effort: N m, A, or 1, the share of the supply
    gains: dict[str, Estimate] = field(default_factory=dict)
    table: tuple[tuple[float, float], ...] = ()  # position error and effort, of a table
    explained: float = 0.0  # share of the held-out effort's variance
    error: float = 0.0  # root mean square that it leaves of it, in the effort's unit
    in_band: float = 0.0  # share that a law of any kind explains in the band of the motion
    data: str = ""  # the recordings it was judged on
    given_wrong: dict[str, float] = field(default_factory=dict)  # gains that the study gives
    untellable: tuple[str, ...] = ()  # what it hides, in words
    drive: dict[str, Estimate] = field(default_factory=dict)  # of a motor driven by a voltage
    load: dict[str, Estimate] = field(default_factory=dict)  # what such a motor shows of it


@dataclass(frozen=True, slots=True, kw_only=True)
class OrdinaryPart:
    """One part of what every machine has, at a joint or a link, as these recordings show it.

    It is sized and not selected: a value within its error of nothing is stated, too.
    """

    effect: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    parameter: str = ""
    estimate: Estimate = Estimate(value=0.0, std=0.0, interval95=(0.0, 0.0), unit="-")
    negligible: bool = True  # not surely there, or little compared with what nothing explains


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnosis:
    """Verdict, findings by how much of the mismatch each explains, and the fit of each joint."""

    verdict: Verdict
    findings: tuple[Finding, ...]
    joints: dict[str, JointFit]
    notes: tuple[str, ...] = ()  # what was repaired, assumed or cannot be known, in words
    suspected: tuple[Finding, ...] = ()  # of low confidence: not claimed, and not in the model
    thresholds: dict[str, dict[str, float]] = field(default_factory=dict)  # by stage and name
    controllers: tuple[ControllerEstimate, ...] = ()  # of each joint
    ordinary: tuple[OrdinaryPart, ...] = ()  # of every joint and body, findings or not

    def to_json(self) -> str:
        """Text of diagnosis.json."""
        return json.dumps({"schema": SCHEMA, **asdict(self)}, indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str) -> Diagnosis:
        """The diagnosis whose `to_json` is `text`.

        Raises:
            ValueError: `text` is not of this schema.
        """
        content = json.loads(text)
        if not isinstance(content, dict) or content.get("schema") != SCHEMA:
            raise ValueError(f"not a diagnosis: expected JSON of schema {SCHEMA}")
        return cls(
            verdict=content["verdict"],
            findings=tuple(_finding(each) for each in content["findings"]),
            joints={name: _joint(each) for name, each in content["joints"].items()},
            notes=tuple(content.get("notes", ())),
            suspected=tuple(_finding(each) for each in content.get("suspected", ())),
            thresholds=dict(content.get("thresholds", {})),
            controllers=tuple(_controller(each) for each in content.get("controllers", ())),
            ordinary=tuple(_part(each) for each in content.get("ordinary", ())),
        )


def _controller(content: dict[str, Any]) -> ControllerEstimate:
    return ControllerEstimate(
        **{
            **content,
            "gains": {name: _estimate(each) for name, each in content["gains"].items()},
            "drive": {name: _estimate(each) for name, each in content["drive"].items()},
            "load": {name: _estimate(each) for name, each in content["load"].items()},
            "table": tuple((float(x), float(y)) for x, y in content["table"]),
            "untellable": tuple(content["untellable"]),
        }
    )


def _part(content: dict[str, Any]) -> OrdinaryPart:
    return OrdinaryPart(
        **{
            **content,
            "joints": tuple(content["joints"]),
            "links": tuple(content["links"]),
            "estimate": _estimate(content["estimate"]),
        }
    )


def _joint(content: dict[str, Any]) -> JointFit:
    residue = content.get("residue")
    return JointFit(**{**content, "residue": None if residue is None else Residue(**residue)})


def _finding(content: dict[str, Any]) -> Finding:
    window, positions = content["window"], content.get("positions")
    return Finding(
        effect=content["effect"],
        joints=tuple(content["joints"]),
        links=tuple(content["links"]),
        recordings=tuple(content["recordings"]),
        window=None if window is None else (window[0], window[1]),
        positions=None if positions is None else (positions[0], positions[1]),
        regime=content["regime"],
        statement=content["statement"],
        parameters={name: _estimate(each) for name, each in content["parameters"].items()},
        equivalents=tuple(
            Equivalent(
                effect=each["effect"],
                joints=tuple(each.get("joints", ())),
                links=tuple(each.get("links", ())),
            )
            for each in content["equivalents"]
        ),
        decided_by=content["decided_by"],
        evidence=Evidence(
            validation_gain=content["evidence"]["validation_gain"],
            interval95=tuple(content["evidence"]["interval95"]),
            with_others=content["evidence"].get("with_others"),
            channels=tuple(content["evidence"].get("channels", ())),
        ),
        support=Support(**content["support"]) if content.get("support") else None,
        weight=float(content.get("weight", content["evidence"]["validation_gain"])),
        confidence=float(content.get("confidence", 1.0)),
        held_out_only=bool(content.get("held_out_only", False)),
        variant=str(content.get("variant", "")),
        shape=tuple(float(each) for each in content.get("shape", ())),
        edge=float(content.get("edge", 0.0)),
    )


def _estimate(content: dict[str, Any]) -> Estimate:
    low, high = content["interval95"]
    return Estimate(
        value=content["value"],
        std=content["std"],
        interval95=(low, high),
        unit=content["unit"],
        spread=content.get("spread"),
        spread_p=content.get("spread_p"),
    )
