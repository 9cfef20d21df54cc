"""A model as it was in one recording: with its robot, the body attached to it, its gains."""

from __future__ import annotations

import numpy as np

from ..simulation import Inertial, LinkChange, Simulator
from ..study import Payload, Setup
from .model import Model


def simulator_in(model: Model, setup: Setup, *, findings: bool = True) -> Simulator:
    """Closed-loop simulation of a recording with what was found, or as the study has it.

    Raises:
        LoadError: the recording's robot cannot be read.
        ValueError: the study had no robot.
    """
    if setup.is_plain:
        return model.simulator(findings=findings)
    own = model if setup.robot is None else model.with_robot(setup.robot)
    held = () if setup.payload is None else (held_part(setup.payload),)
    return Simulator(
        own.description,
        model.joints,
        setup.controller or model.controller,
        model.rotor_inertia,
        (*own.parts(findings=findings, held=setup.payload), *held),
        tip=model.tip,
        gravity=model.gravity,
        believed=own.description if setup.compensated else model.description,
        believed_parts=held if setup.compensated else (),
    )


def held_part(payload: Payload) -> LinkChange:
    """A known body, for the simulation."""
    inertial = Inertial.about_com(payload.mass, np.array(payload.com), payload.inertia_matrix)
    return LinkChange(link=payload.link, inertial=inertial)
