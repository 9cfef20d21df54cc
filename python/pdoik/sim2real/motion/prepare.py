"""Makes the motions and balances of a study's recordings."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..study import Setup, Study
from .balances import Balances
from .foot_forces import with_ground
from .motion import Motion, motion_of, thinned
from .motion_noise import chosen_cutoff, noise_of
from .rigid_body import RigidBody


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """A study ready to be searched."""

    study: Study
    body: RigidBody | None
    cutoff: float  # [Hz]
    fit: Balances
    validate: Balances | None  # None where nothing was held out


def rigid_body(study: Study) -> RigidBody | None:
    """The study's robot; None without one."""
    if study.robot is None:
        return None
    return RigidBody(study.robot, study.joints, study.rotor_inertia, floats=study.floats)


def prepare(study: Study, body: RigidBody | None = None, cutoff: float | None = None) -> Prepared:
    """Smooth every recording and make its balances.

    Args:
        study: with its recordings read.
        body: of the study's robot; made where it is None and the study has one.
        cutoff: of the balances [Hz]; chosen by the channels' noise where it is None.
    """
    body = rigid_body(study) if body is None else body
    fit = [thinned(r) for r in study.fit]
    noise = noise_of(fit)
    if cutoff is None:
        cutoff = chosen_cutoff(fit, body, noise, study.thresholds.noise)
    held_out = [thinned(r) for r in study.validate]
    return Prepared(
        study=study,
        body=body,
        cutoff=cutoff,
        fit=Balances(motions_of(study, fit, body, cutoff, noise), study.thresholds),
        validate=Balances(motions_of(study, held_out, body, cutoff, noise), study.thresholds)
        if held_out
        else None,
    )


def simulated(prepared: Prepared) -> Balances | None:
    """Balances of what the user's own simulator gave; None without any."""
    study = prepared.study
    if not study.simulation or prepared.body is None:
        return None
    thin = [thinned(r) for r in study.simulation]
    noise = np.zeros(len(study.joints))
    motions = motions_of(study, thin, prepared.body, prepared.cutoff, noise)
    return Balances(motions, study.thresholds)


def motions_of(
    study: Study,
    recordings: list[Recording],
    body: RigidBody | None,
    cutoff: float,
    noise: FloatArray,
) -> list[Motion]:
    """Motions of thinned recordings, with the density (n,) of noise in their positions."""
    begins: dict[str, float] = {}
    for each in (*study.recordings, *recordings):
        name = _file(each)
        begins[name] = min(begins.get(name, np.inf), each.start)
    clocks, passed = {}, 0.0
    for each in study.recordings:
        clocks[each.name] = passed
        passed += float(each.time[-1] - each.time[0])
    motions = []
    for r in recordings:
        setup = study.setup_of(r)
        moved = body_in(study, setup, body)
        made = motion_of(
            r,
            moved,
            setup.controller or study.controller,
            cutoff,
            noise,
            study.tip,
            r.start - begins[_file(r)],
            study.thresholds,
            moved if setup.compensated else body,
            setup,
            study.base,
        )
        if study.base is not None:
            limits = study.thresholds
            made = with_ground(made, study.base.ground, limits.noise, limits.feet)
        motions.append(replace(made, clock=clocks.get(r.name, 0.0)))
    return motions


def body_in(study: Study, setup: Setup, body: RigidBody | None) -> RigidBody | None:
    """The robot as it was in one recording: its own description, what it is known to hold.

    Args:
        study: of the recording.
        setup: of the recording.
        body: of the study's robot.
    """
    if body is not None and setup.robot is not None:
        body = RigidBody(setup.robot, study.joints, study.rotor_inertia, floats=study.floats)
    return body if body is None or setup.payload is None else body.holding(setup.payload)


def _file(recording: Recording) -> str:
    """The file a recording or a block of one comes from."""
    return recording.file or recording.name
