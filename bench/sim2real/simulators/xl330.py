"""A real hobby servo that swings a load, compared with the simulator that its data sheet makes.

    python -m bench.sim2real.simulators.xl330 ../shared/recordings/bam_xl330

An XL330-M288-T of Robotis with 0.49 kg at 0.1 m (recordings of github Rhoban/bam, Apache-2.0, not
copied here). Its data sheet gives 0.52 N m at stall and 103 1/min without load, and what its gain
of position means: duty by 885 for each of 4,096 steps a turn, over 128. Friction, rotor, delay and
filter are in no data sheet. The drive lets go in one of the four motions, which is left out.
"""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from bench.sim2real.simulators.robots import compared, told_of

MOTIONS, HELD_OUT = ("sin_sin", "up_and_down"), "sin_time_square"
MASS, ARM = 0.49, 0.1  # [kg], [m]
STALL, FREE = 0.52, 103.0 / 60.0 * 2.0 * np.pi  # [N m], [rad/s]


def simulator(gain: int) -> str:
    """MJCF of the servo and its load, at a firmware gain."""
    kp = STALL * gain / 128.0 * 4096.0 / (2.0 * np.pi) / 885.0
    return f"""<mujoco>
  <option timestep="0.001" integrator="implicitfast"/>
  <worldbody>
    <body name="load">
      <joint name="joint1" axis="0 1 0"/>
      <inertial mass="{MASS}" pos="0 0 {-ARM}" diaginertia="1e-5 1e-5 1e-5"/>
    </body>
  </worldbody>
  <actuator>
    <position name="servo" joint="joint1" kp="{kp:.4g}" kv="{STALL / FREE:.4g}"
      forcelimited="true" forcerange="{-STALL} {STALL}"/>
  </actuator>
</mujoco>"""


def study(folder: Path, gain: int) -> dict[str, Any]:
    """The keys of the YAML as a user would write it, but for the simulator."""
    return {
        "joints": ["joint1"],
        "ignore": ["duty.joint1", "volts", "temperature"],
        "recordings": [
            {
                "file": str(folder.resolve() / f"kp{gain}_{motion}.csv"),
                "role": "validate" if motion == HELD_OUT else "fit",
            }
            for motion in (*MOTIONS, HELD_OUT)
        ],
    }


def main(
    folder: Annotated[Path, typer.Argument(help="With the recordings.")],
    gain: Annotated[int, typer.Option(help="Of the firmware: 100 or 400.")] = 400,
) -> None:
    """Compare, print the table and what was found."""
    typer.echo(told_of(compared(simulator(gain), study(folder, gain))))


if __name__ == "__main__":
    typer.run(main)
