"""What is written down of what is true: coarse, noisy, off by what the machine's sensors are."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.csv
from scipy.spatial.transform import Rotation

from bench.common.whole_files import write_whole
from bench.sim2real.legged.machine import Machine
from bench.sim2real.legged.run import TICKS, Rows
from bench.sim2real.legged.spec import Array

AVERAGED = ("said", "tau_cmd", "q_des", "gyro", "acc", "contact")


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensors:
    """Standard deviations of white noise, and steps."""

    rate: int  # of the log [Hz]
    q: float  # [rad]
    q_step: float  # [rad]; 0: none
    dq: float  # [rad/s]
    tau: Array  # (n,) [N m]
    gyro: float  # [rad/s]
    acc: float  # [m/s^2]
    position: float  # of the base [m]
    turn: float  # of the base [rad]
    contact: float  # [N]

    def facts(self) -> dict[str, Any]:
        return {**asdict(self), "tau": self.tau.tolist()}


def sensors(machine: Machine, weight: float, rng: np.random.Generator) -> Sensors:
    """Draws them; `weight` of the robot [N]."""
    coarse = rng.random() < 0.5
    return Sensors(
        rate=int(rng.choice(list(TICKS))),
        q=0.0 if coarse else 1e-4,
        q_step=float(rng.uniform(1e-4, 2e-4)) if coarse else 0.0,
        dq=float(rng.uniform(0.005, 0.02)),
        tau=machine.robot.effort * rng.uniform(0.01, 0.02),
        gyro=float(rng.uniform(0.002, 0.01)),
        acc=float(rng.uniform(0.02, 0.1)),
        position=float(rng.uniform(5e-4, 1e-3)),
        turn=float(rng.uniform(5e-4, 1e-3)),
        contact=float(weight * rng.uniform(0.005, 0.015)),
    )


def measured(
    rows: Rows, machine: Machine, sense: Sensors, rng: np.random.Generator, *, held: bool
) -> dict[str, Array]:
    robot, every = machine.robot, TICKS[sense.rate][1]
    mean = rows.averaged(AVERAGED, every)
    read, count = rows.read[::every], len(rows.time[::every])

    def noisy(values: Array, size: float | Array) -> Array:
        return np.asarray(values + size * rng.normal(size=values.shape))

    q = noisy(read, sense.q)
    if sense.q_step > 0.0:
        q = np.rint(q / sense.q_step) * sense.q_step
    channels = {
        "q": q,
        "dq": noisy(rows.speed[::every], sense.dq),
        "tau": noisy(mean["said"], sense.tau),
        "q_des": mean["q_des"],
        "tau_cmd": mean["tau_cmd"],
    }
    table = {"time": rows.time[::every]}
    for channel, values in channels.items():
        table |= {f"{channel}.{name}": values[:, j] for j, name in enumerate(robot.joints)}
    base = rows.base[::every]
    position = noisy(base[:, :3], sense.position)
    turn = Rotation.from_quat(base[:, 3:], scalar_first=True)
    turn = turn * Rotation.from_rotvec(sense.turn * rng.normal(size=(count, 3)))
    wxyz = turn.as_quat(scalar_first=True)
    wxyz *= np.where(wxyz[:, :1] < 0.0, -1.0, 1.0)
    table |= {f"base.{axis}": position[:, k] for k, axis in enumerate("xyz")}
    table |= {f"base.q{axis}": wxyz[:, k] for k, axis in enumerate("wxyz")}
    for name, bias, size in (
        ("gyro", machine.gyro_bias, sense.gyro),
        ("acc", machine.acc_bias, sense.acc),
    ):
        values = noisy(mean[name] + bias, size)
        table |= {f"{name}.{axis}": values[:, k] for k, axis in enumerate("xyz")}
    if not held:
        force = noisy(mean["contact"], sense.contact)
        table |= {f"contact.{foot}": force[:, k] for k, foot in enumerate(robot.feet)}
    return table


DIGITS = {"time": 5, "q": 7, "q_des": 7, "base": 7, "contact": 3}  # 6 of the others


def write_log(path: Path, table: dict[str, Array]) -> None:
    columns = {
        name: np.round(values, DIGITS.get(name.partition(".")[0], 6)) + 0.0  # no -0
        for name, values in table.items()
    }
    text = pyarrow.BufferOutputStream()
    options = pyarrow.csv.WriteOptions(include_header=False, quoting_style="none")
    pyarrow.csv.write_csv(pyarrow.table(columns), text, write_options=options)
    head = (",".join(table) + "\n").encode()  # which pyarrow would quote
    write_whole(path, lambda new: new.write_bytes(head + text.getvalue().to_pybytes()))
