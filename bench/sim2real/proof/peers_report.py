"""Tables of the comparison with peers, and the picture of black boxes outside their data."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.common.markdown import markdown_table, table_of
from bench.common.whole_files import write_whole
from bench.sim2real.frame.tracks import Array, smooth
from bench.sim2real.proof.peers_study import METHODS, Case, WorldSpec, affected, nothing, one_thread

TITLES = {"validate": "held out", "faster": "faster", "poses": "other poses", "load": "other load"}
LEVEL = 1.05  # times the lowest error is level with it
BLUR = 0.1  # of the noise: errors nearer than this cannot be distinguished in use


def levels(rows: pd.DataFrame, blur: float) -> pd.Series:
    """Whether each row's method is lowest of its study and column, or level with it."""
    lowest = rows.groupby(["seed", "column"]).floors.transform("min")
    return (rows.floors <= LEVEL * lowest) | (rows.floors <= lowest + blur)


def method_table(rows: pd.DataFrame, value: str) -> str:
    """Median with quartiles of `ratio` or `floors`, per method and column."""
    columns = {
        title: lambda some, c=column: quartiles(some[some.column == c][value])
        for column, title in TITLES.items()
    }
    return table_of("method", rows.groupby("method", sort=False), columns)


def level_table(rows: pd.DataFrame) -> str:
    """Share of studies in which a method is lowest or level; and median seconds of its fit."""
    rivals = rows[rows.method != "nothing"]

    def won(some: pd.DataFrame, column: str, blur: float) -> str:
        level = levels(rivals, blur)[some[some.column == column].index]
        return f"{100.0 * float(np.mean(level)):.0f} %"

    columns = {
        title if blur == 0.0 else f"{title}, or within {blur:g} of the noise": partial(
            won, column=column, blur=blur
        )
        for column, title in TITLES.items()
        for blur in (0.0, BLUR)
    }
    columns["seconds"] = lambda some: f"{some.seconds.median():.1f}"
    return table_of("method", rivals.groupby("method", sort=False), columns)


def effect_table(rows: pd.DataFrame, column: str | None) -> str:
    """Median error over the noise by effect and method; of no column: the worst beyond the fit.

    The lowest and those level with it are bold.
    """
    some = rows[rows.column != "validate"] if column is None else rows[rows.column == column]
    keys = ["seed", "effect", "method"]
    worst = some.groupby(keys, sort=False).floors.max().reset_index()
    wide = worst.pivot_table(
        index="effect", columns="method", values="floors", aggfunc="median", sort=False
    )
    table = []
    for effect, values in wide.iterrows():
        lowest = np.nanmin(values)
        level = (values <= LEVEL * lowest) | (values <= lowest + BLUR)
        cells = [
            f"**{short(value)}**" if best else short(value)
            for value, best in zip(values, level, strict=True)
        ]
        table.append([str(effect), *cells])
    return markdown_table(["effect", *map(str, wide.columns)], table)


def not_lowest(rows: pd.DataFrame) -> list[str]:
    """Where ours is neither lowest nor level, a line each, the widest gap first."""
    rivals = rows[rows.method != "nothing"]
    level = levels(rivals, BLUR)
    lost = rivals[(rivals.method == "ours") & ~level]
    lines: list[tuple[float, str]] = []
    for row in lost.itertuples():
        others = rivals[(rivals.seed == row.seed) & (rivals.column == row.column)]
        best = others.loc[others.floors.idxmin()]
        text = (
            f"- {row.effect}, {row.robot}, seed {row.seed}, {TITLES[row.column]}: ours"
            f" {row.floors:.2f} of the noise, {best.method} {best.floors:.2f};"
            f" ours said: {row.said}"
        )
        lines.append((row.floors - best.floors, text))
    return [line for _, line in sorted(lines, reverse=True)]


def quartiles(values: Sequence[float]) -> str:
    """Median [lower quartile, upper quartile]."""
    low, middle, high = np.quantile(values, [0.25, 0.5, 0.75])
    return f"{short(middle)} [{short(low)}, {short(high)}]"


def short(value: float) -> str:
    """Two decimals, or fewer where it is large."""
    return f"{value:.2f}" if value < 10.0 else f"{value:.0f}"


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
    figure = Figure(figsize=(5.2 * (len(cases) + 1), 4.3))
    axes = figure.subplots(1, len(cases) + 1)
    for index, (effect, column, name, label, title) in enumerate(cases):
        robot = "random3" if quick else ("iiwa14", "panda")[index]
        spec = WorldSpec(seed=seed + 400 + index, effect=effect, robot=robot)
        draw_curve(axes[index], curve(spec, column, name), label, title)
    draw_boxes(axes[-1], rows)
    figure.tight_layout()
    write_whole(path, lambda temporary: figure.savefig(temporary, dpi=130, format="png"))


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


def draw_curve(axes: Axes, curve: Curve, label: str, title: str) -> None:
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


def draw_boxes(axes: Axes, rows: pd.DataFrame) -> None:
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
