"""Figures about the study as a whole: joints, regimes, hypotheses, cut-off."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pdoik.sim2real.findings import Diagnosis, JointFit

from .data import CutoffInfluence, Hypothesis, RegimeMap, ReportData
from .style import AFTER, BEFORE, GRID, INK, MUTED, NOISE, Picture, picture, quiet_legend, short
from .words import DASH, effect_name, number

FOREST = 24  # rows of the forest plot
LOWEST = -0.35  # scores below are drawn as an arrow


def joints_picture(diagnosis: Diagnosis) -> Picture:
    """Residual of each joint before and after, with its noise floor."""
    fits = diagnosis.joints
    height = 0.85 + 0.40 * max(len(fits), 1)
    figure = Figure(figsize=(10.6, height))
    axes = figure.add_axes((0.13, 0.5 / height, 0.85, (height - 0.78) / height))
    joint_bars(axes, fits)
    quiet_legend(axes)
    return picture(
        figure, "joints", "Residual of each joint on held-out data, in units of its noise floor."
    )


def joint_bars(axes: Axes, fits: dict[str, JointFit], room: float = 1.25) -> None:
    """Bars from before to after, in multiples of the noise floor; `room` is for the numbers."""
    names = list(fits)
    rows = np.arange(len(names))[::-1]
    before, after = (
        np.array([_ratio(getattr(fit, which), fit.noise_floor) for fit in fits.values()])
        for which in ("before", "after")
    )
    axes.hlines(rows, after, before, color=NOISE, lw=2.4, zorder=1)
    axes.plot(before, rows, "o", color=BEFORE, ms=7, label="before")
    axes.plot(after, rows, "o", color=AFTER, ms=7, label="after")
    axes.axvline(1.0, color=MUTED, lw=1.2, ls=(0, (4, 2)), label="noise floor")
    for fit, row, right in zip(fits.values(), rows, np.fmax(before, after), strict=True):
        text = f"{number(fit.before)} → {number(fit.after)} {fit.unit}"
        if np.isfinite(right):
            axes.annotate(
                text, (right, row), (9, 0), textcoords="offset points", va="center", fontsize=8,
                color=MUTED,
            )  # fmt: skip
    top = float(np.nanmax([*before, *after, 1.5]))
    if top > 12:
        axes.set_xscale("log")
        _plain_log(axes, "x")
        axes.set_xlim(0.6, 0.6 * (top / 0.6) ** room)
    else:
        axes.set_xlim(0, (1.6 * room - 0.6) * top)
    axes.set_yticks(rows, [short(name, 18) for name in names], color=INK)
    axes.set_ylim(-0.6, len(names) - 0.4)
    axes.set_xlabel("root mean square residual / noise floor")
    axes.grid(visible=False, axis="y")


def _ratio(value: float, floor: float) -> float:
    return value / floor if floor > 0 else float("nan")


def _plain_log(axes: Axes, which: str) -> None:
    axis = axes.xaxis if which == "x" else axes.yaxis
    axis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.set_minor_formatter(lambda value, _: "")


def regimes_picture(data: ReportData, regimes: RegimeMap, fits: dict[str, JointFit]) -> Picture:
    """The heat map of joint by regime."""
    n, m = regimes.share.shape
    height = 0.62 + 0.46 * n
    figure = Figure(figsize=(10.6, height))
    axes = figure.add_axes((0.13, 0.05 / height, 0.865, (height - 0.62) / height))
    quantities = [quantity for quantity, _ in regimes.bins]
    left, edges = [], []
    x = 0.0
    for k in range(m):
        if k and quantities[k] != quantities[k - 1]:
            x += 0.35
        left.append(x)
        x += 1.0
    for i in range(n):
        fit = fits.get(data.joints[i])
        quiet = fit is not None and fit.before <= 1.25 * fit.noise_floor
        for k in range(m):
            _cell(axes, left[k], n - 1 - i, regimes, i, k, quiet)
    for k in range(m):
        axes.text(left[k] + 0.5, n + 0.08, regimes.bins[k][1], ha="center", va="bottom",
                  fontsize=7.5, color=MUTED)  # fmt: skip
        if k == 0 or quantities[k] != quantities[k - 1]:
            last = max(j for j in range(m) if quantities[j] == quantities[k])
            edges.append((left[k] + left[last] + 1) / 2)
            axes.text(edges[-1], n + 0.62, quantities[k], ha="center", va="bottom", fontsize=9,
                      weight="bold", color=INK)  # fmt: skip
    axes.set(xlim=(0, x), ylim=(0, n))
    names = [short(name, 18) for name in data.joints]
    axes.set_yticks(n - 0.5 - np.arange(n), names, color=INK)
    axes.set_xticks([])
    axes.grid(visible=False)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.tick_params(length=0)
    caption = (
        "Share of each joint's squared residual (before the findings) by regime; within a quantity"
        " the shares add up to 100 %."
    )
    if regimes.visited is not None:
        caption += (
            " Small: share of the time spent there. Coloured where the residual's share is larger"
            " than the time's."
        )
    return picture(figure, "regimes", f"{caption} Pale rows are within their noise.")


def _cell(axes: Axes, x: float, y: float, regimes: RegimeMap, i: int, k: int, quiet: bool) -> None:
    share = regimes.share[i, k]
    visited = 1.0 if regimes.visited is None else float(regimes.visited[i, k])
    axes.add_patch(Rectangle((x + 0.02, y + 0.04), 0.96, 0.92, facecolor=GRID, alpha=0.45, lw=0))
    if not np.isfinite(share) or visited == 0:
        axes.text(x + 0.5, y + 0.5, DASH, ha="center", va="center", fontsize=8, color=MUTED)
        return
    strength = _strength(float(share), None if regimes.visited is None else visited)
    if quiet:
        strength *= 0.25
    axes.add_patch(
        Rectangle((x + 0.02, y + 0.04), 0.96, 0.92, facecolor=BEFORE, alpha=strength, lw=0)
    )
    tiny = regimes.visited is not None
    color = MUTED if quiet else INK
    axes.text(x + 0.5, y + (0.64 if tiny else 0.5), f"{100 * share:.0f} %", ha="center",
              va="center", fontsize=8.5, color=color)  # fmt: skip
    if tiny:
        axes.text(x + 0.5, y + 0.26, f"{100 * visited:.0f} %", ha="center", va="center",
                  fontsize=6.5, color=color)  # fmt: skip


def _strength(share: float, visited: float | None) -> float:
    """Strength of the colour, 0 to 0.85: the share, or how far it exceeds that of the time."""
    excess = share if visited is None else share / visited - 1
    return 0.85 * min(max(excess, 0.0), 1.0)


def hypotheses_picture(hypotheses: Sequence[Hypothesis]) -> Picture:
    """Forest plot: held-out score with its interval, accepted ones and the best of the rest."""
    shown = forest_rows(hypotheses, FOREST)
    height = 0.85 + 0.265 * len(shown)
    figure = Figure(figsize=(10.6, height))
    axes = figure.add_axes((0.30, 0.5 / height, 0.68, (height - 0.8) / height))
    forest(axes, shown)
    quiet_legend(axes)
    left_out = len(hypotheses) - len(shown)
    rest = f" {left_out} with lower scores are in the table only." if left_out else ""
    caption = (
        "Hypotheses tried, by what each gains on held-out data given everything that was found,"
        f" with 95 % intervals.{rest}"
    )
    return picture(figure, "hypotheses", caption)


def forest_rows(hypotheses: Sequence[Hypothesis], most: int) -> list[Hypothesis]:
    """The accepted first, then the others; each by score."""

    def rank(hypothesis: Hypothesis) -> tuple[bool, float]:
        return not hypothesis.accepted, -float(np.nan_to_num(hypothesis.score, nan=-np.inf))

    return sorted(hypotheses, key=rank)[:most]


def forest(axes: Axes, shown: Sequence[Hypothesis], width: int = 44) -> None:
    """Draw the rows from top to bottom."""
    rows = np.arange(len(shown))[::-1]
    right = max([0.1, *(each.interval95[1] for each in shown if np.isfinite(each.interval95[1]))])
    axes.axvline(0, color=MUTED, lw=1.0)
    lowest = min([0.0, *(each.interval95[0] for each in shown if np.isfinite(each.interval95[0]))])
    lowest = max(lowest, LOWEST)
    labelled = set()
    for each, row in zip(shown, rows, strict=True):
        color = AFTER if each.accepted else NOISE
        low, high = each.interval95
        label = "accepted" if each.accepted else "not accepted"
        axes.plot(
            [max(low, lowest), max(high, lowest)], [row, row], color=color, lw=2.0,
            solid_capstyle="butt",
        )  # fmt: skip
        inside = each.score >= lowest
        axes.plot(
            [max(each.score, lowest)], [row], marker="o" if inside else "<", ls="", ms=5.5,
            color=color, label=None if label in labelled else label,
        )  # fmt: skip
        labelled.add(label)
    names = [short(f"{effect_name(each.effect)}, {each.place}", width) for each in shown]
    axes.set_yticks(rows, names)
    for tick, each in zip(axes.get_yticklabels(), shown, strict=True):
        tick.set_color(INK if each.accepted else MUTED)
    pad = 0.04 * (right - lowest)
    axes.set(xlim=(lowest - pad, right + pad), ylim=(-0.7, len(shown) - 0.3))
    axes.set_xlabel("gain on held-out data [share of the mean square residual]")
    axes.grid(visible=False, axis="y")


def cutoff_picture(data: ReportData, cutoff: CutoffInfluence) -> Picture:
    """Residual by the filter's cut-off, a panel for each joint."""
    n = len(data.joints)
    columns = min(n, 4)
    lines = -(-n // columns)
    height = 0.75 + 1.75 * lines
    figure = Figure(figsize=(10.6, height))
    grid = figure.add_gridspec(
        lines, columns, left=0.055, right=0.99, top=1 - 0.42 / height, bottom=0.42 / height,
        wspace=0.28, hspace=0.55,
    )  # fmt: skip
    for joint in range(n):
        axes = figure.add_subplot(grid[joint // columns, joint % columns])
        before, after = cutoff.before[:, joint], cutoff.after[:, joint]
        axes.plot(cutoff.frequency, before, "o-", ms=3.5, color=BEFORE, label="before")
        axes.plot(cutoff.frequency, after, "o-", ms=3.5, color=AFTER, label="after")
        if cutoff.chosen is not None:
            axes.axvline(cutoff.chosen, color=MUTED, lw=1, ls=(0, (4, 2)), label="chosen")
        axes.set_xscale("log")
        axes.set_xticks(cutoff.frequency, [f"{value:.2g}" for value in cutoff.frequency])
        axes.minorticks_off()
        axes.set_ylim(0, reach_up(before, after))
        axes.set_title(f"{short(data.joints[joint], 20)} [{data.units[joint]}]")
        if joint // columns == lines - 1:
            axes.set_xlabel("cut-off [Hz]")
        if joint == columns - 1:
            axes.legend(loc="best", fontsize=7.5)
    return picture(figure, "cutoff", "Root mean square residual on held-out data by cut-off.")


def reach_up(*series: np.typing.NDArray[np.float64]) -> float:
    """Top of an axis from zero that holds them all."""
    values = np.concatenate([each[np.isfinite(each)] for each in series])
    return 1.12 * float(values.max()) if values.size and values.max() > 0 else 1.0
