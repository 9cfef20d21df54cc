"""A study's robot with what was found, for simulation and prediction."""

from __future__ import annotations

from ..findings import Finding
from ..model import Model
from ..motion import Prepared
from ..simulation import read_description
from .fit import Fit
from .trusted_bodies import TRUST


def improved_model(prepared: Prepared, findings: tuple[Finding, ...], fit: Fit) -> Model:
    """The robot with findings, and with its inertias as far as the study trusts none.

    Raises:
        LoadError: the robot's file cannot be read.
    """
    model = Model.of_study(prepared.study, findings, cutoff=prepared.cutoff)
    changes = {
        term.place.link: beta
        for term, beta in fit.weighted
        if term.effect == TRUST and term.place.link is not None
    }
    if not changes or model.robot is None:
        return model
    described = read_description(model.robot)
    own, floats = described.inertials, () if model.base is None else (model.base,)
    links = (*described.links_of(model.joints), *floats)  # a base that floats comes last
    corrected = {
        links[k]: own[links[k]].ten() + change for k, change in changes.items() if links[k] in own
    }
    return Model.of_study(prepared.study, findings, corrected, prepared.cutoff)
