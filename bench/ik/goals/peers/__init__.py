"""The other rows' problems by the peers that a user would try, from the same starts.

Each peer is used as its documentation has it, with what was found to help it here. A peer that is
not installed is left out. As a command of its own it makes a table of its own.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from bench.common.intervals import duration
from bench.ik.goals import five
from bench.ik.goals.peers.cases import CASES, Case
from bench.ik.goals.peers.drake_ik import DrakeIk
from bench.ik.goals.peers.mink_ik import MinkIk
from bench.ik.goals.peers.ours import Ours
from bench.ik.goals.peers.problems import Answer, Maker, Peer
from bench.ik.lines import Jobs, Line, share
from bench.ik.soak.solves import Row

__all__ = ["COUNTS", "SIZES", "SOLVERS", "Peer", "jobs", "lines", "run_job"]

SIZES = (1, 10)  # jobs of a kind
COUNTS = {"hands": 5, "grasps": 8, "five": 4, "regions": 5}  # cases of a job, at most
SOLVERS: Mapping[str, Maker] = {"pdoik": Ours, "mink": MinkIk, "Drake": DrakeIk}


def jobs(size: int, seed: int) -> Jobs:
    """Some cases of a kind each."""
    robots = {"five": five.ROBOTS}
    return {
        f"{k:03d}-{kind}{robot and '-'}{robot}": {
            "index": k,
            "seed": seed,
            "kind": kind,
            "robot": robot,
            "count": count,
        }
        for k in range(size)
        for kind, count in COUNTS.items()
        for robot in robots.get(kind, ("",))
    }


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """All cases by one solver after the other, so that each has them in a row."""
    body, drawn = CASES[job["kind"]](job)
    cases, rows = list(drawn), []
    for name, maker in SOLVERS.items():
        try:
            peer = maker(body)
        except ImportError:
            continue
        for case in cases[:1]:  # what it makes once
            case.ask(peer)
        answers = [case.ask(peer) for case in cases]  # in a row, as programs do
        more = {"solver": name, "version": peer.name}
        rows += [_row(*each) | more for each in zip(cases, answers, strict=True)]
    return rows


def _row(case: Case, answer: Answer) -> Row:
    verdict = case.judge(answer)
    return {
        "problem": case.problem,
        "claimed": answer.claimed,
        "solved": answer.claimed and verdict.solves,
        "wrong": answer.claimed and not verdict.holds,
        "error": verdict.error if answer.claimed else np.inf,
        "time": answer.time,
    }


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of each compared with pdoik; a line for each peer that is not there."""
    found = [
        Line(what=f"{name} is not installed", asked="", measured="", cases="0", failures="")
        for name in SOLVERS
        if name not in set(trials.solver)
    ]
    for (problem, version), some in trials.groupby(["problem", "version"], sort=False):
        ours = trials[(trials.problem == problem) & (trials.solver == "pdoik")]
        found.append(
            Line(
                what=f"{problem}: {version}, solved of feasible",
                asked=""
                if version == "pdoik"
                else f"pdoik: {share(ours.solved, len(ours))}, {duration(ours.time.median())}",
                measured=f"{share(some.solved, len(some))}, median {duration(some.time.median())} "
                f"(99 %: {duration(some.time.quantile(0.99))})",
                cases=f"{len(some):,}",
                failures=int(some.wrong.sum()),
            )
        )
    return found
