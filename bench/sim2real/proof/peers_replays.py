"""Motions instead of torques: what each method's simulation makes of the same commands.

    python -m bench.sim2real.proof.peers_replays --out build/bench/peers-replays

The studies and conditions of `peers_run`. Each method's model is simulated in closed loop from the
recorded commands, of which a 20 s recording gives one run, and its positions are compared with
those of the machine. Torque regressions are no simulators: they have no part in this.
"""

import tempfile
import time
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer

from bench.common import commands as cli
from bench.common.digests import code_digest
from bench.common.markdown import markdown_table
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.tracks import Array, Track, smooth
from bench.sim2real.proof.peers_report import TITLES
from bench.sim2real.proof.peers_run import ROOM, specs
from bench.sim2real.proof.peers_study import COLUMNS, Case, one_thread
from bench.sim2real.proof.peers_trajectories import trajectory_sysid
from pdoik.sim2real import Model, examine, model_of

METHODS = ("nothing", "ours", "mujoco.sysid")
LEVEL = 1.05  # times the lowest error is level with it
SAME = 0.01  # of a milliradian: nearer than this nobody cares


def main(
    out: cli.OutFolder = cli.BUILD / "peers-replays",
    quick: cli.Quick = False,
    seed: cli.Seed = 4000,
    studies: Annotated[int, typer.Option(min=1, max=ROOM, help="Of each effect.")] = 1,
    scheduler: cli.Scheduler = None,
    workers: cli.Workers = None,
) -> None:
    """Compare simulated motions."""
    if quick:
        studies, out = 1, out.with_name(out.name + "-quick")
    jobs = {
        f"{spec.seed}-{spec.effect}": {"spec": asdict(spec)} for spec in specs(seed, studies, quick)
    }
    with cli.plain_errors():
        settings = {
            "experiment": "replays",
            "seed": seed,
            "code": code_digest("concealed", "proof"),
        }
        rows = cli.run_campaign(out, settings, run_study, jobs, scheduler, workers)
        tables = report(rows)
        cli.write_report(out / "replays.md", tables)
        cli.show(tables)


def run_study(job: dict[str, Any]) -> list[dict[str, Any]]:
    spec = WorldSpec(**job["spec"])
    rows = []
    with tempfile.TemporaryDirectory(prefix="pdoik-replays-") as folder, one_thread():
        case = Case(Path(folder), spec)
        for method in METHODS:
            begin, said = time.perf_counter(), ""
            try:
                replay = simulator_of(method, case)
                seconds = time.perf_counter() - begin
                errors = {c: error(replay, case.columns[c]) for c in COLUMNS}
            except Exception as failure:  # a study that a method breaks on is shown as that
                seconds, said = time.perf_counter() - begin, f"{type(failure).__name__}: {failure}"
                errors = dict.fromkeys(COLUMNS, np.nan)
            row = {**asdict(spec), "method": method, "seconds": seconds, "said": said}
            rows += [row | {"column": c, "mrad": 1e3 * errors[c]} for c in COLUMNS]
    return rows


def simulator_of(method: str, case: Case) -> Any:
    """What gives positions (T, n) for the commands of a track."""
    if method == "mujoco.sysid":
        identified = trajectory_sysid(case.study)
        return lambda track: identified.replay(track.recording, track.urdf)
    model = model_of(examine(case.study)) if method == "ours" else Model.of_study(case.study)

    def replay(track: Track) -> Array:
        simulator = model.with_robot(track.urdf).simulator()
        return simulator.replay(track.recording, drive="controller", tip=False).q

    return replay


def error(replay: Any, tracks: list[Track]) -> float:
    """Root mean square over joints and rows of replayed less recorded position, smoothed [rad]."""
    total, count = 0.0, 0
    for track in tracks:
        left = smooth(replay(track) - track.recording.q, track.period)[track.inner]
        total, count = total + float(np.sum(left**2)), count + left.size
    return float(np.sqrt(total / count))


def report(rows: pd.DataFrame) -> str:
    """Shares of the given model's error, then each study in mrad."""
    keys = ["seed", "effect", "robot", "column"]
    wide = rows.set_index([*keys, "method"]).mrad.unstack("method")[list(METHODS)]
    share = wide.div(wide["nothing"], axis=0)
    lowest = wide[list(METHODS[1:])].min(axis=1)
    level = wide.le(np.maximum(LEVEL * lowest, lowest + SAME), axis=0)
    lines = [
        "Replayed motion error over that of the model as given, median [quartiles]; share of"
        f" studies in which a method is lowest or level (within 5 % or {SAME:g} mrad):",
        "",
    ]
    table = []
    for method in METHODS:
        cells = [method]
        for column in TITLES:
            here = share[method].xs(column, level="column")
            low, mid, high = here.quantile([0.25, 0.5, 0.75])
            won = level[method].xs(column, level="column").mean()
            best = "" if method == "nothing" else f", lowest in {100 * won:.0f} %"
            cells.append(f"{mid:.3f} [{low:.3f}, {high:.3f}]{best}")
        seconds = rows[rows.method == method].groupby("seed").seconds.first().median()
        table.append([*cells, "" if method == "nothing" else f"{seconds:.0f}"])
    lines.append(markdown_table(["method", *TITLES.values(), "seconds"], table))
    lines += ["", "Each study [mrad]: as given, ours, mujoco.sysid.", ""]
    table = []
    for (_, effect, robot), some in wide.groupby(level=["seed", "effect", "robot"], sort=False):
        cells = [
            " / ".join(f"{x:.3g}" for x in some.xs(column, level="column").iloc[0])
            for column in TITLES
        ]
        table.append([effect, robot, *cells])
    lines.append(markdown_table(["effect", "robot", *TITLES.values()], table))
    failed = rows[rows.said != ""].drop_duplicates(["seed", "method"])
    lines += [f"- {r.method} on {r.effect}, {r.robot}: {r.said}" for r in failed.itertuples()]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    typer.run(main)
