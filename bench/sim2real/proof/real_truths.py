"""What is known to be true of real machines, and whether a diagnosis agrees."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pdoik.sim2real.effects import CATALOGUE

Content = Mapping[str, Any]

FRICTION = {each.id for each in CATALOGUE.values() if each.family == "friction"} | {
    "gear_efficiency"
}
LOADS = {"payload": "mass", "link_inertial_error": "d_mass"}
DELAYS = ("command_delay", "actuator_lag")


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """A fact, and how a diagnosis is held against it."""

    fact: str
    said: Callable[[Content], tuple[str, bool]]  # of a diagnosis: in words, and whether it agrees


def friction_everywhere(fact: str) -> Known:
    """Friction of some kind at every joint that is judged."""

    def said(diagnosis: Content) -> tuple[str, bool]:
        judged = [name for name, each in diagnosis["joints"].items() if each["excited"]]
        rubbing = {j for f in _findings(diagnosis, FRICTION) for j in f["joints"]}
        missing = [name for name in judged if name not in rubbing]
        words = f"friction at {len(judged) - len(missing)} of {len(judged)} joints"
        return words + (f", not {', '.join(missing)}" if missing else ""), not missing

    return Known(fact=fact, said=said)


def friction_within(least: float, most: float, fact: str) -> Known:
    """Levels of dry friction, where they are told, within bounds [N m]."""

    def said(diagnosis: Content) -> tuple[str, bool]:
        levels = [
            f["parameters"]["level"]["value"]
            for f in _findings(diagnosis, FRICTION)
            if "level" in f["parameters"]
        ]
        if not levels:
            return "no dry friction", False
        words = f"{len(levels)} levels, {min(levels):.2g} to {max(levels):.2g} N m"
        return words, least <= min(levels) and max(levels) <= most

    return Known(fact=fact, said=said)


def no_load_beyond(most: float, fact: str) -> Known:
    """No mass that was not there, but for so much [kg]."""

    def said(diagnosis: Content) -> tuple[str, bool]:
        found = [
            (f["links"][0], f["parameters"][LOADS[f["effect"]]]["value"])
            for f in _findings(diagnosis, LOADS)
            if LOADS[f["effect"]] in f["parameters"]
        ]
        words = ", ".join(f"{mass:+.2g} kg at {link}" for link, mass in found)
        return words or "no mass", all(abs(mass) <= most for _, mass in found)

    return Known(fact=fact, said=said)


def delay_between(least: float, most: float, fact: str) -> Known:
    """Delay and lag of commands together at every joint, of those that are told [s]."""

    def said(diagnosis: Content) -> tuple[str, bool]:
        late: dict[str, float] = {}
        for f in _findings(diagnosis, DELAYS):
            values = {name: each["value"] for name, each in f["parameters"].items()}
            for joint in f["joints"]:
                late[joint] = late.get(joint, 0.0) + sum(values.values())
        if not late:
            return "no delay", False
        words = f"{len(late)} joints, {min(late.values()):.2g} to {max(late.values()):.2g} s"
        return words, all(least <= each <= most for each in late.values())

    return Known(fact=fact, said=said)


def none_of(effects: Sequence[str], fact: str, joints: Sequence[str] = ()) -> Known:
    """None of these names, at some joints or anywhere."""

    def said(diagnosis: Content) -> tuple[str, bool]:
        wrong = [
            f"{f['effect']} at {', '.join(f['joints'])}"
            for f in _findings(diagnosis, effects)
            if not joints or set(f["joints"]) & set(joints)
        ]
        return "; ".join(wrong) or "none of it", not wrong

    return Known(fact=fact, said=said)


def _findings(diagnosis: Content, effects: Any) -> list[Content]:
    return [each for each in diagnosis["findings"] if each["effect"] in effects]
