"""The experiment's report: tables in Markdown, the same in JSON."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import mujoco
import numpy as np

from bench.common.arrays import FloatArray
from bench.common.commands import BUILD
from bench.common.markdown import markdown_table
from bench.common.provenance import provenance
from bench.common.whole_files import write_text
from bench.humanoid.report.foreseen import mm, predict_part
from bench.humanoid.trials.experiment import Experiment, Job
from bench.humanoid.trials.store import Record, plain


def write_report(experiment: Experiment, command: str) -> Path:
    """Write report.md and report.json of what is done so far; the former's path."""
    jobs = {job: experiment.store.get(job.name) for job in experiment.jobs()}
    done = {job: record for job, record in jobs.items() if record is not None}
    content = {
        "command": command,
        "machine": {**provenance(BUILD), "mujoco": mujoco.__version__},
        "settings": experiment.settings.identity,
        "finished": len(done),
        "of": len(jobs),
        "latency": {name: _latency(times) for name, times in _times(experiment, done).items()},
        "trials": {job.name: record for job, record in done.items()},
    }
    folder = experiment.store.folder
    write_text(folder / "report.json", json.dumps(plain(content), indent=1) + "\n")
    write_text(folder / "report.md", _markdown(experiment, content, done))
    return folder / "report.md"


def _times(experiment: Experiment, done: dict[Job, Record]) -> dict[str, FloatArray]:
    """How long the Tracker's steps took, by mode and set-up [s]."""
    times: dict[str, list[FloatArray]] = {}
    for job in done:
        path = experiment.steps / f"{job.name}.npz"
        if path.exists():
            with np.load(path) as arrays:
                times.setdefault(f"{job.mode}, {job.setup.name}", []).append(arrays["seconds"])
    return {name: np.concatenate(parts).astype(np.float64) for name, parts in times.items()}


def _latency(seconds: FloatArray) -> Record:
    quantiles = np.quantile(seconds, [0.5, 0.99, 0.999, 1.0])
    return {
        "steps": len(seconds),
        **dict(zip(("median", "p99", "p99.9", "max"), quantiles.tolist(), strict=True)),
        "over_1_ms": int((seconds > 1e-3).sum()),
    }


def _markdown(experiment: Experiment, content: Record, done: dict[Job, Record]) -> str:
    settings, machine = experiment.settings, content["machine"]
    objects = "YCB scans" if settings.ycb else "primitives of the scans' size"
    parts = [
        "# The H1 dodges\n",
        f"`{content['command']}`\n",
        f"{content['finished']} of {content['of']} trials. {machine['processor']},"
        f" {machine['processors']} cores, load {machine['load before']}; pdoik"
        f" {machine['pdoik']}, MuJoCo {machine['mujoco']}; seed"
        f" {settings.seed}; objects: {objects}.\n",
    ]
    by_mode: dict[str, dict[Job, Record]] = {}
    for job, record in done.items():
        by_mode.setdefault(job.mode, {})[job] = record
    if stands := by_mode.get("stand"):
        parts += ["## Standing\n", _stand_table(stands)]
    if predictions := by_mode.get("predict"):
        parts += predict_part(predictions, settings.budget)
    if reactions := by_mode.get("react"):
        parts += [
            "## Throws that are not foreseen\n",
            "The Tracker sees the cloud of the moment only. A run ends with contact or a fall,"
            " which may come before the object would have touched.\n",
            _react_table(reactions),
        ]
    if content["latency"]:
        parts += ["## How long a Tracker's step takes\n", _latency_table(content["latency"])]
    return "\n".join(parts) + "\n"


def _stand_table(records: dict[Job, Record]) -> str:
    head = ["set-up", "stood", "drift [mm]", "pushed", "from", "worst drift [mm]",
            "CoM out of its box [mm]", "fell"]  # fmt: skip
    rows = []
    for job, record in records.items():
        pushed = record["pushed"]
        fell = [name for name, run in pushed.items() if not run["stands"]]
        stood = record["still"]["stands"]
        rows.append(
            [
                job.setup.name,
                f"{record['seconds']:g} s" if stood else "fell",
                mm(record["still"]["foot_drift"], 3),
                f"{record['force']:g} N, {record['force_seconds']:g} s",
                ", ".join(pushed),
                mm(max(run["foot_drift"] for run in pushed.values()), 3),
                mm(max(max(run["com_beyond_box"]) for run in pushed.values()), 1),
                ", ".join(fell) or "never",
            ]
        )
    return markdown_table(head, rows)


def _react_table(records: dict[Job, Record]) -> str:
    head = ["set-up", "speed [m/s]", "throws", "dodged", "touched", "fell untouched",
            "touched, share", "touched later than standing still by, median [s]",
            "limbs touched"]  # fmt: skip
    rows = []
    groups: dict[tuple[str, float], list[Record]] = {}
    for job, record in records.items():
        groups.setdefault((job.setup.name, record["speed"]), []).append(record)
    for (name, speed), some in groups.items():
        touched = [record for record in some if not record["run"]["untouched"]]
        dodged = sum(record["run"]["dodged"] for record in some)
        links = Counter(record["run"]["contact"]["link"] for record in touched)
        later = [
            record["run"]["contact"]["time"] - record["standing_still"]["time"]
            for record in touched
            if record["standing_still"]
        ]
        rows.append(
            [
                name,
                f"{speed:g}",
                str(len(some)),
                str(dodged),
                str(len(touched)),
                str(len(some) - dodged - len(touched)),
                f"{100 * len(touched) / len(some):.0f} %",
                f"{np.median(later):.2f}" if later else "-",
                ", ".join(f"{link.removesuffix('_link')} {n}" for link, n in links.most_common()),
            ]
        )
    return markdown_table(head, rows)


def _latency_table(latency: dict[str, Record]) -> str:
    head = ["", "steps", "median", "p99", "p99.9", "max [us]", "over 1 ms"]
    rows = [
        [
            name,
            str(found["steps"]),
            *(f"{1e6 * found[key]:.0f}" for key in ("median", "p99", "p99.9", "max")),
            str(found["over_1_ms"]),
        ]
        for name, found in latency.items()
    ]
    return markdown_table(head, rows)
