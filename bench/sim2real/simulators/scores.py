"""How right a comparison is about a machine of worlds.py: strictly and leniently."""

import json
from collections.abc import Iterator, Sequence
from typing import Any

import pandas as pd

from bench.common.intervals import share
from bench.common.markdown import markdown_table
from bench.sim2real.frame.score import Content, alternatives
from bench.sim2real.simulators.worlds import NEAR, SAID

_BESIDE = {"coulomb_friction": ("frictionloss",), "viscous_friction": ("damping", "kv")}
_SURE = 0.9


def right(finding: Content, answer: Content) -> str:
    """strict, lenient or "": whether what a finding says is there.

    Strict is one of the words for what the machine has, at its joint or link. Of an effect that
    simulators have no word for only what comes with it counts (the dry friction below Stribeck's).
    Lenient are also the nearest words for it at its joint, and a word that the finding lists as
    explaining the same.
    """
    if _mass_improves(finding, answer):
        return "strict"
    for effect in answer["effects"]:
        words = SAID.get(effect["effect"], ())
        words += tuple(w for each in effect["beside"] for w in _BESIDE.get(each, ()))
        if _says(finding, effect, words):
            return "strict"
    for effect in answer["effects"]:
        words = SAID.get(effect["effect"], ()) + NEAR.get(effect["effect"], ())
        if any(_says(each, effect, words) for each in alternatives(finding, None)):
            return "lenient"
    return ""


def _says(finding: Content, effect: Content, words: Sequence[str]) -> bool:
    if finding["effect"] not in words:
        return False
    joints, links = set(finding["joints"]), set(finding["links"])
    here = {*effect["joints"], *(f"link{j.removeprefix('joint')}" for j in effect["joints"])}
    return bool((joints | links) & (here | set(effect["links"])))


def _mass_improves(finding: Content, answer: Content) -> bool:
    """Whether a mass comes nearer to the true one, where all masses are misjudged."""
    masses, value = answer["masses"], finding["values"].get("mass")
    if not masses or value is None or not set(finding["links"]) <= set(masses):
        return False
    (link,) = finding["links"]
    return abs(value / masses[link] - 1.0) < 0.04  # where it is about 0.05 off


def score(name: str, answer: Content, said: Content) -> dict[str, Any]:
    """One row: what was said and what is there, a JSON list of each."""
    found = said.get("comparison", {}).get("findings", [])
    return {
        "name": name,
        "clean": not answer["effects"] and not answer["masses"],
        "silent": not any(each["claimed"] for each in found),
        "failed": "error" in said,
        "seconds": said["seconds"],
        "findings": json.dumps(list(rows_of(answer, found))),
        "causes": json.dumps(list(causes_of(answer, found))),
    }


def rows_of(answer: Content, found: Sequence[Content]) -> Iterator[dict[str, Any]]:
    about = {key: answer["job"][key] for key in ("name", "effect", "background", "torque")}
    for finding in found:
        yield {
            **about,
            "said": finding["effect"],
            "claimed": finding["claimed"],
            "confidence": finding["confidence"],
            "gain": finding["gain"],
            "right": right(finding, answer),
        }


def causes_of(answer: Content, found: Sequence[Content]) -> Iterator[dict[str, Any]]:
    """A row for each thing that is there: whether it was claimed, by its word or nearly."""
    for effect in answer["effects"]:
        words = SAID.get(effect["effect"], ())
        near = words + NEAR.get(effect["effect"], ())
        claimed = [f for f in found if f["claimed"]]
        listed = [each for f in claimed for each in alternatives(f, None)]
        yield {
            "effect": effect["effect"],
            "role": effect["role"],
            "has word": bool(words),
            "strict": any(_says(f, effect, words) for f in claimed),
            "lenient": any(_says(f, effect, near) for f in (*listed, *found)),
        }


def unfolded(worlds: pd.DataFrame, column: str) -> pd.DataFrame:
    """A row per finding, or per cause, of all worlds."""
    return pd.DataFrame([row for world in worlds[column] for row in json.loads(world)])


def all_tables(worlds: pd.DataFrame, not_made: Sequence[str] = ()) -> str:
    """Precision, recall, and what confidences are worth."""
    findings, causes = (unfolded(worlds, column) for column in ("findings", "causes"))
    claimed = findings[findings.claimed]
    sure = claimed[claimed.confidence >= _SURE]
    precision = [
        (what, share(part.right == "strict"), share(part.right != ""))
        for what, part in (
            ("all claims", claimed),
            (f"of confidence {_SURE:g} and more", sure),
            ("below it", claimed[claimed.confidence < _SURE]),
            ("where its simulator has words for all", claimed[claimed.effect.isin(SAID)]),
            ("where it lacks one", claimed[claimed.effect.isin(NEAR)]),
            ("suspected, not claimed", findings[~findings.claimed]),
        )
        if len(part)
    ]
    recall = [
        (what, share(part.strict), share(part.lenient))
        for what, part in (
            ("hidden, a word for it", causes[(causes.role == "hidden") & causes["has word"]]),
            ("hidden, no word for it", causes[(causes.role == "hidden") & ~causes["has word"]]),
            ("friction of the background", causes[causes.role == "background"]),
        )
        if len(part)
    ]
    by_effect = [
        (effect, share(part.strict), share(part.lenient))
        for effect, part in causes[causes.role == "hidden"].groupby("effect")
    ]
    clean = worlds[worlds.clean]
    return "\n".join(
        (
            f"{len(worlds)} pairs; {clean.silent.sum()} of {len(clean)} clean machines of which"
            f" nothing is said; {worlds.failed.sum()} that could not be compared,"
            f" {len(not_made)} that could not be made.\n",
            markdown_table(("claims", "right, strict", "lenient"), precision),
            markdown_table(("there", "claimed by its word", "or nearly, or suspected"), recall),
            markdown_table(("hidden", "claimed by its word", "or nearly, or suspected"), by_effect),
        )
    )
