"""What is said of a concealed world held against its truth: names, places, figures, residuals."""

from collections.abc import Sequence

import numpy as np

from bench.common.campaign import Row
from bench.sim2real.frame.score import Content, alternatives, covered, error_of

ONE_NAME = {"actuator_lag": "command_delay", "link_inertial_error": "payload"}
"""Pairs that slow motion cannot split count as one name; of links only the last is a payload's."""

CHOICES = ("harmonic", "side")
"""Parameters that are chosen among a few values, so that an interval says nothing."""

OPEN_END = 60.0  # a truth's window that ends there ends with the recordings [s]
LEAST_OPEN = 5.0  # that such a window lasts at least [s]
AFFECTED = 1.5  # times its noise floor: a joint with more residual shows what is hidden


def scores(truth: Content, said: Content) -> Row:
    """How well a diagnosis, as its JSON has it, says what a truth has.

    What comes with the hidden effect (the Coulomb friction of a Stribeck curve) is no finding
    too many, and may be found before it.
    """
    found = said["findings"]
    if not truth["effects"]:
        right = not found and said["verdict"] == "no_mismatch"
        return {"named": right, "listed": right, "placed": right, "extra": len(found)} | measured(
            None, None, said["joints"]
        )
    hidden, last = truth["effects"][0], last_link(truth["joints"])
    rest = rest_of(truth["effects"], found, last)
    first = rest[0] if rest else None
    named = first is not None and name_of(first, last) == name_of(hidden, last)
    match = next((e for e in rest if e["effect"] == hidden["effect"] and placed(e, hidden)), None)
    return {
        "named": named,
        "listed": any(
            name_of(each, last) == name_of(hidden, last)
            for finding in rest
            if finding is first or placed(finding, hidden)
            for each in alternatives(finding)
        ),
        "placed": first is not None and placed(first, hidden),
        "extra": sum(not same(each, hidden, last) for each in rest[1:]),
    } | measured(hidden, match, said["joints"])


def rest_of(effects: Sequence[Content], found: Sequence[Content], last: str) -> list[Content]:
    """Findings but for what comes with the hidden effect, which is the first of a truth's."""
    return [each for each in found if not any(same(each, other, last) for other in effects[1:])]


def last_link(joints: Sequence[str]) -> str:
    """The link that carries a payload in a concealed arm."""
    return f"link{len(joints)}"


def name_of(entry: Content, last: str) -> str:
    """An effect's name; the same for a pair that counts as one."""
    if entry["effect"] == "link_inertial_error" and set(entry["links"]) != {last}:
        return "link_inertial_error"
    return ONE_NAME.get(entry["effect"], entry["effect"])


def same(finding: Content, entry: Content, last: str) -> bool:
    return name_of(finding, last) == name_of(entry, last) and placed(finding, entry)


def placed(finding: Content, entry: Content) -> bool:
    """Joints and links as hidden; a window, where one is given, mostly its own.

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


def measured(hidden: Content | None, match: Content | None, joints: Content) -> Row:
    """Parameters inside their intervals, the main one's error, and what residual is left."""
    row: Row = {"inside": 0, "intervals": 0, "error": np.nan, "left": left(hidden, joints)}
    if hidden is None or match is None:
        return row
    pairs = [
        (float(value), match["parameters"][name], name == "phase")
        for name, value in hidden["parameters"].items()
        if name in match["parameters"] and name not in CHOICES
    ]
    errors = [error_of(each, value, turns=turns) for value, each, turns in pairs]
    row["intervals"] = len(pairs)
    row["inside"] = sum(
        covered(each, error) for (_, each, _), error in zip(pairs, errors, strict=True)
    )
    for unit in dict.fromkeys(each["unit"] for _, each, _ in pairs):  # the main one first
        group = [k for k, (_, each, _) in enumerate(pairs) if each["unit"] == unit]
        size = np.linalg.norm([pairs[k][0] for k in group])
        if size > 0.0:
            row["error"] = float(np.linalg.norm([errors[k] for k in group]) / size)
            break
    return row


def left(hidden: Content | None, joints: Content) -> float:
    """Held-out residual over the noise floor: median of the joints that show what is hidden."""
    judged = {name: each for name, each in joints.items() if each["noise_floor"] > 0.0}
    shown = [
        name for name, each in judged.items() if each["before"] > AFFECTED * each["noise_floor"]
    ]
    names = shown or [n for n in (hidden or {}).get("joints", ()) if n in judged] or list(judged)
    ratios = [judged[name]["after"] / judged[name]["noise_floor"] for name in names]
    return float(np.median(ratios)) if ratios else float("nan")
