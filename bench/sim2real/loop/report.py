"""Tables and the picture of what closing the loop is worth."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.common.markdown import markdown_table
from bench.common.whole_files import write_whole

GEOMETRY = ("joint_offset", "kinematic_error", "several_at_once")


def per_world(rows: pd.DataFrame) -> pd.DataFrame:
    """One row per world: figures of each way over its paths [mm], and the share removed."""
    worlds = []
    for (effect, seed), some in rows.groupby(["effect", "seed"], sort=False):
        world = {"effect": effect, "seed": seed, "seconds": some.seconds.iloc[0]}
        planned = some[some.way == "floor"].sort_values("path").clearance.to_numpy()
        for way, runs in some.groupby("way", sort=False):
            runs = runs.sort_values("path")
            world[f"rms_{way}"] = 1e3 * float(np.sqrt(np.mean(runs.rms**2)))
            world[f"largest_{way}"] = 1e3 * float(runs.largest.max())
            world[f"clearance_{way}"] = 1e3 * float(runs.clearance.min())
            world[f"lost_{way}"] = 1e3 * float(np.max(planned - runs.clearance.to_numpy()))
            world[f"reach_{way}"] = 1e3 * float(runs.reach.max())
        before, after = world["rms_given"], world["rms_diagnosed"]
        world["less"] = 1.0 - after / before
        world["removed"] = 1.0 - (after - world["rms_floor"]) / (before - world["rms_floor"])
        worlds.append(world)
    return pd.DataFrame(worlds)


def main_table(rows: pd.DataFrame) -> str:
    """One row per effect: medians over its worlds, and the worst world."""
    header = ["concealed", "worlds", "PD alone: tip error rms", "given model fed forward"]
    header += ["diagnosed model fed forward", "nothing concealed", "less, median (worst)"]
    header += ["of what could go, median (worst)", "largest error before", "after"]
    header += ["clearance lost before", "after"]
    table = []
    for effect, some in per_world(rows).groupby("effect", sort=False):
        rms = [f"{some[f'rms_{way}'].median():.3g}" for way in ("pd", "given")]
        after = f"{some.rms_diagnosed.median():.3g} ({some.rms_diagnosed.max():.3g})"
        shares = [f"{100 * some[c].median():.1f} % ({100 * some[c].min():.1f} %)" for c in SHARES]
        largest = [f"{some[f'largest_{way}'].max():.3g}" for way in ("given", "diagnosed")]
        lost = [f"{max(some[f'lost_{way}'].max(), 0.0):.2g}" for way in ("given", "diagnosed")]
        floor = f"{some.rms_floor.median():.2g}"
        table.append([effect, len(some), *rms, after, floor, *shares, *largest, *lost])
    intro = (
        "Millimetres. Tip errors are of the true tip from the wanted path at the same time, root "
        "mean squares over the paths of a world, medians over worlds (worst in brackets); largest "
        "error and lost clearance are the worst of all worlds. Clearance lost is against the same "
        "path of a machine in which nothing is concealed."
    )
    return f"{intro}\n\n{markdown_table(header, table)}"


SHARES = ("less", "removed")


def reach_table(rows: pd.DataFrame) -> str:
    """How far the solver's own solutions are from the real targets, standing still."""
    worlds = per_world(rows)
    table = []
    for effect, some in worlds[worlds.effect.isin(GEOMETRY)].groupby("effect", sort=False):
        before, after = some.reach_given, some.reach_diagnosed
        times = (before / after).to_numpy()
        table.append(
            [
                effect,
                len(some),
                f"{before.median():.3g} ({before.max():.3g})",
                f"{after.median():.2g} ({after.max():.2g})",
                f"{np.median(times):.0f} ({times.min():.0f})",
            ]
        )
    if not table:
        return ""
    header = ["concealed", "worlds", "given URDF: largest error at the targets"]
    header += ["improved URDF", "times better"]
    intro = (
        "Solutions of the solver at rest on the true machine (MuJoCo's kinematics of it), largest "
        "error along the paths [mm], median and worst world:"
    )
    return f"{intro}\n\n{markdown_table(header, table)}"


def details(rows: pd.DataFrame) -> str:
    """Lists for each world what was hidden, what was said, and what came of it."""
    lines = []
    first = rows.groupby(["effect", "seed"], sort=False).first()
    for world in per_world(rows).itertuples():
        words = first.loc[(world.effect, world.seed)]
        lines += [
            f"- {world.effect}, seed {world.seed}: rms {world.rms_pd:.3g} (PD), "
            f"{world.rms_given:.3g}, {world.rms_diagnosed:.3g}, floor {world.rms_floor:.2g} mm; "
            f"least clearance {world.clearance_given:.1f}, {world.clearance_diagnosed:.1f}, "
            f"{world.clearance_floor:.1f} mm; diagnosis {world.seconds:.0f} s",
            f"  - hidden: {words.hidden}",
            f"  - found: {words.said}",
        ]
    return "\n".join(lines) + "\n"


COLORS = {"pd": "0.6", "given": "tab:red", "diagnosed": "tab:blue", "floor": "black"}
WORDS = {
    "pd": "PD and gravity compensation alone",
    "given": "given model fed forward",
    "diagnosed": "diagnosed model fed forward",
    "floor": "nothing concealed, true model",
}
SHOWN = ("coulomb_friction", "command_delay", "kinematic_error", "several_at_once")
STEP = 0.02  # of the stored errors [s]


def write_picture(rows: pd.DataFrame, path: Path) -> None:
    """Left all effects, right the error over time of a path in the first world of some."""
    effects = list(dict.fromkeys(rows.effect))
    shown = [name for name in SHOWN if name in effects] or effects[:4]
    height = max(4.2, 0.42 * len(effects) + 1.6)
    figure = Figure(figsize=(12.5, height), layout="constrained")
    grid = figure.add_gridspec(len(shown), 2, width_ratios=[1.15, 1.0])
    left = figure.add_subplot(grid[:, 0])
    _by_effect(left, per_world(rows), effects)
    figure.legend(loc="outside upper center", ncols=4, fontsize=9, frameon=False)
    axes: list[Axes] = []
    for k, effect in enumerate(shown):
        axes.append(figure.add_subplot(grid[k, 1], sharex=axes[0] if axes else None))
        _over_time(axes[-1], rows[rows.effect == effect], effect)
        axes[-1].tick_params(labelbottom=k == len(shown) - 1)
    axes[-1].set_xlabel("time since the arm set out on a path the diagnosis never saw [s]")
    write_whole(path, lambda temporary: figure.savefig(temporary, dpi=110, format="png"))


def _by_effect(axes: Axes, worlds: pd.DataFrame, effects: list[str]) -> None:
    """A dot per world, a bar at the median."""
    for row, effect in enumerate(effects):
        some = worlds[worlds.effect == effect]
        for shift, (way, color) in zip((-0.24, -0.08, 0.08, 0.24), COLORS.items(), strict=True):
            values = some[f"rms_{way}"].to_numpy()
            label = WORDS[way] if row == 0 else None
            at = np.full(len(values), row + shift)
            axes.plot(values, at, "o", color=color, ms=4, alpha=0.75, label=label)
            axes.plot(
                2 * [np.median(values)], [row + shift - 0.09, row + shift + 0.09], color=color
            )
    axes.set_xscale("log")
    axes.set_yticks(range(len(effects)), [name.replace("_", " ") for name in effects])
    axes.set_ylim(len(effects) - 0.5, -0.5)
    axes.grid(axis="x", which="major", color="0.88")
    axes.set_axisbelow(True)
    axes.set_xlabel("tip error, root mean square over new paths [mm]; a dot is a machine")


def _over_time(axes: Axes, rows: pd.DataFrame, effect: str) -> None:
    seed = rows.seed.iloc[0]
    for run in rows[(rows.seed == seed) & (rows.path == 0)].itertuples():
        error = 1e3 * np.asarray(run.error)
        axes.plot(STEP * np.arange(len(error)), error, color=COLORS[run.way], lw=1.0)
    axes.set_yscale("log")
    axes.set_ylim(1e-3, 60.0)
    axes.set_ylabel("[mm]")
    axes.set_title(f"tip error: {effect.replace('_', ' ')}", fontsize=9, loc="left")
    axes.grid(axis="y", color="0.9")
