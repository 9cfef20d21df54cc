"""Recordings cut into short runs, from which candidates start anew at the measured state.

Errors of position of one run do not pile up over the next: multiple shooting with the measured
states as the nodes. Each run has a beginning that is not judged, in which a wrong start dies out.
"""

from __future__ import annotations

import copy
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray
from scipy.signal import lfilter

from pdoik.descriptions import quiet_mujoco
from pdoik.recordings import FloatArray, Recording

from ..simulation import measured_state
from .candidates import Values, delays_with, filters_with, model_with
from .commands import check_commands, fed_forward, follow, mean_over, settle_actuators
from .sampled import Sampled
from .stability import check_states
from .user_model import UserModel

WARM = 0.3  # beginning of each run that is not judged [s]
LENGTH = 1.5  # of what is judged of each run [s]
BLOCK = 0.75  # of rows that are drawn together, [s]
MOST_ROWS = 12000  # judged samples of all recordings
MOST_SECONDS = 30.0  # judged of all recordings
_CONTROL = int(mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_QFRC_APPLIED)
_MOST_THREADS = 4  # in which runs of one candidate go on
_MEMORY = 8.0  # time constants of what smooths commands, until it has forgotten
_FINER = 4  # steps in one, to see what a step does
_MOST_GIVEN = 5_000  # numerics: commands of one drive in one run that are kept
_PHASES = 10  # samples among which a run may begin
_STATE = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Run:
    """One stretch of a recording."""

    recording: int
    start: float  # of the simulation [s]
    state: FloatArray  # (nstate,)
    rows: NDArray[np.intp]  # of the recording that are judged


class Experiment:
    """Candidates of one model, run under the commands of some recordings.

    `measured` (R, C) has a column per joint's position and, where torque was logged, one per
    joint's torque; `block` (R,) says which rows are drawn together, `recording` which one it is.
    """

    def __init__(
        self,
        user: UserModel,
        recordings: Sequence[Recording],
        *,
        length: float = LENGTH,
        warm: float = WARM,
        torque: bool = True,
        thin: bool = True,
        most_rows: int = MOST_ROWS,
        most_seconds: float = MOST_SECONDS,
    ) -> None:
        """Cut the recordings.

        Args:
            user: the model.
            recordings: with q_des of all its joints.
            length: of what is judged of each run [s].
            warm: beginning of each run that is not judged [s].
            torque: whether to show torques, too, where all recordings have them.
            thin: whether long recordings are judged at a part of their samples.
            most_rows: judged samples of all recordings, then.
            most_seconds: judged of all recordings, then.

        Raises:
            ValueError: commands are missing.
        """
        self.user = user
        self.recordings = tuple(recordings)
        for each in recordings:
            check_commands(each, user.joints)
        self.torque = torque and all(
            each.tau is not None and bool(np.isfinite(each.tau).all()) for each in recordings
        )
        self._data = mujoco.MjData(user.model)
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
        self._threads = [mujoco.MjData(user.model) for _ in range(min(cores or 1, _MOST_THREADS))]
        self._of_step: FloatArray | None = None
        self._given: dict[tuple[object, ...], FloatArray] = {}
        self._forward = [fed_forward(user, each) for each in recordings]
        self._steps = round((warm + length) / user.timestep)
        self._most = most_rows, most_seconds
        self._runs = self._cut(length, warm, thin)
        if not self._runs:
            raise ValueError("recordings: too short to simulate any of them")
        parts = [self._measured(run) for run in self._runs]
        self.measured: FloatArray = np.concatenate(parts)
        times = [
            self.recordings[run.recording].time[run.rows] + 1e4 * run.recording
            for run in self._runs
        ]
        self.time: FloatArray = np.concatenate(times)
        self.recording = np.concatenate([np.full(len(r.rows), r.recording) for r in self._runs])
        self.block: NDArray[np.intp] = np.unique(
            np.floor(self.time / BLOCK).astype(np.int64), return_inverse=True
        )[1]

    @property
    def channels(self) -> tuple[tuple[str, int], ...]:
        """Channel and joint of each column."""
        n = len(self.user.joints)
        kinds = ("q", "tau") if self.torque else ("q",)
        return tuple((kind, k) for kind in kinds for k in range(n))

    @property
    def parts(self) -> tuple[slice, ...]:
        """Rows of each run."""
        ends = np.cumsum([0, *(len(run.rows) for run in self._runs)])
        return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))

    def largest_torque(self, values: Values, k: int) -> float:
        """The largest torque that a joint's drive gives in any run of a candidate [N m]."""
        _, sensed = self._rolled(values)
        return float(np.abs(sensed[..., self.user.torque_sensors[k]]).max())

    def allow_for_step(self, values: Values) -> None:
        """Let `run` add, from now on, what truer steps change in this candidate.

        What a simulator's step does to a motion (half a step of delay, more or less damping) is
        none of its properties, and must not pass for one of the machine's. Truer is a fourth of
        the step, and where the controller's period is known, torques that are held for it.
        """
        self._of_step = None
        user, steps, plain = self.user, self._steps, self.run(values)
        try:
            if user.law is not None and user.law.period is not None:
                self._of_step = self._sampled(values) - plain
                return
            fine = copy.copy(user.model)
            fine.opt.timestep = user.timestep / _FINER
            self.user, self._steps = replace(user, model=fine), steps * _FINER
            self._of_step = self.run(values) - plain
        finally:
            self.user, self._steps = user, steps

    def _sampled(self, values: Values) -> FloatArray:
        """What a candidate shows whose torques are held from tick to tick, (R, C)."""
        rows = []
        sampled = Sampled.of(self.user, model_with(self.user, values))
        self._steps = round(self._steps * self.user.timestep / sampled.user.timestep)
        self.user = sampled.user
        for run in self._runs:
            steps = np.arange(self._steps, dtype=np.float64)
            times = np.asarray(run.start + self.user.timestep * steps, dtype=np.float64)
            recording = self.recordings[run.recording]
            commands = self._commands(recording, times, values, looked_at=True)
            forward = self._forward[run.recording]
            if forward is not None:
                columns = [np.interp(times, recording.time, each) for each in forward.T]
                forward = np.stack(columns, axis=1)
            states, held = sampled.run(run.state, commands, forward)
            check_states(self.user, states, recording.name, run.start)
            sensed = np.zeros((len(states), self.user.model.nsensordata))
            sensed[:, list(self.user.torque_sensors)] = held
            rows.append(self._shown(run, states, sensed))
        return np.concatenate(rows)

    def run(self, values: Values, *, as_it_is: bool = False) -> FloatArray:
        """What a candidate shows where `measured` is, (R, C).

        Args:
            values: of the properties that are not the user's.
            as_it_is: without what `allow_for_step` adds.

        Raises:
            SimulationError: it left all bounds.
        """
        rows = [
            self._shown(run, state, sensed)
            for run, state, sensed in zip(self._runs, *self._rolled(values), strict=True)
        ]
        shown = np.concatenate(rows)
        return shown if as_it_is or self._of_step is None else shown + self._of_step

    def _cut(self, length: float, warm: float, thin: bool) -> list[_Run]:
        runs: list[_Run] = []
        seconds = sum(float(each.time[-1]) for each in self.recordings)
        most_rows, most_seconds = self._most
        share = min(1.0, most_seconds / seconds) if thin else 1.0
        rows = sum(len(each.time) for each in self.recordings) * share
        every = max(1, int(np.ceil(rows / most_rows))) if thin else 1
        self.spacing = every * max(each.period for each in self.recordings)  # of judged rows [s]
        for k, recording in enumerate(self.recordings):
            q, dq = measured_state(recording, self.user.joints, None, None)
            end = float(recording.time[-1]) + recording.period
            count = max(1, int((end - warm) / length + 0.5))
            wanted = max(1, round(count * share))
            for piece in np.unique(np.linspace(0, count - 1, wanted).round().astype(int)):
                first = warm + piece * (end - warm) / count
                last = warm + (piece + 1) * (end - warm) / count
                at = self._in_step(recording, max(0, round((first - warm) / recording.period)))
                start = float(recording.time[at])
                reach = start + self._steps * self.user.timestep
                inside = (recording.time >= first) & (recording.time < min(last, reach))
                judged = np.flatnonzero(inside & recording.valid)[::every]
                if len(judged):
                    state = self._state(recording, q[at], dq[at], start)
                    runs.append(_Run(recording=k, start=start, state=state, rows=judged))
        return runs

    def _in_step(self, recording: Recording, at: int) -> int:
        """The sample at or soon after one that is nearest to a step of a run of the whole.

        Commands then jump where they do in steps of that, and torques at samples are the same.
        """
        place = recording.time[at : at + _PHASES] / self.user.timestep
        return at + int(np.argmin(np.round(np.abs(place - np.round(place)), 6)))

    def _state(
        self, recording: Recording, q: FloatArray, dq: FloatArray, start: float
    ) -> FloatArray:
        user, data = self.user, self._data
        model = user.model
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        else:
            mujoco.mj_resetData(model, data)
        data.time = 0.0
        data.qvel[:] = 0.0
        data.qpos[list(user.qpos)], data.qvel[list(user.dof)] = q, dq
        follow(model, data)
        command = self._commands(recording, np.array([start]), {})[0]
        data.ctrl[list(user.controls)] = command
        settle_actuators(user, data, command)
        state = np.empty(mujoco.mj_stateSize(model, _STATE))
        mujoco.mj_getState(model, data, state, _STATE)
        self._rest = np.array(data.ctrl)
        return state

    def _commands(
        self,
        recording: Recording,
        times: FloatArray,
        values: Values,
        *,
        looked_at: bool = False,
    ) -> FloatArray:
        """What each drive is given over the steps that begin at these even times, (K, n).

        A command is held until the next one, as control loops do; a step gets the mean over its
        length, which is smooth in the delay. Of a controller that is known to run much faster than
        the log, commands lie on lines between samples. What smooths commands has seen those before
        the first of the times.

        Args:
            recording: whose commands.
            times: [s].
            values: of the candidate.
            looked_at: whether the controller looks at commands at these times, and at no others.
        """
        delays, smooth = delays_with(self.user, values), filters_with(self.user, values)
        dt = float(times[1] - times[0]) if len(times) > 1 else self.user.timestep
        columns = []
        for k, drive in enumerate(zip(delays, smooth, strict=True)):
            key = (recording.name, k, *drive, float(times[0]), len(times), dt, looked_at)
            if key not in self._given:
                if len(self._given) >= _MOST_GIVEN:
                    self._given.clear()
                self._given[key] = self._drive_command(recording, k, drive, times, dt, looked_at)
            columns.append(self._given[key])
        return np.stack(columns, axis=1)

    def _drive_command(
        self,
        recording: Recording,
        k: int,
        drive: tuple[float, float],
        times: FloatArray,
        dt: float,
        looked_at: bool,
    ) -> FloatArray:
        """One drive's command, delayed and smoothed by `drive` [s], (K,)."""
        late, slow = drive
        if slow <= 0.0:
            return self._command(recording, k, times - late, dt, looked_at)
        before = int(np.ceil(_MEMORY * slow / dt))
        all_times = np.concatenate([times[0] - dt * np.arange(before, 0, -1), times])
        column = self._command(recording, k, all_times - late, dt, looked_at)
        share = slow / (slow + dt)  # late by `slow` in the mean, however short
        filtered, _ = lfilter([1.0 - share], [1.0, -share], column, zi=share * column[:1])
        return np.asarray(filtered[before:])

    def _command(
        self, recording: Recording, k: int, times: FloatArray, dt: float, looked_at: bool
    ) -> FloatArray:
        """One joint's command, as it was sent, (K,)."""
        q_des = recording.q_des
        assert q_des is not None
        if self._is_faster(recording):
            at = times if looked_at else times + 0.5 * dt
            return np.asarray(np.interp(at, recording.time, q_des[:, k]))
        if not looked_at:
            return mean_over(recording.time, q_des[:, k], times, dt)
        since = np.floor((times - recording.time[0]) / recording.period + 1e-6)
        return np.asarray(q_des[np.clip(since, 0, len(q_des) - 1).astype(int), k])

    def _is_faster(self, recording: Recording) -> bool:
        """Whether the controller is known to run much faster than the log."""
        law = self.user.law
        return law is not None and law.period is not None and 2.0 * law.period < recording.period

    def _rolled(self, values: Values) -> tuple[FloatArray, FloatArray]:
        """States and sensor values after each step of each run, (runs, K, .)."""
        model = model_with(self.user, values)
        start = np.stack([run.state for run in self._runs])
        control = np.stack([self._control(run, values) for run in self._runs])
        with quiet_mujoco():
            states, sensors = rollout.rollout(
                model, self._threads, start, control, control_spec=_CONTROL
            )
        for run, state in zip(self._runs, states, strict=True):
            name = self.recordings[run.recording].name
            check_states(self.user, state, name, run.start)
        return states, sensors

    def _control(self, run: _Run, values: Values) -> FloatArray:
        times = np.asarray(
            run.start + self.user.timestep * np.arange(self._steps), dtype=np.float64
        )
        model = self.user.model
        control = np.zeros((self._steps, model.nu + model.nv))
        control[:, : model.nu] = self._rest
        commands = self._commands(self.recordings[run.recording], times, values)
        control[:, list(self.user.controls)] = commands
        torque = self._forward[run.recording]
        if torque is not None:
            recording = self.recordings[run.recording]
            for dof, column in zip(self.user.dof, torque.T, strict=True):
                control[:, model.nu + dof] = np.interp(times, recording.time, column)
        return control

    def _measured(self, run: _Run) -> FloatArray:
        recording = self.recordings[run.recording]
        columns = [recording.q[run.rows]]
        if self.torque:
            assert recording.tau is not None
            columns.append(recording.tau[run.rows])
        return np.concatenate(columns, axis=1)

    def _shown(self, run: _Run, states: FloatArray, sensed: FloatArray) -> FloatArray:
        """A run's states, after each step, at the recording's samples."""
        dt = self.user.timestep
        time = self.recordings[run.recording].time[run.rows] - run.start
        place = np.clip(time / dt, 0.0, len(states) - 0.0)
        qpos = [1 + k for k in self.user.qpos]  # the first of a state is the time
        q = np.concatenate([run.state[None, qpos], states[:, qpos]])  # (K + 1, n)
        low = np.minimum(np.floor(place + 1e-6).astype(int), len(q) - 2)
        share = (place - low)[:, None]
        columns = [(1.0 - share) * q[low] + share * q[low + 1]]
        if self.torque:
            torque = sensed[low][:, list(self.user.torque_sensors)]
            forward = self._forward[run.recording]
            columns.append(torque if forward is None else torque + forward[run.rows])
        return np.concatenate(columns, axis=1)


def simulated(user: UserModel, recording: Recording, values: Values) -> Recording:
    """One run of a candidate from a recording's first state under its commands, on its grid.

    Raises:
        SimulationError: it left all bounds.
        ValueError: commands are missing.
    """
    whole = float(recording.time[-1]) + recording.period
    like = replace(recording, valid=np.ones_like(recording.valid), tau=np.zeros_like(recording.q))
    run = Experiment(user, [like], length=whole, warm=0.0, thin=False)
    shown, n = run.run(values), len(user.joints)
    q = shown[:, :n]
    return replace(
        like,
        q=q,
        dq=np.gradient(q, recording.period, axis=0),
        tau=shown[:, n:],
        current=None,
        duty=None,
        tau_cmd=None,
        tip=None,
        jitter=0.0,
        notes=(f"simulated by {user.name}",),
    )
