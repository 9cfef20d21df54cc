"""A real quadruped that hangs: what `pdoik compare` finds from positions alone, and a picture.

    python -m bench.sim2real.simulators.go2 SHARED/recordings/go2_hanging --picture FILE

The user's simulator is the Go2 of example-robot-data under the drives' gains (kp 20, kd 1.5),
nothing else. Next to it stand the figures that the recording's authors simulate with (damping 0.6,
dry friction 0.2, armature 0.01 in every joint). Errors are those of the held-out end, in runs of
1.5 s that begin at the measured state.
"""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from matplotlib.figure import Figure

from bench.common.descriptions import go2_urdf
from bench.common.whole_files import write_whole
from bench.sim2real.simulators.robots import compared, errors_by_joint, found_in
from pdoik.sim2real.report import AFTER, BEFORE, MEASURED, house_style, png_of
from pdoik.sim2real.simulators import Comparison, ParameterId

MAKERS = {"damping": 0.6, "frictionloss": 0.2, "armature": 0.01}
LEG = 3  # joints of one


def table(comparison: Comparison) -> str:
    """Each joint's held-out error of the simulator, with its makers' figures, and patched."""
    assert comparison.machine is not None
    explained = comparison.machine.explained
    held, joints = explained.held_out, comparison.study.joints
    makers = {
        ParameterId(name, k): value for name, value in MAKERS.items() for k in range(len(joints))
    }
    sides = {
        "as it is [mrad]": explained.before,
        "with the authors' figures": held.run(makers, as_it_is=True),
        "patched": explained.after,
    }
    return errors_by_joint(comparison, sides)


def picture(comparison: Comparison) -> bytes:
    trace = next(t for t in comparison.traces if t.recording.role == "validate")
    assert trace.patched is not None
    time = trace.recording.time + trace.recording.start
    with house_style():
        figure = Figure(figsize=(9.0, 5.4), layout="constrained")
        axes = figure.subplots(LEG, 1, sharex=True)
        at = slice(int(3.5 / trace.recording.period), None)
        for k, one in enumerate(axes):
            for values, color, width, label in (
                (trace.recording.q, MEASURED, 1.8, "machine"),
                (trace.simulator, BEFORE, 1.1, "simulator as it is"),
                (trace.patched, AFTER, 1.1, "simulator, patched"),
            ):
                one.plot(time[at], values[at, k], color=color, lw=width, label=label)
            sizes = [
                1e3 * np.sqrt(np.mean((trace.recording.q[:, k] - side[:, k]) ** 2))
                for side in (trace.simulator, trace.patched)
            ]
            joint = comparison.study.joints[k]
            one.set_title(f"{joint}: {sizes[0]:.0f} → {sizes[1]:.0f} mrad rms, held out")
            one.set_ylabel("position [rad]")
        axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=3)
        axes[-1].set_xlabel("time [s]")
        return png_of(figure)


def main(
    folder: Annotated[Path, typer.Argument(help="With run1.csv.")],
    image: Annotated[Path | None, typer.Option("--picture", help="PNG to write.")] = None,
) -> None:
    """Compare, print the table and what was found, draw one leg."""
    study = {
        "controller": {"type": "pd", "kp": [20.0] * 12, "kd": [1.5] * 12},
        "recordings": [str(folder.resolve() / "run1.csv")],
    }
    comparison = compared(go2_urdf(), study)
    typer.echo(table(comparison))
    typer.echo(found_in(comparison))
    if image is not None:
        png = picture(comparison)
        write_whole(image, lambda temporary: temporary.write_bytes(png))


if __name__ == "__main__":
    typer.run(main)
