"""Build a study folder from a spec: a machine, its days, its fault; the truth lies elsewhere."""

from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.frame.arm import urdf
from bench.sim2real.frame.motion import Motion
from bench.sim2real.frame.robots import robot
from bench.sim2real.frame.study_files import write_recording, write_study, write_truth
from bench.sim2real.machines import kinds, logger
from bench.sim2real.machines.chain import chain_of
from bench.sim2real.machines.draw import Machine, machine, path_torque
from bench.sim2real.machines.fault import Fault, Log, Scene
from bench.sim2real.machines.figures import INDEX, Array, Figures
from bench.sim2real.machines.motions import STYLES, motion
from bench.sim2real.machines.plan import WorldSpec
from bench.sim2real.machines.simulate import Day, Track, simulate
from bench.sim2real.machines.visibility import visibility

_TURNS = 6  # of the gains
_HUM = 0.01  # change of the torque from tick to tick, of the rated one
_SEEN = 2.5  # times what is left without it: what moves a channel less is tried again
_SEVERITIES = (1.0, 1.8, 3.2)
_MOVES = 0.03  # [rad/s]
_EVERY = 20  # ticks between the rows that a fault is sized on


@dataclass(frozen=True, kw_only=True, eq=False)
class Draft:
    """All that is decided before anything moves."""

    spec: WorldSpec
    machine: Machine
    motions: tuple[Motion, ...]
    roles: tuple[str, ...]
    days: tuple[dict[str, Any], ...]  # of each recording
    faults: tuple[Fault, ...]
    begins: tuple[tuple[int, float] | None, ...]  # of each fault: recording and time


def make_study(folder: Path, spec: WorldSpec, truth_folder: Path | None = None) -> dict[str, Any]:
    """Writes robot.urdf, study.yaml and recordings; the truth only where asked for."""
    draft, (logs, tracks), seen = _visible(spec)
    truth = {
        "schema": "pdoik.machines/1",
        "spec": asdict(spec),
        "joints": [f"joint{k + 1}" for k in range(draft.machine.arm.n)],
        "faults": [f.truth(b) for f, b in zip(draft.faults, draft.begins, strict=True)],
        "background": background(draft, tracks),
        "controller": draft.machine.control.kind,
        "gear": draft.machine.gear,
        "period": draft.machine.sensors.period,
        "visibility": seen,
    }
    folder.mkdir(parents=True, exist_ok=True)
    order = spec.stream("columns")
    names = logger.channels(draft.machine.sensors)
    if any(f.kind == "sensor_gain" for f in draft.faults) and "dq" not in names:
        names.append("dq")
    for k, log in enumerate(logs):
        write_recording(folder / f"rec{k + 1}.csv", log, names, None, order)
    write_study(folder, urdf(draft.machine.believed), _study(draft))
    if truth_folder is not None:
        write_truth(truth_folder, folder, truth)
    return truth


def _visible(spec: WorldSpec) -> tuple[Draft, tuple[list[Log], list[Track]], list[dict[str, Any]]]:
    """A draft whose faults are seen, severer where they were not; the last one if none is."""
    clean = None
    for attempt, severity in enumerate(_SEVERITIES):
        draft = draft_of(spec, attempt, severity)
        made = run(draft, draft.faults)
        if not draft.faults:
            return draft, made, []
        clean = clean or run(draft, ())[0]
        seen = visibility(draft.machine.believed, draft.faults, made[0], clean)
        if min(each["most"] for each in seen) >= _SEEN:
            break
    return draft, made, seen


def draft_of(spec: WorldSpec, attempt: int = 0, severity: float = 1.0) -> Draft:
    """Draws it all; another attempt has other faults of the same kinds on the same machine."""
    arm = robot(spec.robot, spec.stream("robot"))
    made = commissioned(machine(arm, spec.stream("machine")), spec)
    rng = spec.stream("motions")
    roles = ("fit", "fit", "validate") if rng.random() < 0.6 else ("fit", "fit", "fit", "validate")
    styles = ["excitation", *rng.choice(STYLES, len(roles) - 1, p=[0.35, 0.25, 0.25, 0.15])]
    styles = [str(style) for style in rng.permutation(styles)]
    haste = 1.0
    for _ in range(6):  # slower until the drives can bear it
        state = rng.bit_generator.state
        motions = [
            motion(arm, rng, style, float(np.round(rng.uniform(24.0, 40.0))), haste)
            for style in styles
        ]
        rows = _rows(motions)
        torque = path_torque(made, *rows)
        if np.all(np.abs(torque) < 1.4 * made.rated):
            break
        rng.bit_generator.state = state
        haste *= 0.8
    scene = Scene(
        machine=made,
        q=rows[0],
        dq=rows[1],
        ddq=rows[2],
        tau=torque,
        recordings=len(roles),
        duration=min(float(each.time[-1]) for each in motions),
        rng=spec.stream(f"faults {attempt}"),
        severity=severity,
    )
    faults = tuple(kinds.KINDS[kind](scene) for kind in spec.faults)
    begins = tuple(_begin(fault, scene) for fault in faults)
    return Draft(
        spec=spec,
        machine=made,
        motions=tuple(motions),
        roles=roles,
        days=tuple(_day(spec.stream(f"day {k}"), arm.n) for k in range(len(roles))),
        faults=faults,
        begins=begins,
    )


def commissioned(made: Machine, spec: WorldSpec) -> Machine:
    """Gains turned down until the machine no longer hums, as anybody would who stands by it."""
    rng = spec.stream("commissioning")
    moved = motion(made.arm, rng, "excitation", 6.0, 0.6)
    day = {"friction": np.ones(made.arm.n), "warmer": np.zeros(made.arm.n)}
    for _ in range(_TURNS):
        chain, believed = chain_of(made.arm), chain_of(made.believed)
        plain = _as_on(made, day, len(moved.q), rng)
        try:
            torque = simulate(chain, believed, made.control, plain, moved.q, moved.dq).torque
        except RuntimeError:
            torque = np.full((100, made.arm.n), 1e3) * (-1.0) ** np.arange(100)[:, None]
        hums = np.sqrt(np.mean(np.diff(torque, axis=0) ** 2, axis=0)) > _HUM * made.rated
        if not np.any(hums):
            break
        control = made.control
        slower = {"kp": 0.6 if control.kind != "cascade" else 0.75, "kd": 0.7, "ki": 0.5}
        gains = {
            name: getattr(control, name) * np.where(hums, factor, 1.0)
            for name, factor in slower.items()
        }
        made = replace(made, control=replace(control, **gains))
    return made


def _as_on(made: Machine, day: dict[str, Any], ticks: int, rng: np.random.Generator) -> Day:
    """A day without faults; encoders are on the motors, so finer than at the joints."""
    n = made.arm.n
    step = np.asarray(2.0 * np.pi / 2.0 ** (made.sensors.bits + 5.0))  # [rad]
    figures = _on(made.figures, day["friction"])
    return Day(
        figures=figures,
        later=figures,
        since=1e6,
        warmer=day["warmer"],
        heating=day.get("heating", np.zeros(n)),
        cooling=900.0,
        braked=np.zeros((ticks, n)),
        push=np.zeros((ticks, 3)),
        reading=rng.normal(0.0, 0.4, (ticks, n)) * step,
        step=step,
    )


def _begin(fault: Fault, scene: Scene) -> tuple[int, float] | None:
    """Some faults begin in the middle of a recording, and stay."""
    if not fault.may_begin or scene.rng.random() > 0.2:
        return None
    return int(scene.rng.integers(scene.recordings - 1)), scene.uniform(0.3, 0.7) * scene.duration


def _day(rng: np.random.Generator, n: int) -> dict[str, Any]:
    """What changes from day to day: friction, temperature, how long the drives have been on."""
    common = rng.normal(0.0, 0.06)
    return {
        "friction": np.exp(common + rng.normal(0.0, 0.08, n)),
        "warmer": rng.uniform(-8.0, 4.0) + rng.uniform(0.0, 12.0, n),
        "hours": float(rng.uniform(0.1, 3.0)),
        "heating": rng.uniform(1e-3, 5e-3, n),
    }


def run(draft: Draft, faults: tuple[Fault, ...]) -> tuple[list[Log], list[Track]]:
    """Logs and truths of all recordings with these faults; the same random numbers each time."""
    made = draft.machine
    arm = made.arm
    for fault in faults:
        arm = arm if fault.arm is None else fault.arm(arm)
    chain, believed = chain_of(arm), chain_of(made.believed)
    logs, tracks = [], []
    for k, moved in enumerate(draft.motions):
        day = _figures_of_day(draft, faults, k)
        track = simulate(chain, believed, made.control, day, moved.q, moved.dq)
        rng = draft.spec.stream(f"log {k}")
        log = logger.logged(track, moved.q, moved.dq, made.sensors, draft.days[k]["hours"], rng)
        for fault in faults:
            if fault.log is not None:
                fault.log(log, draft.spec.stream(f"fault's log {k}"))
        logs.append(log)
        tracks.append(track)
    return logs, tracks


def _figures_of_day(draft: Draft, faults: tuple[Fault, ...], k: int) -> Day:
    """A recording's day with these faults."""
    made, day = draft.machine, draft.days[k]
    plain = _as_on(made, day, len(draft.motions[k].q), draft.spec.stream(f"reading {k}"))
    (ticks, n), since = plain.braked.shape, plain.since
    before = after = made.figures
    braked, push = plain.braked, plain.push
    begins = dict(zip([f.kind for f in draft.faults], draft.begins, strict=True))
    for fault in faults:
        begin = begins[fault.kind]
        rng = draft.spec.stream(f"fault {fault.kind} {k}")
        if fault.braked is not None:
            braked = braked + fault.braked(ticks, n, rng)
        if fault.push is not None:
            push = push + fault.push(k, ticks, rng)
        if fault.figures is None or (begin is not None and k < begin[0]):
            continue
        after = fault.figures(after)
        if begin is None or k > begin[0]:
            before = fault.figures(before)
        else:
            since = begin[1]
    figures, later = (_on(each, day["friction"]) for each in (before, after))
    return replace(plain, figures=figures, later=later, since=since, braked=braked, push=push)


def _on(figures: Figures, factor: Array) -> Figures:
    """The figures on a day: its friction."""
    joints = figures.joints.copy()
    for name in ("coulomb", "stiction", "viscous"):
        joints[:, INDEX[name]] *= factor
    return Figures(joints, figures.whole)


def background(draft: Draft, tracks: list[Track]) -> list[dict[str, Any]]:
    """What every joint has, faults with it, and what the believed model has wrong.

    `level` and `slope` are the line through the friction at speeds above 0.03 rad/s, the mean of
    the days, as the log's torque has it; `spread` is the level's from day to day.
    """
    made = draft.machine
    result = []
    for j in range(made.arm.n):
        own = {
            name: float(value) for name, value in zip(INDEX, made.figures.joints[j], strict=True)
        }
        lines = np.array([_line(track, j) for track in tracks])
        factor = (1.0 + made.sensors.current_gain[j]) / own["gain"]
        own["level"], own["slope"] = (float(factor * each) for each in np.nanmean(lines, axis=0))
        own["spread"] = float(factor * np.nanstd(lines[:, 0], ddof=1))
        fast = np.concatenate([np.abs(track.speed[:, j]) for track in tracks])
        own["speed"] = float(np.median(fast[fast > _MOVES])) if np.any(fast > _MOVES) else 0.0
        own["torque_gain"] = float((1.0 + made.sensors.current_gain[j]) / own["gain"])
        own["torque_offset"] = float(made.sensors.current_offset[j])
        own["rated"] = float(made.rated[j])
        rotor = made.given_rotor
        own["rotor_given"] = 0.0 if rotor is None else float(rotor[j])
        real, said = made.arm.links[j], made.believed.links[j]
        own["mass"], own["mass_told"] = float(real.mass), float(said.mass)
        result.append(own)
    return result


def _line(track: Track, j: int) -> tuple[float, float]:
    """Level and slope of a joint's friction over its speed; NaN where it hardly moves."""
    v = track.speed[::10, j]
    moving = np.abs(v) > _MOVES
    if np.count_nonzero(moving) < 100:
        return np.nan, np.nan
    A = np.column_stack([np.sign(v), v])[moving]
    level, slope = np.linalg.lstsq(A, track.friction[::10, j][moving], rcond=None)[0]
    return float(level), float(slope)


def _rows(motions: list[Motion]) -> tuple[Array, Array, Array]:
    parts = [(m.q[::_EVERY], m.dq[::_EVERY], m.ddq[::_EVERY]) for m in motions]
    q, dq, ddq = (np.concatenate(each) for each in zip(*parts, strict=True))
    return q, dq, np.clip(ddq, -20.0, 20.0)


def _study(draft: Draft) -> dict[str, Any]:
    study: dict[str, Any] = {
        "robot": "robot.urdf",
        "joints": [f"joint{k + 1}" for k in range(draft.machine.arm.n)],
        "recordings": [
            {"file": f"rec{k + 1}.csv", "role": role} for k, role in enumerate(draft.roles)
        ],
    }
    if draft.machine.given_rotor is not None:
        study["rotor_inertia"] = draft.machine.given_rotor.tolist()
    return study
