"""Compares this library with its peers and with the paper, in one run.

    python -m bench.ik.compare [--quick] [--ycb DIR] [--out DIR]

Three experiments: random reachable poses against KDL and a Levenberg-Marquardt method on Pinocchio;
the paper's cluttered scenes; and the paper's algorithm from one start, against a plain scalar
implementation of it. bench/ik/compare/README.md says what the columns mean.
"""

from collections.abc import Callable
from functools import partial
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

import pdoik
from bench.common import commands
from bench.common.grouped import grouped_table, mean
from bench.common.peer_library import build_peers
from bench.common.whole_files import write_whole
from bench.ik.compare.experiments import Compared, plan
from bench.ik.experiment import ARMS, Arm, take_turns, tell
from bench.ik.scenes.around import models_of


def main(
    ycb: commands.YcbFolder = None,
    out: commands.OutFolder = commands.BUILD / "compare",
    quick: Annotated[bool, typer.Option("--quick", help="A tenth of the problems.")] = False,
    robot: Annotated[list[str] | None, typer.Option(help="One of the arms; repeatable.")] = None,
    targets: Annotated[int, typer.Option(min=1, help="Per arm, without obstacles.")] = 1000,
    scenes: Annotated[int, typer.Option(min=1, help="Per arm, with obstacles.")] = 200,
    seed: commands.Seed = 0,
    build: commands.BuildFolder = commands.BUILD,
) -> None:
    """Compare this library with its peers and with the paper, in one run."""
    if quick:
        targets, scenes = max(1, targets // 10), max(1, scenes // 10)
    with commands.plain_errors():
        try:
            models = models_of(commands.setting_of(ycb))
            arms = [Arm.builtin(name) for name in robot or ARMS]
        except (pdoik.PdoikError, ValueError) as error:
            raise RuntimeError(str(error)) from error
        with commands.console.status("building the peers"):
            libraries = build_peers(build)
        source = f"{len(models)} {commands.source_of(ycb)}"
        parts, texts = [], []
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
        with Progress(
            *columns, TimeElapsedColumn(), console=commands.console, transient=True
        ) as progress:
            for each in plan(targets, scenes, models, source, libraries):
                advance = partial(progress.advance, progress.add_task(each.title))
                rows = []
                for index, arm in enumerate(arms):
                    rng = np.random.default_rng([seed, index])
                    rows += solves(arm, each.make(arm, each.count, rng), advance)
                parts.append(pd.DataFrame(rows).assign(block=each.title))
                texts.append(f"**{each.title}.** {each.note}\n\n{table(parts[-1])}")
        trials = pd.concat(parts, ignore_index=True)
        out.mkdir(parents=True, exist_ok=True)
        write_whole(out / "trials.parquet", lambda file: trials.to_parquet(file, index=False))
        tell(out, "\n".join(texts))
        ours = trials[trials.method.isin(["pdoik", "paper"])]
        if (ours.claimed & ~ours.confirmed).any():
            raise typer.Exit(1)


def solves(arm: Arm, compared: Compared, advance: Callable[[int], object]) -> list[dict[str, Any]]:
    """A row for each problem and method, who take turns."""

    def judged(name: str, solve: Any) -> Callable[[Any], dict[str, Any]]:
        def row(problem: Any) -> dict[str, Any]:
            answer = solve(problem)
            confirmed = compared.confirms(problem, answer.q)
            row = {"arm": arm.name, "method": name, **answer.row(), "confirmed": confirmed}
            if name == "plain scalar":  # it makes no claim of its own
                row["claimed"] = confirmed
            prototype = compared.prototype if name == "paper" else ""
            return {**row, "points": len(problem.points), "prototype": prototype}

        return row

    methods = {name: judged(name, solve) for name, solve in compared.methods.items()}
    outcomes = take_turns(methods, compared.problems, advance)
    return [row for rows in outcomes.values() for row in rows]


def table(trials: pd.DataFrame) -> str:
    """A row per arm and method, over all problems, solved or not; ratios are to the first."""
    several = trials.method.nunique() > 1
    first = trials[trials.method == trials.method.iloc[0]].groupby("arm").time

    def at(percent: float) -> Callable[[pd.DataFrame], str]:
        return lambda some: f"{np.percentile(1e6 * some.time, percent):.1f}"

    def ratio(quantile: float) -> Callable[[pd.DataFrame], str]:
        def cell(some: pd.DataFrame) -> str:
            base = first.get_group(some.arm.iloc[0]).quantile(quantile)
            return f"{some.time.quantile(quantile) / base:.2f}"

        return cell

    def solved(some: pd.DataFrame) -> str:
        false = (some.claimed & ~some.confirmed).sum()
        text = f"{(some.claimed & some.confirmed).sum()} / {len(some)}"
        return f"{text} ({false} false)" if false else text

    columns = {
        "solved": solved,
        "median": at(50),
        "p95": at(95),
        "p99": at(99),
        "max [us]": at(100),
        "iterations": mean("iterations", 1),
        "restarts": mean("restarts", 2),
        **({"median x": ratio(0.5), "p95 x": ratio(0.95)} if several else {}),
        **({} if several else {"points": mean("points", 0)}),
    }
    if trials.prototype.any():
        columns["prototype"] = lambda some: some.prototype.iloc[0]
    return grouped_table(trials, {"arm": "arm", "method": "method"}, columns)


if __name__ == "__main__":
    typer.run(main)
