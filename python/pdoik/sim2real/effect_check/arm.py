"""The arm that effects are tried on: three joints under gravity, moved slowly and quickly."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np

from pdoik.recordings import FloatArray, Recording, Role

from ..model import held_part
from ..motion import Balances, prepare
from ..simulation import Part, Simulator
from ..study import Controller, Payload, Setup, Study

JOINTS = ("j1", "j2", "j3")
TIP = "tool"
SECONDS = 10.0
RECORDING = "example"
_PERIOD = 0.002  # of the log [s]
_AXES = ("0 0 1", "0 1 0", "0.6 0.8 0")
_ROTORS = np.array([0.06, 0.05, 0.03])  # [kg m^2]
_SINES = ((0.7, 0.21, 0.4), (0.25, 0.53, 1.1), (0.05, 1.3, 2.0))  # [rad], [Hz], [rad]


class Arm:
    """Description, controller and motion, all the same for every effect."""

    def __init__(self, folder: Path, seconds: float = SECONDS, held: Payload | None = None) -> None:
        """Write the description into a folder.

        Args:
            folder: that is there.
            seconds: of the motion [s].
            held: a known body attached to its hand.
        """
        self.folder, self.robot = folder, folder / "arm.urdf"
        self.robot.write_text(_urdf(), encoding="utf-8")
        self.controller = Controller(
            kp=np.array([400.0, 400.0, 200.0]),
            kd=np.array([30.0, 30.0, 12.0]),
            gravity_compensation=True,
        )
        self._seconds = seconds
        self._held = held

    def holding(self, payload: Payload) -> Arm:
        """The same arm with a known body attached to its hand."""
        return Arm(self.folder, self._seconds, payload)

    def run(
        self, parts: Iterable[Part] = (), *, name: str = RECORDING, late: float = 0.0
    ) -> Recording:
        """What a simulation with parts logs: every channel, and the tip's poses.

        Args:
            parts: in addition to the description's.
            name: of the recording.
            late: where in the commanded motion it begins [s].

        Raises:
            SimulationError: the arm ran away.
        """
        held = () if self._held is None else (held_part(self._held),)
        parts = (*parts, *held)
        simulator = Simulator(self.robot, JOINTS, self.controller, _ROTORS, parts, tip=TIP)
        commands = _commands(self._seconds, name, late)
        return replace(simulator.replay(commands, drive="controller", tip=True), notes=())

    @cached_property
    def plain_run(self) -> Recording:
        """What the arm logs as it is described."""
        return self.run()

    @cached_property
    def plain(self) -> Balances:
        """The balances of `plain_run`."""
        return self.balances(self.plain_run)

    def study(self, *recordings: Recording, split: str = "by recording") -> Study:
        """What a diagnosis is given of recordings."""
        return Study(
            folder=self.folder,
            robot=self.robot,
            tip=TIP,
            joints=JOINTS,
            recordings=recordings,
            split=split,
            controller=self.controller,
            rotor_inertia=_ROTORS,
            setups={r.name: Setup(payload=self._held) for r in recordings},
        )

    def balances(self, recording: Recording) -> Balances:
        """The balances of a recording, as a diagnosis makes them."""
        return prepare(self.study(recording)).fit


def noisy(recording: Recording, role: Role, seed: int) -> Recording:
    """The recording with the noise of decent sensors."""
    rng = np.random.default_rng(seed)

    def with_noise(values: FloatArray | None, std: float) -> FloatArray | None:
        return None if values is None else values + std * rng.standard_normal(values.shape)

    return replace(
        recording,
        role=role,
        q=recording.q + 2e-6 * rng.standard_normal(recording.q.shape),
        dq=with_noise(recording.dq, 1e-3),
        tau=with_noise(recording.tau, 0.02),
    )


def _commands(seconds: float, name: str, late: float) -> Recording:
    time = _PERIOD * np.arange(round(seconds / _PERIOD) + 1, dtype=np.float64)
    return Recording(
        name=name,
        role="fit",
        start=0.0,
        time=time,
        q=_wave(time + late),
        dq=_wave(time + late, 1),
        q_des=_wave(time + late),
        dq_des=_wave(time + late, 1),
        valid=np.ones(len(time), dtype=np.bool_),
        raw_period=_PERIOD,
        jitter=0.0,
    )


def _wave(time: FloatArray, order: int = 0) -> FloatArray:
    """Desired positions, or their derivatives of an order, (T, 3)."""
    result = np.full((len(time), len(JOINTS)), 0.3 if order == 0 else 0.0)
    for k in range(len(JOINTS)):
        for amplitude, frequency, phase in _SINES:
            omega = 2.0 * np.pi * frequency * (1.0 + 0.17 * k)
            turn = omega * time + phase * (k + 1) + 0.5 * np.pi * order
            result[:, k] += amplitude * omega**order * np.sin(turn)
    return result


def _urdf() -> str:
    text = '<robot name="arm"><link name="base"/>'
    for k, (joint, axis) in enumerate(zip(JOINTS, _AXES, strict=True), start=1):
        parent, origin = ("base", "0 0 0.1") if k == 1 else (f"l{k - 1}", "0.3 0.05 0.1")
        text += f"""
          <joint name="{joint}" type="revolute"><parent link="{parent}"/><child link="l{k}"/>
            <origin xyz="{origin}" rpy="{0.2 * k} {-0.1 * k} 0.3"/><axis xyz="{axis}"/>
            <limit lower="-3" upper="3" effort="90" velocity="9"/></joint>
          <link name="l{k}"><inertial><origin xyz="0.15 {0.04 * k} 0.06"/>
            <mass value="{2.5 - k / 2}"/>
            <inertia ixx="0.02" iyy="0.03" izz="0.025" ixy="0.002" ixz="-0.001" iyz="0.003"/>
          </inertial></link>"""
    return (
        text
        + f"""
      <link name="{TIP}"/><joint name="flange" type="fixed"><parent link="l{len(JOINTS)}"/>
        <child link="{TIP}"/><origin xyz="0.2 0.03 -0.05" rpy="0.1 0.2 0.3"/></joint></robot>"""
    )
