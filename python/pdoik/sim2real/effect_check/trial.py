"""An effect's example at its place on the arm, without and with it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from pdoik.recordings import Recording

from ..effects import Effect, Example, known, parts_of_finding
from ..findings import Estimate, Finding
from ..motion import Balances, Motion, Place, Shape
from ..simulation import Part
from .arm import JOINTS, RECORDING, Arm

_JOINT = 1  # gravity loads it, and it moves others


class Trial:
    """One effect at the example's figures."""

    def __init__(self, effect: Effect, example: Example, arm: Arm) -> None:
        self.effect, self.example = effect, example
        self.arm = arm if example.held is None else arm.holding(example.held)
        self.shape, self.beta = effect.coefficients(example.values, example.shape)
        others = [(known(name), values) for name, values in example.beside.items()]
        self.others = [(other, *other.coefficients(values)) for other, values in others]

    @cached_property
    def plain_run(self) -> Recording:
        """What the arm logs without the effect, with the example's other effects."""
        return self.arm.run(self.with_parts) if self.others else self.arm.plain_run

    @cached_property
    def plain(self) -> Balances:
        """The balances of `plain_run`."""
        return self.arm.balances(self.plain_run) if self.others else self.arm.plain

    @property
    def motion(self) -> Motion:
        """The arm's motion without the effect."""
        return self.arm.plain.motions[0]

    @cached_property
    def place(self) -> Place | None:
        """Where it is tried: the example's place, else one with the second joint; None without."""
        if self.example.place is not None:
            return self.example.place
        places = self.effect.places([self.motion])
        here = [each for each in places if _JOINT in each.joints]
        return next(iter(here or places), None)

    @cached_property
    def with_parts(self) -> tuple[Part, ...]:
        """The parts of the example's other effects."""
        return tuple(part for each, shape, _ in self.others for part in self._parts_of(each, shape))

    def _parts_of(self, other: Effect, shape: Shape) -> tuple[Part, ...]:
        return parts_of_finding(self.finding(self.example.beside[other.id], shape, other))

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """What the simulation is given."""
        return self.parts_at(self.example.values, self.shape)

    def parts_at(self, values: Mapping[str, float], shape: Shape) -> tuple[Part, ...]:
        """What the simulation is given for other figures."""
        return parts_of_finding(self.finding(values, shape))

    def finding(
        self, values: Mapping[str, float], shape: Shape, effect: Effect | None = None
    ) -> Finding:
        """The finding that a diagnosis would give of the effect, or of another at its place."""
        effect = effect or self.effect
        place = self.place
        assert place is not None
        body = self.motion.body
        assert body is not None
        link = place.link
        if effect.on == "link" and place.joints:
            link = place.joints[0]
        gate = place.gate
        window = place.window
        if gate is not None and gate.of == "time":
            window = (gate.low, gate.high)
        at = gate is not None and gate.of == "position"
        return Finding(
            effect=effect.id,
            joints=tuple(JOINTS[j] for j in place.joints),
            links=() if link is None else (body.links[link],),
            recordings=() if place.recording is None else (place.recording,),
            window=window,
            positions=(gate.low, gate.high) if gate is not None and at else None,
            edge=gate.edge if gate is not None else 0.0,
            parameters={
                name: Estimate.normal(v, 0.0, effect.unit_of(name)) for name, v in values.items()
            },
            variant=effect.variant(shape) if place.held is None else place.held.label,
            shape=shape,
        )

    @cached_property
    def logged(self) -> Recording:
        """What the arm logs with the effect.

        Raises:
            SimulationError: it ran away.
        """
        return self.log(self.arm)

    def log(self, arm: Arm, *, name: str = RECORDING, late: float = 0.0) -> Recording:
        """`logged` of another motion."""
        assert self.place is not None
        run = arm.run((*self.with_parts, *self.parts), name=name, late=late)
        return self.effect.logged(run, self.place, self.example.values)

    @cached_property
    def balances(self) -> Balances:
        """The balances of what the arm logs with the effect."""
        return self.arm.balances(self.logged)
