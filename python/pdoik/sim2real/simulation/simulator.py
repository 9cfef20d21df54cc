"""Closed-loop replay of recorded commands."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pdoik.descriptions import quiet_mujoco
from pdoik.recordings import FloatArray, Recording

from ..motion import lagged
from ..study import Controller
from .control import Control, GravityModel, control_law, longest_control_step, missing_rotor_inertia
from .drift_reset import LOOKED_EVERY, DriftReset
from .parts import Part, SensedChannel, Vector
from .plant import STANDARD_GRAVITY
from .segments import Segment, measured_state, row_at, run_ends, sampled
from .stepper import Stepper

OPEN_LOOP_WINDOW = 0.2  # a robot without its controller falls away from a recording [s]
DrivenBy = Literal["controller", "tau_cmd", "tau"]


class Simulator:
    """Simulates a study's robot with its controller for given commands."""

    def __init__(
        self,
        robot: str | Path,
        joints: Sequence[str],
        controller: Controller | None = None,
        rotor_inertia: FloatArray | None = None,
        parts: Iterable[Part] = (),
        *,
        tip: str | None = None,
        gravity: Vector = STANDARD_GRAVITY,
        timestep: float = 1e-3,
        believed: str | Path | None = None,
        believed_parts: Iterable[Part] = (),
    ) -> None:
        """Build the model.

        Args:
            robot: File of a URDF or MJCF, or the text of one.
            joints: Order of the recordings' columns; other joints are held at zero.
            controller: Of the recorded machine; None: only recorded torques can be replayed.
            rotor_inertia: (n,) at the joints [kg m^2]; None: the description's armatures.
            parts: What is added to the description; the controller's gravity knows nothing of it.
            tip: Link whose pose is simulated; the last joint's otherwise.
            gravity: In the base frame [m/s^2].
            timestep: The longest step; stiff parts take shorter ones, down to 0.1 ms [s].
            believed: The robot whose gravity the controller compensates; `robot` if None.
            believed_parts: What the controller knows to be added to that.

        Raises:
            ValueError: a joint or link is missing, or a figure is no robot's.
        """
        self.joints = tuple(joints)
        self.controller = controller
        self.stepper = Stepper(
            robot, self.joints, parts, rotor_inertia=rotor_inertia, tip=tip, gravity=gravity
        )
        self._longest = timestep
        plant = self.stepper.plant
        self._armature: FloatArray = plant.model.dof_armature[list(plant.dof)]
        self._added: tuple[str, ...] = ()  # notes on the last replay
        self.put_back: dict[str, int] = {}  # by joint, how often the last replay put it back
        self._control: Control | None = None
        if controller is not None:
            compensates = controller.gravity_compensation
            known = (believed or robot, self.joints, gravity, believed_parts)
            self._control = control_law(controller, GravityModel(*known) if compensates else None)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed of the model, in words."""
        return self.stepper.plant.notes + self._added

    def drive_for(self, commands: Recording) -> DrivenBy:
        """What can drive the simulation: the controller, or else a recorded torque.

        Raises:
            ValueError: nothing can.
        """
        if self.controller is not None and commands.q_des is not None:
            return "controller"
        if commands.tau_cmd is not None:
            return "tau_cmd"
        if commands.tau is not None:
            return "tau"
        raise ValueError(
            f"{commands.name}: nothing to replay: expected q_des and a known controller, or "
            f"tau_cmd, or tau; got {', '.join(commands.channels)}"
            + (" and no controller" if self.controller is None else "")
        )

    def replay(
        self,
        commands: Recording,
        *,
        drive: DrivenBy | None = None,
        window: float | None = None,
        q0: FloatArray | None = None,
        dq0: FloatArray | None = None,
        tip: bool | None = None,
        drift_reset: bool = False,
    ) -> Recording:
        """The motion that follows from a recording's commands, on the recording's grid.

        Commands between samples lie on straight lines. Drives, friction and play begin settled.
        With `window` the motors are put back to the recorded state every so often, and samples
        there still show the run before. Open loop that is needed, so there it is 0.2 s if None.

        Args:
            commands: q_des and dq_des for the controller, or tau_cmd, or tau; and the first state.
            drive: What drives; `drive_for(commands)` if None. "tau" skips what drives do to
                commands, since reported torque is what came of that.
            window: [s]; None in closed loop: one run.
            q0: Measured positions at the start, (n,); the recording's first if None.
            dq0: Measured speeds at the start, (n,); the recording's first if None.
            tip: Whether to give the tip's poses; where the recording has some if None.
            drift_reset: Put a joint back to the recorded state, alone and at once, where it has
                strayed by 0.3 rad or 0.1 m, rather than let it run away. `put_back` counts that.

        Returns:
            Channels q, dq, tau as measured (with sensors' gains and skews), tau_cmd, the commands,
            and `tip`, where it truly is.

        Raises:
            ValueError: a needed channel is missing.
            SimulationError: the robot ran away.
        """
        drive = drive or self.drive_for(commands)
        if window is None and drive != "controller":
            window = OPEN_LOOP_WINDOW
        q, dq = measured_state(commands, self.joints, q0, dq0)
        stepper, (dt, hold) = self.stepper, self._steps(commands, drive)
        if stepper.timestep != dt:
            stepper.timestep = dt
        self._add_missing_rotors(q[0], dt * hold, drive)
        stepper.recording, stepper.laws.start = commands.name, commands.start
        stepper.reset(q[0], dq[0])
        duration = float(commands.time[-1])
        ticks = self._commands(commands, drive, np.arange(0.0, duration + 2 * dt, dt * hold))
        ends = run_ends(duration, window, commands.period)
        reset = DriftReset(stepper, commands.time, q, dq) if drift_reset else None
        segments, first = [], 0
        for end in ends:
            last = max(first + 1, int(np.ceil(end / dt - 1e-6)))
            last += end == ends[-1]  # for the torque of the last sample
            while first < last:
                with quiet_mujoco():
                    segments.append(self._run(first, last, hold, ticks, drive, reset))
                first += len(segments[-1].command)
                if reset is not None and first < last:
                    reset.put_back(first * dt)
            if end < ends[-1]:
                now = last * dt
                stepper.place(row_at(now, commands.time, q), row_at(now, commands.time, dq))
        strays = [] if reset is None else zip(self.joints, reset.count.tolist(), strict=True)
        self.put_back = {joint: count for joint, count in strays if count}
        return self._recording(commands, segments, drive, window, tip)

    def _steps(self, commands: Recording, drive: DrivenBy) -> tuple[float, int]:
        """Length of a step [s] and steps per command."""
        period, longest = commands.period, self.stepper.laws.longest_step(self._longest)
        if drive == "controller" and self.controller is not None:
            if self.controller.period is not None:
                period = self.controller.period
            else:
                inverse = self.stepper.plant.inverse_inertia(commands.q[0])
                longest = longest_control_step(self.controller, inverse, longest)
        count = max(1, int(np.ceil(period / longest - 1e-6)))
        held = drive == "controller" and self.controller and self.controller.period is not None
        return period / count, count if held else 1

    def _add_missing_rotors(self, q: FloatArray, period: float, drive: DrivenBy) -> None:
        """Add rotors where they are not known, so that the controller does not shake the model."""
        plant = self.stepper.plant
        plant.set_armature(self._armature)
        self._added = ()
        if drive != "controller" or self.controller is None:
            return
        missing = missing_rotor_inertia(self.controller, plant.inverse_inertia(q), period)
        plant.set_armature(self._armature + missing)
        if missing.any():
            rotors = ", ".join(
                f"{each:.3g} of {joint}"
                for joint, each in zip(self.joints, missing, strict=True)
                if each
            )
            self._added = (
                f"rotor inertias were added, in kg m^2: {rotors}; without them the controller, "
                f"whose torque is held for {1e3 * period:.3g} ms, would shake this model",
            )

    def _commands(self, commands: Recording, drive: DrivenBy, times: FloatArray) -> list[Any]:
        """Desired positions and speeds, or torques, per command, as they act."""
        drives = [self.stepper.drive_of(k) for k in range(len(self.joints))]

        def acting(channel: str, delayed: bool = True) -> list[list[float]]:
            values = getattr(commands, channel)
            if values is None:
                raise ValueError(f"{commands.name}: {channel} is needed and was not recorded")
            for k, joint in enumerate(self.joints):
                if not np.isfinite(values[:, k]).all():
                    raise ValueError(f"{commands.name}: {channel}.{joint} is needed, it has gaps")
            columns = [
                np.interp(times - drives[k].delay * delayed, commands.time, values[:, k])
                for k in range(len(self.joints))
            ]
            if channel == "q_des":
                columns = [
                    lagged(column, drives[k].command_lag, float(times[1] - times[0]))
                    if drives[k].command_lag
                    else column
                    for k, column in enumerate(columns)
                ]
            rows: list[list[float]] = np.stack(columns, axis=1).tolist()
            return rows

        if drive != "controller":
            return acting(drive, delayed=drive == "tau_cmd")
        q_des = _let_go(acting("q_des"), commands, times)
        if commands.dq_des is None:
            return [(row, [0.0] * len(self.joints)) for row in q_des]
        return list(zip(q_des, acting("dq_des"), strict=True))

    def _run(
        self,
        first: int,
        last: int,
        hold: int,
        ticks: list[Any],
        drive: DrivenBy,
        drift_reset: DriftReset | None = None,
    ) -> Segment:
        """Steps from number `first` up to `last`, or to where a joint has strayed."""
        stepper, control = self.stepper, self._control
        data, sensors, dof = stepper.data, stepper.sensors, stepper.plant.dof
        qpos, qvel = data.qpos, data.qvel
        dt, half, everything = stepper.timestep, 0.5 * stepper.timestep, tuple(range(len(qpos)))
        # One flat list each: a list per step would keep the garbage collector busy.
        positions: list[float] = []
        velocities: list[float] = []
        commanded: list[float] = []
        reported: list[float] = []
        advance = stepper.advance if drive != "tau" else stepper.advance_exerted
        tau: list[float] = [0.0] * len(dof)
        look = max(1, round(LOOKED_EVERY / dt))
        data.time = first * dt
        for k in range(first, last):
            if (
                drift_reset is not None
                and k > first
                and k % look == 0
                and drift_reset.strays(k * dt)
            ):
                break
            q, v = qpos.tolist(), qvel.tolist()
            positions += q
            velocities += v
            if k % hold == 0 or k == first:
                tick = ticks[k // hold]
                if drive != "controller":
                    tau = tick
                else:
                    assert control is not None
                    w = v if dof == everything else [v[i] for i in dof]
                    x = [q[i] - half * v[i] for i in dof]
                    if not sensors.plain:
                        x = sensors.seen("q", np.array(x)).tolist()
                        w = sensors.seen("dq", np.array(w)).tolist()
                    tau = control(tick[0], tick[1], x, w)
                stepper.check(v)
            commanded += tau
            reported += advance(tau, q, v)
        positions += qpos.tolist()
        velocities += qvel.tolist()
        stepper.check(qvel.tolist())
        velocity = np.array(velocities).reshape(-1, len(qvel))
        return Segment(
            first * dt,
            np.array(positions).reshape(-1, len(qpos)) - half * velocity,
            velocity,
            np.array(commanded).reshape(-1, len(dof)),
            np.array(reported).reshape(-1, len(dof)),
        )

    def _recording(
        self,
        commands: Recording,
        segments: list[Segment],
        drive: DrivenBy,
        window: float | None,
        tip: bool | None,
    ) -> Recording:
        stepper, time = self.stepper, commands.time
        sensors, dof, dt = stepper.sensors, list(stepper.plant.dof), stepper.timestep

        def channel(name: SensedChannel, field: str, columns: list[int]) -> FloatArray:
            skew = sensors.skew[name]
            values = [
                sampled(segments, field, dt, time - late)
                for late in (np.unique(skew) if skew.any() else [0.0])
            ]
            if not skew.any():
                return sensors.measured(name, values[0][:, columns])
            which = np.unique(skew, return_inverse=True)[1]
            measured = [sensors.measured(name, each[:, columns]) for each in values]
            return np.stack([measured[w][:, k] for k, w in enumerate(which)], axis=1)

        everything = list(range(len(dof)))
        wanted = commands.tip is not None if tip is None else tip
        words = {"controller": "closed loop", "tau_cmd": "open loop", "tau": "open loop"}[drive]
        note = f"simulated in {words}, driven by the {drive.replace('tau', 'recorded tau')}"
        if window is not None:
            note += f", put back to the recorded state every {window:g} s"
        return replace(
            commands,
            q=channel("q", "position", dof),
            dq=channel("dq", "velocity", dof),
            tau=channel("tau", "reported", everything),
            tau_cmd=sampled(segments, "command", dt, time),
            current=None,
            duty=None,
            tip=stepper.tip_poses(sampled(segments, "position", dt, time)) if wanted else None,
            valid=commands.valid.copy(),
            jitter=0.0,
            notes=(note, *self.notes),
        )


def _let_go(rows: list[list[float]], commands: Recording, times: FloatArray) -> list[list[float]]:
    """Desired positions, NaN where the recording's drives have let go."""
    if commands.released is None or not commands.released.any():
        return rows
    place = np.minimum((times / commands.period + 0.5).astype(np.intp), len(commands.time) - 1)
    gone: list[list[float]] = np.where(commands.released[place], np.nan, rows).tolist()
    return gone
