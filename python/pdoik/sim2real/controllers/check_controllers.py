"""Every joint's controller, the study with what was not known of it, and gains given compared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from ..findings import ControllerEstimate, Finding
from ..motion import Prepared, prepare, thinned
from ..study import Controller, GivenController, Study, VoltageDrive
from ..thresholds import ControllerThresholds
from .drive_findings import Drives, drive_findings
from .estimate import JointLaw, joint_law
from .load import Load, in_words, load_of
from .rows import Feeds
from .voltage import Motor, motor_of, supply, with_torque
from .words import contradictions, drive_in_words, law_in_words, nothing_known, with_untellable

SEEN_ITSELF = ("tau_cmd", "duty")
"""Efforts that are the law's own: a torque reported may differ from it by the drive's gain."""


def given_gains(study: Study, j: int) -> dict[str, float]:
    """Gains of joint j that the study gives, by name."""
    given, known = study.told, study.controller
    if given is not None:
        every = {name: float(values[j]) for name, values in given.gains.items()}
        return {name: value for name, value in every.items() if np.isfinite(value)}
    if isinstance(known, Controller) and known.type == "pd":
        return {"kp": float(known.kp[j]), "kd": float(known.kd[j])}
    return {}


def compared(
    law: JointLaw, gains: dict[str, float], limits: ControllerThresholds
) -> ControllerEstimate:
    """The estimate with the position gain given, if the effort contradicts it.

    Only where the law's own effort was logged and is explained, and in every recording by itself:
    what one of them has is no gain. Dampings and integrals are not judged: a speed that is logged
    late, or with noise of the log's own, changes what they seem.
    """
    estimate = law.estimate
    seen = estimate.effort in SEEN_ITSELF and estimate.explained >= limits.used
    if not seen or "kp" not in gains or "kp" not in estimate.gains:
        return estimate
    value, found = gains["kp"], estimate.gains["kp"]
    if "kv" in gains and estimate.law == "pd":  # what a cascade without an integral is
        value *= gains["kv"]
    elif ("kv" in gains) != (estimate.law == "cascade") or estimate.law == "table":
        return estimate
    shown = ((found.value, found.std), *law.each)
    same_way = len({value > kp for kp, _ in shown}) == 1
    far = all(abs(value - kp) > limits.given_off * abs(kp) for kp, _ in shown)
    differs = all(_log_odds(value, kp, std, limits) > limits.worth for kp, std in shown)
    wrong = same_way and far and differs
    return replace(estimate, given_wrong={"kp": value}) if wrong else estimate


def _log_odds(value: float, kp: float, std: float, limits: ControllerThresholds) -> float:
    """That a gain is another one than given, as usual errors of it are.

    The density of the gain at the value given before the data over that after them (Dickey, Annals
    of Mathematical Statistics 42, 1971).
    """
    usual = np.hypot(limits.given_usual * value, std)
    return float(0.5 * ((value - kp) / std) ** 2 + np.log(std / usual))


_WIDER = 2.5  # as motions are filtered: speeds for back-EMFs
_NEVER = 1e6  # a limit that is none


@dataclass(frozen=True, kw_only=True, eq=False)
class ControllerCheck:
    """What the controllers were found to be."""

    study: Study
    estimates: tuple[ControllerEstimate, ...]
    notes: tuple[str, ...]
    findings: tuple[Finding, ...]  # of drives whose controllers are not given
    changed: bool  # whether the study is another than before


def check_controllers(prepared: Prepared) -> ControllerCheck:
    """Estimate each joint's law; where the study needs it, put in what was not known."""
    study = prepared.study
    limits = study.thresholds.controllers
    fit = [thinned(r) for r in study.fit]
    judges = [thinned(r) for r in study.validate]
    feeds = Feeds(prepared.body)
    laws = [joint_law(name, j, fit, judges, feeds, limits) for j, name in enumerate(study.joints)]
    drives = Drives.of(prepared, fit, judges, feeds)
    estimates = [compared(law, given_gains(study, j), limits) for j, law in enumerate(laws)]
    changed = _with_released(study, laws)
    motors: list[Motor | None] = [None] * len(laws)
    if prepared.body is not None and prepared.fit.motions[0].source == "duty":
        if changed is not study:
            prepared = prepare(changed, prepared.body, prepared.cutoff)
        motors = [motor_of(prepared.fit, j, study.told, limits) for j in range(len(laws))]
        cutoff = _WIDER * prepared.cutoff
        recordings = with_torque(changed.recordings, motors, study.told, cutoff)
        changed = _with_rotors(replace(changed, recordings=recordings), motors)
    loads = [
        None
        if motor is None or prepared.body is None
        else load_of(prepared.body, j, motor, limits.drive_error)
        for j, motor in enumerate(motors)
    ]
    estimates = [
        replace(
            each,
            in_band=max(drives.followed(j), 0.0),
            drive={} if motor is None else motor.estimates(),
            load={} if load is None else load.estimates(),
        )
        for j, (each, motor, load) in enumerate(zip(estimates, motors, loads, strict=True))
    ]
    controller = _known(changed, estimates, motors)
    # What is not given of an arm's law is reported, not run: simulations would rest on it.
    given = study.told is not None or study.controller is not None
    asked = given or any(motor is not None for motor in motors)
    if asked and controller is not None and controller is not study.controller:
        changed = replace(changed, controller=controller)
    estimates = [
        with_untellable(each, study, _released(changed, j)) for j, each in enumerate(estimates)
    ]
    unknown = study.controller is None and changed.controller is None
    return ControllerCheck(
        study=changed,
        findings=drive_findings(drives) if unknown else (),
        estimates=tuple(estimates),
        notes=tuple(_notes(study, changed, estimates, motors, loads)),
        changed=changed is not study,
    )


def _notes(
    study: Study,
    changed: Study,
    estimates: Sequence[ControllerEstimate],
    motors: Sequence[Motor | None],
    loads: Sequence[Load | None],
) -> list[str]:
    known = study.controller is not None
    wrong = [said for each in estimates for said in contradictions(each)]
    blind = [each.joint for each in estimates if not each.effort and not _logged(study, each.joint)]
    notes = wrong if known or not blind else [nothing_known(study, blind), *wrong]
    for each, motor, load in zip(estimates, motors, loads, strict=True):
        asked = not known or each.effort in SEEN_ITSELF
        if asked and law_in_words(each):
            notes.append(law_in_words(each))
        if drive_in_words(each, motor is not None and motor.given):
            notes.append(drive_in_words(each, motor is not None and motor.given))
        if load is not None:
            sure = study.thresholds.diagnosis.sure
            notes.append(in_words(each.joint, load, study.rotor_inertia is not None, sure))
        if not known and each.untellable:
            notes.append(f"{each.joint}: {'; '.join(each.untellable)}.")
    for j, name in enumerate(study.joints):
        files = [
            r.name for r in changed.recordings if r.released is not None and r.released[:, j].any()
        ]
        if files:
            notes.append(f"{name}: its drive lets go in {', '.join(files)}: no torque acts there.")
    return notes


def _with_rotors(study: Study, motors: Sequence[Motor | None]) -> Study:
    """The study with the rotors' inertias that were fitted with the motors, where none is given."""
    own = np.zeros(len(motors)) if study.rotor_inertia is None else study.rotor_inertia
    found = [
        own[j] if motor is None or motor.given_rotor else motor.rotor.value
        for j, motor in enumerate(motors)
    ]
    return replace(study, rotor_inertia=np.array(found))


def _released(study: Study, j: int) -> bool:
    """Whether joint j's drive lets go in a recording to fit."""
    return any(r.released is not None and bool(r.released[:, j].any()) for r in study.fit)


def _logged(study: Study, joint: str) -> bool:
    """Whether any effort of a joint was logged."""
    j = study.joints.index(joint)
    each = [
        values
        for r in study.recordings
        for values in (r.tau, r.current, r.duty, r.tau_cmd)
        if values is not None
    ]
    return any(np.isfinite(values[:, j]).any() for values in each)


def _with_released(study: Study, laws: Sequence[JointLaw]) -> Study:
    """The study with the samples at which drives have let go."""
    limits = study.thresholds.controllers
    recordings = []
    for r in study.recordings:
        each = [law.let_go(r, j, limits) for j, law in enumerate(laws)]
        released = np.stack(each, axis=1)
        recordings.append(replace(r, released=released) if released.any() else r)
    if all(new is old for new, old in zip(recordings, study.recordings, strict=True)):
        return study
    return replace(study, recordings=tuple(recordings))


def _known(
    study: Study, estimates: Sequence[ControllerEstimate], motors: Sequence[Motor | None]
) -> Controller | None:
    """The law with what was estimated in place of what was not known, or was given wrong.

    The study's own where nothing is better; None where a joint's is not known well enough.
    """
    least = study.thresholds.controllers.used
    own = study.controller
    believed = all(each.law == "pd" and each.explained >= least for each in estimates)
    wrong = any(each.given_wrong for each in estimates)
    if not believed or (own is not None and not wrong):
        return own
    if study.told is not None and study.told.type in ("pid", "cascade", "table") and not wrong:
        return own  # a law of more terms was given than these recordings show
    kp, kd, gravity = (_gain(estimates, name) for name in ("kp", "kd", "gravity"))
    units = {each.unit for each in estimates}
    given = study.told
    if own is not None and own.type == "pd":  # what is given wrong is a position gain
        wrong_at = [bool(each.given_wrong) for each in estimates]
        return replace(own, kp=np.where(wrong_at, kp, own.kp))
    if units == {"N m"}:
        return Controller(
            kp=kp,
            kd=kd,
            gravity_compensation=bool(gravity.any()),
            gravity_factor=gravity if gravity.any() else None,
            torque_limit=_limit(estimates, given),
            period=_period(estimates, given),
        )
    if units == {"1"} and all(motors):
        drive = _drive(study, estimates, [motor for motor in motors if motor is not None], given)
        volts = drive.torque_per_volt * drive.volts
        return Controller(
            type="voltage",
            kp=volts * kp,
            kd=volts * kd + drive.back_emf,
            period=_period(estimates, given),
            drive=drive,
            kp_duty=kp,
            kd_duty=kd,
        )
    return own


def _drive(
    study: Study,
    estimates: Sequence[ControllerEstimate],
    motors: Sequence[Motor],
    given: GivenController | None,
) -> VoltageDrive:
    def limit(j: int) -> float:
        if given is not None and given.duty_limit is not None:
            return float(given.duty_limit[j])
        found = estimates[j].gains.get("limit")
        return 1.0 if found is None else found.value

    every = range(len(motors))
    volts = [
        float(np.median(np.concatenate([supply(r, j, given) for r in study.fit]))) for j in every
    ]
    return VoltageDrive(
        torque_per_volt=np.array([motor.torque_per_volt.value for motor in motors]),
        back_emf=np.array([motor.back_emf.value for motor in motors]),
        supply_loss=np.array([motor.supply_loss.value for motor in motors]),
        volts=np.array(volts),
        duty_limit=np.array([limit(j) for j in every]),
    )


def _gain(estimates: Sequence[ControllerEstimate], name: str) -> FloatArray:
    """A gain of every joint, 0 where it has none, (n,)."""
    none = [each.gains.get(name) for each in estimates]
    return np.array([0.0 if each is None else max(each.value, 0.0) for each in none])


def _limit(
    estimates: Sequence[ControllerEstimate], given: GivenController | None
) -> FloatArray | None:
    if given is not None and given.torque_limit is not None:
        return given.torque_limit
    found = [each.gains.get("limit") for each in estimates]
    if not any(found):
        return None
    return np.array([_NEVER if each is None else each.value for each in found])


def _period(estimates: Sequence[ControllerEstimate], given: GivenController | None) -> float | None:
    if given is not None and given.period is not None:
        return given.period
    found = [each.gains["period"].value for each in estimates if "period" in each.gains]
    return float(np.median(found)) if found else None
