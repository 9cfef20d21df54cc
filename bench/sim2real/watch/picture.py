"""The picture of `pdoik watch` in the README: a joint's residual, its CUSUM charts, and the alarms.

python -m bench.sim2real.watch --out watch_day            makes the model, and stops at will
python -m bench.sim2real.watch.picture watch_day/model.json bench/sim2real/watch/watch.png
"""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import typer
from matplotlib.figure import Figure

from bench.sim2real.watch.machine import JOINTS, SEED, Machine, Onset
from pdoik import sim2real
from pdoik.sim2real.watch import Charts, Residuals, Rows, Windows, joined

JOINT, NUMBER, SINCE, SECONDS = 3, 501, 31.0, 60.0
CHARTS = ("offset", "friction", "gain")


def main(model_file: Path, out: Path) -> None:
    """Watch one log, and draw what the charts saw."""
    model = sim2real.load_model(model_file)
    assert model.healthy is not None
    limits = sim2real.Thresholds().watch
    onset = Onset(kind="friction", at=SINCE, joint=JOINT, size=2.0)
    log = Machine(SEED).log(NUMBER, SECONDS, onset)
    watch = sim2real.Watch(model)
    alarms = watch.feed(log.columns()) + watch.end()
    residuals = Residuals(model, model.healthy.position_noise, limits.slides)
    windows = Windows(len(JOINTS), residuals.cutoff)
    cut = windows.add(Rows(time=log.time, q=log.q, tau=log.tau))
    charts = Charts(model.healthy, limits)
    residuals.today = charts.today
    rows = joined(residuals.rows(each) for each in cut)
    used, crossing, path = charts.update(rows)
    figure = Figure(figsize=(9.0, 5.0), layout="constrained", dpi=110)
    upper, lower = figure.subplots(2, 1, sharex=True)
    moving = rows.moving[:, JOINT]
    shown = np.where(moving, rows.residual[:, JOINT], np.nan)
    upper.plot(rows.time, rows.residual[:, JOINT], color="0.8", lw=0.8, label="at rest or turning")
    upper.plot(rows.time, shown, color="#1f5fa8", lw=1.0, label="counted")
    allowed = rows.allowed[:, JOINT]
    upper.fill_between(
        rows.time, -allowed, allowed, color="#2a9d5c", alpha=0.2, lw=0, label="allowed"
    )
    upper.set_ylabel(f"residual of {JOINTS[JOINT]} [N m]")
    for k, name in enumerate(CHARTS):
        lower.plot(rows.time[:used], path[:, JOINT, k].max(axis=1), lw=1.4, label=name)
    lower.axhline(charts.threshold, color="k", ls="--", lw=0.8, label="threshold, 1 in 24 h")
    lower.set(ylabel="CUSUM [log likelihood ratio]", xlabel="time [s]", xlim=(0.0, 1.2 * SECONDS))
    for axes in (upper, lower):
        axes.axvline(SINCE, color="#c0392b", lw=1.0, label="friction doubles")
        for alarm in alarms:
            axes.axvline(alarm.told, color="#c0392b", lw=1.0, ls=":")
        axes.legend(loc="upper left", fontsize=8)
    for alarm in alarms:
        cause = alarm.causes[0].effect.replace("_", " ") if alarm.causes else "?"
        upper.annotate(
            f"{alarm.stage}:\n{cause}",
            (alarm.told, 0.05),
            xycoords=("data", "axes fraction"),
            xytext=(3, 0),
            textcoords="offset points",
            fontsize=8,
            color="#c0392b",
        )
    assert crossing is not None
    figure.savefig(out)


if __name__ == "__main__":
    mpl.use("Agg")
    typer.run(main)
