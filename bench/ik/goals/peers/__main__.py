"""The row `peers` of bench.ik.goals, and its own table.

    python -m bench.ik.goals.peers --out build/bench/goals_peers

It needs the extra `peers`; those that are not installed are left out.
"""

import numpy as np
import pandas as pd
import typer

from bench.common import commands
from bench.common.grouped import grouped_table, time_at
from bench.ik.experiment import tell
from bench.ik.goals import peers
from bench.ik.lines import share
from bench.ik.rows import measure


def main(
    out: commands.OutFolder = commands.BUILD / "goals_peers",
    quick: commands.Quick = False,
    seed: commands.Seed = 0,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = 1,
) -> None:
    """Measure, and make the table."""
    folder = out.with_name(out.name + "-quick") if quick else out

    def kept(_: str, trials: pd.DataFrame) -> None:
        tell(folder, f"Seed {seed}.\n\n**Peers**\n\n{table(trials)}", name="peers")

    rows = {"peers": peers}
    more = {"seed": seed, "scheduler": scheduler, "workers": workers}
    measure("goals", rows, None, out, quick=quick, kept=kept, **more)


def table(trials: pd.DataFrame) -> str:
    """A row for each problem and solver."""
    ours = trials[trials.solver == "pdoik"].groupby("problem").time.median()

    def ratio(some: pd.DataFrame) -> str:
        return f"{some.time.median() / ours[some.problem.iloc[0]]:.0f}"

    def excess(some: pd.DataFrame) -> str:
        left = 100 * some.error[np.isfinite(some.error)]
        ends = (round(left.median(), 1) + 0.0, round(left.max(), 1) + 0.0)  # no minus zero
        return "{:.1f} %, {:.1f} %".format(*ends) if len(left) else ""

    return grouped_table(
        trials,
        {"problem": "problem", "version": "solver"},
        {
            "n": len,
            "solved": lambda some: share(some.solved, len(some)),
            "wrong": lambda some: int(some.wrong.sum()),
            "median": time_at(0.5),
            "p99": time_at(0.99),
            "median x": ratio,
            "error over the least: median, worst": excess,
        },
        order={"problem": list(dict.fromkeys(trials.problem))},
    )


if __name__ == "__main__":
    typer.run(main)
