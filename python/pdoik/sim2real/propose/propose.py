"""Proposes the next motion from a report: `pdoik propose` in Python."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path as File

import numpy as np
from threadpoolctl import threadpool_limits

from pdoik.errors import LoadError

from ..diagnose import Tell, preprocess
from ..evidence import DIAGNOSIS
from ..findings import Diagnosis, Finding
from ..model import FILE_NAME, Model, load_model
from ..motion import Prepared
from ..study import load_study
from .clear import Clear, Verdict
from .design import Bounds, Design, designed
from .excitation import random_motion
from .expected import Pair
from .path import Path
from .proposal import Proposal
from .questions import ENOUGH, Cause, Question, beyond_motion, cause_of, open_findings, questions_of
from .setting import bounds_of, predict_of
from .weigh import Weigher
from .wishes import Wishes

_RANDOM_TRIES = 20


class NothingToSettleError(ValueError):
    """A diagnosis lists no equivalents and is sure of all it found, or no motion would help."""


def propose(report: str | File, wishes: Wishes | None = None, tell: Tell | None = None) -> Proposal:
    """The motion that separates best what a diagnosis could not.

    Args:
        report: folder of `pdoik diagnose`.
        wishes: the defaults if none are given.
        tell: called with a stage's name, words, and the share of the work done.

    Raises:
        NothingToSettleError: no motion is needed, or none would help.
        LoadError: a file of the report, or the study, is not there or is not what it should be.
        ValueError: limits are missing, the start breaks them, or it cannot be said whether a robot
            that stands would stay up.
    """
    wishes, say = wishes or Wishes(), tell or (lambda stage, text, share: None)
    diagnosis, model = _read(File(report))
    findings = () if wishes.figures else open_findings(diagnosis)
    unsettled = tuple(said for each in findings if (said := beyond_motion(each)))
    if not findings and not wishes.figures:
        raise NothingToSettleError(
            "there is nothing to settle: every finding has a confidence of 0.9 or more and no"
            " equivalents; with --figures the motion is by which all joints' figures are known best"
        )
    if findings and len(unsettled) == len(findings):
        raise NothingToSettleError(f"no motion would settle what is open: {'; '.join(unsettled)}")
    study = load_study(_study_file(model, wishes))
    with threadpool_limits(limits=1, user_api="blas"):
        ready = preprocess(study, lambda stage, text, share: say(stage, text, 0.5 * share))
        prepared = ready.prepared
        questions = questions_of(findings, prepared)
        say("rivals", f"{len(questions)} questions", 0.1)
        causes = _causes(diagnosis, questions, prepared)
        predict = predict_of(prepared, causes, wishes.base)
        bounds, notes = bounds_of(predict, Weigher(prepared, questions, causes), wishes)
        _check_start(bounds)
        design = _found(bounds, wishes, say)
        if questions:
            _check_hope(questions, design)
        verdict = _judged(bounds.clear, design.run.path)
        return _proposal(bounds, design, verdict, wishes, unsettled, notes)


def _read(report: File) -> tuple[Diagnosis, Model]:
    if not report.is_dir():
        raise LoadError(f"{report}: no such folder; expected the report of pdoik diagnose")
    file = report / DIAGNOSIS
    for path in (file, report / FILE_NAME):
        if not path.is_file():
            raise LoadError(f"{path}: no such file; expected the report of pdoik diagnose")
    try:
        diagnosis = Diagnosis.from_json(file.read_text(encoding="utf-8"))
    except ValueError as error:
        raise LoadError(f"{file}: {error}") from None
    return diagnosis, load_model(report)


def _study_file(model: Model, wishes: Wishes) -> File:
    file = wishes.study or (None if model.study is None else File(model.study))
    if file is None:
        raise LoadError("the report does not say of which study it is: give it with --study")
    if not file.is_file():
        raise LoadError(f"the study is not at {file} any more: give its place with --study")
    return file


def _causes(
    diagnosis: Diagnosis, questions: tuple[Question, ...], prepared: Prepared
) -> list[Cause]:
    """All that was found and acts along a motion, the questions' own causes among it."""
    asked = {_name(question.finding) for question in questions}
    others = [
        cause_of(each, prepared)
        for each in diagnosis.findings
        if not beyond_motion(each) and _name(each) not in asked
    ]
    return [*(question.own for question in questions), *others]


def _name(finding: Finding) -> tuple[object, ...]:
    return finding.effect, finding.joints, finding.links, finding.positions, finding.variant


def _check_start(bounds: Bounds) -> None:
    """The start must be a place to be."""
    predict = bounds.predict
    start = bounds.frame.start if predict.may_be_led else predict.start
    load = np.abs(predict.load(start)) / bounds.limits.torque
    j = int(np.argmax(load))
    if load[j] > 1.0:
        raise ValueError(
            f"{predict.prepared.study.joints[j]} needs more torque to stand at the start than the"
            " limits allow: give another start with --start"
        )
    if bounds.clear is not None:
        there = bounds.clear.at(start)
        if there.short():
            raise ValueError(
                f"the start is not clear ({there.worst}): give another with --start, or take what"
                " is too near out of the cloud"
            )


def _found(bounds: Bounds, wishes: Wishes, say: Tell) -> Design:
    rng = np.random.default_rng(wishes.seed)
    if wishes.random:
        for _ in range(_RANDOM_TRIES):
            made = bounds.made(random_motion(bounds.frame, rng), costly=True)
            if made is not None:
                return made
    else:
        best = designed(
            bounds,
            rng,
            wishes.effort,
            wishes.search,
            lambda text, share: say("design", text, 0.15 + 0.8 * share),
        )
        if best is not None:
            return best
    if not bounds.predict.may_be_led:
        raise ValueError(
            "no motion of the standing robot is proposed: in MuJoCo, with the study's gains, it"
            " comes off its feet or beyond its limits in each that was tried; hang the robot up and"
            " use --base hang"
        )
    raise ValueError(
        "no motion from this start holds all limits: give another start with --start, or larger"
        " shares of the limits"
    )


def _hopeless(design: Design) -> frozenset[Pair]:
    """Findings and the rivals listed with them, that would be after every motion looked at."""
    listed = {(p.finding, r.rival) for p in design.prospects for r in p.rivalries if r.listed}
    return design.hopeless & listed


def _side_by_side(pairs: Iterable[Pair]) -> tuple[str, ...]:
    return tuple(
        f"whether it is {finding} or {rival}: after any motion both would be listed"
        for finding, rival in sorted(pairs)
    )


def _check_hope(questions: Iterable[Question], design: Design) -> None:
    """Nobody should run a motion for what no motion distinguishes."""
    hopeless = _hopeless(design)
    for question, prospect in zip(questions, design.prospects, strict=False):
        rivals = {(prospect.finding, each.rival) for each in prospect.rivalries if each.listed}
        if not rivals or not rivals <= hopeless or question.finding.confidence < ENOUGH:
            return
    raise NothingToSettleError(f"no motion tells {'; '.join(_side_by_side(hopeless))}")


def _judged(clear: Clear | None, path: Path) -> Verdict | None:
    """Verdict of dense samples, once more; None without a scene."""
    if clear is None:
        return None
    verdict = clear.along(path)
    if verdict.short(margin=0.5 * clear.travel(path)):
        raise ValueError(
            f"no clear motion was found: {verdict.worst} at {verdict.time:.2f} s; try another"
            " --seed or --start"
        )
    return verdict


def _proposal(
    bounds: Bounds,
    design: Design,
    verdict: Verdict | None,
    wishes: Wishes,
    unsettled: tuple[str, ...],
    notes: tuple[str, ...],
) -> Proposal:
    path, torque, limits = design.run.path, design.run.torque, bounds.limits
    assert torque is not None
    time = np.arange(round(path.duration * wishes.rate) + 1) / wishes.rate
    curve = path.curve
    middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * (limits.upper - limits.lower)
    used = {
        "position": float(np.max(np.abs(path.q - middle) / half)),
        "speed": float(np.max(np.abs(path.dq) / limits.speed)),
        "acceleration": float(np.max(np.abs(path.ddq) / limits.acceleration)),
        "torque": float(np.max(np.abs(torque) / limits.torque)),
    }
    return Proposal(
        joints=bounds.predict.prepared.study.joints,
        time=time,
        q=curve(time),
        dq=curve(time, 1),
        torque=torque,
        used=used,
        prospects=tuple(each for each in design.prospects if each.why),
        figures=design.figures,
        unsettled=(*unsettled, *_side_by_side(_hopeless(design))),
        hopeless=_hopeless(design),
        verdict=verdict,
        looked_at=design.looked_at,
        random=wishes.random,
        notes=notes,
    )
