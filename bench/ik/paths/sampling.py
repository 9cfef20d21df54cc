"""The reference: many random starts, each led along the path by differential kinematics.

A start is a random configuration brought to the first station. From there each station is met by
Newton's steps from the one before, and what the goal leaves free goes, by a share, to a random
posture or to where the joints were. Ends of joints hold back, contacts end a try. All by
Pinocchio; the best of what the judge confirms is kept.
"""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.paths.arms import judge_of
from bench.ik.paths.contacts import Contacts
from bench.ik.paths.judge import judged
from bench.ik.paths.newton import Chain
from bench.ik.paths.problem import Problem

NEWTON, START = 12, 60  # steps at a station, at the first
STEP = 0.1  # of a joint from station to station, at most [rad] or [m]
LOOK = 10  # stations, after which contacts are looked for
PULLS = (0.0, 0.01, 0.03, 0.1)  # shares of the way to a posture, at each station


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What a search found."""

    Q: FloatArray | None  # stations' configurations; None if it found none
    length: float
    farthest: int  # station that a try got to; -1 if none met the first
    tries: int
    time: float


def search(
    problem: Problem, max_time: float, rng: np.random.Generator, *, first: bool = False
) -> Found:
    """The shortest whole motion found in a time; or the first one."""
    began = perf_counter()
    chain, judge = Chain(problem), judge_of(problem.arm)
    contacts = Contacts(judge, problem.world)
    best: FloatArray | None = None
    length, tries, farthest = np.inf, 0, -1
    at = np.arange(problem.last + 1.0)
    while perf_counter() - began < max_time and not (first and best is not None):
        tries += 1
        Q, got = _follow(problem, chain, contacts, rng)
        farthest = max(farthest, got)
        if Q is None:
            continue
        gone = float(np.linalg.norm(np.diff(Q, axis=0), axis=1).sum())
        if gone < length and not _faults(judged(problem, Q, at)):
            best, length = Q, gone
    took = perf_counter() - began
    return Found(Q=best, length=length, farthest=farthest, tries=tries, time=took)


def _follow(
    problem: Problem, chain: Chain, contacts: Contacts, rng: np.random.Generator
) -> tuple[FloatArray | None, int]:
    """Stations' configurations, if all are met; and the last station that was."""
    low, high = np.maximum(chain.lower, -np.pi), np.minimum(chain.upper, np.pi)
    met = chain.meet(rng.uniform(low, high), problem.T[0], START, 0.5)
    if met is None or _is_deep(contacts, met[0][None]):
        return None, -1
    posture = rng.choice(np.array([rng.uniform(low, high), met[0], 0.5 * (low + high)]))
    pull, Q, clear = rng.choice(PULLS), [met[0]], 0
    for k, T in enumerate(problem.T[1:], start=1):
        q, null = met
        aside = pull * null @ (posture - q)
        aside *= min(1.0, 0.5 * STEP / max(np.abs(aside).max(), 1e-12))
        met = chain.meet(q + aside, T, NEWTON, STEP)
        if met is None or np.abs(met[0] - q).max() > STEP:
            return None, clear
        Q.append(met[0])
        if k % LOOK == 0 or k == len(problem.T) - 1:
            if _is_deep(contacts, np.array(Q[clear:])):
                return None, clear
            clear = k
    if problem.closed:
        Q.append(Q[0])
        if np.abs(Q[-1] - Q[-2]).max() > STEP:
            return None, clear
    return np.array(Q), clear


def _is_deep(contacts: Contacts, Q: FloatArray) -> bool:
    return any(depth.max() > 0.0 for depth in contacts.depths(Q))


def _faults(verdict: Any) -> list[str]:
    return list(verdict.faults)
