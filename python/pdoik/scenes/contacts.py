"""Rules of contact in scene files, pdoik's own and MoveIt's."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

from pdoik._core import ContactRule
from pdoik.scenes import moveit_octomap
from pdoik.scenes.values import EntryError

_KEYS = ("one", "other", "allowed", "clearance", "optional")
_PIECE = re.compile(r"(.+)/\d+")


def read_rules(value: Any, file: Path, entry: str) -> list[ContactRule]:
    """What pdoik's own YAML lists as `contacts`.

    Raises:
        EntryError: Names the rule and what is wrong with it.
    """
    if not isinstance(value, list):
        raise EntryError(file, f"expected a list of rules, got {value!r}", entry)
    return [_read_rule(item, file, f"{entry}[{k}]") for k, item in enumerate(value)]


def _read_rule(item: Any, file: Path, entry: str) -> ContactRule:
    if not isinstance(item, Mapping) or not {"one", "other"} <= set(item) <= set(_KEYS):
        raise EntryError(file, f"expected {{{', '.join(_KEYS)}}}, got {item!r}", entry)
    allowed, clearance = item.get("allowed"), item.get("clearance")
    optional = item.get("optional", False)
    names = item["one"], item["other"]
    if not all(isinstance(name, str) for name in names):
        raise EntryError(file, f"expected two names, got {names!r}", entry)
    if not isinstance(optional, bool):
        raise EntryError(file, f"expected true or false, got {optional!r}", f"{entry}.optional")
    for key, length in (("allowed", allowed), ("clearance", clearance)):
        is_length = isinstance(length, int | float) and not isinstance(length, bool)
        if length is not None and not is_length and not (key == "allowed" and length in (0, 1)):
            expected = "true, false or a depth" if key == "allowed" else "metres"
            raise EntryError(file, f"expected {expected}, got {length!r}", f"{entry}.{key}")
    try:
        return ContactRule(*names, allowed=allowed, clearance=clearance, optional=optional)
    except ValueError as error:
        raise EntryError(file, str(error), entry) from error


def rule_entry(rule: ContactRule) -> dict[str, Any]:
    """What `read_rules` reads."""
    entry: dict[str, Any] = {"one": rule.one, "other": rule.other}
    if rule.clearance is None:
        entry["allowed"] = False
    elif rule.clearance == -math.inf:
        entry["allowed"] = True
    else:
        entry["clearance"] = rule.clearance
    return entry | ({"optional": True} if rule.optional else {})


def rules_of_pairs(pairs: Iterable[tuple[str, str]], shapes: Iterable[str]) -> list[ContactRule]:
    """Rules that let links touch these shapes and no others.

    A name also means the pieces of an object: those that may not be touched are ruled out again.

    Args:
        pairs: (link, shape).
        shapes: All that there are.
    """
    names, by_link = list(shapes), dict[str, list[str]]()
    for link, shape in pairs:
        by_link.setdefault(link, []).append(shape)
    rules = []
    for link, touched in by_link.items():
        may = set(touched)
        rules += [ContactRule(link, shape) for shape in touched]
        rules += [
            ContactRule(link, name, allowed=False)
            for name in names
            if name not in may and (piece := _PIECE.fullmatch(name)) and piece[1] in may
        ]
    return rules


def is_pattern(name: str) -> bool:
    """Whether a rule's name is not exact."""
    return bool(set("*?") & set(name))


def as_optional(rule: ContactRule) -> ContactRule:
    """The same where there may be nothing of its names."""
    if rule.clearance is None:
        return ContactRule(rule.one, rule.other, allowed=False, optional=True)
    return ContactRule(rule.one, rule.other, clearance=rule.clearance, optional=True)


def read_matrix(
    scene: Mapping[str, Any], file: Path, objects: Collection[str] = ()
) -> list[ContactRule]:
    """What the allowed_collision_matrix of a PlanningScene says, as MoveIt reads it.

    A pair has an entry of its own, or else counts by the defaults of its two names, of which one
    that checks collisions wins. All rules are optional: such files list links and objects that
    others do not have. Of a link and an object the link comes first. Names are exact there: one
    with `*` or `?` that the scene does not have allows nothing.

    Args:
        scene: A PlanningScene.
        file: Where it comes from, for messages.
        objects: The names of the scene's objects.

    Raises:
        EntryError: The matrix is not square, or a default has no value.
    """
    at = "allowed_collision_matrix"
    matrix = scene.get(at) or {}
    names, rows = matrix.get("entry_names") or [], matrix.get("entry_values") or []
    if len(rows) != len(names):
        raise EntryError(file, f"{len(names)} entry_names, {len(rows)} entry_values", at)
    by_default, values = (matrix.get(f"default_entry_{what}") or [] for what in ("names", "values"))
    if len(by_default) != len(values):
        what = f"{len(by_default)} default_entry_names, {len(values)} default_entry_values"
        raise EntryError(file, what, at)
    pairs = zip(by_default, values, strict=True)
    named = {_name(name, objects): _is_true(value) for name, value in pairs}
    defaults = {name: may for name, may in named.items() if _is_exact(name, objects)}
    rules = [_rule(name, "*", may=True) for name, may in defaults.items() if may]
    if rules:
        rules += [_rule(name, "*", may=False) for name, may in defaults.items() if not may]
    entries: dict[tuple[str, str], bool] = {}
    for first, row in zip(names, rows, strict=True):
        enabled = row.get("enabled", []) if isinstance(row, Mapping) else row
        for second, value in zip(names, enabled, strict=False):
            one, other = _name(first, objects), _name(second, objects)
            if one == other:
                continue
            pair = (other, one) if one in objects and other not in objects else (one, other)
            pair = pair if pair[::-1] not in entries else pair[::-1]
            entries[pair] = entries.get(pair, False) or _is_true(value)
    for pair, may in entries.items():
        if not all(_is_exact(name, objects) for name in pair):
            continue
        # What is checked says nothing new, but where a default lets it touch.
        if may or any(defaults.get(name, False) for name in pair):
            rules.append(_rule(*pair, may=may))
    return rules


def _name(name: Any, objects: Collection[str]) -> str:
    """Name as rules have it: MoveIt's octomap is a shape if the scene has it, else all points."""
    is_points = str(name) == moveit_octomap.NAME and str(name) not in objects
    return "points" if is_points else str(name)


def _is_exact(name: str, objects: Collection[str]) -> bool:
    """Whether a rule of it is of that name alone, and not of all that are like it."""
    return name in objects or not is_pattern(name)


def _is_true(value: Any) -> bool:
    return value is True or value == 1


def _rule(one: str, other: str, *, may: bool) -> ContactRule:
    return ContactRule(one, other, allowed=may, optional=True)
