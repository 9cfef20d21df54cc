"""A servo with a closed firmware: what is said of a wrong study, and how well motions are foreseen.

    python -m bench.sim2real.servo [--markdown FILE]

Recordings: `recordings/bam_xl330` of the shared material (PDOIK_SHARED, or ../shared), a servo that
swings a point load, at two gains of its firmware, of which gains, load and length are known.
The source's kind of model is refitted here: torque of a voltage, back-EMF, Coulomb, viscous,
Stribeck and load-dependent friction, by simulation, for each motor.
"""

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from bench.common.commands import write_report
from bench.sim2real.servo.study import FOLDER, GAINS, LENGTH, LIMIT, MASS, MOTIONS, UNIT, study
from pdoik.sim2real import Examination, Model, Recording, examine, servo_model
from pdoik.sim2real.evidence import with_drive

FloatArray = NDArray[np.float64]

WRONG = (0.4, 0.6, 0.8, 1.2, 1.4, 1.6)


def given_drive(reference: Examination, gain: float) -> dict[str, Any]:
    """Keys of a study that tells the drive's figures as another study found them."""
    drive = {name: [each.value] for name, each in reference.diagnosis.controllers[0].drive.items()}
    rotor = drive.pop("rotor_inertia")
    controller = {"type": "voltage", "kp": [gain], "unit": [UNIT], **drive}
    return {"controller": controller, "rotor_inertia": rotor}


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceModel:
    """The source's kind of model: a motor's voltage, and friction fitted for it.

    tau = k V duty - b dq - sign(dq) (c + s exp(-(dq / v)^2) + l |tau_motor + tau_load|) - d dq
    """

    k: float = 0.1
    b: float = 0.03
    inertia: float = 1.5e-3
    coulomb: float = 0.01
    viscous: float = 2e-3
    load: float = 0.1
    stribeck: float = 0.01
    speed: float = 0.3

    @property
    def array(self) -> FloatArray:
        """All figures, (8,)."""
        return np.array([getattr(self, name) for name in self.__slots__])


VOLTS = 7.4  # nominal
STEP = 1e-3  # [s]


def simulated(
    recordings: Sequence[Recording], gains: Sequence[float], figures: FloatArray
) -> list[FloatArray]:
    """Positions of each recording for the source's model with K sets of figures, (T, K)."""
    last = max(float(r.time[-1]) for r in recordings)
    time = np.arange(0.0, last + STEP, STEP)
    q_des = np.stack([np.interp(time, r.time, r.q_des[:, 0]) for r in recordings])  # type: ignore[index]
    off = np.stack([_let_go(r, time) for r in recordings])
    kp = np.array(gains)[:, None]
    k, b, rotor, coulomb, viscous, load, stribeck, speed = (row[None] for row in figures.T)
    inertia, moment = MASS * LENGTH**2 + rotor, MASS * 9.81 * LENGTH
    q = np.repeat(np.array([r.q[0, 0] for r in recordings])[:, None], len(figures), axis=1)
    v = np.zeros_like(q)
    path = np.empty((len(time), *q.shape))
    for i in range(len(time)):
        path[i] = q
        duty = np.clip(kp * (q_des[:, i, None] - q), -LIMIT, LIMIT)
        motor = np.where(off[:, i, None], 0.0, k * VOLTS * duty - b * v)
        borne = moment * np.sin(q)
        most = coulomb + stribeck * np.exp(-((v / speed) ** 2)) + load * np.abs(motor + borne)
        free = (v + STEP * (motor - borne) / inertia) / (1.0 + STEP * viscous / inertia)
        v = np.sign(free) * np.maximum(np.abs(free) - STEP * most / inertia, 0.0)
        q = q + STEP * v
    return [
        np.stack([np.interp(r.time, time, column) for column in path[:, i].T], axis=1)
        for i, r in enumerate(recordings)
    ]


def _let_go(r: Recording, time: FloatArray) -> NDArray[np.bool_]:
    if r.released is None:
        return np.zeros(len(time), dtype=np.bool_)
    place = np.minimum((time / r.period + 0.5).astype(int), len(r.time) - 1)
    return np.asarray(r.released[place, 0])


def source_model(recordings: Sequence[Recording], gain: float) -> FloatArray:
    """Figures of the source's kind of model, fitted to positions by simulation, (8,)."""
    size = SourceModel().array

    def at(x: FloatArray) -> FloatArray:
        return np.abs(x) * size

    def errors(rows: FloatArray) -> FloatArray:
        paths = simulated(recordings, [gain] * len(recordings), rows)
        left = [(p - r.q)[::4] for p, r in zip(paths, recordings, strict=True)]
        return np.concatenate(left)

    def left(x: FloatArray) -> FloatArray:
        return errors(at(x)[None])[:, 0]

    def slopes(x: FloatArray) -> FloatArray:
        step = 1e-3
        rows = np.stack([x, *(x + step * row for row in np.eye(len(x)))])
        there = errors(at(rows))
        return np.asarray((there[:, 1:] - there[:, :1]) / step)

    found = optimize.least_squares(
        left, np.ones(len(size)), jac=slopes, loss="soft_l1", f_scale=0.02, max_nfev=25
    )
    return at(found.x)


def position_error(paths: Sequence[FloatArray], recordings: Sequence[Recording]) -> list[float]:
    """Root mean square of each recording, and of all [rad]."""
    squares = [float(np.mean((p - r.q) ** 2)) for p, r in zip(paths, recordings, strict=True)]
    return [*np.sqrt(squares), float(np.sqrt(np.mean(squares)))]


def foreseen(model: Model, recordings: Sequence[Recording], ratio: float) -> list[FloatArray]:
    """Positions of a model whose gain is given as `ratio` times the one it was learnt at."""
    controller = model.controller
    assert controller is not None
    assert controller.drive is not None
    assert controller.kp_duty is not None
    assert controller.kd_duty is not None
    other = replace(
        controller, kp_duty=ratio * controller.kp_duty, kd_duty=ratio * controller.kd_duty
    )
    limited = replace(controller.drive, duty_limit=np.array([LIMIT]))
    simulator = replace(model, controller=with_drive(other, limited)).simulator()
    return [simulator.replay(r, drive="controller").q for r in recordings]


def predictions(references: dict[int, Examination]) -> list[str]:
    """Rows: motions at the gain not learnt."""
    rows = [
        "| learnt at, foreseen at | model | " + " | ".join(MOTIONS) + " | all |",
        "| --- | --- |" + " --- |" * (len(MOTIONS) + 1),
    ]
    for gain in GAINS:
        (other,) = (each for each in GAINS if each != gain)
        learnt = references[gain].prepared.study.recordings
        unseen = references[other].prepared.study.recordings
        ours = foreseen(servo_model(references[gain], learnt), unseen, other / gain)
        plain = source_model(learnt, gain * UNIT)
        theirs = [p[:, :1] for p in simulated(unseen, [other * UNIT] * len(unseen), plain[None])]
        for name, paths in (("pdoik", ours), ("friction per motor (source's kind)", theirs)):
            errors = position_error(paths, unseen)
            shown = " | ".join(f"{each:.3f}" for each in errors)
            rows.append(f"| {gain}, {other} | {name} | {shown} |")
    return rows


def gains_given_wrong(folder: Path) -> list[str]:
    rows = ["| gain | told | said first | gain said | error |", "| --- | --- | --- | --- | --- |"]
    for gain, given in ((100, 160), (100, 60), (400, 560), (400, 240), (100, 100), (400, 400)):
        controller = {"type": "voltage", "kp": [given], "unit": [UNIT]}
        found = examine(study(folder, gain, controller=controller)).diagnosis.controllers[0]
        said = "the gain told is wrong" if "kp" in found.given_wrong else "nothing of the gain"
        value = found.gains["kp"].value / UNIT
        rows.append(
            f"| {gain} | {given} | {said} | {value:.1f} | {100 * (value / gain - 1):+.1f} % |"
        )
    return rows


def loads_given_wrong(folder: Path, references: dict[int, Examination]) -> list[str]:
    """Rows: a mass or length given wrong, with nothing known of the drive and with its figures."""
    rows = [
        "| gain | told wrong | nothing known of the drive: swings like [m] | load is said to be"
        " | drive known from the other gain: length [m] | error | mass [kg] | error |",
        "| --- |" + " --- |" * 7,
    ]
    for gain in GAINS:
        (other,) = (each for each in GAINS if each != gain)
        cases = [("nothing", 1.0, 1.0)]
        cases += [(f"mass {100 * (w - 1):+.0f} %", w, 1.0) for w in WRONG]
        cases += [(f"length {100 * (w - 1):+.0f} %", 1.0, w) for w in WRONG]
        for name, by_mass, by_length in cases:
            mass, length = by_mass * MASS, by_length * LENGTH
            blind = examine(study(folder, gain, mass, length)).diagnosis
            swings = blind.controllers[0].load["reduced_length"].value
            loads = ("link_inertial_error", "payload")
            claimed = next((f.effect for f in blind.findings if f.effect in loads), "")
            too_long = any("it is too long" in note for note in blind.notes)
            said = "too long" if too_long else claimed.replace("_", " ") or "not told apart"
            keys = given_drive(references[other], gain)
            load = examine(study(folder, gain, mass, length, **keys)).diagnosis.controllers[0].load
            long = length * load["length_factor"].value
            heavy = mass * load["mass_factor"].value
            rows.append(
                f"| {gain} | {name} | {swings:.4f} | {said} | {long:.4f} |"
                f" {100 * (long / LENGTH - 1):+.1f} % | {heavy:.3f} |"
                f" {100 * (heavy / MASS - 1):+.1f} % |"
            )
    return rows


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--markdown", type=Path, help="write the tables there too")
    parser.add_argument("--only", choices=("gains", "loads", "motions"), help="one table")
    options = parser.parse_args()
    if not FOLDER.is_dir():
        raise SystemExit(f"no {FOLDER}: recordings/bam_xl330 of the shared material is needed")
    parts: list[str] = []
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home)
        references = {gain: examine(study(folder / f"true{gain}", gain)) for gain in GAINS}
        if options.only in (None, "gains"):
            parts += [*gains_given_wrong(folder / "gains"), ""]
        if options.only in (None, "loads"):
            parts += [*loads_given_wrong(folder / "loads", references), ""]
        if options.only in (None, "motions"):
            parts += [*predictions(references), ""]
    print("\n".join(parts))
    if options.markdown is not None:
        write_report(options.markdown, "\n".join(parts) + "\n")


if __name__ == "__main__":
    main()
