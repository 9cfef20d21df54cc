"""What confidences of `pdoik compare` are worth, and the two figures that they are made with.

    python -m bench.sim2real.simulators.confidence build/bench/simulators_dev ...

Folders are those of sealed.py with seeds of development. Every finding that holds
on held-out data, claimed or not, is true or false by the answers; its log odds are fitted as a line
over the log odds of its gain, by logistic regression with a weak prior on both (standard deviation
3), for findings are few.
"""

from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
import typer
from scipy.optimize import minimize

from bench.common.commands import show
from bench.common.intervals import share
from bench.common.markdown import markdown_table
from bench.sim2real.frame.score import by_confidence
from bench.sim2real.simulators.scores import unfolded

PRIOR = 3.0  # standard deviation of base and slope


def main(folders: Annotated[list[Path], typer.Argument(help="Of development's pairs.")]) -> None:
    """Fit, and print how true findings are by confidence."""
    worlds = [pd.read_parquet(path) for each in folders for path in each.glob("worlds-*.parquet")]
    rows = unfolded(pd.concat(worlds), "findings")
    gain = np.clip(rows.gain.to_numpy(dtype=float), 1e-4, 1.0 - 1e-4)
    true = (rows.right != "").to_numpy()
    base, slope = fitted(np.log(gain / (1.0 - gain)), true)
    show(f"{len(rows)} findings, {true.sum()} true: base {base:.2f}, per_gain {slope:.2f}\n")
    table = [
        (name, share(true[inside]))
        for name, inside in by_confidence(rows.confidence.to_numpy(), (0, 0.5, 0.75, 0.9, 0.97, 1))
    ]
    show(markdown_table(("confidence", "true"), table))


def fitted(x: np.ndarray, true: np.ndarray) -> tuple[float, float]:
    """Base and slope of the log odds, the most probable ones."""

    def loss(p: np.ndarray) -> float:
        z = np.where(true, 1.0, -1.0) * (p[0] + p[1] * x)
        return float(np.logaddexp(0.0, -z).sum() + 0.5 * (p @ p) / PRIOR**2)

    base, slope = minimize(loss, np.zeros(2)).x
    return float(base), float(slope)


if __name__ == "__main__":
    typer.run(main)
