"""One study's scores: its truth and what was said of it.

What the right answer to a decoy is, and to a study whose motion cannot show what is hidden.

- *outside*: physics that the catalogue lacks. Right where the mismatch is seen and no name is
  claimed to explain it all: the verdict is `mismatch_unexplained` without any name, or it is
  `mismatch_unexplained` or `mismatch_partly_explained` and one of the findings is `unknown` at the
  hidden joint (at any joint where no joint but a link carries it). Names claimed together with
  `unknown` do not make it wrong; they are counted (`beside_unknown`).
- *lying*: a channel that is not what its name says. Right where a finding says that a sensor or
  torque of that joint reads wrong, and of that channel; where a note names that channel of that
  joint (`tau.joint3`); where the study is refused with a question about that channel; or, where the
  model was logged as torque, where a note says that torque is no measurement.
- *still*: joints that do not move. Right where none of these is judged (they are marked as moved
  too little, or the verdict is `cannot_tell`) and nothing is found at them.
- *poor*: an effect of the catalogue under motion that hardly shows it. Right where it is named, or
  listed, all the same; or where no other name is claimed (`unknown` is none) and either the verdict
  is `cannot_tell`, or all joints that stood still are marked as moved too little, or the study is
  refused because nothing moves in it. "No mismatch" without such a mark is wrong, and so is another
  name.
"""

import json
from collections.abc import Iterable, Mapping

import numpy as np

from bench.common.campaign import Row
from bench.sim2real.concealed.score import AFFECTED, last_link, name_of, overlap, rest_of, scores
from bench.sim2real.frame.score import Content, as_diagnosis

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
        **scores(truth, diagnosis),
        **window(truth, diagnosis),
        **against_true(truth, diagnosis, true),
        **replayed(said),
        "seconds": said["seconds"],
        "process_seconds": said["process_seconds"],
        "peak_gib": said.get("peak_gib", np.nan),
        "alarm": alarm(diagnosis),
        "beside_unknown": beside_unknown(diagnosis) if group == "outside" else 0,
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
    """The first finding's name besides what belongs to the hidden effect; or what stood for one."""
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
        return "told" if unknown_told(hidden, diagnosis) else "wrong"
    if group == "lying":
        return "told" if lie_told(hidden, diagnosis) else "wrong"
    if group == "still":
        return "not judged" if still_told(truth["still"], diagnosis) else "wrong"
    if row["hide"] == "poor":
        rest = rest_of(truth["effects"], diagnosis["findings"], last_link(truth["joints"]))
        listed = bool(row["listed"])
        others = sum(each["effect"] != "unknown" for each in rest)
        return poor_told(truth["still"], diagnosis, listed=listed, others=others)
    return "named" if row["named"] and row["placed"] else "wrong"


def window(truth: Content, diagnosis: Content) -> Row:
    """Whether the hidden effect acts in a window only, and whether that was reported."""
    hidden = truth["effects"][0] if truth["effects"] else {}
    kinds = [kind for kind in ("window", "position_window") if hidden.get(kind)]
    if not kinds:
        return {"window_hidden": False, "window_told": False}
    last = last_link(truth["joints"])
    found = False
    for finding in diagnosis["findings"]:
        if name_of(finding, last) == name_of(hidden, last):
            given = finding.get("window" if kinds[0] == "window" else "positions")
            found = found or overlap(given, hidden[kinds[0]]) > 0.5
    return {"window_hidden": True, "window_told": found}


def against_true(truth: Content, diagnosis: Content, true: Mapping[str, float]) -> Row:
    """Held-out residual after, over the true model's; over the noise floor where there is none.

    The median of the joints that show what is hidden, as in `concealed.score.left`.
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


NOTHING_MOVES = "no joint moves"  # within the words of a refusal
CHANNEL_OF_VARIANT = {"speed": "dq", "logged speed": "dq", "position": "q", "logged position": "q"}


def unknown_told(hidden: Content, said: Content) -> bool:
    unknown = [each for each in said["findings"] if each["effect"] == "unknown"]
    if said["verdict"] == "mismatch_unexplained" and len(unknown) == len(said["findings"]) == 0:
        return True
    at = set(hidden["joints"])
    left = {name for name, each in said["joints"].items() if each.get("residue")}
    placed = any(not at or at & joints for joints in (*(set(u["joints"]) for u in unknown), left))
    return placed and said["verdict"] in ("mismatch_unexplained", "mismatch_partly_explained")


def beside_unknown(said: Content) -> int:
    """Names claimed where the catalogue has none."""
    return sum(each["effect"] != "unknown" for each in said["findings"])


def lie_told(hidden: Content, said: Content) -> bool:
    if hidden["kind"] == "tau_model":
        return any("no measurement" in note for note in said["notes"])
    channel, (joint,) = hidden["channel"], hidden["joints"]
    if said["verdict"].startswith("error"):
        return f"'{channel}'" in said["verdict"]
    if any(f"{channel}.{joint} " in f"{note} " for note in said["notes"]):
        return True
    return any(
        each["effect"] in ("sensor_gain", "torque_gain")
        and joint in each["joints"]
        and channel_of(each) == channel
        for each in said["findings"]
    )


def channel_of(finding: Content) -> str:
    """The channel whose factor a finding states."""
    if finding["effect"] == "torque_gain":
        return "tau"
    return CHANNEL_OF_VARIANT.get(finding.get("variant", ""), "tau")


def nothing_judged(still: Iterable[str], said: Content) -> bool:
    """Whether joints that stood still are said not to be judged."""
    joints = said["joints"]
    if said["verdict"] == "cannot_tell" or NOTHING_MOVES in said["verdict"]:
        return True
    marked = [name in joints and not joints[name]["excited"] for name in still]
    return bool(marked) and all(marked)


def still_told(still: Iterable[str], said: Content) -> bool:
    names = set(still)
    found = any(names & set(each["joints"]) for each in said["findings"])
    return nothing_judged(names, said) and not found


def poor_told(still: Iterable[str], said: Content, *, listed: bool, others: int) -> str:
    """How a study with poor motion was answered: named, not judged, or wrong."""
    if listed:
        return "named"
    return "not judged" if others == 0 and nothing_judged(still, said) else "wrong"
