"""What may be known of a real machine, held against a diagnosis of it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bench.sim2real.proof.real_counts import (
    Content,
    Count,
    Fact,
    Finding,
    Told,
    is_refusal,
    named,
)
from pdoik.sim2real.effects import CATALOGUE, VARIABLES

Range = tuple[float, float]

FRICTION = {each.id for each in CATALOGUE.values() if each.family == "friction"} | {
    "gear_efficiency"
}
DRY = ("coulomb_friction", "presliding_hysteresis")  # what has a level
LOADS = {"payload": "mass", "link_inertial_error": "d_mass"}
DELAYS = ("command_delay", "actuator_lag")


# What may be known


def friction_at(diagnosis: Content, joints: Sequence[str]) -> Told:
    """Friction of some kind at each of these joints."""
    rubbing = {j for _, f in _findings(diagnosis, FRICTION) for j in f["joints"]}
    missing = [name for name in joints if name not in rubbing]
    count = Count(len(joints) - len(missing), len(joints))
    words = f"friction at {count} joints" + (f", not {', '.join(missing)}" if missing else "")
    return Told(words=words, agrees=not missing, needed=count)


def friction_within(diagnosis: Content, least: float, most: float) -> Told:
    """Levels of dry friction, where they are reported, within bounds [N m]."""
    levels = [
        f["parameters"]["level"]["value"]
        for _, f in _findings(diagnosis, FRICTION)
        if "level" in f["parameters"]
    ]
    if not levels:
        return Told(words="no dry friction", agrees=False)
    words = f"{len(levels)} levels, {min(levels):.2g} to {max(levels):.2g} N m"
    figures = Count(sum(least <= each <= most for each in levels), len(levels))
    return Told(words=words, agrees=figures.hits == figures.of, figures=figures)


def no_load_beyond(diagnosis: Content, most: float) -> Told:
    """No mass that was not there, but for so much [kg]."""
    found = [
        (k, f["links"][0], f["parameters"][LOADS[f["effect"]]]["value"])
        for k, f in _findings(diagnosis, LOADS)
        if LOADS[f["effect"]] in f["parameters"]
    ]
    wrong = frozenset(k for k, _, mass in found if abs(mass) > most)
    words = ", ".join(f"{mass:+.2g} kg at {link}" for _, link, mass in found)
    return Told(words=words or "no mass", agrees=not wrong, wrong=wrong)


def delay_between(diagnosis: Content, joints: Sequence[str], least: float, most: float) -> Told:
    """Delay and lag of commands together, within bounds at every joint where it is reported [s]."""
    late: dict[str, float] = {}
    for _, f in _findings(diagnosis, DELAYS):
        for joint in f["joints"]:
            lateness = sum(each["value"] for each in f["parameters"].values())
            late[joint] = late.get(joint, 0.0) + lateness
    needed = Count(sum(joint in late for joint in joints), len(joints))
    if not late:
        return Told(words="no delay", agrees=False, needed=needed)
    figures = Count(sum(least <= each <= most for each in late.values()), len(late))
    words = f"{len(late)} joints, {min(late.values()):.2g} to {max(late.values()):.2g} s"
    agrees = figures.hits == figures.of
    return Told(words=words, agrees=agrees, needed=needed, figures=figures)


def none_of(diagnosis: Content, effects: Collection[str], joints: Collection[str] = ()) -> Told:
    """None of these names, at some joints or anywhere."""
    wrong = {
        k: f
        for k, f in _findings(diagnosis, effects)
        if not joints or set(f["joints"]) & set(joints)
    }
    words = "; ".join(named(f) for f in wrong.values()) or "none of it"
    return Told(words=words, agrees=not wrong, wrong=frozenset(wrong))


def only(diagnosis: Content, may: Callable[[Finding], bool], needless: int = 0) -> Told:
    """Nothing but what may be there, and so many needless names that are forgiven."""
    wrong = {k: f for k, f in enumerate(diagnosis["findings"]) if not may(f)}
    words = "; ".join(named(f) for f in wrong.values()) or "nothing else"
    return Told(words=words, agrees=len(wrong) <= needless, wrong=frozenset(wrong))


def figures_at(
    diagnosis: Content,
    effects: Collection[str],
    parameter: str,
    known: Mapping[str, Range],
    share: float = 0.0,
    optional: bool = False,
) -> Told:
    """A cause at each of these joints, its figure within a share of what is known, or about it.

    Args:
        diagnosis: what was said.
        effects: names of it; a finding that lists one as equivalent names it too.
        parameter: its figure.
        known: where it lies, by joint; an interval that reaches there is right as well.
        share: by which it may miss that.
        optional: saying nothing is right as well, and no cause is needed.
    """
    words, causes, figures = list[str](), 0, Count()
    for joint, span in known.items():
        here = [f for f in diagnosis["findings"] if joint in f["joints"] and _names(f, effects)]
        causes += bool(here)
        estimates = [f["parameters"][parameter] for f in here if parameter in f["parameters"]]
        figures += Count(
            sum(_within(each, span, share) for each in estimates[:1]), len(estimates[:1])
        )
        words += [f"{joint} {estimates[0]['value']:.2g}" if estimates else f"{joint} {_of(here)}"]
    right = figures.hits == figures.of and (optional or figures.of == len(known))
    needed = Count() if optional else Count(causes, len(known))
    return Told(words=", ".join(words), agrees=right, needed=needed, figures=figures)


def tilt_about_y(diagnosis: Content, least: float, most: float) -> Told:
    """A base that is turned so far about its y axis, and within ten degrees not about x [deg]."""
    found = [f["parameters"] for _, f in _findings(diagnosis, ("gravity_direction",))]
    if not found:
        return Told(words="no tilt", agrees=False, needed=Count(0, 1))
    x, y = (np.degrees(found[0][f"tilt_{axis}"]["value"]) for axis in "xy")
    right = bool(least <= y <= most and abs(x) <= 10.0)
    words = f"{y:.0f} degrees about y, {x:.0f} about x"
    return Told(words=words, agrees=right, needed=Count(1, 1), figures=Count(int(right), 1))


def depends_on_position(diagnosis: Content, joint: str) -> Told:
    """A torque of this joint that depends on its position, by name or without one."""
    found = [f for f in diagnosis["findings"] if joint in f["joints"] and of_position(f)]
    words = "; ".join(named(f) for f in found) or "no such torque"
    return Told(words=words, agrees=bool(found), needed=Count(int(bool(found)), 1))


def either_friction(diagnosis: Content, joint: str) -> Told:
    """Whether Coulomb's and viscous friction are said to be indistinguishable: listed or noted."""
    both = {"coulomb_friction", "viscous_friction"}
    here = [f for f in diagnosis["findings"] if joint in f["joints"]]
    listed = any({f["effect"]} | {e["effect"] for e in f["equivalents"]} >= both for f in here)
    noted = any("viscous" in each and "oulomb" in each for each in diagnosis["notes"])
    words = "listed as equivalents" if listed else "in a note" if noted else "not said"
    return Told(words=words, agrees=listed or noted)


def left_at_most(diagnosis: Content, most: Mapping[str, float]) -> Told:
    """Held-out residuals at most so large [N m]."""
    joints = diagnosis["joints"]
    after = {name: joints[name]["after"] if name in joints else np.inf for name in most}
    count = Count(sum(after[name] <= limit for name, limit in most.items()), len(most))
    words = ", ".join(f"{each:.2g}" for each in after.values()) + " N m"
    return Told(words=words, agrees=count.hits == count.of, residuals=count)


def or_refused(diagnosis: Content, fact: Fact, why: Collection[str]) -> Told:
    """A fact, or that nothing is said, for a reason that has one of these words."""
    outcome = fact(diagnosis)
    refused = diagnosis["verdict"] == "cannot_tell" or is_refusal(diagnosis)
    text = " ".join([diagnosis["verdict"], *diagnosis["notes"]]).lower()
    if refused and not diagnosis["findings"] and any(each in text for each in why):
        return replace(outcome, words="refused, for it", agrees=True, needed=_full(outcome.needed))
    return outcome


def of_position(finding: Finding) -> bool:
    """Whether it is a torque that depends on the joint's position."""
    if finding["effect"] == "unknown":
        index = int(finding["parameters"]["variable"]["value"])
        return "position" in VARIABLES[index] and "other" not in VARIABLES[index]
    return bool(finding["effect"] == "position_dependent_spring")


# What a finding says


def _findings(diagnosis: Content, effects: Collection[str]) -> list[tuple[int, Finding]]:
    return [(k, f) for k, f in enumerate(diagnosis["findings"]) if f["effect"] in effects]


def _names(finding: Finding, effects: Collection[str]) -> bool:
    return finding["effect"] in effects or any(
        each["effect"] in effects for each in finding["equivalents"]
    )


def _of(findings: Sequence[Finding]) -> str:
    return findings[0]["effect"] if findings else "none"


def _within(estimate: Mapping[str, Any], known: Range, share: float) -> bool:
    (low, high), value = estimate["interval95"], estimate["value"]
    inside = known[0] - share * abs(known[0]) <= value <= known[1] + share * abs(known[1])
    narrow = high - low <= 2.0 * abs(value)  # one that holds everything tells nothing
    return bool(inside or (narrow and low <= known[1] and high >= known[0]))


def _full(count: Count) -> Count:
    return Count(count.of, count.of)
