"""A day of a machine that is watched: false alarms, what is reported, how soon, at what cost.

python -m bench.sim2real.watch --out watch_day            resumes where it was stopped
python -m bench.sim2real.watch --out watch_day --table    the table only

Half of the time nothing is wrong with the machine. In the other half each log has one change that
begins at a random time and joint, and stays. The model comes from a diagnosis of four recordings
of the same machine on other days, one of them held out. A change shows from the first moment after
its onset at which it adds to the torque of a moving joint more than --friction-change of its
friction, by which that may be another on another day, and three times the floor of the residual.
"""

import argparse
import json
import os
import time
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from bench.common.commands import write_report
from bench.common.whole_files import write_text
from bench.sim2real.watch.machine import COULOMB, JOINTS, SEED, Machine, Onset, write_study
from pdoik import sim2real

SECONDS = 600.0  # of a log
HEALTHY, CHANGED = 72, 72  # logs
KINDS = ("friction", "payload", "offset", "gain")
CHUNK = 1000  # rows that are fed at a time
MOVES = 0.02  # [rad/s]
FRICTION = (
    "coulomb_friction",
    "viscous_friction",
    "presliding_hysteresis",
    "load_dependent_friction",
)
RIGHT = {
    "friction": FRICTION,
    "payload": ("payload",),
    "offset": ("torque_offset",),
    "gain": ("torque_gain",),
}


def onset_of(number: int) -> Onset:
    rng = np.random.default_rng([SEED, 2, number])
    kind = KINDS[number % len(KINDS)]
    joint = int(rng.integers(len(JOINTS)))
    at = float(rng.uniform(60.0, SECONDS - 240.0))
    sign = float(rng.choice([-1.0, 1.0]))
    size = {
        "friction": 2.0,
        "payload": 1.0,
        "offset": sign * COULOMB[joint],
        "gain": 1.0 + 0.15 * sign,
    }[kind]
    com = tuple(rng.uniform([-0.05, -0.05, 0.05], [0.05, 0.05, 0.15]).tolist())
    return Onset(kind=kind, at=at, joint=joint, size=size, com=com)


def shows(log: Any, onset: Onset, floor: np.ndarray, allowed: float) -> tuple[float, float]:
    """When the joint first moves, and when the effect is first seen [s]; inf for never."""
    moving = np.abs(log.dq) > MOVES
    acts = (log.time[:, None] >= onset.at) & moving
    if onset.kind != "payload":
        acts &= np.arange(len(JOINTS)) == onset.joint
    seen = acts & (np.abs(log.effect) > np.maximum(allowed * COULOMB, 3.0 * floor))
    return tuple(
        float(log.time[np.argmax(each.any(axis=1))]) if each.any() else np.inf
        for each in (acts, seen)
    )


def watched(watch: sim2real.Watch, log: Any, name: str) -> tuple[list[sim2real.Alarm], float]:
    """Alarms of a log, and the CPU's seconds."""
    columns, before = log.columns(), time.process_time()
    alarms = []
    for at in range(0, len(log.time), CHUNK):
        part = {key: values[at : at + CHUNK] for key, values in columns.items()}
        alarms += watch.feed(part, source=name)
    alarms += watch.end()
    return alarms, time.process_time() - before


def main() -> None:
    """Run what is missing, then print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--out", type=Path, default=Path("watch_day"))
    parser.add_argument("--table", action="store_true", help="of what is there")
    parser.add_argument("--friction-change", type=float, default=0.15, help="as of pdoik watch")
    options = parser.parse_args()
    if not options.table:
        run(options.out, options.friction_change)
    text = "\n".join(table(options.out))
    write_report(options.out / "tables.md", f"{text}\n")
    print(text)


def run(out: Path, allowed: float) -> None:
    """Every log whose result is missing; healthy and changed ones by turns."""
    machine = Machine(SEED)
    study = write_study(out / "study", machine)
    if not (out / "model.json").is_file():
        sim2real.write(out / "report", sim2real.examine(study), quick=True)
        write_text(out / "model.json", (out / "report" / "model.json").read_text())
    model = sim2real.load_model(out / "model.json")
    (out / "logs").mkdir(exist_ok=True)
    for number in (n for pair in zip(range(HEALTHY), range(CHANGED), strict=True) for n in pair):
        for kind in ("healthy", "changed"):
            path = out / "logs" / f"{kind}_{number}.json"
            if not path.is_file():
                write_text(path, json.dumps(result(machine, model, kind, number, allowed)) + "\n")


def result(
    machine: Machine, model: sim2real.Model, kind: str, number: int, allowed: float
) -> dict[str, Any]:
    """Row of what was reported of a log, and the truth."""
    onset = onset_of(number) if kind == "changed" else None
    log = machine.log(1000 * (1 + (kind == "changed")) + number, SECONDS, onset)
    thresholds = sim2real.Thresholds().changed({"watch.friction_change": allowed})
    alarms, seconds = watched(sim2real.Watch(model, thresholds=thresholds), log, kind)
    row: dict[str, Any] = {
        "kind": kind,
        "number": number,
        "cpu": seconds,
        "resident": resident(),
        "alarms": [json.loads(each.to_json()) for each in alarms],
    }
    if onset is not None:
        assert model.healthy is not None
        floor = np.sqrt(model.healthy.variance[:, 0])
        moves, seen = shows(log, onset, floor, allowed)
        row |= {"onset": asdict(onset), "moves": moves, "shows": seen}
    return row


def resident() -> float:
    """Memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGESIZE") / 2**20


def rows_of(out: Path, kind: str) -> Iterator[dict[str, Any]]:
    paths = (out / "logs").glob(f"{kind}_*.json")
    yield from (json.loads(path.read_text()) for path in sorted(paths, key=_number))


def _number(path: Path) -> int:
    return int(path.stem.rpartition("_")[2])


def table(out: Path) -> list[str]:
    healthy, changed = list(rows_of(out, "healthy")), list(rows_of(out, "changed"))
    noticed = [a for row in healthy for a in row["alarms"] if a["stage"] == "noticed"]
    early = [
        a
        for row in changed
        for a in row["alarms"]
        if a["stage"] == "noticed" and a["told"] < row["onset"]["at"]
    ]
    hours = SECONDS / 3600.0 * len(healthy)
    before = sum(row["onset"]["at"] for row in changed) / 3600.0
    every = [*healthy, *changed]
    memory = [row["resident"] for row in every]
    lines = [
        f"{len(every)} logs of {SECONDS:g} s at 100 Hz. Without a change: {hours:.1f} h and"
        f" {before:.1f} h before onsets, {len(noticed) + len(early)} false alarms. CPU:"
        f" {np.mean([r['cpu'] for r in every]) * 3600 / SECONDS:.0f} s per hour of log. Resident"
        f" memory of the process after a log: {min(memory):.0f} to {max(memory):.0f} MB.",
        "",
        "| change | logs | ever shows | told | delay from showing: median, p95, worst [s] |"
        " within 2 s | right joint | right cause when noticed | right cause when learnt |"
        " more alarms than one |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for kind in (*KINDS, "all"):
        rows = [r for r in changed if kind in (r["onset"]["kind"], "all")]
        lines.append(_line(kind, rows))
    return lines


def _line(kind: str, rows: list[dict[str, Any]]) -> str:
    shown = [r for r in rows if np.isfinite(r["shows"])]
    delays, joints, first, last, found, more = [], 0, 0, 0, 0, 0
    for row in shown:
        alarms = [a for a in row["alarms"] if a["told"] >= row["onset"]["at"]]
        noticed = [a for a in alarms if a["stage"] == "noticed"]
        if not noticed:
            continue
        found += 1
        more += len(noticed) > 1
        delays.append(noticed[0]["told"] - row["shows"])
        learnt = [
            a for a in alarms if a["stage"] == "learnt" and a["number"] == noticed[0]["number"]
        ]
        wanted, name = RIGHT[row["onset"]["kind"]], JOINTS[row["onset"]["joint"]]
        payload = row["onset"]["kind"] == "payload"
        joints += payload or noticed[0]["joint"] == name
        first += _names(noticed[0], wanted)
        last += (
            bool(learnt)
            and _names(learnt[-1], wanted)
            and (payload or name in learnt[-1]["causes"][0]["joints"])
        )
    of = f"{len(shown)}"
    spread = (
        ", ".join(f"{x:.2f}" for x in (*np.quantile(delays, (0.5, 0.95)), max(delays)))
        if delays
        else "-"
    )
    quick = sum(d <= 2.0 for d in delays)
    return (
        f"| {kind} | {len(rows)} | {len(shown)} | {found} of {of} | {spread} | {quick} of {of} |"
        f" {joints} of {found} | {first} of {found} | {last} of {found} | {more} |"
    )


def _names(alarm: dict[str, Any], wanted: tuple[str, ...]) -> bool:
    return bool(alarm["causes"]) and alarm["causes"][0]["effect"] in wanted


if __name__ == "__main__":
    main()
