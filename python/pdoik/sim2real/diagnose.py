"""The stages from a study to what is wrong with its model, one after the other."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

from threadpoolctl import threadpool_limits

from .channels import ChannelCheck, check_channels
from .confirm import confirmed_by_simulation, why_not
from .controllers import ControllerCheck, check_controllers
from .findings import Diagnosis
from .identify import identify
from .infer import Examination, conclude, source_in_words, why_unanswerable
from .motion import Prepared, prepare
from .study import Study, excerpted, load_study
from .thresholds import Thresholds

Tell = Callable[[str, str, float], None]


class UnanswerableError(ValueError):
    """Nothing can be found in a study, whatever is wrong with its model."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Ready:
    """A study before the search: its channels and controllers are what they are believed to be."""

    prepared: Prepared
    control: ControllerCheck
    check: ChannelCheck

    @property
    def unanswerable(self) -> str:
        """Why nothing can be found in it, in words; "" where something may be."""
        return why_unanswerable(self.prepared, self.control, self.check)


def preprocess(study: Study, say: Tell = lambda stage, text, share: None) -> Ready:
    """Set up the balances of a study, work out its controllers and mend its channels.

    Args:
        study: as it was read.
        say: called with a stage, what it came to in words, and the share of the diagnosis done.
    """
    study = excerpted(study)
    say("read", f"{len(study.recordings)} recordings of {len(study.joints)} joints", 0.02)
    prepared = prepare(study)
    say("residual", f"cut-off {prepared.cutoff:.3g} Hz, torque {source_in_words(prepared)}", 0.15)
    control = check_controllers(prepared)
    for note in control.notes:
        say("controllers", note, 0.155)
    if control.changed:
        prepared = prepare(control.study)
    check = check_channels(prepared)
    for note in check.notes:
        say("channels", note, 0.16)
    if check.mended:
        prepared = prepare(check.study, prepared.body)
    return Ready(prepared=prepared, control=control, check=check)


def diagnose(
    study: Study | str | os.PathLike[str],
    *,
    seed: int = 0,
    tell: Tell | None = None,
    thresholds: Thresholds | None = None,
) -> Diagnosis:
    """Where and why recordings and model disagree.

    Each recording is compared with the model as it was then: with its payload, robot and gains.
    Friction is a mean over sessions, or recordings; its spread is given if the study has sessions.

    Args:
        study: a study, or its YAML file.
        seed: of the draws behind intervals.
        tell: called with a stage's name, what it found in words, and the share of the work done.
        thresholds: what is believed; the study's own, which are the defaults, if none are given.

    Raises:
        LoadError, ValueError: the study cannot be used; the message says what was expected.
    """
    return examine(study, seed=seed, tell=tell, thresholds=thresholds).diagnosis


def examine(
    study: Study | str | os.PathLike[str],
    *,
    seed: int = 0,
    tell: Tell | None = None,
    thresholds: Thresholds | None = None,
    anyway: bool = True,
) -> Examination:
    """`diagnose`, with all it rests on.

    Raises:
        UnanswerableError: nothing can be found in the study, and `anyway` is False.
    """
    say = tell or (lambda stage, text, share: None)
    with threadpool_limits(limits=1, user_api="blas"):  # of small solves threads only wait
        ready = preprocess(_believing(load_study(study), thresholds), say)
        if ready.unanswerable and not anyway:
            raise UnanswerableError(ready.unanswerable)
        return _examined(ready, seed, say)


def _believing(study: Study, thresholds: Thresholds | None) -> Study:
    return study if thresholds is None else replace(study, thresholds=thresholds)


def _examined(ready: Ready, seed: int, say: Tell) -> Examination:
    control, check = ready.control, ready.check
    prepared, state = identify(ready.prepared, say)
    state = confirmed_by_simulation(prepared, state, seed, lambda text: say("simulate", text, 0.78))
    if state.accepted and not why_not(control.study):
        say("simulate", "the figures refined by simulating the arm from its commands", 0.85)
    return conclude(prepared, state, seed, check, control)
