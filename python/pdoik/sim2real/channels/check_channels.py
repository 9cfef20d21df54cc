"""Channels first: a sign, a factor, a model logged as a measurement, a noisy sensor."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..effects.drives import kinds, speed_torque_limit_of, top_of
from ..effects.sensors import SensorGain
from ..findings import Estimate, Evidence, Finding
from ..motion import Balances, Motion, Prepared, RigidBody, derivative, zero_phase
from ..study import Study
from .factors_by_model import factors_by_model
from .noisy_channels import noisy_channels

_SETTLING = 0.5  # numerics: in which filters settle [s]
_FEWEST = 30  # numerics: rows of a fit


@dataclass(frozen=True, kw_only=True, eq=False)
class ChannelCheck:
    """What was found in the channels, and the study with what can be mended mended."""

    study: Study
    findings: tuple[Finding, ...]
    notes: tuple[str, ...]

    @property
    def mended(self) -> bool:
        """Whether the study is another than before."""
        return bool(self.notes)


def check_channels(prepared: Prepared) -> ChannelCheck:
    """Test every channel against what the others say."""
    study = prepared.study
    findings: list[Finding] = []
    notes: list[str] = []
    body = prepared.body
    if body is not None and prepared.fit.motions[0].source == "current":
        study, notes = _torque_of_current(prepared)
    elif body is not None and study.fit[0].tau is not None:
        if _copies_model(prepared.fit, body):
            notes.append(
                "tau is no measurement: it is the model's own torque for the commanded motion, and"
                " was left out."
            )
            study = _without_tau(study)
        else:
            factors = _factors(prepared.fit)
            for j, (factor, error) in factors.items():
                findings.append(_lie(prepared, j, factor, error))
                notes.append(
                    f"tau.{study.joints[j]} was divided by {factor:.4g} before all else was judged."
                )
            study = _scaled(study, {j: factor for j, (factor, _) in factors.items()})
    findings += noisy_channels(prepared, study)
    return ChannelCheck(study=study, findings=tuple(findings), notes=tuple(notes))


def _torque_of_current(prepared: Prepared) -> tuple[Study, list[str]]:
    """Currents turned into torques by the constants that fit the model best, with friction."""
    study, b = prepared.study, prepared.fit
    constants = np.full(b.n, np.nan)
    for j in range(b.n):
        if ("torque", j) not in b.residual or not b.excited[j]:
            continue
        current, A = _rows(b, j, [_own(m, j) for m in b.motions])
        if len(current) >= _FEWEST and np.any(A[:, 0]):
            slope = float(np.linalg.lstsq(A, current, rcond=None)[0][0])
            constants[j] = 1.0 / slope if slope else np.nan

    def turned(recording: Recording) -> Recording:
        assert recording.current is not None
        return replace(recording, tau=recording.current * constants)

    known = [
        f"{name} {constant:.4g}"
        for name, constant in zip(study.joints, constants, strict=True)
        if np.isfinite(constant)
    ]
    note = (
        "Torques are currents times constants that were fitted to the model [N m/A]: "
        f"{', '.join(known)}. Masses and torque gains can then not be distinguished."
    )
    changed = replace(study, recordings=tuple(turned(r) for r in study.recordings))
    return changed, [note]


def _factors(b: Balances) -> dict[int, tuple[float, float]]:
    """Joints whose torque is a wrong multiple of what it should be, with factor and error.

    Of the command where it was recorded. Of the controller's law only where the model agrees, since
    the law is worked out with positions and speeds that may lie themselves. Else of the model's,
    with all that an ordinary machine has as nuisance terms.
    """
    result, limits = {}, b.thresholds.channels
    by_model = factors_by_model(b)
    for j in range(b.n):
        if ("torque", j) not in b.residual or not b.excited[j]:
            continue
        if all(m.has_command(j) for m in b.motions):
            found = _factor(b, j, [_commanded(m, j) for m in b.motions])
        elif all(m.has_law(j) for m in b.motions):
            found = _factor(b, j, [_commanded(m, j) for m in b.motions])
            modelled = _factor(b, j, [_with_rotor(m, j) for m in b.motions])
            if found is not None and (modelled is None or not _agree(b, modelled[0] / found[0])):
                found = None
        else:
            found = by_model.get(j)
        if found is not None and (found[0] < limits.tiny or not _limited(b, j)):
            result[j] = found
    return result


def _agree(b: Balances, ratio: float) -> bool:
    """Whether two factors with this ratio say the same."""
    within = b.thresholds.channels.law_agrees
    return 1.0 / within < ratio < within


def _limited(b: Balances, j: int) -> bool:
    """Whether joint j's torque is cut off, which makes it less than it should be."""
    return any(
        top_of(b.motions, j, kind) or speed_torque_limit_of(b.motions, j, kind)
        for kind in kinds(b.motions[0], j)
    )


def _factor(b: Balances, j: int, columns: list[FloatArray]) -> tuple[float, float] | None:
    """Joint j's torque over the first column, the others fitted too; None where it is near one."""
    limits, (torque, A) = b.thresholds.channels, _rows(b, j, columns)
    if len(torque) < _FEWEST or not np.any(A[:, 0]):
        return None
    scale = np.sqrt(np.mean(A**2, axis=0)) + 1e-12
    inverse = np.linalg.inv((A / scale).T @ (A / scale) + 1e-6 * len(A) * np.eye(len(scale)))
    beta = inverse @ ((A / scale).T @ torque) / scale
    left = torque - A @ beta
    error = 3.0 * float(np.std(left) * np.sqrt(inverse[0, 0]) / scale[0])
    part = A[:, 0] * beta[0]
    explained = float(np.std(part) / max(np.std(part + left), 1e-12))
    outside = not limits.least_factor < beta[0] < limits.most_factor
    # A torque far below what it should be drowns in its noise: its smallness is what is sure.
    tiny = abs(beta[0]) < limits.tiny and error < limits.tiny_error * limits.tiny
    clear = abs(beta[0] - 1.0) > limits.factor_t * error
    sure = outside and clear and (explained > limits.least_correlation or tiny)
    return (float(beta[0]), error) if sure else None


def _rows(b: Balances, j: int, columns: list[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Joint j's torque and columns of each motion, filtered, on the rows that count."""
    keep = b.mask["torque", j]
    torque = np.concatenate([b.thin(i, _torque(m, j)) for i, m in enumerate(b.motions)])[keep]
    return torque, np.concatenate([b.thin(i, column) for i, column in enumerate(columns)])[keep]


def _commanded(m: Motion, j: int) -> FloatArray:
    """The command or the law, and a constant; (T, 2)."""
    asked = m.command[:, j] if m.has_command(j) and m.command is not None else m.law_of(j)
    return np.stack([asked, np.ones(len(m.time))], axis=1)


def _own(m: Motion, j: int) -> FloatArray:
    """The model's torque, friction's columns, a constant; (T, 4)."""
    return np.stack([m.borne[:, j], m.sign(j), m.dq[:, j], np.ones(len(m.time))], axis=1)


def _with_rotor(m: Motion, j: int) -> FloatArray:
    """`_own` and the column of a rotor that is not given; (T, 5)."""
    return np.hstack([_own(m, j), m.ddq[:, j, None]])


def _copies_model(b: Balances, body: RigidBody) -> bool:
    """Whether most joints' torques are the model's for the commands, not for the motion."""
    copies, judged, limits = 0, 0, b.thresholds.channels
    for m in b.motions:
        if m.q_des is None or m.torque is None:
            return False
        planned = _planned(m, body)
        good = m.valid & (np.arange(len(m.time)) * m.period > _SETTLING)
        good &= good[::-1]
        for j in range(m.n):
            if not b.excited[j] or ("torque", j) not in b.floor:
                continue
            torque = zero_phase(m.torque[:, j], m.cutoff, m.period)[good]
            by_plan = np.std(torque - zero_phase(planned[:, j], m.cutoff, m.period)[good])
            by_motion = np.std(torque - zero_phase(m.borne[:, j], m.cutoff, m.period)[good])
            judged += 1
            floor = b.floor["torque", j]
            near = by_plan < limits.copy_floor * floor
            copies += bool(by_plan < limits.copy_nearer * by_motion and near)
    return judged > 0 and copies > limits.copied_joints * judged


def _planned(m: Motion, body: RigidBody) -> FloatArray:
    assert m.q_des is not None
    q = zero_phase(m.q_des, 2.5 * m.cutoff, m.period)
    dq = derivative(q, m.period)
    return body.dynamics(q, dq, derivative(dq, m.period)).tau


def _without_tau(study: Study) -> Study:
    return replace(study, recordings=tuple(replace(r, tau=None) for r in study.recordings))


def _scaled(study: Study, factors: dict[int, float]) -> Study:
    if not factors:
        return study

    def mended(recording: Recording) -> Recording:
        assert recording.tau is not None
        tau = recording.tau.copy()
        for j, factor in factors.items():
            tau[:, j] /= factor
        return replace(recording, tau=tau)

    return replace(study, recordings=tuple(mended(r) for r in study.recordings))


def _lie(prepared: Prepared, j: int, factor: float, error: float) -> Finding:
    name = prepared.study.joints[j]
    what = "has the wrong sign" if factor < 0 else "is not at the joint, or in another unit"
    share = _mended(prepared.validate or prepared.fit, j, factor)
    return Finding(
        effect=SensorGain.id,
        joints=(name,),
        recordings=tuple(r.name for r in prepared.study.fit),
        regime=f"in proportion to the torque of {name}",
        statement=f"The torque of Joint {name} reads {factor:.4g} times the model's: it {what}.",
        parameters={"gain": Estimate.normal(factor, error, "-")},
        weight=_mended(prepared.fit, j, factor),
        decided_by="the channel beside a second instrument, or the drive's manual",
        evidence=Evidence(
            validation_gain=share,
            interval95=(share, share),
            channels=("tau",),
        ),
    )


def _mended(b: Balances, j: int, factor: float) -> float:
    """Share of joint j's mean square residual that goes with a torque's factor; 0 at least."""
    rows = b.mask["torque", j]
    before = b.residual["torque", j][rows]
    measured = np.concatenate([b.thin(i, _torque(m, j)) for i, m in enumerate(b.motions)])[rows]
    after = before - measured * (1.0 - 1.0 / factor)
    return max(1.0 - float(np.mean(after**2)) / max(float(np.mean(before**2)), 1e-12), 0.0)


def _torque(m: Motion, j: int) -> FloatArray:
    assert m.torque is not None
    return np.ascontiguousarray(m.torque[:, j])
