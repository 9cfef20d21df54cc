"""What a report shows besides the diagnosis: plain arrays, filled by `diagnose`."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pdoik.recordings import FloatArray, Role


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Traces:
    """A recording and the model's prediction, before and after the findings.

    Arrays are (T, n) in the order of the joints; NaN where nothing is known. A residual is measured
    minus predicted, both through the same filter.
    """

    name: str  # of the recording
    role: Role
    time: FloatArray  # (T,) of the recording [s]
    clock: FloatArray  # (T,) the same on the study's clock, or time of day [s]
    q: FloatArray  # [rad] or [m]
    dq: FloatArray  # [rad/s] or [m/s]
    load: FloatArray  # torque the joint transmits by the rigid body alone [N m] or [N]
    before: FloatArray  # residual of the user's model
    after: FloatArray  # residual with the findings
    measured: FloatArray | None = None  # what the residuals are of: torque, or else
    predicted_before: FloatArray | None = None
    predicted_after: FloatArray | None = None
    parts: tuple[FloatArray, ...] = ()  # (T, n) each: a finding's share of before - after


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """One cause that was tried at one place."""

    effect: str
    place: str  # joint or link, "base", "all joints"
    score: float  # gain on held-out data: share of the mean square residual, at most 1
    interval95: tuple[float, float]
    accepted: bool
    reason: str = ""  # why it was not accepted, or dropped again, in words


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RegimeMap:
    """Where each joint's residual sits.

    Columns are bins of quantities, as ("speed", "slow"); a quantity's bins stand side by side.
    """

    bins: tuple[tuple[str, str], ...]  # (m) of quantity and label
    share: FloatArray  # (n, m) of the joint's squared residual; each quantity adds up to 1
    visited: FloatArray | None = None  # (n, m) share of the time spent there

    def __post_init__(self) -> None:
        _expect("share", self.share, (None, len(self.bins)))
        if self.visited is not None:
            _expect("visited", self.visited, self.share.shape)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Replay:
    """Simulation of a recording's commands, and what the machine did."""

    recording: str
    time: FloatArray  # (T,) [s]
    recorded: FloatArray  # (T, n) q [rad] or [m]
    before: FloatArray  # (T, n) q of the user's model
    after: FloatArray  # (T, n) q with the findings
    how: str = "closed-loop simulation for the recorded commands"
    horizon: float | None = None  # every so long all is put back to the recording; None: never [s]

    def __post_init__(self) -> None:
        for name in ("recorded", "before", "after"):
            _expect(name, getattr(self, name), (len(self.time), None))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CutoffInfluence:
    """Root mean square residuals on held-out data by the filter's cut-off."""

    frequency: FloatArray  # (k,) [Hz], rising
    before: FloatArray  # (k, n)
    after: FloatArray  # (k, n)
    chosen: float | None = None  # [Hz], the one the report rests on

    def __post_init__(self) -> None:
        for name in ("before", "after"):
            _expect(name, getattr(self, name), (len(self.frequency), None))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReportData:
    """All of a report that is not in the diagnosis. Only the first five are needed."""

    title: str  # the study's or the robot's name
    joints: tuple[str, ...]  # (n)
    units: tuple[str, ...]  # (n) of the residuals: N m, N, A, rad, m
    noise_floor: FloatArray  # (n,) in these units
    recordings: tuple[Traces, ...]
    position_units: tuple[str, ...] = ()  # (n) "rad" or "m"; empty: all rad
    residual_of: str = "torque"  # what was measured and predicted, in words
    split: str = ""  # how fit and validate were parted, in words
    hypotheses: tuple[Hypothesis, ...] = ()  # in the order they were tried
    regimes: RegimeMap | None = None  # None: worked out from the recordings
    replays: tuple[Replay, ...] = ()
    cutoff: CutoffInfluence | None = None
    events: tuple[tuple[str, float, float], ...] = ()  # recording, begin and end [s] of each
    notes: tuple[str, ...] = field(default_factory=tuple)  # besides the diagnosis's own

    def __post_init__(self) -> None:
        n = len(self.joints)
        for name in ("units", "position_units"):
            entries = getattr(self, name)
            if len(entries) != n and not (name == "position_units" and not entries):
                raise ValueError(f"{name} has {len(entries)} entries, the study has {n} joints")
        _expect("noise_floor", self.noise_floor, (n,))
        for traces in self.recordings:
            shape = (len(traces.time), n)
            _expect(f"clock of {traces.name}", traces.clock, shape[:1])
            for name in ("q", "dq", "load", "before", "after"):
                _expect(f"{name} of {traces.name}", getattr(traces, name), shape)
            for name in ("measured", "predicted_before", "predicted_after"):
                if (array := getattr(traces, name)) is not None:
                    _expect(f"{name} of {traces.name}", array, shape)
            for array in traces.parts:
                _expect(f"parts of {traces.name}", array, shape)
        if self.regimes is not None:
            _expect("regimes.share", self.regimes.share, (n, None))
        for replay in self.replays:
            _expect(f"replay of {replay.recording}", replay.recorded, (None, n))
        if self.cutoff is not None:
            _expect("cutoff.before", self.cutoff.before, (None, n))

    @property
    def held_out(self) -> tuple[Traces, ...]:
        """The recordings that nothing was fitted to; all of them if there are none."""
        some = tuple(traces for traces in self.recordings if traces.role == "validate")
        return some or self.recordings

    @property
    def telling(self) -> tuple[Traces, ...]:
        """Those held out, and those in which something happened."""
        names = {name for name, _, _ in self.events}
        held_out = self.held_out
        some = (t for t in self.recordings if t.name in names and t not in held_out)
        return (*held_out, *some)

    def position_unit(self, joint: int) -> str:
        """Unit of position of joint number `joint`: rad or m."""
        return self.position_units[joint] if self.position_units else "rad"

    def load_unit(self, joint: int) -> str:
        """Unit of load of joint number `joint`: N m, or N if it slides."""
        return "N" if self.position_unit(joint) == "m" else "N m"


def _expect(name: str, array: FloatArray, shape: tuple[int | None, ...]) -> None:
    found = np.shape(array)
    if len(found) != len(shape) or any(
        wanted is not None and wanted != got for wanted, got in zip(shape, found, strict=True)
    ):
        wanted = ", ".join("any" if size is None else str(size) for size in shape)
        raise ValueError(f"{name} has shape {found}, expected ({wanted})")
