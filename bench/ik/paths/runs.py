"""One problem by the library, judged; and what tables say of many."""

from collections.abc import Mapping
from math import ceil, floor
from time import process_time
from typing import Any

import numpy as np
import pandas as pd

from bench.common.intervals import duration
from bench.ik.lines import Line, share
from bench.ik.paths.judge import SAID_STEP, faults_of_move, judged
from bench.ik.paths.problem import Problem
from bench.ik.paths.sampling import search
from bench.ik.soak.solves import Row

SAID = 1e-6  # by so much figures may differ from what they are said to be
SEARCH = 15.0  # of a reference, where the library has no whole path [s]
FEASIBLE, WRONG = "0.990", "0"


def run(problem: Problem, **options: Any) -> Row:
    """The library's answer and what it is worth."""
    path, took = asked(problem, **options)
    return row_of(problem, path) | {"processor": took}


def asked(problem: Problem, **options: Any) -> tuple[Any, float]:
    """The answer, and the processor's time for the call [s]."""
    solver = problem.solver()
    began = process_time()
    path = problem.ask(solver, **options)
    return path, process_time() - began


def row_of(problem: Problem, path: Any) -> Row:
    """What an answer says, and what it is worth."""
    row: Row = {
        "key": problem.key,
        "arm": problem.arm,
        "stations": len(problem.T),
        "status": path.status,
        "message": path.message,
        "ends": "; ".join(f"{end.at:.3f} {end.reason}" for end in path.ends),
        "pieces": len(path.pieces),
        "complete": path.complete,
        "rows": len(path.q),
        "time": path.time,
        "said_step": path.largest_step,
        "whole": path.success,
    }
    if path.success:
        verdict = judged(problem, path.q, path.at)
        said = {
            "said_step": abs(verdict.station_step - path.largest_step) > SAID,
            "said_length": abs(verdict.length - path.length) > SAID * verdict.length,
        }
        faults = [*verdict.faults, *(name for name in said if said[name])]
        row |= verdict.row()
    else:
        faults = faults_of_pieces(problem, path)
    return row | {"faults": " ".join(faults), "wrong": bool(faults)}


def faults_of_pieces(problem: Problem, path: Any) -> list[str]:
    """What is wrong with the pieces of a path that is not whole, and with moves between them."""
    Q, at, faults = np.asarray(path.q), np.asarray(path.at), list[str]()
    for first, end in path.pieces:
        faults += judged(problem, Q[first:end], at[first:end], part=True).faults
    for (_, end), (first, _), move in zip(path.pieces, path.pieces[1:], path.moves, strict=False):
        if len(move):
            ends = Q[end - 1], Q[first]
            faults += faults_of_move(problem.arm, problem.world, np.asarray(move), *ends)
    if path.status == "pieces":
        met = {k for a, b in path.pieces for k in range(ceil(at[a]), floor(at[b - 1]) + 1)}
        faults += [] if len(met) == problem.last + 1 else ["covers"]
    return list(dict.fromkeys(faults))


def run_or_refer(problem: Problem, seed: int) -> Row:
    """The same; where there is no whole path, whether a sampling search finds one."""
    row = run(problem)
    return row | refer(problem, row, seed)


def refer(problem: Problem, row: Row, seed: int) -> Row:
    """Whether a sampling search finds what the library did not."""
    if row["whole"] and not row["wrong"]:
        return {"reference": False, "tries": 0}
    found = search(problem, SEARCH, np.random.default_rng([seed, 99]), first=True)
    return {"reference": found.Q is not None, "tries": found.tries}


def solved(trials: pd.DataFrame, what: str) -> Line:
    """The share of feasible problems solved, and what was wrong."""
    right = trials.whole & ~trials.wrong
    feasible = right | trials.reference
    words = ", ".join(
        f"{count} {status}" for status, count in trials[~trials.whole].status.value_counts().items()
    )
    return Line(
        what=f"{what}: whole of feasible; wrong anywhere",
        asked=f"{FEASIBLE}; {WRONG}",
        measured=f"{share(right, int(feasible.sum()))}; {int(trials.wrong.sum())}"
        + (f"; the rest: {words}" if words else ""),
        cases=f"{int(feasible.sum()):,} feasible of {len(trials):,}",
        failures=int((feasible & ~right).sum() + (trials.wrong & ~feasible).sum()),
    )


def timed(trials: pd.DataFrame, what: str, wanted: tuple[float, float]) -> Line:
    """Line with the times of whole paths of 200 stations."""
    some = trials[trials.whole & (trials.stations == 200)]
    if some.empty:
        return Line(what=f"{what}: time", asked="", measured="none", cases="0", failures="")
    median, late, most = some.time.median(), some.time.quantile(0.95), some.time.max()
    return Line(
        what=f"{what}, 200 stations, whole: median, 95 %, most; on the processor",
        asked=f"{duration(wanted[0])}, {duration(wanted[1])}",
        measured=f"{duration(median)}, {duration(late)}, {duration(most)}; "
        f"{duration(some.processor.median())}, {duration(some.processor.quantile(0.95))}",
        cases=f"{len(some):,}",
        failures="",
    )


def stepped(trials: pd.DataFrame, what: str) -> Line:
    """Steps from station to station."""
    some = trials[trials.whole]
    large = some.said_step > SAID_STEP
    said = some.faults.str.contains("said_step")
    return Line(
        what=f"{what}: largest joint step from station to station",
        asked="7 degrees, or said",
        measured=f"median {np.rad2deg(some.said_step.median()):.1f}, most "
        f"{np.rad2deg(some.said_step.max()):.1f} degrees; {int(large.sum())} larger, all said"
        if len(some)
        else "none",
        cases=f"{len(some):,}",
        failures=int(said.sum()),
    )


def worst(trials: pd.DataFrame, what: str) -> Line:
    """The largest errors of whole paths, as judged."""
    some: Mapping[str, float] = trials[trials.whole].max(numeric_only=True)
    return Line(
        what=f"{what}: largest errors at stations, between, deepest contact",
        asked="10 um, 10 urad; 100 um, 1.75 mrad; 100 um",
        measured=f"{1e6 * some['station_position']:.1f} um, {1e6 * some['station_rotation']:.1f} "
        f"urad; {1e6 * some['way_position']:.0f} um, {1e3 * some['way_rotation']:.2f} mrad; "
        f"{1e6 * max(some['depth'], some['own_depth']):.0f} um"
        if trials.whole.any()
        else "none",
        cases=f"{int(trials.whole.sum()):,}",
        failures="",
    )
