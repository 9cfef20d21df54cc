"""The user's MJCF with the changed attributes only, every other byte as it was."""

from __future__ import annotations

import re
import xml.parsers.expat
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from pdoik.errors import LoadError

from .candidates import EVERY, Knob, delays_with, model_with
from .user_model import UserModel

_ACTUATORS = ("position", "general", "motor", "intvelocity", "velocity")
_OF_JOINT = ("damping", "frictionloss", "armature", "stiffness", "ref")
_OF_BODY = ("mass", "com_x", "com_y", "com_z")


@dataclass(frozen=True, slots=True, kw_only=True)
class Patch:
    """An MJCF's text, and what it could not say."""

    text: str
    left_out: tuple[str, ...]  # in words


@dataclass(frozen=True, slots=True, kw_only=True)
class _Tag:
    """A start tag by its place in the text."""

    name: str
    attributes: Mapping[str, str]
    begin: int
    end: int  # behind its ">"
    owner: str  # the <body> around it
    inside: tuple[str, ...]  # names of the elements around it


def patched(user: UserModel, values: Mapping[Knob, float]) -> Patch:
    """The text with these values.

    Raises:
        LoadError: its joints or bodies are in included files.
    """
    text = user.source.read_text() if isinstance(user.source, Path) else user.source
    edits: dict[tuple[int, int], dict[str, str | None]] = {}
    inserts: dict[int, str] = {}
    tags = list(_tags(text))
    candidate, left_out = model_with(user, values), []
    touched = {(knob.property, knob.index) for knob in values if knob.index != EVERY}

    def edit(tag: _Tag, changed: Mapping[str, str | None]) -> None:
        edits.setdefault((tag.begin, tag.end), {}).update(changed)

    for k, joint in enumerate(user.joints):
        mine = {name for name, index in touched if index == k}
        if mine & set(_OF_JOINT):
            tag = _joint(tags, user, joint)
            for name in sorted(mine & set(_OF_JOINT)):
                value = values[Knob(name, k)]
                if name == "ref" and user.degrees and _turns(user, k):
                    value = float(np.rad2deg(value))
                edit(tag, {name: _number(value)})
        if mine & {"kp", "kv"}:
            if user.law_outside:
                left_out.append(f"gains of {joint}: they are the study's controller's")
            else:
                edit(_actuator(tags, user, k), _gains(tags, user, candidate, k))
        if mine & set(_OF_BODY):
            _of_body(tags, user, candidate, user.body_of(k), edit, inserts)
    if not user.law_outside:
        for k in range(len(user.joints)):
            tag = _actuator(tags, user, k)
            if "dampratio" in tag.attributes and touched:  # it would follow other inertias
                edit(tag, _gains(tags, user, candidate, k))
    if user.law is not None and user.law.gravity_compensation:
        left_out.append("the controller's gravity compensation, which is none of the model")
    left_out += _delayed(tags, user, values, edit)
    for tag in tags:
        if tag.name == "compiler" and isinstance(user.source, Path):
            folders = {
                key: str((user.source.parent / tag.attributes.get(key, "")).resolve())
                for key in ("meshdir", "texturedir", "assetdir")
                if key in tag.attributes
            }
            if folders:
                edit(tag, folders)
    return Patch(text=_edited(text, edits, inserts), left_out=tuple(left_out))


def _joint(tags: list[_Tag], user: UserModel, joint: str) -> _Tag:
    def mine(tag: _Tag) -> bool:
        named = tag.attributes.get("name") == joint
        return named and tag.name == "joint" and "worldbody" in tag.inside

    return _one(tags, mine, user, f"joint {joint!r}")


def _gains(tags: list[_Tag], user: UserModel, candidate: Any, k: int) -> dict[str, str | None]:
    actuator = user.actuators[k]
    tag = _actuator(tags, user, k)
    gain, bias = candidate.actuator_gainprm[actuator], candidate.actuator_biasprm[actuator]
    if tag.name == "position":
        changed: dict[str, str | None] = {"kp": _number(gain[0]), "kv": _number(-bias[2])}
        return changed | {"dampratio": None} if "dampratio" in tag.attributes else changed
    return {"gainprm": _numbers(gain[:3]), "biasprm": _numbers(bias[:3])}


def _actuator(tags: list[_Tag], user: UserModel, k: int) -> _Tag:
    name, joint = user.model.actuator(user.actuators[k]).name, user.joints[k]

    def mine(tag: _Tag) -> bool:
        if tag.name not in _ACTUATORS or "actuator" not in tag.inside:
            return False
        named = tag.attributes.get("name", "")
        return named == name if name else tag.attributes.get("joint") == joint

    return _one(tags, mine, user, f"the actuator of {joint!r}")


def _delayed(
    tags: list[_Tag],
    user: UserModel,
    values: Mapping[Knob, float],
    edit: Callable[[_Tag, Mapping[str, str | None]], None],
) -> list[str]:
    """Delays as the actuators' own, where this MuJoCo has them."""
    delays = delays_with(user, values)
    late = {user.joints[k]: delay for k, delay in enumerate(delays) if delay > 0.0}
    if not late:
        return []
    shown = ", ".join(f"{joint} {1e3 * delay:.3g} ms" for joint, delay in late.items())
    if user.law_outside or not hasattr(user.model, "actuator_delay"):
        return [f"delays of commands, to be given to the controller: {shown}"]
    for k, delay in enumerate(delays):
        if delay <= 0.0:
            continue
        before = float(user.model.actuator_delay[user.actuators[k]])
        count = int(np.ceil((before + delay) / user.timestep)) + 2
        changed = {"delay": _number(before + delay), "nsample": str(count), "interp": "linear"}
        edit(_actuator(tags, user, k), changed)
    return []


def _of_body(
    tags: list[_Tag],
    user: UserModel,
    candidate: Any,
    body: int,
    edit: Callable[[_Tag, Mapping[str, str | None]], None],
    inserts: dict[int, str],
) -> None:
    name = user.model.body(body).name
    mass, centre = candidate.body_mass[body], candidate.body_ipos[body]
    changed = {"mass": _number(mass), "pos": _numbers(centre)}
    found = [tag for tag in tags if tag.name == "inertial" and tag.owner == name]
    if found:
        edit(found[0], changed)
        return
    tag = _one(tags, lambda t: t.name == "body" and t.attributes.get("name") == name, user, name)
    quaternion, moments = _numbers(candidate.body_iquat[body]), candidate.body_inertia[body]
    inserts[tag.end] = (
        f'<inertial pos="{changed["pos"]}" mass="{changed["mass"]}" quat="{quaternion}"'
        f' diaginertia="{_numbers(moments)}"/>'
    )


def _tags(text: str) -> Iterator[_Tag]:
    """Start tags in their order."""
    raw = text.encode()
    found: list[_Tag] = []
    around: list[tuple[str, str]] = []
    parser = xml.parsers.expat.ParserCreate("utf-8")

    def start(name: str, attributes: dict[str, str]) -> None:
        begin = parser.CurrentByteIndex
        owner = next((n for kind, n in reversed(around) if kind == "body"), "")
        found.append(
            _Tag(
                name=name,
                attributes=attributes,
                begin=begin,
                end=_end_of_tag(raw, begin),
                owner=owner,
                inside=tuple(kind for kind, _ in around),
            )
        )
        around.append((name, attributes.get("name", "")))

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda name: around.pop()
    parser.Parse(raw, True)
    yield from found


def _end_of_tag(raw: bytes, begin: int) -> int:
    """Behind the ">" of a start tag, which values in quotes may contain, too."""
    match = re.compile(rb"<(?:[^>\"']|\"[^\"]*\"|'[^']*')*>").match(raw, begin)
    assert match is not None
    return match.end()


def _one(tags: list[_Tag], wanted: Callable[[_Tag], bool], user: UserModel, what: str) -> _Tag:
    found = [tag for tag in tags if wanted(tag)]
    if not found:
        raise LoadError(
            f"{user.name}: {what} is not in this file itself; to have it patched, give the model as"
            " one file (MuJoCo's 'compile' writes one)"
        )
    return found[0]


def _edited(
    text: str, edits: Mapping[tuple[int, int], Mapping[str, str | None]], inserts: Mapping[int, str]
) -> str:
    raw = text.encode()
    pieces: list[tuple[int, int, bytes]] = []
    for (begin, end), changed in edits.items():
        tag = _with_attributes(raw[begin:end].decode(), changed)
        pieces.append((begin, end, tag.encode()))
    pieces += [(at, at, element.encode()) for at, element in inserts.items()]
    for begin, end, piece in sorted(pieces, reverse=True):
        raw = raw[:begin] + piece + raw[end:]
    return raw.decode()


def _with_attributes(tag: str, changed: Mapping[str, str | None]) -> str:
    """A start tag's text with other attributes; None takes one away."""
    for name, value in changed.items():
        pattern = re.compile(rf"(\s){re.escape(name)}\s*=\s*(\"[^\"]*\"|'[^']*')")
        if value is None:
            tag = pattern.sub("", tag, count=1)
        elif pattern.search(tag):
            tag = pattern.sub(rf'\g<1>{name}="{value}"', tag, count=1)
        else:
            end = len(tag) - (2 if tag.endswith("/>") else 1)
            tag = f'{tag[:end].rstrip()} {name}="{value}"{tag[end:]}'
    return tag


def _turns(user: UserModel, k: int) -> bool:
    return int(user.model.jnt_type[user.joint_ids[k]]) == int(mujoco.mjtJoint.mjJNT_HINGE)


def _number(value: float) -> str:
    return f"{float(value):.12g}"


def _numbers(values: Any) -> str:
    return " ".join(map(_number, values))
