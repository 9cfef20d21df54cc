"""How right a comparison is about a machine of simulator_worlds.py: strictly and leniently."""

from collections.abc import Iterator, Sequence
from typing import Any

import pandas as pd

from bench.common.intervals import share
from bench.common.markdown import markdown_table
from bench.sim2real.simulators.worlds import NEAR, SAID

Told = dict[str, Any]
_BESIDE = {"coulomb_friction": ("frictionloss",), "viscous_friction": ("damping", "kv")}
_SURE = 0.9


def right(finding: Told, answer: Told) -> str:
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
        if any(_says(each, effect, words) for each in (finding, *finding["equivalents"])):
            return "lenient"
    return ""


def _says(finding: Told, effect: Told, words: Sequence[str]) -> bool:
    if finding["effect"] not in words:
        return False
    joints, links = set(finding["joints"]), set(finding["links"])
    here = {*effect["joints"], *(f"link{j.removeprefix('joint')}" for j in effect["joints"])}
    return bool((joints | links) & (here | set(effect["links"])))


def _mass_improves(finding: Told, answer: Told) -> bool:
    """Whether a mass comes nearer to the true one, where all masses are misjudged."""
    masses, value = answer["masses"], finding["values"].get("mass")
    if not masses or value is None or not set(finding["links"]) <= set(masses):
        return False
    (link,) = finding["links"]
    return abs(value / masses[link] - 1.0) < 0.04  # where it is about 0.05 off


def rows_of(answer: Told, said: Told) -> Iterator[Told]:
    about = {key: answer["job"][key] for key in ("name", "effect", "background", "torque")}
    for finding in said["findings"]:
        yield {
            **about,
            "said": finding["effect"],
            "claimed": finding["claimed"],
            "confidence": finding["confidence"],
            "gain": finding["gain"],
            "right": right(finding, answer),
        }


def causes_of(answer: Told, said: Told) -> Iterator[Told]:
    """A row for each thing that is there: whether it was claimed, by its word or nearly."""
    for effect in answer["effects"]:
        words = SAID.get(effect["effect"], ())
        near = words + NEAR.get(effect["effect"], ())
        claimed = [f for f in said["findings"] if f["claimed"]]
        listed = [each for f in claimed for each in (f, *f["equivalents"])]
        yield {
            "effect": effect["effect"],
            "role": effect["role"],
            "has word": bool(words),
            "strict": any(_says(f, effect, words) for f in claimed),
            "lenient": any(_says(f, effect, near) for f in (*listed, *said["findings"])),
        }


def tables(answers: Sequence[Told], said: Sequence[Told]) -> str:
    """Precision, recall, and what confidences are worth."""
    both = list(zip(answers, said, strict=True))
    findings = pd.DataFrame([row for a, s in both for row in rows_of(a, s)])
    causes = pd.DataFrame([row for a, s in both for row in causes_of(a, s)])
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
    clean = [s for a, s in both if not a["effects"] and not a["masses"]]
    silent = sum(not any(f["claimed"] for f in s["findings"]) for s in clean)
    failed = [a["job"]["name"] for a, s in both if "error" in s]
    return "\n".join(
        (
            f"{len(both)} pairs; {silent} of {len(clean)} clean machines of which nothing is said;"
            f" {len(failed)} that could not be compared.\n",
            markdown_table(("claims", "right, strict", "lenient"), precision),
            markdown_table(("there", "claimed by its word", "or nearly, or suspected"), recall),
            markdown_table(("hidden", "claimed by its word", "or nearly, or suspected"), by_effect),
        )
    )
