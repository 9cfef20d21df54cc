"""What every machine has, as smooth curves without names.

Bearings rub, rotors turn with the joints, drawings are a tenth wrong, torque sensors are a little
off. A finding must be more than a machine that has all of it in every joint explains. What even
that leaves is the discrepancy of the model: it counts as noise, and with as few independent samples
as it has.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects.sensors import ImuOffset, ImuTilt
from ..motion import Balances, Columns, Key, Motion, Place, Shape
from .fit import Fit, Term, term_of
from .trusted_bodies import trusted
from .wald import repeats_of

BACKGROUND = "background"
"""Effect id of the terms; none of the catalogue."""

_SOFT = (0.02, 0.06, 0.2, 0.6)  # speeds over which friction turns [rad/s]
_ROUNDS = 3  # of fit and noise in turn


class Friction:
    """A smooth curve of the speed, the same in both directions, and the rotor."""

    id = BACKGROUND
    shape = (0.0,)

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Steps of several widths, viscosity and rotor."""
        (j,) = place.joints
        steps = [motion.sign(j, s) for s in _SOFT]
        return {("torque", j): np.column_stack([*steps, motion.dq[:, j], motion.ddq[:, j]])}


class OneWay:
    """The difference of friction between the directions."""

    id = BACKGROUND
    shape = (1.0,)

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Fading steps of several widths, and viscosity."""
        (j,) = place.joints
        fading = [np.abs(motion.sign(j, s)) for s in _SOFT]
        return {("torque", j): np.column_stack([*fading, np.abs(motion.dq[:, j])])}


class Rest:
    """What is there at rest, too."""

    id = BACKGROUND
    shape = (2.0,)

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """A column of ones."""
        (j,) = place.joints
        return {("torque", j): np.ones((len(motion.time), 1))}


class Scale:
    """The torque's own scale."""

    id = BACKGROUND
    shape = (3.0,)

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The model's torque."""
        (j,) = place.joints
        return {("torque", j): motion.borne[:, j : j + 1]}


def _is(term: Term, cause: type[Friction | OneWay | Rest | Scale]) -> bool:
    return term.effect == BACKGROUND and term.shape == cause.shape


def is_scale(term: Term) -> bool:
    """Whether a term is a torque's scale."""
    return _is(term, Scale)


def friction_at(fit: Fit, j: int) -> FloatArray:
    """Joint j's friction along the rows that count, the rotor apart, (N,) [N m]."""
    key: Key = ("torque", j)
    total = np.zeros(len(fit.rows[key]))
    for term, beta in fit.weighted:
        if term.place.joints == (j,) and (_is(term, Friction) or _is(term, OneWay)):
            kept = beta[:-1] if _is(term, Friction) else beta
            total += term.columns[key][fit.rows[key], : len(kept)] @ kept
    return total


def background(balances: Balances) -> tuple[Balances, tuple[Term, ...]]:
    """The balances with the discrepancy as their noise, and the terms of all that is ordinary."""
    plain = _terms(balances)
    if not plain:
        return balances, ()
    terms, least = plain, balances.sigma
    for _ in range(_ROUNDS):
        fit = Fit(balances, terms)
        left = {key: fit.residual(key) * balances.sigma[key] for key in fit.design}
        sigma = {
            key: max(least[key], float(np.sqrt(np.mean(each**2))))
            for key, each in left.items()
            if len(each)
        }
        same = {key: repeats_of(balances, fit.rows[key], each) for key, each in left.items()}
        usual = float(np.median(list(same.values())))
        balances = balances.with_noise(sigma)
        terms = tuple(replace(t, prior=t.prior * same.get(_own(t), usual)) for t in plain)
    return balances, terms


def _own(term: Term) -> Key:
    """The one balance of a joint's term; of a body's none."""
    return ("torque", term.place.joints[0] if term.place.joints else -1)


def _terms(balances: Balances) -> tuple[Term, ...]:
    """Terms of every joint that can be judged, and of the bodies."""
    believed = balances.thresholds.priors
    terms: list[Term] = []
    for j in range(balances.n):
        if ("torque", j) not in balances.residual or not balances.excited[j]:
            continue
        place = Place(joints=(j,))
        size = believed.friction * usual_torque(balances, j)
        causes = ((Friction(), size), (OneWay(), size), (Rest(), size), (Scale(), believed.torque))
        for cause, scale in causes:
            columns = balances.columns(cause, place, cause.shape)
            if columns:
                width = next(iter(columns.values())).shape[1]
                prior = np.full(width, 1.0 / max(scale, 1e-9) ** 2)
                terms.append(
                    Term(
                        effect=BACKGROUND,
                        place=place,
                        shape=cause.shape,
                        columns=columns,
                        prior=prior,
                    )
                )
    for term, sizes in imu_parts(balances):
        terms.append(replace(term, effect=BACKGROUND, prior=1.0 / sizes**2))
    return (*terms, *trusted(balances, believed.bodies))


def imu_parts(balances: Balances) -> Iterator[tuple[Term, FloatArray]]:
    """An IMU's mounting and zeros, which are never quite right, and how large they usually are."""
    believed = balances.thresholds.priors
    turn, acc, gyro = believed.imu_tilt, believed.imu_acc, believed.imu_gyro
    for effect, sizes in ((ImuTilt(), [turn] * 3), (ImuOffset(), [acc] * 3 + [gyro] * 3)):
        for place in effect.places(balances.motions):
            term = term_of(balances, effect, place, ())
            if term is not None:
                yield term, np.array(sizes)


def usual_torque(balances: Balances, j: int) -> float:
    """What joint j's torque usually is, the model's and what differs from it [N m]."""
    tau = np.concatenate([m.borne[:, j] for m in balances.motions])
    return float(np.hypot(np.sqrt(np.mean(tau**2)), balances.rms(("torque", j))))
