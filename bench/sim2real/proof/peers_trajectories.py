"""MuJoCo's system identification toolbox as its manual has it: fitted to simulated trajectories."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout

from bench.sim2real.frame.tracks import Array, Believed
from bench.sim2real.proof.peers_sysid import (
    LATEST,
    WORTH,
    carried,
    optimized,
    parameters,
    sensed,
    set_body,
    set_gains,
    specification,
)
from pdoik.sim2real import Recording, Study

TIMESTEP = 2e-3  # of all simulations [s]
CHUNK = 4.0  # begun at the recorded state and simulated at a stretch [s]
APART = 2  # only every second chunk is simulated: a Panda takes minutes as it is


@dataclass(frozen=True, slots=True, kw_only=True)
class Chunk:
    """A stretch of a recording with commands as MuJoCo's actuators take them."""

    time: Array  # (T,) [s]
    command: Array  # (T, n) position plus kd/kp times speed plus gravity over kp [rad]
    q: Array  # (T, n) measured
    tau: Array | None  # (T, n) measured
    dq0: Array  # (n,) at the first sample

    def part(self, first: int, last: int) -> Chunk:
        """Rows from first to last, begun with the speed that the positions have there."""
        rows = slice(first, last)
        period = self.time[1] - self.time[0]
        around = slice(max(0, first - 3), first + 4)
        speed = np.polyfit(period * np.arange(len(self.q[around])), self.q[around], 1)[0]
        tau = None if self.tau is None else self.tau[rows]
        return Chunk(
            time=self.time[rows], command=self.command[rows], q=self.q[rows], tau=tau, dq0=speed
        )


def chunk_of(study: Study, recording: Recording, urdf: Path) -> Chunk:
    """A whole recording; gravity that the controller compensates is that of the given URDF."""
    control = study.controller
    if control is None or recording.q_des is None:
        raise ValueError(f"{recording.name}: no controller or no commands")
    dq_des = np.zeros_like(recording.q) if recording.dq_des is None else recording.dq_des
    command = recording.q_des + control.kd / control.kp * dq_des
    if control.gravity_compensation:
        rest = np.zeros_like(recording.q)
        believed = Believed(urdf, study.joints, study.rotor_inertia)
        command = command + believed.torque(recording.q, rest, rest) / control.kp
    whole = Chunk(
        time=recording.time,
        command=command,
        q=recording.q,
        tau=recording.tau,
        dq0=np.zeros(recording.q.shape[1]),
    )
    return whole.part(0, len(recording.time))


class Identified:
    """What the toolbox found, ready to be simulated."""

    def __init__(self, study: Study, params: Any, toolbox: Any) -> None:
        self.study, self.params, self.toolbox = study, params, toolbox
        self.delays = delays_of(params, list(study.joints))

    def replay(self, recording: Recording, urdf: Path) -> Array:
        """Positions (T, n) for a recording's commands; a load in another URDF is added."""
        spec = self.toolbox.apply_param_modifiers_spec(self.params, controlled(self.study))
        model = loaded_model(spec, self.study, urdf)
        chunk = chunk_of(self.study, recording, urdf)
        q, _ = simulated(model, self.study, [chunk], self.delays)[0]
        return q


def trajectory_sysid(study: Study) -> Identified:
    """Everything that torques alone were fitted with, and drives' gains, offsets and delays.

    Positions and torques of closed-loop simulations are compared with the recorded ones, in
    chunks of `CHUNK` seconds of the recordings to fit.
    """
    from mujoco import sysid as toolbox

    logging.getLogger("absl").setLevel(logging.ERROR)
    names = list(study.joints)
    chunks = [
        whole.part(first, min(first + count, len(whole.time)))
        for whole in (chunk_of(study, recording, study.robot) for recording in study.fit)
        for count in [round(CHUNK / (whole.time[1] - whole.time[0]))]
        for first in range(0, len(whole.time) - count // 2, APART * count)
    ]
    chunks = [chunk for chunk in chunks if len(chunk.time) == len(chunks[0].time)]
    spec = controlled(study)
    model = spec.compile()
    params = parameters(toolbox, spec, model, names)
    add_drives(toolbox, params, study, names)
    given = simulated(model, study, chunks, np.zeros(len(names)))
    spread = [
        np.std(np.concatenate([of(c, g) for c, g in zip(chunks, given, strict=True)]), axis=0)
        for of in (lambda c, g: g[0] - c.q, lambda c, g: g[1] - c.tau)
    ]
    scale = np.maximum(np.concatenate(spread), 1e-9)

    def residual(x: Array, params: Any, **_: Any) -> Any:
        columns = []
        for vector in x.reshape(len(x), -1).T:
            params.update_from_vector(vector)
            now = toolbox.apply_param_modifiers(params, spec)
            runs = simulated(now, study, chunks, delays_of(params, names))
            mapping = toolbox.TimeSeries.compute_all_sensor_mapping(now)
            left = []
            for chunk, (q, tau) in zip(chunks, runs, strict=True):
                said = toolbox.TimeSeries(chunk.time, tau, mapping)
                tau = sensed(toolbox, params, said, names).data
                left.append(np.hstack([q - chunk.q, tau - chunk.tau]) / scale)
            columns.append(np.concatenate(left).ravel())
        result = np.stack(columns, axis=1) / np.sqrt(columns[0].size)
        return [result if x.ndim > 1 else result[:, 0]], None, None

    def fitted(params: Any) -> Identified:
        return Identified(study, optimized(toolbox, params, residual), toolbox)

    of = ("gain", "drive")  # hard to identify with free masses
    set_gains(params, names, of, frozen=True)
    plain = fitted(params)
    freed = plain.params.copy()
    set_gains(freed, names, of, frozen=False)
    scaled = fitted(freed)
    return scaled if held_out(scaled) < WORTH * held_out(plain) else plain


def held_out(identified: Identified) -> float:
    """Mean square of replayed less recorded positions of the recordings to validate."""
    study = identified.study
    left = [identified.replay(each, study.robot) - each.q for each in study.validate]
    return float(np.mean(np.concatenate(left) ** 2))


def controlled(study: Study) -> Any:
    """The URDF in MuJoCo with the study's controller as its actuators."""
    names = list(study.joints)
    spec = specification(study.robot, study, names)
    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    control = study.controller
    for index, name in enumerate(names):
        motor = spec.actuator(name)
        motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        set_drive(motor, float(control.kp[index]), float(control.kd[index]), 1.0, 0.0)
    return spec


def set_drive(motor: Any, kp: float, kd: float, gain: float, offset: float) -> None:
    """A PD law times a gain plus an offset."""
    motor.gainprm[0] = gain * kp
    motor.biasprm[:3] = [offset, -gain * kp, -gain * kd]


def add_drives(toolbox: Any, params: Any, study: Study, names: list[str]) -> None:
    """Gain and offset of every drive, and how late its commands act."""
    for index, name in enumerate(names):
        kp, kd = float(study.controller.kp[index]), float(study.controller.kd[index])

        def gain(spec: Any, p: Any, name: str = name, kp: float = kp, kd: float = kd) -> None:
            motor, value = spec.actuator(name), float(p.value[0])
            set_drive(motor, kp, kd, value, float(motor.biasprm[0]))

        def offset(spec: Any, p: Any, name: str = name, kp: float = kp) -> None:
            spec.actuator(name).biasprm[0] = kp * float(p.value[0])

        params.add(toolbox.Parameter(f"{name}_drive", 1.0, 0.5, 2.0, modifier=gain))
        params.add(toolbox.Parameter(f"{name}_shift", 0.0, -0.5, 0.5, modifier=offset))
        params.add(toolbox.Parameter(f"{name}_late", 0.0, -LATEST, LATEST))


def delays_of(params: Any, names: list[str]) -> Array:
    """How late commands act, per joint [s]."""
    return np.array([float(params[f"{name}_late"].value[0]) for name in names])


def simulated(
    model: Any, study: Study, chunks: list[Chunk], delays: Array
) -> list[tuple[Array, Array]]:
    """Positions and drive torques (T, n) of each chunk, on its own grid."""
    names = list(study.joints)
    position = [int(model.joint(name).qposadr[0]) for name in names]
    force = [int(model.sensor(f"tau_{name}").adr[0]) for name in names]
    motor = [int(model.actuator(name).id) for name in names]
    data, result = mujoco.MjData(model), []
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    for chunk in chunks:
        mujoco.mj_resetData(model, data)
        data.qpos[position], data.qvel[position] = chunk.q[0], chunk.dq0
        start = np.empty(size)
        mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        length = chunk.time[-1] - chunk.time[0]
        times = chunk.time[0] + TIMESTEP * np.arange(int(np.ceil(length / TIMESTEP)) + 1)
        control = np.empty((len(times), model.nu))
        for k, column in enumerate(motor):
            late = times - delays[k]
            control[:, column] = np.interp(late, chunk.time, chunk.command[:, k])
        state, sensors = rollout.rollout(model, data, start, control[None])
        after = times + TIMESTEP
        q = np.vstack([chunk.q[:1], state[0][:, 1:][:, position]])
        known = np.concatenate([times[:1], after])
        result.append(
            (
                np.stack([np.interp(chunk.time, known, column) for column in q.T], axis=1),
                np.stack(
                    [np.interp(chunk.time, times, sensors[0][:, column]) for column in force],
                    axis=1,
                ),
            )
        )
    return result


def loaded_model(spec: Any, study: Study, urdf: Path) -> Any:
    """A specification compiled, with what another URDF's last link has more than the study's."""
    names = list(study.joints)
    plain, loaded = (specification(each, study, names).compile() for each in (study.robot, urdf))
    last = plain.body(int(plain.jnt_bodyid.max())).name
    load = moments(loaded, last) - moments(plain, last)
    if load[0] > 1e-9:
        add_load(spec, last, load)
    return spec.compile()


def moments(model: Any, name: str) -> Array:
    """Mass, first moment and inertia about its frame's origin of a body, (13,)."""
    body = model.body(name)
    mass, com = float(body.mass[0]), np.array(body.ipos)
    R = np.empty(9)
    mujoco.mju_quat2Mat(R, body.iquat)
    R = R.reshape(3, 3)
    about = R @ np.diag(body.inertia) @ R.T + carried(mass, com)
    return np.concatenate([[mass], mass * com, about.ravel()])


def add_load(spec: Any, last: str, load: Array) -> None:
    """A body without joints, as heavy as given."""
    body = spec.body(last).add_body(name="known_load")
    set_body(body, float(load[0]), load[1:4], load[4:].reshape(3, 3))
