"""The tables of bench/ik/clouds/__main__.py."""

import numpy as np
import pandas as pd

from bench.common.intervals import duration
from bench.common.markdown import markdown_table
from bench.ik.clouds.structures import COAL, OURS, VOXEL
from bench.ik.experiment import ARMS

DIAGONAL = np.sqrt(3.0) * VOXEL  # how far a voxel may reach beyond the point in it [m]


def all_tables(rows: pd.DataFrame, seed: int) -> str:
    """One text."""
    parts = {
        f"Intake, processor time, seed {seed}": intake_table(rows),
        "Memory": memory_table(rows),
        "Update of a hundredth": update_table(rows),
        "Questions about a configuration, median processor time": query_table(rows),
        "Do free and touching agree with ours?": agreement_table(rows),
        "A solve, in C++": solve_table(rows),
    }
    if (rows.kind == "capt").any():
        parts["VAMP: Panda as its 59 spheres, by points or by itself"] = capt_table(rows)
    return "\n".join(f"**{title}**\n\n{table}" for title, table in parts.items())


def intake_table(rows: pd.DataFrame) -> str:
    """A row per structure and size."""
    some = rows[rows.kind == "intake"]
    medians = some.groupby(["name", "points"], sort=False).time.median()
    table = []
    for (name, points), group in some.groupby(["name", "points"], sort=False):
        median = medians[name, points]
        table.append(
            [
                f"{points:,}",
                name,
                len(group),
                duration(median),
                duration(group.time.quantile(0.95)),
                f"{1e-6 * points / median:.2f}",
                f"{median / medians[OURS, points]:.2f}",
            ]
        )
    header = ["points", "structure", "n", "median", "p95", "million points / s", "median x"]
    return markdown_table(header, table)


def memory_table(rows: pd.DataFrame) -> str:
    """Bytes a point, of the largest clouds: those of small ones drown in whole pages."""
    some = rows[rows.kind == "memory"]
    some = some[some.points >= min(100_000, some.points.max())]
    table = []
    for (name, points), group in some.groupby(["name", "points"], sort=False):
        stated = group.stated.iloc[0]
        table.append(
            [
                f"{points:,}",
                name,
                f"{group.held.iloc[0] / points:.1f}",
                f"{stated / points:.1f}" if np.isfinite(stated) else "",
            ]
        )
    return markdown_table(["points", "structure", "bytes a point", "by nbytes"], table)


def update_table(rows: pd.DataFrame) -> str:
    """A row per size, beside the intake of all."""
    intake = rows[(rows.kind == "intake") & (rows.name == OURS)].groupby("points").time.median()
    table = []
    for points, group in rows[rows.kind == "update"].groupby("points"):
        median = group.time.median()
        table.append(
            [
                f"{points:,}",
                f"{100 * group.share.iloc[0]:.2f} %",
                duration(median),
                duration(group.time.quantile(0.95)),
                duration(group.time.max()),
                f"{intake[points] / median:.0f}",
            ]
        )
    header = ["points", "replaced", "median", "p95", "max", "times faster than intake"]
    return markdown_table(header, table)


def questions(rows: pd.DataFrame) -> pd.DataFrame:
    """The questions' rows, with what we say and take beside, as our_free and so on."""
    some = rows[rows.kind == "query"].astype({"free": bool})
    key = ["robot", "points", "index"]
    ours = some[some.method == OURS].set_index(key)
    columns = ["free", "free_time", "clearance", "clearance_time"]
    return some.join(ours[columns].add_prefix("our_"), on=key)


def query_table(rows: pd.DataFrame) -> str:
    """A row per arm, size and method; ratios are to ours."""
    table = []
    for (robot, points, method), group in _by_arm(questions(rows)):
        free, touching = group[group.our_free], group[~group.our_free]
        times = [free.free_time.median(), touching.free_time.median()]
        ours = [free.our_free_time.median(), touching.our_free_time.median()]
        times.append(group.clearance_time.median())
        ours.append(group.our_clearance_time.median())
        ratios = [time / our for time, our in zip(times, ours, strict=True)]
        cells = [duration(time) if np.isfinite(time) else "" for time in times]
        cells += [f"{ratio:#.3g}".rstrip(".") if np.isfinite(ratio) else "" for ratio in ratios]
        table.append([robot, f"{points:,}", method, *cells])
    header = ["arm", "points", "method", "is it free? yes", "no", "clearance"]
    return markdown_table([*header, "yes x", "no x", "clearance x"], table)


def agreement_table(rows: pd.DataFrame) -> str:
    """Where a peer says otherwise than we do, and whether voxels and capsules explain it.

    A touch that only the octree sees is explained where a point is within a voxel's diagonal of a
    capsule. Nothing explains one that only we see: capsules hold the hulls, voxels the points.
    """
    table = []
    for (robot, points, method), group in _by_arm(questions(rows)):
        if method == OURS:
            continue
        only_peer, only_ours = group.our_free & ~group.free, ~group.our_free & group.free
        explained = only_peer & (group.capsule_gap <= DIAGONAL) & (method == COAL)
        both = group[group.our_free & group.free & group.clearance.notna()]
        short = 1e3 * (both.our_clearance - both.clearance)
        table.append(
            [
                robot,
                f"{points:,}",
                method,
                f"{group.our_free.sum()} of {len(group)}",
                only_peer.sum(),
                only_ours.sum(),
                (only_peer & ~explained).sum() + only_ours.sum(),
                *([f"{short.median():.1f}", f"{short.max():.1f}"] if len(short) else ["", ""]),
            ]
        )
    header = ["arm", "points", "peer", "free by ours", "touch by the peer only", "by ours only"]
    header += ["not explained", "clearance short by [mm], median", "max"]
    return markdown_table(header, table)


def solve_table(rows: pd.DataFrame) -> str:
    """A row per arm and size, with ratios to the smallest cloud on the same targets."""
    some = rows[rows.kind == "solve"]
    table = []
    for (robot, points), group in some.groupby(["robot", "points"]):
        arm = some[some.robot == robot]
        first = arm[arm.points == arm.points.min()].time
        quantiles = [group.time.median(), group.time.mean(), group.time.quantile(0.95)]
        base = [first.median(), first.mean(), first.quantile(0.95)]
        table.append(
            [
                robot,
                f"{points:,}",
                f"{group.solved.sum()} / {len(group)}",
                *(duration(value) for value in quantiles),
                *(f"{value / least:.2f}" for value, least in zip(quantiles, base, strict=True)),
                f"{group.restarts.mean():.2f}",
            ]
        )
    table.sort(key=lambda row: ARMS.index(row[0]))
    header = ["arm", "points", "solved", "median", "mean", "p95", "median x", "mean x", "p95 x"]
    return markdown_table([*header, "restarts"], table)


def capt_table(rows: pd.DataFrame) -> str:
    """A row per setting and size; the time by which a configuration's own spheres stop it is in."""
    some = rows[rows.kind == "capt"].astype({"free": bool})
    table = []
    for (name, points), group in some.groupby(["name", "points"], sort=False):
        one, lanes = group[group.method == "one"], group[group.method == "lanes"]
        medians = [
            one[one.free].free_time.median(),
            one[~one.free].free_time.median(),
            lanes[lanes.free].free_time.median(),
        ]
        left = f"{one.kept.iloc[0]:,.0f}"
        free = f"{one.free.sum()} of {len(one)}"
        table.append([f"{points:,}", name, left, free, *(duration(time) for time in medians)])
    header = ["points", "structure", "points kept", "free", "is it free? yes", "no"]
    return markdown_table([*header, "yes, lanes full, each"], table)


def _by_arm(some: pd.DataFrame) -> list[tuple[tuple[str, int, str], pd.DataFrame]]:
    groups = list(some.groupby(["robot", "points", "method"], sort=False))
    return sorted(groups, key=lambda each: (ARMS.index(each[0][0]), each[0][1]))
