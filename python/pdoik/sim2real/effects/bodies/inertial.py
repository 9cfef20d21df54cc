"""Bodies that are not in the model: a payload, or a link that weighs otherwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import Inertial, LinkChange, Part
from ...study import Payload as KnownBody
from ..effect import Effect, Example, Parameter
from ..site import Site

INERTIAS = ("ixx", "ixy", "iyy", "ixz", "iyz", "izz")
PRIOR = np.array([5.0, 1.0, 1.0, 1.0] + [0.3] * 6)
"""Standard deviations that keep what no motion shows near zero: kg, kg m, kg m^2."""


_LOAD, _NEAR = 0.1, 0.1  # of an arm's mass that it usually holds, and how far from the link [m]
_LINK = 0.5  # of a link's own size, that it is usually wrong by where it is wrong at all


class LinkInertials(Effect):
    """Ten inertial parameters added to one link; only combinations of them are visible."""

    id = "link_inertial_error"
    name = "a link's inertia"
    family = "body"
    on = "link"
    equation = "tau = Y(q, dq, ddq) dpi, ten parameters of one link"
    parameters = (
        Parameter("d_mass", "kg"),
        *(Parameter(f"d_first_moment_{axis}", "kg m") for axis in "xyz"),
        *(Parameter(f"d_{name}", "kg m^2") for name in INERTIAS),
    )
    confused_with: ClassVar[tuple[str, ...]] = (
        "payload",
        "torque_gain",
        "gravity_direction",
        "joint_offset",
    )
    decided_by = "slow and quick motion of all joints after this link, over the whole range"
    source = "Atkeson, An and Hollerbach, IJRR 5(3), 1986; Wensing et al., RA-L 3(1), 2018"
    example = Example(
        values={"d_mass": 0.4, "d_first_moment_x": 0.06, "d_first_moment_y": 0.02}
        | {"d_first_moment_z": 0.03, "d_ixx": 0.006, "d_ixy": 0.0, "d_iyy": 0.012}
        | {"d_ixz": 0.0, "d_iyz": 0.0, "d_izz": 0.01},
        place=Place(link=1),
    )
    complexity = 5
    corrected = 0.5  # torques are linear in it: a regression shows it as well as a simulation
    per_joint_moving = False
    against = "q"
    is_body = True

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """Every link; on the last it may be lighter, where a payload cannot."""
        body = motions[0].body
        return [] if body is None else [Place(link=link) for link in range(len(body.links))]

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """One, with a model."""
        return [()] if motions[0].body is not None else []

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The link's part of the regressor; zero for joints that do not carry it."""
        assert place.link is not None
        part = motion.regressor()[:, :, place.link]
        return motion.on_rows(part)

    def prior(self, width: int) -> FloatArray:
        """What no motion shows stays near zero."""
        return 1.0 / PRIOR**2

    def prior_at(self, motion: Motion, place: Place, width: int) -> FloatArray:
        """Precision of the prior, (width,), by the link's size: twice any mass costs the same."""
        if motion.body is None or place.link is None:
            return self.prior(width)
        return np.asarray(1.0 / (_LINK * motion.body.inertial_scale(place.link)) ** 2)

    def beneath(self, motion: Motion, place: Place) -> FloatArray | None:
        """The model's link."""
        if motion.body is None or place.link is None:
            return None
        return np.asarray(motion.body.inertial_parameters()[place.link])

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """A mass that is distributed as the link's is; at the link's origin where it has none."""
        own = LinkInertials.beneath(self, motions[0], place)
        if own is None or own[0] <= 0.0:
            return shape, amount * np.eye(width)[0]
        return shape, amount / own[0] * own

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        ten = [site.get(each.name) for each in self.parameters]
        return (LinkChange(link=site.link, inertial=Inertial.from_ten(ten)),)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        h = np.linalg.norm([values[f"d_first_moment_{axis}"] for axis in "xyz"])
        return (
            f"The inertia of {where} is not the model's: {values['d_mass']:+.3g} kg and"
            f" {h:.3g} kg m of first moment, or a combination of links that amounts to the same."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return "every pose, at rest and in motion"


class Payload(LinkInertials):
    """A body attached to the last link."""

    id = "payload"
    odds = 0.2
    name = "payload"
    on = "link"
    equation = "tau = Y(q, dq, ddq) pi(mass, com, inertia), at the last link"
    parameters = (
        Parameter("mass", "kg", lower=0.0),
        *(Parameter(f"com_{axis}", "m") for axis in "xyz"),
        *(Parameter(name, "kg m^2") for name in INERTIAS),
    )
    confused_with = ("link_inertial_error", "torque_gain", "gravity_direction")
    decided_by = "the same motion with a known weight in the hand and without"
    example = Example(
        values={"mass": 0.7, "com_x": 0.08, "com_y": 0.03, "com_z": 0.05}
        | {"ixx": 2e-3, "ixy": 0.0, "iyy": 3e-3, "ixz": 0.0, "iyz": 0.0, "izz": 2e-3},
    )
    complexity = 4
    corrected = 0.5

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """The last link; where the base floats, that and each that is no part of a leg."""
        body = motions[0].body
        if body is None:
            return []
        if motions[0].base is None:
            return [Place(link=body.last)]
        legs = [np.any(foot.jacobian[0] != 0.0, axis=0) for foot in motions[0].feet]
        in_leg = np.any([np.zeros(body.n, dtype=bool), *legs], axis=0)
        return [Place(link=body.n), *(Place(link=int(k)) for k in np.flatnonzero(~in_leg))]

    def prior_at(self, motion: Motion, place: Place, width: int) -> FloatArray:
        """A tenth of what the arm weighs, as far from the link's origin as the link reaches."""
        if motion.body is None:
            return self.prior(width)
        mass = max(_LOAD * float(np.sum(motion.body.inertial_parameters()[:, 0])), 1e-3)
        reach = _NEAR
        if place.link is not None and place.link < len(motion.body.links):
            own = motion.body.inertial_scale(place.link)
            reach = max(_NEAR, 2.0 * float(own[1] / max(own[0], 1e-9)))
        size = np.array([1.0, *(3 * [reach]), *(6 * [reach**2])])
        return np.asarray(1.0 / (mass * size) ** 2)

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """A point mass at the tip, where the study says one, else at the link's own centre."""
        first = motions[0]
        if first.tip is None or first.body is None:
            shape, beta = super().of_amount(amount, motions, place, shape, width)
            com = beta[1:4] / amount
        else:
            held = KnownBody(link=first.tip, mass=1.0, com=(0.0, 0.0, 0.0))
            com = first.body.carrier(held)[1][1:4]
        point = Inertial.about_com(amount, com, np.zeros((3, 3)))
        return shape, np.asarray(point.ten())

    def beneath(self, motion: Motion, place: Place) -> FloatArray | None:
        """Nothing: a load is a body by itself."""
        return np.zeros(10)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """A mass is positive."""
        return np.array([0.0] + [-np.inf] * 9), np.full(10, np.inf)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Mass, centre of mass in the link's frame, inertias about that centre."""
        mass = max(float(beta[0]), 1e-9)
        com = beta[1:4] / mass
        xx, xy, yy, xz, yz, zz = beta[4:]
        about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        about = about - mass * (com @ com * np.eye(3) - np.outer(com, com))
        inertias = (about[0, 0], about[0, 1], about[1, 1], about[0, 2], about[1, 2], about[2, 2])
        names = [p.name for p in self.parameters]
        return dict(zip(names, map(float, (mass, *com, *inertias)), strict=True))

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Ten inertial parameters about the frame's origin."""
        mass = values["mass"]
        com = np.array([values[f"com_{axis}"] for axis in "xyz"])
        xx, xy, yy, xz, yz, zz = (values[name] for name in INERTIAS)
        about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        about = about + mass * (com @ com * np.eye(3) - np.outer(com, com))
        inertias = (about[0, 0], about[0, 1], about[1, 1], about[0, 2], about[1, 2], about[2, 2])
        return (), np.array([mass, *(mass * com), *inertias])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        com = np.array([site.get(f"com_{axis}") for axis in "xyz"])
        about_com = Inertial.from_ten([0.0] * 4 + [site.get(name) for name in INERTIAS]).inertia
        body = Inertial.about_com(site["mass"], com, about_com)
        return (LinkChange(link=site.link, inertial=body),)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        com = ", ".join(f"{1e3 * values[f'com_{axis}']:.3g}" for axis in "xyz")
        return (
            f"{where} carries {values['mass']:.3g} kg that is not in the model, at"
            f" ({com}) mm in its frame."
        )
