"""All thresholds of a diagnosis."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields, replace

from .table import (
    ChannelThresholds,
    ConfidenceThresholds,
    ControllerThresholds,
    DiagnosisThresholds,
    FeetThresholds,
    LimitThresholds,
    NoiseThresholds,
    PriorThresholds,
    ProposeThresholds,
    SimulatorThresholds,
    WatchThresholds,
)
from .threshold import numbers_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Threshold:
    """One of them, to be read."""

    name: str  # GROUP.NAME
    value: float
    default: float
    meaning: str
    unit: str
    source: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Thresholds:
    """The numbers by which a diagnosis decides, by stage.

    `Thresholds().changed({"diagnosis.worth": 4.0})` is another set.
    """

    priors: PriorThresholds = field(default_factory=PriorThresholds)
    diagnosis: DiagnosisThresholds = field(default_factory=DiagnosisThresholds)
    confidence: ConfidenceThresholds = field(default_factory=ConfidenceThresholds)
    noise: NoiseThresholds = field(default_factory=NoiseThresholds)
    limits: LimitThresholds = field(default_factory=LimitThresholds)
    feet: FeetThresholds = field(default_factory=FeetThresholds)
    controllers: ControllerThresholds = field(default_factory=ControllerThresholds)
    channels: ChannelThresholds = field(default_factory=ChannelThresholds)
    simulators: SimulatorThresholds = field(default_factory=SimulatorThresholds)
    watch: WatchThresholds = field(default_factory=WatchThresholds)
    propose: ProposeThresholds = field(default_factory=ProposeThresholds)

    def changed(self, values: dict[str, float]) -> Thresholds:
        """The thresholds with other values by GROUP.NAME.

        Raises:
            ValueError: there is none of that name, or the value is no number of its kind.
        """
        known = {each.name for each in self}
        by_group: dict[str, dict[str, float]] = {}
        for name, value in values.items():
            if name not in known:
                raise ValueError(f"thresholds: no {name!r}; expected one of {', '.join(known)}")
            group, _, number = name.partition(".")
            by_group.setdefault(group, {})[number] = value
        groups = {name: replace(getattr(self, name), **new) for name, new in by_group.items()}
        return replace(self, **groups)

    def __iter__(self) -> Iterator[Threshold]:
        """Each with its meaning."""
        for group in fields(self):
            numbers = getattr(self, group.name)
            for each in numbers_of(numbers):
                yield Threshold(
                    name=f"{group.name}.{each.name}",
                    value=getattr(numbers, each.name),
                    default=float(each.default),  # type: ignore[arg-type]  # each has one
                    **each.metadata,
                )

    def values(self) -> dict[str, dict[str, float]]:
        """Numbers by group and name, as diagnosis.json has them."""
        return asdict(self)
