"""One study's scores: its truth beside what was said of it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from bench.common.campaign import Row
from bench.sim2real.diagnosis.score import AFFECTED, last_link, name_of, overlap, rest_of, scores
from bench.sim2real.proof import decoys
from bench.sim2real.proof.diagnose import as_diagnosis

Content = Mapping[str, Any]  # of JSON

GROUPS = ("clean", "outside", "lying", "still")


def score(name: str, truth: Content, said: Content, true: Mapping[str, float]) -> Row:
    """All columns of a study.

    Args:
        name: of the study.
        truth: of the sealed file.
        said: by one.py.
        true: held-out residual of each joint under the true model; empty where there is none.
    """
    spec, diagnosis = truth["spec"], as_diagnosis(said)
    group = spec["effect"].partition(":")[0]
    group = group if group in GROUPS else "effect"
    row: Row = {
        "name": name,
        **{key: spec[key] for key in ("seed", "effect", "hide", "robot")},
        "group": group,
        "corner": truth["corner"],
        "size": truth["size"],
        "verdict": diagnosis["verdict"],
        "first": first_said(truth, diagnosis),
        **scores(SimpleNamespace(effects=truth["effects"], joints=truth["joints"]), diagnosis),
        **window(truth, diagnosis),
        **against_true(truth, diagnosis, true),
        **replayed(said),
        "seconds": said["seconds"],
        "process_seconds": said["process_seconds"],
        "peak_gib": said.get("peak_gib", np.nan),
        "alarm": alarm(diagnosis),
        "beside_unknown": decoys.beside_unknown(diagnosis) if group == "outside" else 0,
    }
    row["answer"] = answer(group, row, truth, diagnosis)
    row["right"] = row["answer"] in ("named", "not judged", "told", "no mismatch")
    poor = row["hide"] == "poor" and row["right"]
    row["listed_or_right"] = bool(row["listed"] or poor)
    row["placed_or_right"] = bool(row["placed"] or poor)
    for key in ("hidden", "findings", "suspected", "joints", "notes"):
        content = truth["effects"] if key == "hidden" else diagnosis.get(key, [])
        row[key] = json.dumps(content)
    return row


def first_said(truth: Content, diagnosis: Content) -> str:
    """The first finding's name beside what belongs to the hidden effect; or what stood for one."""
    if diagnosis["verdict"].startswith("error"):
        return "error"
    rest = rest_of(truth["effects"], diagnosis["findings"], last_link(truth["joints"]))
    if rest:
        return str(rest[0]["effect"])
    return {"cannot_tell": "cannot tell", "mismatch_unexplained": "unknown"}.get(
        diagnosis["verdict"], "nothing"
    )


def alarm(diagnosis: Content) -> bool:
    """Whether something is said to be wrong: a finding, a mismatch, a study refused."""
    return bool(diagnosis["findings"]) or diagnosis["verdict"].startswith(("mismatch", "error"))


def answer(group: str, row: Row, truth: Content, diagnosis: Content) -> str:
    """The right answer in a word (named, told, not judged, no mismatch), or wrong."""
    if group == "clean":
        right = diagnosis["verdict"] == "no_mismatch" and not diagnosis["findings"]
        return "no mismatch" if right else "wrong"
    hidden = truth["effects"][0] if truth["effects"] else None
    if group == "outside":
        return "told" if decoys.unknown_told(hidden, diagnosis) else "wrong"
    if group == "lying":
        return "told" if decoys.lie_told(hidden, diagnosis) else "wrong"
    if group == "still":
        return "not judged" if decoys.still_told(truth["still"], diagnosis) else "wrong"
    if row["hide"] == "poor":
        rest = rest_of(truth["effects"], diagnosis["findings"], last_link(truth["joints"]))
        listed = bool(row["listed"])
        others = sum(each["effect"] != "unknown" for each in rest)
        return decoys.poor_told(truth["still"], diagnosis, listed=listed, others=others)
    return "named" if row["named"] and row["placed"] else "wrong"


def window(truth: Content, diagnosis: Content) -> Row:
    """Whether the hidden effect acts in a window only, and whether that was told."""
    hidden = truth["effects"][0] if truth["effects"] else {}
    kinds = [kind for kind in ("window", "position_window") if hidden.get(kind)]
    if not kinds:
        return {"window_hidden": False, "window_told": False}
    last = last_link(truth["joints"])
    told = False
    for finding in diagnosis["findings"]:
        if name_of(finding, last) == name_of(hidden, last):
            given = finding.get("window" if kinds[0] == "window" else "positions")
            told = told or overlap(given, hidden[kinds[0]]) > 0.5
    return {"window_hidden": True, "window_told": told}


def against_true(truth: Content, diagnosis: Content, true: Mapping[str, float]) -> Row:
    """Held-out residual after, over the true model's; over the noise floor where there is none.

    The median of the joints that show what is hidden, as in `diagnosis_score.left`.
    """
    joints = {n: each for n, each in diagnosis["joints"].items() if each["noise_floor"] > 0.0}
    shown = [n for n, each in joints.items() if each["before"] > AFFECTED * each["noise_floor"]]
    at = [n for effect in truth["effects"][:1] for n in effect["joints"] if n in joints]
    names = [n for n in shown or at or list(joints) if true.get(n, 1.0) > 0.0]
    if not names:
        return {"over_true": np.nan, "by_floor": True}
    by_floor = not all(n in true for n in names)
    floors = {n: joints[n]["noise_floor"] if by_floor else true[n] for n in names}
    ratio = float(np.median([joints[n]["after"] / floors[n] for n in names]))
    return {"over_true": ratio, "by_floor": by_floor}


def replayed(said: Content) -> Row:
    """Motion error of held-out recordings replayed, root mean square, before and after [rad]."""
    replays = said.get("replays") or []
    if not replays:
        return {"replay_before": np.nan, "replay_after": np.nan}
    return {
        f"replay_{which}": float(np.sqrt(np.mean([each[which] ** 2 for each in replays])))
        for which in ("before", "after")
    }
