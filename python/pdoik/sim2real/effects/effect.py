"""What an effect is: its equation, where it may sit, and what it adds to the balances."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..motion import Columns, Motion, Place, Shape
from ..simulation import Part
from ..study import Payload
from .site import Site

Axis = Literal["speed", "q", "load"]
Family = Literal[
    "friction", "body", "torque", "timing", "transmission", "geometry", "sensor", "contact", "other"
]
Sought = Literal["candidates", "harmonics", "windows", "last", "channels"]
"""How an effect is looked for: at all places, as harmonics of a joint's angle in the residual, as
windows of time, only where names explain too little, or in the channels before all else."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """Name, unit and bounds of one parameter."""

    name: str
    unit: str
    lower: float = -np.inf
    upper: float = np.inf
    chosen: bool = False  # among a few values: nothing between them has a meaning


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    """Figures of an effect that somebody may find, by which `pdoik effects check` tries it.

    The check's arm has three joints and one recording, "example"; without a place it sits at the
    first that `places` gives it at the second joint.
    """

    values: Mapping[str, float]
    shape: Shape = ()  # that it would be found with; () for that of the values
    place: Place | None = None
    beside: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Figures of effects that are there as well, by their id, at the same place."""
    nothing: Mapping[str, float] | None = None  # figures at which it does nothing, if not at 0
    held: Payload | None = None  # a body that the arm is known to hold, at the link "tool"


class Effect(ABC):
    """One kind of physics a model may have left out.

    An effect's columns times its coefficients are what it adds to the residual of a balance:
    torque: recorded torque less the rigid body's; drive: recorded less commanded torque; law:
    commanded torque less the controller's law; velocity:
    recorded speed less the positions' derivative; tip: measured pose less the model's; servo:
    position less its command. What is not linear is the shape, found by search.
    """

    id: ClassVar[str]
    name: ClassVar[str] = ""  # in words; the id's where it is ""
    family: ClassVar[Family] = "other"
    on: ClassVar[str]  # joint, link, base, drive, channel, window
    equation: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    source: ClassVar[str] = ""
    against: ClassVar[Axis] = "speed"  # what its curve is drawn over
    example: ClassVar[Example | None] = None  # figures to try it with

    # What else looks like it, and what distinguishes them.
    confused_with: ClassVar[tuple[str, ...]] = ()
    decided_by: ClassVar[str] = ""
    instead: ClassVar[tuple[str, ...]] = ()  # not where one of these was found at the joint
    one_of: ClassVar[str] = ""  # kind of law of which a joint has one
    complexity: ClassVar[float] = 1  # simpler effects go first where data cannot decide

    # What is believed of it before the data are looked at.
    odds: ClassVar[float] = 0.02  # probability that a machine has it, at one place
    part_of: ClassVar[tuple[str, float]] = ("", 0.0)  # of what it is a share at most, and which

    # How it is looked for.
    fixed: ClassVar[bool] = False  # the one coefficient is 1 by its meaning
    reach: ClassVar[tuple[float, float]] = (-np.inf, np.inf)  # of it, where shapes may be moved
    sought: ClassVar[Sought] = "candidates"
    costly: ClassVar[bool] = False  # only tried where a joint's balances leave something
    per_joint_moving: ClassVar[bool] = True  # a joint that never moves cannot show it
    gated: ClassVar[bool] = False  # may act in a part of the time or of the positions only
    ordinary: ClassVar[bool] = False  # every machine's joints may have some: compared as a set
    of_floating_base: ClassVar[bool] = False  # nothing that stands fixed can show it
    together: ClassVar[bool] = False  # its joints are one place, not one each

    # What it takes to be believed.
    least_of_rest: ClassVar[float] = 0.0  # share of what is left that it must explain where it acts
    function: ClassVar[bool] = False  # its values say something together: what `size` is of
    carries: ClassVar[tuple[str, ...]] = ()  # of one place, if not stated: in this one's figure
    size_first: ClassVar[bool] = False  # its first parameter is its size: near 0 it is nothing
    is_body: ClassVar[bool] = False  # its figures together are a body's
    is_delay: ClassVar[bool] = False  # of commands: sampling and ticks may look like it
    blurred_by_sampling: ClassVar[bool] = False  # a time that sampling makes less sure
    shared: ClassVar[bool] = False  # one cause where several joints' figures agree

    # How it is simulated and predicted.
    simulated_rivals: ClassVar[tuple[str, ...]] = ()  # names that a simulation rules out
    shown_poorly: ClassVar[bool] = False  # by its columns: simulate before it is believed
    makes_up_for_misfit: ClassVar[bool] = False  # of what is shown poorly, in a regression
    refined: ClassVar[bool] = True  # its figures by simulations
    corrected: ClassVar[float] = 1.0  # share that its figures take of a simulation's correction
    simplified: ClassVar[float] = 0.0  # share of its figures that its law's simplicity may take
    of_commands: ClassVar[bool] = False  # changes what becomes of these, not what a motion needs
    jumps: ClassVar[bool] = False  # its torque does, so that no filter should round it

    @property
    def is_plain(self) -> bool:
        """Whether every machine's joints may have it, and no law of its kind is simpler."""
        return self.ordinary and self.complexity <= 1

    @property
    def words(self) -> str:
        """Name of the effect in words."""
        return self.name or self.id.replace("_", " ")

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """Where it may sit: every joint, unless an effect says otherwise."""
        return [Place(joints=(j,)) for j in range(motions[0].n)]

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Values of the nonlinear parameters to try first; () where there are none."""
        return [()]

    @abstractmethod
    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """What the effect adds per unit of its coefficients, at the motion's rate."""

    def unit_of(self, name: str) -> str:
        """Unit of one of the parameters; "-" where it has none."""
        return next((each.unit for each in self.parameters if each.name == name), "-")

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The parameters by name, from shape and coefficients: these themselves, one by one."""
        return {each.name: float(b) for each, b in zip(self.parameters, beta, strict=True)}

    def exactly(self, motion: Motion, place: Place, values: Mapping[str, float]) -> Columns | None:
        """What figures add where `columns` are of first order only, (T, 1); None elsewhere."""
        return None

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Shape and coefficients of parameters by name: `values` turned round.

        Args:
            values: the parameters.
            shape: that they were found with, for what the values leave open.
        """
        return shape, np.array([values[each.name] for each in self.parameters])

    def asked(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Shapes by which to ask how little of it would be seen; of each variant the most usual."""
        usual: Shape = ()
        if self.example is not None:
            usual = self.coefficients(self.example.values, self.example.shape)[0]
        if self.sought == "harmonics":
            return [usual]
        by_variant: dict[str, list[Shape]] = {}
        for shape in self.shapes(motions, place):
            by_variant.setdefault(self.variant(shape), []).append(shape)
        middle = 0.0 if self.fixed else 0.5
        return [
            usual if usual in each else each[int(middle * len(each))]
            for each in by_variant.values()
        ]

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """Shape and coefficients of so much of it, of nothing at 0.

        The amount is that of the first coefficient, or, where the coefficient is fixed, of the
        first parameter.

        Args:
            amount: more than 0.
            motions: of the study.
            place: where.
            shape: one of `asked`, for what the amount leaves open.
            width: number of coefficients.
        """
        if not self.fixed:
            return shape, amount * np.eye(width)[0]
        values = self.values(shape, np.ones(width))
        return self.coefficients(values | {self.parameters[0].name: amount}, shape)

    def variant(self, shape: Shape) -> str:
        """What it is of (torque, speed, position) where it may be of several; "" elsewhere."""
        return ""

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest value of each coefficient."""
        lower = np.array([each.lower for each in self.parameters])
        upper = np.array([each.upper for each in self.parameters])
        return lower, upper

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Where to look for better nonlinear parameters."""
        return [(0.4 * value, 2.5 * value) for value in shape]

    def free(self, shape: Shape) -> list[int]:
        """Which nonlinear parameters may be moved; others only say where it acts."""
        bounds = self.shape_bounds(shape)
        return [i for i, (low, high) in enumerate(bounds) if high - low > 1e-9]

    def admissible(self, beta: FloatArray) -> bool:
        """Whether coefficients make physical sense."""
        lower, upper = self.bounds
        return bool((beta >= lower).all() and (beta <= upper).all())

    def prior(self, width: int) -> FloatArray:
        """Inverse variances of the coefficients; zero where they are free."""
        return np.zeros(width)

    def prior_at(self, motion: Motion, place: Place, width: int) -> FloatArray:
        """`prior` at a place, where it depends on what is there."""
        return self.prior(width)

    def usual(self, shape: Shape, width: int) -> FloatArray | None:
        """Usual sizes of the coefficients, (width,), where it is there; None: by its balances."""
        return None

    def log_prior(self, shape: Shape) -> float:
        """Log prior of the nonlinear parameters, relative to the likeliest; 0: all alike."""
        return 0.0

    def beneath(self, motion: Motion, place: Place) -> FloatArray | None:
        """What a body's ten parameters are added to, (10,); None of what is no body."""
        return None

    def possible(self, shape: Shape) -> bool:
        """Whether a shape makes physical sense, whatever the recordings say."""
        return True

    def plausible(self, motions: Sequence[Motion], place: Place, shape: Shape) -> bool:
        """Whether nothing in the recordings contradicts it outright."""
        return True

    def negligible(self, motions: Sequence[Motion], shape: Shape) -> bool:
        """Whether it is too small for the recordings' sampling to show."""
        return False

    def trifling(self, values: Mapping[str, float], motion: Motion, place: Place) -> bool:
        """Whether its figures are within what differentiation and rounding may take."""
        return False

    def gravity(self, values: Mapping[str, float]) -> FloatArray | None:
        """Gravity in the frame of the base, (3,) [m/s^2], if it turns that; None elsewhere."""
        return None

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it; () where it acts in a log only.

        Raises:
            KeyError: a parameter is missing.
            ValueError: the site is none of its own.
        """
        return ()

    def logged(self, recording: Recording, place: Place, values: Mapping[str, float]) -> Recording:
        """A log with what acts in it only and is no part of a simulation; unchanged elsewhere."""
        return recording

    def not_simulated(self, values: Mapping[str, float]) -> str:
        """Why `parts` is not what was found, in words; "" where it is."""
        return ""

    def shown(self, values: Mapping[str, float]) -> dict[str, str]:
        """Parameters a reader wants to see, by what they are called there."""
        return {name: name for name in values}

    @abstractmethod
    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """The finding in words a technician understands."""

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"motion of {where}"


def on_torque_and_tip(motion: Motion, torque: FloatArray, tip: FloatArray | None) -> Columns:
    """One coefficient's columns, of changes of all torques (T, rows) and the tip's pose (T, 6)."""
    columns = motion.on_rows(torque)
    if tip is not None:
        columns |= {("tip", axis): tip[:, axis, None] for axis in range(6)}
    return columns


def tip_turned(motion: Motion, j: int, by: FloatArray) -> FloatArray | None:
    """Change of the tip's pose where joint j stands `by` (T,) further; None without tip poses."""
    return None if motion.tip_jacobian is None else motion.tip_jacobian[:, :, j] * by[:, None]
