"""A voltage-driven machine's drives and friction, fitted to positions by simulating its commands.

A regression takes the recorded motion for granted and passes over joints at rest; positions are
where dry friction let a servo stop. Here the machine is simulated from its commands, and the
drives' figures and every friction that a gear may have move until simulated positions are the
recorded ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize

from pdoik.errors import PdoikError
from pdoik.recordings import FloatArray, Recording

from ..effects import CATALOGUE
from ..findings import Estimate, Finding
from ..infer import Examination
from ..model import Model
from ..simulation import Simulator
from ..study import Controller, VoltageDrive
from .gather import model_of

_STEP = 2e-3  # of the simulation [s]
_EVALUATIONS = 14  # of the residual, each with its slopes
_OUTLIER = 0.02  # beyond which a position's error counts linearly [rad]
_EVERY = 4  # samples of a recording to one that counts
_SPREAD = 0.1  # by which positive figures move to find slopes: none may turn negative
_ALIKE = 0.5  # time within which errors of positions are alike [s]
_FAR = 10.0  # error of a simulation that ran away [rad]

FRICTION: dict[str, dict[str, float]] = {
    "coulomb_friction": {"level": 0.02},
    "viscous_friction": {"coefficient": 0.01},
    "load_dependent_friction": {"coefficient": 0.1},
    "stribeck_friction": {"extra": 0.02, "speed": 0.3},
    "torque_offset": {"offset": 0.0},
}
"""Effects of a geared servo with figures to begin at: torques are shares of the largest load's."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Figure:
    """One that is sought: of the drive, or of an effect."""

    joint: int
    effect: str  # "" of the drive
    name: str
    start: float
    scale: float
    signed: bool = False
    std: float = np.inf  # of the start, where something else than positions gives it

    def value(self, x: float) -> float:
        """The figure at a coordinate that is moved: positive figures stay so."""
        return x * self.scale if self.signed else abs(x) * self.scale

    @property
    def coordinate(self) -> float:
        """Where it begins."""
        return self.start / self.scale


def servo_model(examination: Examination, recordings: Sequence[Recording] | None = None) -> Model:
    """The model of a diagnosis with drives and friction fitted to positions.

    Args:
        examination: of a study whose drives' duties were logged.
        recordings: to learn from; the study's own that are to be fitted, if none are given.

    Raises:
        ValueError: the study has no robot, or no voltage drive was given or estimated.
    """
    model, study = model_of(examination), examination.prepared.study
    controller = study.controller
    if controller is None or controller.drive is None or study.robot is None:
        raise ValueError(
            "servo_model: expected a study with a robot whose joints' duties, commands and"
            " positions were logged"
        )
    own = tuple(f for f in model.findings if f.effect not in FRICTION)
    figures = _figures(model, controller, controller.drive, examination)
    learnt = study.fit if recordings is None else recordings
    base = _Servo(model=replace(model, findings=own), figures=figures, recordings=learnt)
    start = np.array([each.coordinate for each in figures])
    found = optimize.least_squares(
        base.left,
        start,
        loss="soft_l1",
        f_scale=_OUTLIER,
        x_scale=np.where([f.signed for f in figures], 1.0, np.maximum(np.abs(start), _SPREAD)),
        diff_step=np.full(len(start), 1e-3),
        max_nfev=_EVALUATIONS,
    )
    return base.at(np.asarray(found.x))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Servo:
    """What is simulated, as a function of the figures sought."""

    model: Model
    figures: Sequence[_Figure]
    recordings: Sequence[Recording]

    def at(self, x: FloatArray) -> Model:
        """The model with figures at these coordinates."""
        model, controller = self.model, self.model.controller
        assert controller is not None
        assert controller.drive is not None
        values = [f.value(float(each)) for f, each in zip(self.figures, x, strict=True)]
        drive = {
            name: np.array(getattr(controller.drive, name))
            for name in ("torque_per_volt", "back_emf", "supply_loss")
        }
        n = len(model.joints)
        rotor = np.zeros(n) if model.rotor_inertia is None else np.array(model.rotor_inertia)
        friction: dict[tuple[int, str], dict[str, float]] = {}
        for figure, value in zip(self.figures, values, strict=True):
            if figure.effect:
                friction.setdefault((figure.joint, figure.effect), {})[figure.name] = value
            elif figure.name == "rotor_inertia":
                rotor[figure.joint] = value
            else:
                drive[figure.name][figure.joint] = value
        return replace(
            model,
            controller=with_drive(controller, replace(controller.drive, **drive)),
            rotor_inertia=rotor,
            findings=(*model.findings, *_findings(model.joints, friction)),
        )

    def left(self, x: FloatArray) -> FloatArray:
        """Simulated less recorded positions on the samples that count [rad]."""
        parts = []
        try:
            simulator = self.at(x).simulator(timestep=_STEP)
        except (PdoikError, ValueError):
            simulator = None
        for r in self.recordings:
            there = self._replayed(simulator, r)
            parts.append((there - r.q)[::_EVERY][r.valid[::_EVERY]].ravel())
        alike = max(1.0, _ALIKE / (_EVERY * self.recordings[0].period))  # samples that count as one
        known = [
            (f.value(float(each)) - f.start) / f.std * _OUTLIER * np.sqrt(alike)
            for f, each in zip(self.figures, x, strict=True)
        ]
        every = np.concatenate([*parts, np.array(known)])
        return np.asarray(np.clip(every, -_FAR, _FAR), dtype=np.float64)

    @staticmethod
    def _replayed(simulator: Simulator | None, r: Recording) -> FloatArray:
        if simulator is not None:
            try:
                return simulator.replay(r, drive="controller").q
            except PdoikError:
                pass
        return r.q + _FAR


def with_drive(controller: Controller, drive: VoltageDrive) -> Controller:
    """The same law with another drive; gains of small duties follow."""
    assert controller.kp_duty is not None
    assert controller.kd_duty is not None
    volts = drive.torque_per_volt * drive.volts
    return replace(
        controller,
        drive=drive,
        kp=volts * controller.kp_duty,
        kd=volts * controller.kd_duty + drive.back_emf,
    )


def _figures(
    model: Model, controller: Controller, drive: VoltageDrive, examination: Examination
) -> tuple[_Figure, ...]:
    """Those of each joint's drive, then of its friction."""
    found: dict[tuple[str, str], Mapping[str, float]] = {
        (joint, f.effect): f.values for f in model.findings for joint in f.joints
    }
    result = []
    given = examination.prepared.study.told
    motions = examination.prepared.fit.motions
    for j, joint in enumerate(model.joints):
        load = max(float(np.max(np.abs(m.tau[:, j]))) for m in motions)
        inertia = max(float(np.max(m.mass_matrix[:, j, j])) for m in motions)
        if given is None or given.torque_per_volt is None:
            k = float(drive.torque_per_volt[j])
            result.append(_Figure(joint=j, effect="", name="torque_per_volt", start=k, scale=k))
        b = float(max(drive.back_emf[j], 1e-6))
        result.append(_Figure(joint=j, effect="", name="back_emf", start=b, scale=b))
        # Positions hardly show the loss while duties are small; readings of the supply do.
        loss = float(max(drive.supply_loss[j], 0.05))
        read = examination.diagnosis.controllers[j].drive.get("supply_loss")
        std = read.std if read is not None and read.std > 0.0 else np.inf
        result.append(
            _Figure(joint=j, effect="", name="supply_loss", start=loss, scale=loss, std=std)
        )
        rotor = 0.0 if model.rotor_inertia is None else float(model.rotor_inertia[j])
        rotor = max(rotor, 0.05 * inertia)
        result.append(_Figure(joint=j, effect="", name="rotor_inertia", start=rotor, scale=rotor))
        for effect, start in FRICTION.items():
            for name, share in start.items():
                torque = effect != "load_dependent_friction" and name != "speed"
                value = share * load if torque else share
                value = float(found.get((joint, effect), {}).get(name, value))
                size = max(abs(value), 0.02 * load if torque else 0.1)
                result.append(
                    _Figure(
                        joint=j,
                        effect=effect,
                        name=name,
                        start=value,
                        scale=size,
                        signed=effect == "torque_offset",
                    )
                )
    return tuple(result)


def _findings(
    joints: tuple[str, ...], friction: Mapping[tuple[int, str], Mapping[str, float]]
) -> tuple[Finding, ...]:
    """Effects as findings that a model carries."""
    result = []
    for (j, effect), values in friction.items():
        unit_of = CATALOGUE[effect].unit_of
        figures = {name: Estimate.normal(v, 0.0, unit_of(name)) for name, v in values.items()}
        result.append(
            Finding(
                effect=effect,
                joints=(joints[j],),
                parameters=figures,
                statement=CATALOGUE[effect].statement(joints[j], values),
            )
        )
    return tuple(result)
