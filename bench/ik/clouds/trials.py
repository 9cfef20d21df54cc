"""What is timed of clouds. Each function is one job, which runs in a process of its own.

bench.ik.clouds gives the job on standard input and the processor as the argument, and reads rows.
Times are the processor's, half a microsecond of asking for it included, since a preemption costs
long calls more than short ones; those of a solve and of VAMP's answers are the wall's, from C++.
"""

from __future__ import annotations

import ctypes
import json
import os
import statistics
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from bench.ik.clouds.capt import SETTINGS, Capt
from bench.ik.clouds.hulls import Capsule
from bench.ik.clouds.queries import Judge, queries
from bench.ik.clouds.scene import hundredth, random_configurations, table_and_balls
from bench.ik.clouds.structures import STRUCTURES, as_wanted
from bench.ik.experiment import Arm

Row = dict[str, Any]
Job = Mapping[str, Any]
FloatArray = npt.NDArray[np.float64]

SOLVE_BUDGET = 1.0  # [s]
NEAR = 0.03  # a clearance that voxels and rounder shapes may turn into a touch [m]
PASSES = 3  # over the configurations, of which the median counts


def run_job(job: Job) -> list[Row]:
    """The rows of any of them."""
    facts = {name: job[name] for name in ("kind", "name", "robot", "points")}
    return [{**facts, **row} for row in JOBS[job["kind"]](job)]


def intake(job: Job) -> list[Row]:
    """What it takes to make each structure, in turn, so that all meet the same noise.

    Of two calls the second counts: the first finds what the structure before left in the cache.
    """
    points = table_and_balls(job["points"], job["seed"])
    calls = {name: _maker(name, points, job["library"]) for name in job["names"]}
    times: dict[str, list[float]] = {name: [] for name in calls}
    left = list(calls)
    while left:
        for name in left:
            calls[name]()
            start = time.process_time()
            kept = calls[name]()
            times[name].append(time.process_time() - start)
            del kept  # apart: giving memory back is not part of it
        left = [
            name
            for name in left
            if len(times[name]) < 3
            or (len(times[name]) < job["repeats"] and sum(times[name]) < job["seconds"])
        ]
    return [{"name": name, "time": t} for name, several in times.items() for t in several]


def memory(job: Job) -> list[Row]:
    """What one structure holds, by the process and in its own words [bytes]."""
    points = table_and_balls(job["points"], job["seed"])
    make = _maker(job["name"], points, job["library"])
    _maker(job["name"], points[:100], job["library"])()  # loads the code
    before = _resident()
    kept = make()
    held = _resident() - before
    stated = kept.nbytes if isinstance(kept, pdoik.Cloud) else np.nan
    return [{"held": float(held), "stated": float(stated)}]


def capt(job: Job) -> list[Row]:
    """VAMP's structure asked about Panda's configurations, one by one and with full lanes.

    Its spheres are other hulls than ours, and it asks for self-collision, too: only times compare.
    """
    points = table_and_balls(job["points"], job["seed"]).astype(np.float32)
    robot = pdoik.Robot.builtin("panda")
    chosen = random_configurations(robot, 8 * job["configurations"], job["seed"] + 1)
    kept = Capt(job["library"], job["name"], points)
    asked = [kept.validate(chosen) for _ in range(PASSES)]
    rows: list[Row] = [
        {
            "method": "one",
            "kept": kept.kept,
            "index": index,
            "free": bool(free),
            "free_time": seconds,
        }
        for index, (free, seconds) in enumerate(
            zip(asked[0][0], np.median([times for _, times in asked], axis=0), strict=True)
        )
    ]
    # A planner's edge: a lane's neighbours differ by little.
    steps = np.linspace(0.0, 0.1, kept.lanes)[None, :, None]
    edges = (chosen[:, None, :] + steps).reshape(-1, robot.dof)
    lanes = [kept.validate_lanes(edges) for _ in range(PASSES)]
    rows += [
        {"method": "lanes", "index": index, "free": bool(free), "free_time": seconds / kept.lanes}
        for index, (free, seconds) in enumerate(
            zip(lanes[0][0], np.median([times for _, times in lanes], axis=0), strict=True)
        )
    ]
    return rows


def update(job: Job) -> list[Row]:
    """A hundredth of the points in place of the same."""
    points = table_and_balls(job["points"], job["seed"])
    region = hundredth(points)
    within = points[((points >= region[0]) & (points <= region[1])).all(axis=1)]
    cloud = pdoik.Cloud(points)
    times = timed(lambda: cloud.update(within, region), job["repeats"], job["seconds"])
    return [{"time": t, "share": len(within) / len(points)} for t in times]


def query(job: Job) -> list[Row]:
    """Whether configurations are free, and their clearance: ours and the peers' among one cloud."""
    robot = Arm.builtin(job["robot"]).robot
    points = table_and_balls(job["points"], job["seed"])
    methods = queries(robot, points)
    chosen = _chosen(robot, points, job["configurations"], job["seed"] + 1)
    places = [{link: robot.fk(q, link) for link in robot.link_names} for q in chosen]
    rows: list[Row] = []
    for method in methods:
        ready = [method.prepare(q, placed) for q, placed in zip(chosen, places, strict=True)]
        free, free_times = _asked(method.free, ready)
        clearance, clearance_times = _asked(method.clearance, ready)
        rows += [
            {
                "method": method.name,
                "index": index,
                "free": bool(free[index]),
                "free_time": free_times[index],
                "clearance": clearance[index],
                "clearance_time": clearance_times[index],
            }
            for index in range(len(chosen))
        ]
    capsules = [Capsule.about(hull) for hull in methods[0].hulls]
    for row in rows:
        ours = rows[row["index"]]
        row["capsule_gap"] = np.nan
        if row["free"] != ours["free"]:
            placed = places[row["index"]]
            row["capsule_gap"] = min(each.gap(placed[each.hull.link], points) for each in capsules)
    return rows


def solve(job: Job) -> list[Row]:
    """The same targets among ever more points, in turn, each from mid-range."""
    robot = Arm.builtin(job["robot"]).robot
    options = pdoik.Options(max_time=SOLVE_BUDGET, base_collision=False)
    solver = pdoik.Solver(robot, options)
    clouds = {n: pdoik.Cloud(table_and_balls(n, job["seed"])) for n in job["sizes"]}
    most = clouds[max(clouds)]
    targets = []
    for q in random_configurations(robot, 50 * job["targets"], job["seed"] + 2):
        T = robot.fk(q)
        if len(targets) < job["targets"] and solver.judge(T, q, most).success:
            targets.append(T)
    rows = []
    q0 = robot.mid_configuration()
    for index, T in enumerate(targets):
        results = {
            n: [solver.solve(T, q0=q0, obstacles=cloud) for _ in range(job["repeats"])]
            for n, cloud in clouds.items()
        }
        rows += [
            {
                "points": n,
                "index": index,
                "time": statistics.median(result.time for result in several),
                "solved": several[0].success,
                "restarts": several[0].restarts,
            }
            for n, several in results.items()
        ]
    return rows


JOBS: Mapping[str, Callable[[Job], list[Row]]] = {
    "intake": intake,
    "memory": memory,
    "capt": capt,
    "update": update,
    "query": query,
    "solve": solve,
}


def timed(call: Callable[[], Any], repeats: int, seconds: float) -> list[float]:
    """Times [s] of so many calls, or of as many as go into the seconds, three at least.

    One call before them is not counted.
    """
    call()
    times: list[float] = []
    while len(times) < 3 or (len(times) < repeats and sum(times) < seconds):
        start = time.process_time()
        kept = call()
        times.append(time.process_time() - start)
        del kept  # apart: taking memory back is not part of it
    return times


def _maker(name: str, points: FloatArray, library: str | None) -> Callable[[], Any]:
    """What makes one structure of the points."""
    if name in SETTINGS:
        assert library is not None
        path, single = library, points.astype(np.float32)
        return lambda: Capt(path, name, single)
    wanted = as_wanted(name, points)
    return lambda: STRUCTURES[name](wanted)


def _chosen(robot: pdoik.Robot, points: FloatArray, count: int, seed: int) -> list[FloatArray]:
    """Random configurations: a third each touch, come near, are clear, by our own judgement."""
    judge = Judge(robot, points)
    kinds: list[list[FloatArray]] = [[], [], []]
    for q in random_configurations(robot, 1000 * count, seed):
        clearance = judge.clearance(judge.prepare(q, {}))
        some = kinds[int(clearance >= 0.0) + int(clearance >= NEAR)]
        if len(some) < count // 3:
            some.append(q)
        if sum(map(len, kinds)) == 3 * (count // 3):
            break
    return [q for some in kinds for q in some]


def _asked(
    call: Callable[[Any], Any] | None, ready: Sequence[Any]
) -> tuple[list[Any], list[float]]:
    """The answers of one question, and the median of three times each [s]; NaN for no question.

    One configuration after the other, as in use: the same one again would find all in the cache.
    """
    if call is None:
        return [np.nan] * len(ready), [np.nan] * len(ready)
    times = np.zeros((PASSES, len(ready)))
    answers = []
    for turn in range(PASSES):
        answers = []
        for index, each in enumerate(ready):
            start = time.process_time()
            answers.append(call(each))
            times[turn, index] = time.process_time() - start
    return answers, np.median(times, axis=0).tolist()


def _resident() -> int:
    """Memory of this process, after what is free went back [bytes]."""
    ctypes.CDLL(None).malloc_trim(0)
    pages = Path("/proc/self/statm").read_text().split()[1]
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def _stay_on(processor: int) -> None:
    allowed = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {allowed[processor % len(allowed)]})


if __name__ == "__main__":
    _stay_on(int(sys.argv[1]))
    json.dump(run_job(json.load(sys.stdin)), sys.stdout)
