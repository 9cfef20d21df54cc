"""One concealed world: made, diagnosed, and held against what was hidden in it."""

import json
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from bench.common.campaign import Job, Row
from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import Truth, WorldSpec
from pdoik.sim2real import diagnose

Entry = dict[str, Any]  # of a truth's effects, or a finding as plain data

ONE_NAME = {"actuator_lag": "command_delay", "link_inertial_error": "payload"}
"""Pairs that slow motion cannot split count as one name; of links only the last is a payload's."""

MOST_EQUIVALENTS = 3  # that a finding may list

CHOICES = ("harmonic", "side")
"""Parameters that are chosen among a few values, so that an interval says nothing."""

OPEN_END = 60.0  # a truth's window that ends there ends with the recordings [s]
LEAST_OPEN = 5.0  # that such a window lasts at least [s]
AFFECTED = 1.5  # times its noise floor: a joint with more residual shows what is hidden


def run_study(job: Job) -> list[Row]:
    """One row: the scores, and in JSON what was hidden and what was said.

    The world's files live in a folder of their own while this runs.
    """
    spec = WorldSpec(**job["spec"])
    with tempfile.TemporaryDirectory(prefix="pdoik-diagnosis-") as folder:
        truth = make_study(Path(folder) / "study", spec)
        begin = time.perf_counter()
        try:
            said = json.loads(diagnose(Path(folder) / "study" / "study.yaml").to_json())
        except Exception as error:  # a study the tool breaks on counts as failed
            said = {"verdict": f"{type(error).__name__}: {error}", "findings": [], "joints": {}}
        seconds = time.perf_counter() - begin
    return [
        {
            **asdict(spec),
            "size": truth.size,
            "seconds": seconds,
            "verdict": said["verdict"],
            **scores(truth, said),
            "hidden": json.dumps(truth.effects),
            "findings": json.dumps(said["findings"]),
            "joints": json.dumps(said["joints"]),
        }
    ]


def scores(truth: Truth, said: dict[str, Any]) -> Row:
    """How well a diagnosis, as its JSON has it, tells a truth.

    What comes beside the hidden effect (the Coulomb friction of a Stribeck curve) is no finding
    too many, and may be found before it.
    """
    found = said["findings"]
    if not truth.effects:
        right = not found and said["verdict"] == "no_mismatch"
        return {"named": right, "listed": right, "placed": right, "extra": len(found)} | measured(
            None, None, said["joints"]
        )
    hidden, last = truth.effects[0], last_link(truth.joints)
    rest = rest_of(truth.effects, found, last)
    first = rest[0] if rest else None
    named = first is not None and name_of(first, last) == name_of(hidden, last)
    match = next((e for e in rest if e["effect"] == hidden["effect"] and placed(e, hidden)), None)
    return {
        "named": named,
        "listed": any(
            name_of(each, last) == name_of(hidden, last)
            for finding in rest
            if finding is first or placed(finding, hidden)
            for each in (finding, *finding["equivalents"][:MOST_EQUIVALENTS])
        ),
        "placed": first is not None and placed(first, hidden),
        "extra": sum(not same(each, hidden, last) for each in rest[1:]),
    } | measured(hidden, match, said["joints"])


def rest_of(effects: Sequence[Entry], found: Sequence[Entry], last: str) -> list[Entry]:
    """Findings but for what stands beside the hidden effect, which is the first of a truth's."""
    return [each for each in found if not any(same(each, other, last) for other in effects[1:])]


def last_link(joints: Sequence[str]) -> str:
    """The link that carries a payload in a concealed arm."""
    return f"link{len(joints)}"


def name_of(entry: Entry, last: str) -> str:
    """An effect's name; the same for a pair that counts as one."""
    if entry["effect"] == "link_inertial_error" and set(entry["links"]) != {last}:
        return "link_inertial_error"
    return ONE_NAME.get(entry["effect"], entry["effect"])


def same(finding: Entry, entry: Entry, last: str) -> bool:
    return name_of(finding, last) == name_of(entry, last) and placed(finding, entry)


def placed(finding: Entry, entry: Entry) -> bool:
    """Joints and links as hidden; a window, where one is told of one, mostly its own.

    A contact must have its own recording and window. Of what else acts in a window only, joint and
    link are enough.
    """
    for part in ("joints", "links"):
        if entry[part] and set(finding[part]) != set(entry[part]):
            return False
    windows = finding["window"], entry["window"]
    if entry["effect"] == "external_contact":
        return finding["recordings"] == entry["recordings"] and overlap(*windows) > 0.5
    return None in windows or overlap(*windows) > 0.5


def overlap(a: Sequence[float] | None, b: Sequence[float] | None) -> float:
    """Length that two windows share, of what they cover together."""
    if a is None or b is None:
        return 0.0
    if b[1] >= OPEN_END:  # to the end of the recordings, which is a's end if a goes so far
        b = (b[0], max(a[1], b[0] + LEAST_OPEN))
    shared = min(a[1], b[1]) - max(a[0], b[0])
    return max(shared, 0.0) / max(max(a[1], b[1]) - min(a[0], b[0]), 1e-9)


def measured(hidden: Entry | None, match: Entry | None, joints: dict[str, Any]) -> Row:
    """Parameters inside their intervals, the main one's error, and what residual is left."""
    row: Row = {"inside": 0, "intervals": 0, "error": np.nan, "left": left(hidden, joints)}
    if hidden is None or match is None:
        return row
    pairs = [
        (float(value), match["parameters"][name], name == "phase")
        for name, value in hidden["parameters"].items()
        if name in match["parameters"] and name not in CHOICES
    ]
    for value, estimate, turns in pairs:
        low, high = estimate["interval95"]
        row["intervals"] += 1
        row["inside"] += abs(off(value, estimate, turns)) <= 0.5 * (high - low)
    for unit in dict.fromkeys(estimate["unit"] for _, estimate, _ in pairs):  # the main one first
        group = [pair for pair in pairs if pair[1]["unit"] == unit]
        size = np.linalg.norm([value for value, _, _ in group])
        if size > 0.0:
            row["error"] = float(np.linalg.norm([off(*pair) for pair in group]) / size)
            break
    return row


def off(value: float, estimate: Entry, turns: bool) -> float:
    """An estimate's error; an angle's within half a turn."""
    error = float(estimate["value"]) - value
    return (error + np.pi) % (2.0 * np.pi) - np.pi if turns else error


def left(hidden: Entry | None, joints: dict[str, Any]) -> float:
    """Held-out residual over the noise floor: median of the joints that show what is hidden."""
    judged = {name: each for name, each in joints.items() if each["noise_floor"] > 0.0}
    shown = [
        name for name, each in judged.items() if each["before"] > AFFECTED * each["noise_floor"]
    ]
    names = shown or [n for n in (hidden or {}).get("joints", ()) if n in judged] or list(judged)
    ratios = [judged[name]["after"] / judged[name]["noise_floor"] for name in names]
    return float(np.median(ratios)) if ratios else float("nan")
