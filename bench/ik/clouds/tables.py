"""The tables of bench/ik/clouds/__main__.py."""

import numpy as np
import pandas as pd

from bench.common.grouped import Cell, grouped_table, mean, time_at
from bench.common.intervals import duration
from bench.ik.clouds.structures import COAL, OURS, VOXEL
from bench.ik.experiment import ARMS

DIAGONAL = np.sqrt(3.0) * VOXEL  # how far a voxel may reach beyond the point in it [m]
STRUCTURE = {"count": "points", "name": "structure"}
BY_ARM = {"robot": "arm", "count": "points", "method": "method"}


def all_tables(rows: pd.DataFrame, seed: int) -> str:
    """One text."""
    rows = rows.assign(count=[f"{points:,}" for points in rows.points])
    kinds = dict(list(rows.groupby("kind")))
    asked = questions(rows)
    parts = {
        f"Intake, processor time, seed {seed}": intake_table(kinds["intake"]),
        "Memory": memory_table(kinds["memory"]),
        "Update of a hundredth": update_table(kinds["update"], kinds["intake"]),
        "Questions about a configuration, median processor time": query_table(asked),
        "Do free and touching agree with ours?": agreement_table(asked),
        "A solve, in C++": solve_table(kinds["solve"]),
    }
    if "capt" in kinds:
        parts["VAMP: Panda as its 59 spheres, by points or by itself"] = capt_table(kinds["capt"])
    return "\n".join(f"**{title}**\n\n{table}" for title, table in parts.items())


def intake_table(some: pd.DataFrame) -> str:
    """A row per structure and size."""
    ours = some[some.name == OURS].groupby("points").time.median()
    return grouped_table(
        some,
        STRUCTURE,
        {
            "n": len,
            "median": time_at(0.5),
            "p95": time_at(0.95),
            "million points / s": lambda g: f"{1e-6 * g.points.iloc[0] / g.time.median():.2f}",
            "median x": lambda g: f"{g.time.median() / ours[g.points.iloc[0]]:.2f}",
        },
    )


def memory_table(some: pd.DataFrame) -> str:
    """Bytes a point, of the largest clouds: those of small ones drown in whole pages."""

    def a_point(column: str) -> Cell:
        return lambda g: _figure(g[column].iloc[0] / g.points.iloc[0], ".1f")

    large = some[some.points >= min(100_000, some.points.max())]
    return grouped_table(
        large, STRUCTURE, {"bytes a point": a_point("held"), "by nbytes": a_point("stated")}
    )


def update_table(some: pd.DataFrame, intake: pd.DataFrame) -> str:
    """A row per size, with the intake of all."""
    ours = intake[intake.name == OURS].groupby("points").time.median()
    return grouped_table(
        some,
        {"count": "points"},
        {
            "replaced": lambda g: f"{100 * g.share.iloc[0]:.2f} %",
            "median": time_at(0.5),
            "p95": time_at(0.95),
            "max": time_at(1.0),
            "times faster than intake": lambda g: f"{ours[g.points.iloc[0]] / g.time.median():.0f}",
        },
    )


def questions(rows: pd.DataFrame) -> pd.DataFrame:
    """The questions' rows, with what we say and take next to them, as our_free and so on."""
    some = rows[rows.kind == "query"].astype({"free": bool})
    key = ["robot", "points", "index"]
    ours = some[some.method == OURS].set_index(key)
    columns = ["free", "free_time", "clearance", "clearance_time"]
    return some.join(ours[columns].add_prefix("our_"), on=key)


def query_table(asked: pd.DataFrame) -> str:
    """A row per arm, size and method; ratios are to ours."""
    free, touching = asked.free_time.where(asked.our_free), asked.free_time.where(~asked.our_free)
    ours = asked.our_free_time
    times = {
        "is it free? yes": (free, ours.where(asked.our_free)),
        "no": (touching, ours.where(~asked.our_free)),
        "clearance": (asked.clearance_time, asked.our_clearance_time),
    }

    def median(each: pd.Series) -> Cell:
        return lambda g: _time(each[g.index].median())

    def ratio(each: pd.Series, our: pd.Series) -> Cell:
        return lambda g: _figure(each[g.index].median() / our[g.index].median(), "#.3g")

    columns = {name: median(each) for name, (each, _) in times.items()}
    columns |= {f"{name.split()[-1]} x": ratio(*both) for name, both in times.items()}
    return grouped_table(_sized(asked), BY_ARM, columns, order={"robot": ARMS})


def agreement_table(asked: pd.DataFrame) -> str:
    """Where a peer says otherwise than we do, and whether voxels and capsules explain it.

    A touch that only the octree sees is explained where a point is within a voxel's diagonal of a
    capsule. Nothing explains one that only we see: capsules hold the hulls, voxels the points.
    """
    near = (asked.capsule_gap <= DIAGONAL) & (asked.method == COAL)
    some = asked.assign(
        only_peer=asked.our_free & ~asked.free,
        only_ours=~asked.our_free & asked.free,
        odd=(asked.our_free != asked.free) & ~(asked.our_free & near),
        short=1e3 * (asked.our_clearance - asked.clearance).where(asked.our_free & asked.free),
    )
    return grouped_table(
        _sized(some[some.method != OURS]),
        {**BY_ARM, "method": "peer"},
        {
            "free by ours": lambda g: f"{g.our_free.sum()} of {len(g)}",
            "touch by the peer only": lambda g: g.only_peer.sum(),
            "by ours only": lambda g: g.only_ours.sum(),
            "not explained": lambda g: g.odd.sum(),
            "clearance short by [mm], median": lambda g: _figure(g.short.median(), ".1f"),
            "max": lambda g: _figure(g.short.max(), ".1f"),
        },
        order={"robot": ARMS},
    )


def solve_table(some: pd.DataFrame) -> str:
    """A row per arm and size, with ratios to the smallest cloud on the same targets."""
    figures = {
        "median": lambda times: times.median(),
        "mean": lambda times: times.mean(),
        "p95": lambda times: times.quantile(0.95),
    }
    first = dict(list(some[some.points == some.points.min()].groupby("robot").time))
    return grouped_table(
        _sized(some),
        {"robot": "arm", "count": "points"},
        {
            "solved": lambda g: f"{g.solved.sum()} / {len(g)}",
            **{name: lambda g, f=f: duration(f(g.time)) for name, f in figures.items()},
            **{
                f"{name} x": lambda g, f=f: f"{f(g.time) / f(first[g.robot.iloc[0]]):.2f}"
                for name, f in figures.items()
            },
            "restarts": mean("restarts", 2),
        },
        order={"robot": ARMS},
    )


def capt_table(some: pd.DataFrame) -> str:
    """A row per setting and size; the time by which a configuration's own spheres stop it is in."""

    def at(method: str, free: bool) -> Cell:
        return lambda g: duration(g[(g.method == method) & (g.free == free)].free_time.median())

    return grouped_table(
        some.astype({"free": bool}),
        STRUCTURE,
        {
            "points kept": lambda g: f"{g.kept.dropna().iloc[0]:,.0f}",
            "free": lambda g: f"{g.free[g.method == 'one'].sum()} of {(g.method == 'one').sum()}",
            "is it free? yes": at("one", True),
            "no": at("one", False),
            "yes, lanes full, each": at("lanes", True),
        },
    )


def _sized(some: pd.DataFrame) -> pd.DataFrame:
    """Rows sorted by the number of points, which sorting their text does not give."""
    return some.sort_values("points", kind="stable")


def _time(seconds: float) -> str:
    return duration(seconds) if np.isfinite(seconds) else ""


def _figure(value: float, form: str) -> str:
    return f"{value:{form}}".rstrip(".") if np.isfinite(value) else ""
