"""From a study to what is wrong with its model: the stages, one after the other."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

from threadpoolctl import threadpool_limits

from .channels.check_channels import ChannelCheck, check_channels
from .confirm.confirm_by_simulation import confirmed_by_simulation
from .confirm.rollouts import why_not
from .confirm.sessions import borne_out
from .controllers.check_controllers import ControllerCheck, check_controllers
from .findings import Diagnosis
from .infer.conclude import Examination, conclude
from .infer.events import without_needless_contacts
from .infer.verdict import source_in_words
from .motion.prepare import Prepared, prepare
from .regression.fit import Term
from .regression.naming import described
from .regression.trial import Search
from .select.answerable import why_unanswerable
from .select.base_tilt import first_search
from .select.contacts import contact_term
from .select.feet_again import with_feet_again
from .select.gates import gated_term
from .select.joint_sets import with_joint_sets
from .select.level_sessions import with_level_sessions
from .select.onsets import with_onsets
from .select.peculiar import peculiar
from .select.rivals import swapped
from .select.search import search
from .select.shared_causes import with_shared_causes
from .select.unnamed import with_unknown
from .select.unspecific import without_unspecific
from .study.read_study import load_study
from .study.study import Study
from .thresholds import Thresholds

Tell = Callable[[str, str, float], None]

_MOST = 5  # rounds of gates and contacts


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


def made_ready(study: Study, say: Tell = lambda stage, text, share: None) -> Ready:
    """Put up the balances, work out controllers and mend channels."""
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

    Each recording is held against the model as it was then: with its payload, robot and gains.
    Where the study tells of sessions, figures are means over these, and their spread is given.

    Args:
        study: a study, or its YAML file.
        seed: of the bootstrap.
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
    study = load_study(study)
    if thresholds is not None:
        study = replace(study, thresholds=thresholds)
    with threadpool_limits(limits=1, user_api="blas"):  # of small solves threads only wait
        ready = made_ready(study, say)
        if ready.unanswerable and not anyway:
            raise UnanswerableError(ready.unanswerable)
        return _examined(ready, seed, say)


def _examined(ready: Ready, seed: int, say: Tell) -> Examination:
    prepared, control, check = ready.prepared, ready.control, ready.check
    study = control.study
    prepared, state = run_search(prepared, say)
    level = with_level_sessions(prepared, state)
    if level is not prepared:
        say("sessions", "once more, with friction as it is on average over sessions", 0.65)
        prepared, state = run_search(level, say)
    say("name", "every joint's friction, offset and rotor, weighed as a set", 0.72)
    state = without_unspecific(with_joint_sets(with_onsets(with_joint_sets(state))))
    state = with_unknown(state)
    say("name", "looking for what else would explain the same", 0.75)
    state = with_shared_causes(without_needless_contacts(swapped(state)))
    state = confirmed_by_simulation(prepared, state, seed, lambda text: say("simulate", text, 0.78))
    say("confirm", "each finding learnt anew without one recording after the other", 0.8)
    state, doubtful = borne_out(state)
    say("estimate", "intervals by the block bootstrap", 0.82)
    if state.accepted and not why_not(study):
        say("simulate", "the figures refined by simulating the arm from its commands", 0.85)
    return conclude(prepared, state, seed, check, doubtful, control)


def run_search(prepared: Prepared, say: Tell) -> tuple[Prepared, Search]:
    """Accept effects, behind gates where they need one, then contacts, and effects beside these."""
    beside = peculiar(prepared.fit)
    first = () if beside is None else beside.accepted
    for each in first:
        say("name", described(prepared, each), 0.15)
    prepared, state = with_feet_again(*first_search(prepared, say, first), say)
    nuisance = state.nuisance
    known = {term.key for term in first}
    contacts: tuple[Term, ...] = ()
    gated: tuple[Term, ...] = ()
    for _ in range(_MOST):
        part = gated_term(state)
        if part is not None:
            gated = (*gated, part)
            say("name", described(prepared, part), 0.6)
        elif (term := contact_term(state.fit)) is not None:
            contacts = (*contacts, term)
            say("name", described(prepared, term), 0.6)
        else:
            break
        begin = (*(t for t in state.accepted if t.key in known), *gated)
        state = search(prepared.fit, nuisance, contacts=contacts, begin=begin)
        gated = tuple(t for t in state.accepted if t.place.gate is not None)
    return prepared, replace(state, peculiar=beside)
