"""What the right answer to a decoy is, and to a study whose motion cannot show what is hidden.

- *outside*: physics that the catalogue lacks. Right where the mismatch is seen and no name is
  claimed to explain it all: the verdict is `mismatch_unexplained` without any name, or it is
  `mismatch_unexplained` or `mismatch_partly_explained` and one of the findings is `unknown` at the
  hidden joint (at any joint where no joint but a link carries it). Names claimed beside `unknown`
  do not make it wrong; they are counted (`beside_unknown`).
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

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

Entry = Mapping[str, Any]
Said = Mapping[str, Any]  # diagnosis.json, or an error as its verdict

NOTHING_MOVES = "no joint moves"  # within the words of a refusal
CHANNEL_OF_VARIANT = {"speed": "dq", "logged speed": "dq", "position": "q", "logged position": "q"}


def unknown_told(hidden: Entry, said: Said) -> bool:
    """Of physics outside the catalogue."""
    unknown = [each for each in said["findings"] if each["effect"] == "unknown"]
    if said["verdict"] == "mismatch_unexplained" and len(unknown) == len(said["findings"]) == 0:
        return True
    at = set(hidden["joints"])
    left = {name for name, each in said["joints"].items() if each.get("residue")}
    placed = any(not at or at & joints for joints in (*(set(u["joints"]) for u in unknown), left))
    return placed and said["verdict"] in ("mismatch_unexplained", "mismatch_partly_explained")


def beside_unknown(said: Said) -> int:
    """Names claimed where the catalogue has none."""
    return sum(each["effect"] != "unknown" for each in said["findings"])


def lie_told(hidden: Entry, said: Said) -> bool:
    """Of a channel that lies."""
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


def channel_of(finding: Entry) -> str:
    """The channel whose factor a finding states."""
    if finding["effect"] == "torque_gain":
        return "tau"
    return CHANNEL_OF_VARIANT.get(finding.get("variant", ""), "tau")


def nothing_judged(still: Iterable[str], said: Said) -> bool:
    """Whether joints that stood still are said not to be judged."""
    joints = said["joints"]
    if said["verdict"] == "cannot_tell" or NOTHING_MOVES in said["verdict"]:
        return True
    marked = [name in joints and not joints[name]["excited"] for name in still]
    return bool(marked) and all(marked)


def still_told(still: Iterable[str], said: Said) -> bool:
    """Of joints that did not move."""
    names = set(still)
    found = any(names & set(each["joints"]) for each in said["findings"])
    return nothing_judged(names, said) and not found


def poor_told(still: Iterable[str], said: Said, *, listed: bool, others: int) -> str:
    """How a study with poor motion was answered: named, not judged, or wrong."""
    if listed:
        return "named"
    return "not judged" if others == 0 and nothing_judged(still, said) else "wrong"
