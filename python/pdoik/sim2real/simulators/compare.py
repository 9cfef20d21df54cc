"""Finds what a study's simulator and machine differ by: `pdoik compare` in Python."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from pdoik.errors import LoadError
from pdoik.recordings import FloatArray, Recording

from ..simulation import SimulationError
from ..study import Study, load_study, split
from .commands import check_base_at_rest, check_commands
from .differences import Difference, differences_of
from .experiment import simulated
from .explain import explain
from .findings import Step, step_of
from .pairing import Pair, at_times_of, drift_note, pairs_of
from .patch import Patch, patched
from .user_model import UserModel, description_of, simulator_of, user_model

Tell = Callable[[str, str, float], None]
Shown = dict[str, FloatArray]  # (T, n) by channel


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """One recording of the machine together with simulations of it, (T, n) positions."""

    recording: Recording
    simulator: FloatArray  # as it is; NaN where its log has nothing
    model: FloatArray | None  # the model that was compared with the machine, unchanged
    patched: FloatArray | None  # the same with the patch


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Comparison:
    """What differs, and the two steps that explain it, kept apart."""

    study: Study
    pairs: tuple[Pair, ...]  # () where the simulator was run by us
    differences: tuple[Difference, ...]  # of the simulator as it is
    traces: tuple[Trace, ...]
    simulator: Step | None  # what the simulator has that the description does not say
    machine: Step | None  # what the machine has beyond the simulator
    patch: Patch | None  # of the simulator, so that it does as the machine does
    notes: tuple[str, ...]


def compare(study: Study | str | os.PathLike[str], *, tell: Tell | None = None) -> Comparison:
    """Compare a simulator with the machine, and say which of its properties differ.

    Args:
        study: with `simulator:` (its model), `simulation:` (its log), or both.
        tell: called with a stage's name, what was found in words, and the share of work done.

    Raises:
        LoadError, ValueError: the study cannot be used; the message says what was expected.
        SimulationError: the simulator as it is is unstable under the recorded commands.
    """
    with threadpool_limits(limits=1, user_api="blas"):
        return _compare(load_study(study), tell or (lambda stage, text, share: None))


def _compare(study: Study, say: Tell) -> Comparison:
    limits, notes = study.thresholds.simulators, []
    if study.simulator is None and not study.simulation:
        raise LoadError(
            "study: expected 'simulator: {mjcf: model.xml}' (your simulator's model) or"
            " 'simulation:' (a log of it under the recorded commands)"
        )
    for each in study.recordings:
        check_base_at_rest(each, limits)
    user = simulator_of(study)
    pairs: tuple[Pair, ...] = ()
    shown: dict[str, Shown] = {}
    if study.simulation:
        pairs = pairs_of(study.recordings, study.simulation, study.joints, limits)
        lost = len(study.recordings) - len(pairs)
        if lost:
            notes.append(f"{lost} recordings have no simulation of the same commands.")
        notes += [drift_note(pair) for pair in pairs if pair.drift]
        shown = {pair.machine.name: _at_samples(pair) for pair in pairs}
        say("pair", f"{len(pairs)} runs have the same commands", 0.05)
    else:
        assert user is not None
        for each in study.recordings:
            check_commands(each, study.joints)
            run = simulated(user, each, {})
            shown[each.name] = {"q": run.q, "dq": run.dq, "tau": run.tau}  # type: ignore[dict-item]
    there = tuple(each for each in study.recordings if each.name in shown)
    differences = tuple(
        one for each in there for one in differences_of(each, shown[each.name], study.joints)
    )
    simulator, baseline = _first_step(study, user, say, notes)
    machine: Step | None = None
    patch: Patch | None = None
    if baseline is not None:
        fit = [each for each in there if each.role == "fit"]
        validate = [each for each in there if each.role == "validate"]
        if not fit or not validate:
            fit, validate = _parted(there)
        say("machine", f"held against {baseline.name}", 0.4)
        explained = explain(baseline, fit, validate, limits, lambda text: say("machine", text, 0.6))
        machine = step_of(explained, "machine", limits)
        try:
            patch = patched(baseline, explained.patch)
            notes += [f"patched.xml: {note}." for note in patch.notes]
        except LoadError as error:
            notes.append(f"patched.xml could not be made: {error}.")
    else:
        notes.append(
            "No model of the simulator is known, so what differs is not explained: give"
            " 'simulator: {mjcf: ...}', or 'robot:' and 'controller:'."
        )
    return Comparison(
        study=study,
        pairs=pairs,
        differences=differences,
        traces=tuple(_trace(each, shown[each.name]["q"], machine) for each in there),
        simulator=simulator,
        machine=machine,
        patch=patch,
        notes=(*study.notes, *notes),
    )


def _first_step(
    study: Study, user: UserModel | None, say: Tell, notes: list[str]
) -> tuple[Step | None, UserModel | None]:
    """What the simulator has beyond the description, and the model to compare with the machine."""
    limits = study.thresholds.simulators
    if study.robot is None:
        return None, user
    if study.controller is None and user is not None:
        notes.append(
            "The description has no gains: with 'controller: {kp: ..., kd: ...}' it would be held"
            " against the simulator, too."
        )
        return None, user
    description = description_of(study)
    assert description is not None
    if study.simulation:
        fit, validate = _parted(study.simulation)
    else:
        assert user is not None
        for field in ("timestep", "integrator"):
            setattr(description.model.opt, field, getattr(user.model.opt, field))
        logs = [replace(simulated(user, r, {}), role=r.role) for r in study.recordings]
        fit = [each for each in logs if each.role == "fit"]
        validate = [each for each in logs if each.role == "validate"]
    say("simulator", f"held against {description.name}", 0.1)
    explained = explain(
        description,
        fit,
        validate,
        limits,
        lambda text: say("simulator", text, 0.3),
        same_step=user is not None,
    )
    step = step_of(explained, "simulator", limits)
    if user is not None:
        return step, user
    like = patched(description, explained.patch)
    model = user_model(
        like.text,
        study.joints,
        name=f"{description.name} with what the simulator has",
        controller=study.controller,
    )
    if like.left_out:
        notes.append(f"Not in that model: {'; '.join(like.left_out)}.")
    return step, model


def _parted(recordings: tuple[Recording, ...]) -> tuple[list[Recording], list[Recording]]:
    plain = tuple(replace(each, role="fit") for each in recordings)
    parts, _ = split(plain)
    return (
        [each for each in parts if each.role == "fit"],
        [each for each in parts if each.role == "validate"],
    )


def _at_samples(pair: Pair) -> Shown:
    """The simulator's log at the machine's samples, NaN where it has none."""
    times = at_times_of(pair)
    found: Shown = {}
    for channel in ("q", "dq", "tau"):
        values: FloatArray | None = getattr(pair.simulation, channel)
        if values is not None:
            columns = [
                np.interp(times, pair.simulation.time, column, left=np.nan, right=np.nan)
                for column in values.T
            ]
            found[channel] = np.stack(columns, axis=1)
    return found


def _trace(recording: Recording, shown: FloatArray, machine: Step | None) -> Trace:
    model = after = None
    if machine is not None:
        user = machine.explained.user
        model = simulated(user, recording, {}).q
        try:
            after = simulated(user, recording, machine.explained.patch).q
        except SimulationError:
            after = None
    return Trace(recording=recording, simulator=shown, model=model, patched=after)
