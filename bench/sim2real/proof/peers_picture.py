"""The picture of the black box outside its data: over speed, over position, over all studies."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd

from bench.common.whole_files import write_whole
from bench.sim2real.proof.peers_data import Array, smooth
from bench.sim2real.proof.peers_report import TITLES
from bench.sim2real.proof.peers_study import METHODS, Case, WorldSpec, affected, nothing, one_thread

mpl.use("Agg")
import matplotlib.pyplot as plt

BINS = 40
SHOWN = {"ours": "tab:blue", "gradient boosting": "tab:red", "network": "tab:orange"}
MOST = 3.0  # of the ratio's axis


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """Missing torque of one joint over one quantity, in bins."""

    at: Array  # (B,) middle of the bins
    values: dict[str, Array]  # (B,) by name, "truth" among them [N m]
    fitted: tuple[float, float]  # what the fit had seen of the quantity
    joint: str
    spec: WorldSpec


def picture(path: Path, rows: pd.DataFrame, seed: int, *, quick: bool) -> None:
    """Write it; in the quick version without the second curve."""
    cases = [("viscous_friction", "faster", "dq", "speed [rad/s]", "faster than the fit")]
    cases += [
        ("position_dependent_spring", "poses", "q", "position [rad]", "in poses beside the fit's")
    ]
    cases = cases[:1] if quick else cases
    figure, axes = plt.subplots(1, len(cases) + 1, figsize=(5.2 * (len(cases) + 1), 4.3))
    for index, (effect, column, name, label, title) in enumerate(cases):
        robot = "random3" if quick else ("iiwa14", "panda")[index]
        spec = WorldSpec(seed=seed + 400 + index, effect=effect, robot=robot)
        draw_curve(axes[index], curve(spec, column, name), label, title)
    draw_boxes(axes[-1], rows)
    figure.tight_layout()
    write_whole(path, lambda temporary: figure.savefig(temporary, dpi=130, format="png"))
    plt.close(figure)


def curve(spec: WorldSpec, column: str, name: str) -> Curve:
    """A world made, fitted and predicted at a condition beyond the fit."""
    with tempfile.TemporaryDirectory(prefix="pdoik-peers-") as folder, one_thread():
        case = Case(Path(folder), spec)
        before = case.errors(nothing(case.study, case.fit, case.choose))
        shown = np.where(affected(before), before[column], 0.0)
        joint, track = int(np.argmax(shown)), case.columns[column][0]
        here, inner = getattr(track, name)[:, joint], track.inner

        def of(tau: Array) -> Array:
            return (smooth(tau, track.period) - track.model)[inner, joint]

        added = {"truth": of(case.true(track))}
        for method in SHOWN:
            predict = METHODS[method][0](case.study, case.fit, case.choose)
            added[method] = of(predict(track))
        seen = np.concatenate([getattr(t, name)[t.inner, joint] for t in case.fit])
        return binned(here[inner], added, seen, case.study.joints[joint], spec)


def binned(at: Array, added: dict[str, Array], seen: Array, joint: str, spec: WorldSpec) -> Curve:
    """Medians in bins of equal width that hold enough rows."""
    edges = np.linspace(at.min(), at.max(), BINS + 1)
    which = np.clip(np.digitize(at, edges) - 1, 0, BINS - 1)
    full = [b for b in range(BINS) if np.count_nonzero(which == b) > 5]
    return Curve(
        at=np.array([np.median(at[which == b]) for b in full]),
        values={
            key: np.array([np.median(tau[which == b]) for b in full]) for key, tau in added.items()
        },
        fitted=(float(seen.min()), float(seen.max())),
        joint=joint,
        spec=spec,
    )


def draw_curve(axes: plt.Axes, curve: Curve, label: str, title: str) -> None:
    """The truth, and what each method makes of it; what the fit has seen is shaded."""
    axes.axvspan(*curve.fitted, color="0.9", label="seen in the fit")
    axes.plot(
        curve.at, curve.values["truth"], color="black", linewidth=4, alpha=0.35, label="truth"
    )
    for method, colour in SHOWN.items():
        axes.plot(curve.at, curve.values[method], color=colour, linewidth=1.6, label=method)
    axes.set_xlabel(f"{curve.joint} {label}")
    axes.set_ylabel("torque the model misses [N m]")
    axes.set_title(f"{curve.spec.effect.replace('_', ' ')}, {curve.spec.robot}: {title}")
    axes.title.set_fontsize(9.5)
    axes.legend(fontsize=8)


def draw_boxes(axes: plt.Axes, rows: pd.DataFrame) -> None:
    """Error over that of the model as given, by column; a box has the quartiles."""
    rows = rows[rows.seen]
    width = 0.8 / len(SHOWN)
    for index, (method, colour) in enumerate(SHOWN.items()):
        some = rows[rows.method == method]
        ratios = [some[some.column == column].ratio.to_numpy() for column in TITLES]
        places = np.arange(len(TITLES)) + (index - 0.5 * (len(SHOWN) - 1)) * width
        boxes = axes.boxplot(
            [np.minimum(r, MOST) for r in ratios],
            positions=places,
            widths=0.85 * width,
            patch_artist=True,
            showfliers=True,
            flierprops={"markersize": 3, "markeredgecolor": colour},
            medianprops={"color": "black"},
        )
        for box in boxes["boxes"]:
            box.set(facecolor=colour, alpha=0.6)
        axes.plot([], [], color=colour, linewidth=6, alpha=0.6, label=method)
    axes.axhline(1.0, color="0.5", linestyle="--", linewidth=1, label="model as given")
    axes.set_xticks(range(len(TITLES)), list(TITLES.values()))
    axes.set_ylim(0.0, MOST * 1.03)
    axes.set_ylabel(f"error / error of the model as given (cut at {MOST:g})")
    axes.set_title(f"{rows.seed.nunique()} studies", fontsize=9.5)
    axes.legend(fontsize=8, loc="upper left")
