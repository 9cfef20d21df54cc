"""Gains that nobody knows, fitted to recorded motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..study.recording import Recording
from ..thresholds.simulators import SimulatorThresholds
from .blocks import Blocks
from .candidates import Knob, terms_of
from .experiment import Experiment
from .explain import fitted, noise_of, sigma_of
from .patch import patched
from .selection import Selection
from .sensitivities import knobs_of, scales_of, sensitivities
from .user_model import UserModel, user_model

_ROUNDS = 4


def with_fitted_gains(
    user: UserModel, fit: Sequence[Recording], limits: SimulatorThresholds
) -> tuple[UserModel, str]:
    """The model with the gains that fit best, and what that means, in words.

    A delay of all commands is fitted with them and then left out: it is a finding.

    Raises:
        SimulationError: the guess is unstable.
        ValueError: commands are missing.
    """
    experiment = Experiment(user, fit, torque=False)
    terms = tuple(t for t in terms_of(user) if _is_fitted(t.knobs[0]))
    noise, scales, knobs = noise_of(experiment), scales_of(experiment), knobs_of(terms)
    values: dict[Knob, float] = {}
    for _ in range(_ROUNDS):
        about = sensitivities(experiment, values, knobs, scales)
        sigma = sigma_of(experiment, about.shown, noise)
        selection = Selection(Blocks.of(experiment, about, sigma), knobs, terms, limits)
        before, values = values, fitted(experiment, about, selection, terms, sigma, scales)
        if before and all(abs(values[k] / before[k] - 1.0) < 0.02 for k in values if k in before):
            break
    gains = {knob: value for knob, value in values.items() if knob.property != "delay"}
    like = patched(user, gains)
    model = replace(user_model(like.text, user.joints, name=user.name), law=None)
    shown = ", ".join(
        f"{joint} {gains.get(Knob('kp', k), 0.0):.3g} and {gains.get(Knob('kv', k), 0.0):.3g}"
        for k, joint in enumerate(user.joints)
    )
    return model, (
        f"Gains are unknown, so kp [N m/rad] and kv [N m s/rad] were fitted first: {shown}."
        " Positions tell torques only beside the model's own masses and inertias: where these are"
        " wrong by a factor, gains, friction and armatures are wrong by the same. A finding says"
        " what still differs."
    )


def _is_fitted(knob: Knob) -> bool:
    own = knob.property in ("kp", "kv")
    return own or (knob.property == "delay" and knob.index < 0)
