"""How a study's robot is carried, and what its motions must hold."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdoik.errors import LoadError
from pdoik.recordings import FloatArray

from ..model import robot_text
from ..motion import Prepared
from .clear import Clear
from .design import Bounds
from .excitation import Frame
from .limits import Limits, limits_of
from .predict import Predict
from .questions import Cause
from .standing import Standing
from .weigh import Weigher
from .wishes import Base, Wishes


def predict_of(prepared: Prepared, causes: Sequence[Cause], base: Base | None) -> Predict:
    """What predicts motions of a study's robot.

    Args:
        prepared: the study.
        causes: that were found.
        base: how one that floats is carried; None: as it was recorded, hanging if it ever was.

    Raises:
        ValueError: a base that is fixed was to hang or stand, or the robot has no feet to stand on.
    """
    floating, motions = prepared.study.base, prepared.fit.motions
    if floating is None:
        if base is not None:
            raise ValueError(f"--base {base}: the base of this robot is fixed")
        return Predict(prepared, causes)
    held = [k for k, motion in enumerate(motions) if motion.setup.held]
    stood = [k for k, motion in enumerate(motions) if not motion.setup.held]
    if base is None:
        base = "hang" if held else "stand"
    if base == "hang":
        return Predict(prepared, causes, like=(*held, 0)[0], held=True)
    if not floating.feet or not stood:
        raise ValueError(
            "no motion of a standing robot is proposed: the study has no recording in which it"
            " stands on feet that it names; hang the robot up and use --base hang"
        )
    return Standing(prepared, causes, like=stood[0])


def bounds_of(predict: Predict, weigher: Weigher, wishes: Wishes) -> tuple[Bounds, tuple[str, ...]]:
    """What a motion must hold, and what is said of it."""
    study = predict.prepared.study
    if study.robot is None:
        raise ValueError("the study has no robot description, so no motion can be designed")
    if not study.robot.is_file():
        raise LoadError(f"the robot's description is not at {study.robot} any more")
    start = predict.start if wishes.start is None else wishes.start
    if start.shape != (len(study.joints),):
        raise ValueError(f"start has {start.size} numbers, expected {len(study.joints)}")
    whole = limits_of(
        robot_text(study.robot),
        study.joints,
        start,
        speed=wishes.max_speed,
        torque=wishes.max_torque,
    )
    limits = whole.within(wishes.speed_share, wishes.torque_share, wishes.acceleration)
    notes = []
    outside = np.flatnonzero((start < limits.lower) | (start > limits.upper))
    if len(outside):
        limits = _reaching(limits, whole, start, outside, study.joints)
        names = ", ".join(study.joints[j] for j in outside)
        notes.append(f"{names}: starts nearer to a limit than a motion should come")
    if predict.note:
        notes.append(predict.note)
    own = (place for question in weigher.questions for place in question.own.places)
    asked = tuple(sorted({j for place in own for j in place.joints}))
    frame = Frame(
        limits=limits, start=start, duration=wishes.seconds, stuck=predict.stuck, asked=asked
    )
    bounds = Bounds(
        weigher=weigher,
        predict=predict,
        limits=limits,
        frame=predict.frame(frame),
        clear=_clear(predict.prepared, wishes),
    )
    return bounds, tuple(notes)


def _reaching(
    limits: Limits,
    whole: Limits,
    start: FloatArray,
    outside: NDArray[np.intp],
    joints: tuple[str, ...],
) -> Limits:
    """Limits that a start near their end is within."""
    for j in outside:
        if not whole.lower[j] <= start[j] <= whole.upper[j]:
            raise ValueError(
                f"the motion would start with {joints[j]} at {start[j]:.3g}, outside of"
                f" {whole.lower[j]:.3g} to {whole.upper[j]:.3g}: give another start with --start"
            )
    lower, upper = np.minimum(limits.lower, start), np.maximum(limits.upper, start)
    return Limits(
        lower=lower,
        upper=upper,
        speed=limits.speed,
        acceleration=limits.acceleration,
        torque=limits.torque,
    )


def _clear(prepared: Prepared, wishes: Wishes) -> Clear | None:
    study = prepared.study
    if wishes.clear is None or study.robot is None:
        return None
    return wishes.clear(study.joints, robot_text(study.robot), study.tip)
