"""A quadruped that trots with an unmodelled load: its base before and after, and its feet.

python -m bench.sim2real.legged.picture STUDY/study.yaml --out bench/sim2real/legged/legged.png
"""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from matplotlib.figure import Figure

from bench.common.whole_files import write_whole
from pdoik import sim2real
from pdoik.sim2real.report import AFTER, BEFORE, MEASURED, house_style, png_of

SHOWN = (6.0, 9.0)  # of the first recording [s]


def main(
    study: Annotated[Path, typer.Argument(help="study.yaml of a legged robot")],
    out: Annotated[Path, typer.Option(help="PNG")] = Path("bench/sim2real/legged/legged.png"),
) -> None:
    """Diagnose a study and draw its first recording."""
    examination = sim2real.examine(study)
    write_whole(out, lambda new: new.write_bytes(picture(examination)))
    for finding in examination.diagnosis.findings:
        typer.echo(f"{finding.confidence:.2f} {finding.statement}")


def picture(examination: sim2real.Examination) -> bytes:
    """Vertical force on the base, and that on a foot next to its sensor's."""
    balances, fit = examination.prepared.fit, examination.state.fit
    motion, key = balances.motions[0], ("base", 2)
    rows = fit.rows[key]
    rows = rows[rows < balances.starts[1]]
    before = balances.residual[key][rows]
    left = (fit.residual(key) * balances.sigma[key])[: len(rows)]
    time = balances.time[rows]
    with house_style():
        figure = Figure(figsize=(9.0, 5.6), layout="constrained")
        base, feet = figure.subplots(2, 1, sharex=True)
        base.plot(time, before, ".", ms=2.5, color=BEFORE, label="as the model has it")
        base.plot(time, left, ".", ms=2.5, color=AFTER, label="with what was found")
        base.set_title("vertical force that the base lacks, forces of the feet eliminated")
        base.set_ylabel("N")
        base.legend(loc="upper right", ncols=2)
        foot = motion.feet[0]
        assert foot.force is not None
        assert motion.base is not None
        up = np.sum(foot.force * motion.base.up, axis=1)
        assert foot.pressed is not None
        feet.plot(motion.time, foot.pressed, color=MEASURED, lw=1.8, label="its sensor")
        feet.plot(motion.time, up, color=AFTER, lw=1.1, label="by torques and the IMU")
        feet.set_title(f"what presses {foot.foot.link}")
        feet.set(ylabel="N", xlabel="s", xlim=SHOWN)
        feet.legend(loc="upper right", ncols=2)
    return png_of(figure)


if __name__ == "__main__":
    typer.run(main)
