"""How far each joint is explained, the verdict in one word, and what cannot be known.

What only a simulation shows well is compared with simulations of the held-out recordings.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from pdoik.errors import PdoikError
from pdoik.recordings import FloatArray

from ..confirm import Arm, Rollout, run_without
from ..effects import Unknown
from ..findings import Evidence, Finding, JointFit, Residue, Verdict
from ..identify import Identified, changes_of
from ..motion import Balances, Key, Prepared, simulated
from ..regression import Prediction, TermKey, share_by_blocks
from ..study import Study
from ..thresholds import DiagnosisThresholds


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedEvidence:
    """Evidence of terms that simulations confirmed."""

    terms: dict[TermKey, Evidence] = field(default_factory=dict)
    left: dict[Key, float] = field(default_factory=dict)  # root mean square, balance by balance


def judged_by_simulation(prepared: Prepared, state: Identified) -> SimulatedEvidence:
    """Evidence on held-out recordings; none where there are none, or the arm runs away."""
    doubtful = [t for t in state.accepted if t.key in state.confirmed]
    if prepared.validate is None or not doubtful:
        return SimulatedEvidence()
    terms, values = state.accepted, state.figures_simulated
    if values is None:
        return SimulatedEvidence()
    try:
        arm = Arm(prepared, state.fit, held_out=True)
        whole = arm.run(terms, values)
        evidence = {
            t.key: _evidence(arm, whole, run_without(arm, terms, values, t), {*t.columns})
            for t in doubtful
        }
    except (PdoikError, ValueError):
        return SimulatedEvidence()
    left = {
        key: float(np.sqrt(np.mean(each**2))) * arm.data.sigma[key]
        for key, each in whole.left.items()
    }
    return SimulatedEvidence(terms=evidence, left=left)


def _evidence(arm: Arm, whole: Rollout, without: Rollout, keys: set[Key]) -> Evidence:
    """Share of what simulations without a finding leave that goes with it, over blocks."""
    count = int(arm.data.block.max()) + 1
    gained, began = np.zeros(count), np.zeros(count)
    for key in keys & set(arm.rows):
        block = arm.data.block[arm.rows[key]]
        before, after = without.left[key] ** 2, whole.left[key] ** 2
        gained += np.bincount(block, before - after, minlength=count)
        began += np.bincount(block, before, minlength=count)
    return share_by_blocks(gained, began, 0)


_BINS = 12  # numerics:


def residue_of(b: Balances, key: Key, left: FloatArray) -> Residue:
    """The variable whose value explains most of what is left of a balance.

    Args:
        b: of the recordings that the joint is judged by.
        key: the balance.
        left: (N,) what is left of it at all rows.

    Returns:
        Its share of the variance between the bins of each variable, less what as many bins of a
        variable that means nothing would have (the adjusted R^2 of a piecewise constant).
    """
    j, rows = key[1], b.mask[key]
    variables = {
        "speed": b.sampled([m.dq[:, j] for m in b.motions]),
        "position": b.sampled([m.q[:, j] for m in b.motions]),
        "load": b.sampled([m.borne[:, j] for m in b.motions]),
        "time": b.time,
    }
    shares = {name: _between(x[rows], left[rows]) for name, x in variables.items()}
    best = max(shares, key=lambda name: shares[name])
    least = b.thresholds.diagnosis.shown
    return Residue(of=best, share=shares[best]) if shares[best] > least else Residue()


def _between(x: FloatArray, y: FloatArray) -> float:
    """Share of y's mean square between bins of x, adjusted for their number."""
    edges = np.unique(np.quantile(x, np.linspace(0.0, 1.0, _BINS + 1))) if len(x) else x
    if len(edges) < 3 or len(x) < 4 * _BINS:
        return 0.0
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    count = np.maximum(np.bincount(place, minlength=len(edges) - 1), 1)
    mean = np.bincount(place, y, minlength=len(edges) - 1) / count
    whole = float(np.sum(y**2))
    inside = float(np.sum((y - mean[place]) ** 2))
    free = len(y) - len(count)
    return float(np.clip(1.0 - inside / max(whole, 1e-300) * len(y) / free, 0.0, 1.0))


_FEW_SESSIONS = 3  # numerics: fewer say next to nothing of others


def joint_fits(
    prepared: Prepared, state: Identified, prediction: Prediction, simulated_left: dict[Key, float]
) -> dict[str, JointFit]:
    """Residual of each joint before and after, on held-out recordings.

    What is left is the regression's, or where an effect was confirmed by simulations, the less of
    what these leave and the regression does. A session that nothing was learnt from is expected to
    differ from the mean as those do that were.
    """
    b = prediction.balances
    left = prediction.residual(state.fit)
    spread = prediction.spread(changes_of(state.fit))
    result = {}
    for j, name in enumerate(prepared.study.joints):
        key = next((k for k in preferred(j) if k in b.residual), None)
        if key is None:
            result[name] = _judged(b, None)
            continue
        rows = b.mask[key]
        excited = bool(prepared.fit.excited[j])
        if not rows.any():
            rows, excited = np.ones_like(rows), False
        after = min(_rms(left[key][rows]), simulated_left.get(key, np.inf))
        fit = replace(
            _judged(b, key, _rms(b.residual[key][rows]), after, excited=excited),
            spread=_rms(spread[key][rows]) if key in spread else 0.0,
        )
        if excited and not _is_quiet(fit, prepared.study.thresholds.diagnosis):
            fit = replace(fit, residue=residue_of(b, key, left[key]))
        result[name] = fit
    return result


def fitted_joints(
    prepared: Prepared, state: Identified, simulated_left: dict[Key, float]
) -> dict[str, JointFit]:
    """The same on the recordings to fit: what happened in these alone is not to be passed over."""
    b, result = prepared.fit, {}
    for j, name in enumerate(prepared.study.joints):
        key = next((k for k in preferred(j) if k in state.fit.design), None)
        if key is None or not len(state.fit.rows[key]):
            continue
        left = state.balances.sigma[key] * _rms(state.fit.residual(key))
        after = min(left, simulated_left.get(key, np.inf))
        result[name] = _judged(b, key, b.rms(key), after, excited=bool(b.excited[j]))
    return result


def _judged(
    b: Balances, key: Key | None, before: float = 0.0, after: float = 0.0, *, excited: bool = False
) -> JointFit:
    """A joint's fit by one of its balances; None where it has none."""
    return JointFit(
        before=before,
        after=after,
        noise_floor=0.0 if key is None else _floor(b, key),
        unit="rad" if key is not None and key[0] == "servo" else "N m",
        data=", ".join(m.recording.name for m in b.motions),
        excited=excited,
    )


def _floor(b: Balances, key: Key) -> float:
    """Floor of a balance: noise of its channels, what filters and rounding leave of a torque."""
    rounding = b.thresholds.noise.rounding if key[0] == "torque" else 0.0
    tau = np.concatenate([m.tau[:, key[1]] for m in b.motions]) if rounding else np.zeros(1)
    return max(b.floor[key], rounding * float(np.sqrt(np.mean(tau**2))))


def preferred(j: int) -> tuple[Key, ...]:
    """Balances that say how far joint j is explained, the first that there is."""
    return (("torque", j), ("servo", j), ("drive", j), ("law", j), ("velocity", j))


def verdict_of(
    findings: tuple[Finding, ...],
    joints: dict[str, JointFit],
    fitted: dict[str, JointFit] | None = None,
    thresholds: DiagnosisThresholds | None = None,
) -> Verdict:
    """The verdict in one word.

    Args:
        findings: of the diagnosis.
        joints: as they are judged.
        fitted: the same on the recordings to fit: what happened in these alone counts too.
        thresholds: what counts as explained; the defaults if none are given.
    """
    limits = DiagnosisThresholds() if thresholds is None else thresholds
    judged = [each for each in joints.values() if each.excited]
    also = [each for each in (fitted or {}).values() if each.excited]
    if not judged:
        return "cannot_tell"
    near = all(_is_explained(each, limits) for each in judged)
    quiet = all(_is_quiet(each, limits) for each in (*judged, *also))
    named = [f for f in findings if f.effect != Unknown.id]
    if not findings and near and quiet and len(judged) < len(joints):
        return "cannot_tell"  # of a joint that did not move
    if not findings:
        if not quiet:
            return "mismatch_unexplained"
        louder = [each.before > limits.quiet * each.noise_floor for each in (*judged, *also)]
        return "mismatch_explained" if any(louder) else "no_mismatch"
    if not named:
        return "mismatch_unexplained"
    explained = near and quiet and len(named) == len(findings)
    return "mismatch_explained" if explained else "mismatch_partly_explained"


def _is_explained(joint: JointFit, limits: DiagnosisThresholds) -> bool:
    floor = max(float(np.hypot(joint.noise_floor, joint.spread)), 1e-12)
    return joint.after <= limits.near_floor * floor or joint.after <= limits.little * joint.before


def _is_quiet(joint: JointFit, limits: DiagnosisThresholds) -> bool:
    """Whether it is explained, or so near its floor that a factor of two is worth no name."""
    floor = float(np.hypot(joint.noise_floor, joint.spread))
    return _is_explained(joint, limits) or joint.after <= limits.quiet * floor


def notes_of(prepared: Prepared, state: Identified, joints: dict[str, JointFit]) -> tuple[str, ...]:
    """What was assumed and what cannot be known, in words."""
    study = prepared.study
    notes = [*study.notes, *simulator_notes(study)]
    for recording in study.recordings:
        notes += [f"{recording.name}: {note}" for note in recording.notes]
    notes.append(f"Fit and held-out recordings were parted {study.split}.")
    notes.append(
        f"Both sides of every balance were filtered at {prepared.cutoff:.3g} Hz without delay;"
        f" torque is {source_in_words(prepared)}."
    )
    if prepared.fit.motions[0].source == "":
        notes.append(
            "Without torques, or gains of the controller, friction, backlash, loads and inertias"
            " cannot be distinguished: only how positions follow their commands."
        )
    notes += simulation_notes(prepared)
    still = [name for name, each in joints.items() if not each.excited]
    if still:
        notes.append(f"{', '.join(still)}: moved too little to be judged.")
    if prepared.fit.told is not None:
        notes.append(_sessions_in_words(prepared))
    if state.bodies > 0.0 and prepared.body is not None:
        allowed = "" if study.trust.rigid_body is None else ", as the study allows"
        notes.append(
            f"The model's masses, centres and inertias were adjusted within"
            f" {100 * state.bodies:.3g} %{allowed}."
        )
    return tuple(dict.fromkeys(notes))


def simulator_notes(study: Study) -> tuple[str, ...]:
    """That a simulator which the study names is judged elsewhere."""
    if study.simulator is None:
        return ()
    return (
        f"The study names a simulator ({study.simulator.path.name}), which a diagnosis does not"
        " run: 'pdoik compare' holds it against the same recordings.",
    )


def _sessions_in_words(prepared: Prepared) -> str:
    """Which recordings to fit are of which session, and what was done about it."""
    assert prepared.fit.told is not None
    groups: dict[str, list[str]] = {}
    for motion in prepared.fit.motions:
        groups.setdefault(motion.setup.session or "not given", []).append(motion.recording.name)
    said = "; ".join(f"{name}: {', '.join(files)}" for name, files in groups.items())
    words = f"Sessions of the recordings to fit: {said}. Figures are means over sessions."
    if len(groups) < _FEW_SESSIONS:
        words += " Two sessions say next to nothing of others: three or more make intervals narrow."
    return words


def simulation_notes(prepared: Prepared) -> list[str]:
    """Whether the user's own simulation is of the model that was given."""
    b = simulated(prepared)
    if b is None:
        return []
    apart, thresholds = [], prepared.study.thresholds
    for j, name in enumerate(prepared.study.joints):
        key: Key = ("torque", j)
        if key in b.residual and b.mask[key].any():
            left, size = b.rms(key), _rms(np.concatenate([m.borne[:, j] for m in b.motions]))
            rest = thresholds.diagnosis.judged * prepared.fit.rms(key)
            if left > thresholds.priors.of_the_model * size and left > rest:
                apart.append(f"{name} by {left:.3g} N m")
    if not apart:
        return ["The given simulation obeys the given model: what differs is the machine."]
    return [
        "The given simulation is not of the given model: its torques differ from inverse dynamics"
        f" at {', '.join(apart)} (its own friction, gains, masses or another description)."
    ]


def source_in_words(prepared: Prepared) -> str:
    """Where the torque comes from."""
    words = {
        "tau": "as the drives report it",
        "current": "in proportion to the drives' currents",
        "duty": "by the drives' duties",
        "tau_cmd": "as commanded (none was reported)",
        "law": "by the controller's law (none was recorded)",
        "": "not known: positions are compared with their commands",
    }
    return words[prepared.fit.motions[0].source]


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
