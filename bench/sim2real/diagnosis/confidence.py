"""How sure findings are: weights of the confidence, and whether it means what it says.

    python -m bench.sim2real.diagnosis.confidence RUN... --fit   weights from runs
    python -m bench.sim2real.diagnosis.confidence machines/said-TOOL ... --fit
    python -m bench.sim2real.diagnosis.confidence RUN... --out FILE   a diagram

A run is a folder of ../proof with studies.parquet, or of what was said of opened
worlds of ../machines. A finding is true where one of the study's hidden effects has its name and
place; where a channel lies, or a cause has no name in the catalogue, where it is at the hidden
joint, of the latter without a name; of machines also what their background has. What is suspected
for other reasons than its confidence is left out: no confidence is asked of it.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, cast

import numpy as np
import pandas as pd
import typer
from matplotlib.figure import Figure
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy import optimize

from bench.common.intervals import wilson
from bench.common.whole_files import write_whole
from bench.sim2real.concealed.score import last_link, same
from bench.sim2real.frame.score import as_diagnosis, by_confidence
from bench.sim2real.machines.score import judged
from pdoik.sim2real import Support
from pdoik.sim2real.effects import Unknown
from pdoik.sim2real.identify import features
from pdoik.sim2real.thresholds import ConfidenceThresholds

_PRIOR = 0.5  # inverse variance of the weights, about the default's signs
_EDGES = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0)
console = Console(width=120)


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """One finding, what it was said to be sure of, and whether it is true."""

    study: str
    effect: str
    support: Support | None
    confidence: float
    true: bool


def claims(run: Path) -> list[Claim]:
    """Findings and suspicions of every study of a run."""
    if not (run / "studies.parquet").exists():
        return _of_machines(run)
    rows = pd.read_parquet(run / "studies.parquet")
    found = []
    for row in rows.itertuples():
        hidden = json.loads(row.hidden)
        joints = list(json.loads(row.joints))
        said = [*json.loads(row.findings), *json.loads(getattr(row, "suspected", None) or "[]")]
        for each in said:
            true = _is_true(each, hidden, last_link(joints), str(row.group))
            found.append(_claim(f"{run.name}/{row.name}", each, true=true))
    return found


def _of_machines(said: Path) -> list[Claim]:
    """Claims of a folder of diagnoses of machines; the truths lie in the folder next to it."""
    found = []
    for path in sorted(said.glob("*.json")):
        truth = json.loads((said.parent / "sealed" / path.name).read_text())
        diagnosis = as_diagnosis(json.loads(path.read_text()))
        for each in [*diagnosis["findings"], *diagnosis.get("suspected", [])]:
            true = judged(each, truth)["right"]
            found.append(_claim(f"{said.parent.name}/{path.stem}", each, true=true))
    return found


def _claim(study: str, said: dict[str, Any], *, true: bool) -> Claim:
    support = Support(**said["support"]) if said.get("support") else None
    return Claim(
        study=study,
        effect=said["effect"],
        support=support,
        confidence=said["confidence"],
        true=true,
    )


def _is_true(finding: dict[str, Any], hidden: list[dict[str, Any]], last: str, group: str) -> bool:
    if group in ("lying", "outside"):  # of the latter what has no name at its joint
        right = group == "lying" or finding["effect"] == Unknown.id
        return bool(hidden) and right and finding["joints"][:1] == hidden[0]["joints"][:1]
    return any(same(finding, each, last) for each in hidden)


def fitted(known: list[Claim]) -> dict[str, float]:
    """Weights of the largest penalised likelihood, one per feature."""
    capped = ConfidenceThresholds().suspected
    supported = [
        c
        for c in known
        if c.support is not None and "odds" in features(c.support) and c.confidence != capped
    ]
    names = list(features(cast("Support", supported[0].support)))
    A = np.array([list(features(cast("Support", c.support)).values()) for c in supported])
    true = np.array([c.true for c in supported])
    start = np.array([getattr(ConfidenceThresholds(), name) for name in names])

    def cost(weights: NDArray[np.float64]) -> float:
        odds = np.where(true, 1.0, -1.0) * (A @ weights)
        return float(np.sum(np.logaddexp(0.0, -odds)) + 0.5 * _PRIOR * np.sum(weights[1:] ** 2))

    found = optimize.minimize(cost, start).x
    return {name: round(float(w), 2) for name, w in zip(names, found, strict=True)}


def reliability(known: list[Claim]) -> list[tuple[str, int, float, float, tuple[float, float]]]:
    """Rows by stated confidence: findings, mean stated, share true and its 95 % interval."""
    stated = np.array([c.confidence for c in known])
    true = np.array([c.true for c in known])
    rows = []
    for name, at in by_confidence(stated, _EDGES):
        count, right = int(at.sum()), int(true[at].sum())
        interval = wilson(right, count)
        rows.append((name, count, float(stated[at].mean()), right / count, interval))
    return rows


def drawn(known: dict[str, list[Claim]], path: Path) -> None:
    """The reliability diagram, one line per kind of world."""
    figure = Figure(figsize=(5.5, 5.0), layout="constrained")
    axes = figure.subplots()
    axes.plot([0.0, 1.0], [0.0, 1.0], color="0.7", lw=1, label="as it should be")
    for name, some in known.items():
        rows = reliability(some)
        x, y = [row[2] for row in rows], np.array([row[3] for row in rows])
        ends = np.array([row[4] for row in rows]).T
        bars = np.abs(ends - y)
        axes.errorbar(x, y, yerr=bars, marker="o", capsize=3, label=f"{name}: {len(some)} findings")
    axes.set(
        xlabel="stated confidence", ylabel="share that is true", xlim=(0, 1.02), ylim=(0, 1.02)
    )
    axes.legend(loc="upper left", frameon=False)
    write_whole(path, lambda temporary: figure.savefig(temporary, dpi=140))


def main(
    runs: Annotated[list[Path], typer.Argument(help="Folders of bench.sim2real.proof, scored.")],
    fit: Annotated[bool, typer.Option("--fit", help="Print weights fitted to these.")] = False,
    out: Annotated[Path | None, typer.Option(help="Picture of the reliability.")] = None,
) -> None:
    """Fit the weights, or show whether stated confidences hold."""
    known = {run.name: claims(run) for run in runs}
    everything = [c for some in known.values() for c in some]
    if fit:
        console.print(fitted(everything))
        bare = [c for c in everything if c.support is None or not c.support.sessions]
        console.print(f"without support: {sum(c.true for c in bare)} true of {len(bare)}")
    for name, some in [*known.items(), ("all", everything)]:
        table = Table("stated", "findings", "mean stated", "true", "95 % interval", title=name)
        for said, count, mean, share, (low, high) in reliability(some):
            table.add_row(
                said, str(count), f"{mean:.3f}", f"{share:.3f}", f"{low:.3f} to {high:.3f}"
            )
        console.print(table)
    if out is not None:
        drawn(known, out)


if __name__ == "__main__":
    typer.run(main)
