"""The user's MJCF with the changed attributes only, every other byte as it was."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from pdoik.errors import LoadError

from .candidates import ParameterId, delays_with, model_with
from .mjcf_edit import Tag, edited, tags_of, with_includes
from .property import EVERY
from .user_model import UserModel

_ACTUATORS = ("position", "general", "motor", "intvelocity", "velocity")
_OF_JOINT = ("damping", "frictionloss", "armature", "ref")
_OF_BODY = ("mass", "com_x", "com_y", "com_z")
_TURNED = ("fullinertia", "euler", "axisangle", "xyaxes", "zaxis")
_ONE_FILE = "its <include>s are in one file"
_REWRITTEN = (
    "it is MuJoCo's own writing of your model, as a joint or body is in no file by its name;"
    " numbers are rounded to six digits"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Patch:
    """An MJCF's text, and what it could not say."""

    text: str
    left_out: tuple[str, ...]  # in words
    notes: tuple[str, ...] = ()  # what else is not as in the user's file


def patched(user: UserModel, values: Mapping[ParameterId, float]) -> Patch:
    """The text with these values: the user's file, or where that is not all of it, one file.

    Raises:
        LoadError: a joint or body cannot be found in any of these.
    """
    problem = LoadError(f"{user.name}: nothing to patch")
    for text, degrees, note in _texts(user):
        try:
            patch = _Editor(replace(user, degrees=degrees), values, text).patch()
        except LoadError as error:
            problem = error
            continue
        return replace(patch, notes=(note,) if note else ())
    raise problem


def _texts(user: UserModel) -> Iterator[tuple[str, bool, str]]:
    """Texts of the model that may be patched, whether in degrees, and what they are in words."""
    if not isinstance(user.source, Path):
        yield user.source, user.degrees, ""
        return
    own = user.source.read_text()
    yield own, user.degrees, ""
    if any(tag.name == "include" for tag in tags_of(own)):
        yield with_includes(own, user.source.parent), user.degrees, _ONE_FILE
    spec = mujoco.MjSpec.from_file(str(user.source))
    spec.compile()
    yield spec.to_xml(), False, _REWRITTEN


class _Editor:
    """Collects changes of one text."""

    def __init__(self, user: UserModel, values: Mapping[ParameterId, float], text: str) -> None:
        self.user, self.values, self.text = user, values, text
        self.candidate = model_with(user, values)
        self.tags = list(tags_of(text))
        self.left_out: list[str] = []
        self._edits: dict[tuple[int, int], dict[str, str | None]] = {}
        self._inserts: dict[int, str] = {}

    def patch(self) -> Patch:
        """All of the values, in the text's order of joints."""
        every = {
            parameter_id.property for parameter_id in self.values if parameter_id.index == EVERY
        }
        for k in range(len(self.user.joints)):
            mine = {
                parameter_id.property for parameter_id in self.values if parameter_id.index == k
            }
            self._joint_figures(k, mine)
            if mine & {"kp", "kv", "gain_factor"} or every & {"kp_factor", "gain_factor"}:
                self._gains(k)
            if mine & set(_OF_BODY):
                self._body(self.user.body_of(k))
            self._smoothing(k, mine)
        self._damping_ratios()
        if self.user.law is not None and self.user.law.gravity_compensation:
            self.left_out.append(
                "the controller's gravity compensation, which is none of the model"
            )
        self._delays()
        self._folders()
        return Patch(
            text=edited(self.text, self._edits, self._inserts), left_out=tuple(self.left_out)
        )

    def _edit(self, tag: Tag, changed: Mapping[str, str | None]) -> None:
        self._edits.setdefault((tag.begin, tag.end), {}).update(changed)

    def _joint_figures(self, k: int, mine: set[str]) -> None:
        changed: dict[str, str | None] = {
            name: _number(self._angle(k, self.values[ParameterId(name, k)], name == "ref"))
            for name in _OF_JOINT
            if name in mine
        }
        if mine & {"stiffness", "spring_torque"}:
            changed["stiffness"] = _number(self.candidate.jnt_stiffness[self.user.joint_ids[k]])
        if "spring_torque" in mine:
            place = float(self.candidate.qpos_spring[self.user.qpos[k]])
            changed["springref"] = _number(self._angle(k, place, True))
        if changed:
            self._edit(self._joint(k), changed)

    def _angle(self, k: int, value: float, is_angle: bool) -> float:
        turns = int(self.user.model.jnt_type[self.user.joint_ids[k]]) == int(
            mujoco.mjtJoint.mjJNT_HINGE
        )
        return float(np.rad2deg(value)) if is_angle and turns and self.user.degrees else value

    def _gains(self, k: int) -> None:
        if self.user.law_outside:
            joint = self.user.joints[k]
            self.left_out.append(f"gains of {joint}: they are the study's controller's")
            return
        actuator, tag = self.user.actuators[k], self._actuator(k)
        gain = self.candidate.actuator_gainprm[actuator]
        bias = self.candidate.actuator_biasprm[actuator]
        if tag.name != "position":
            self._edit(tag, {"gainprm": _numbers(gain[:3]), "biasprm": _numbers(bias[:3])})
            return
        changed: dict[str, str | None] = {"kp": _number(gain[0]), "kv": _number(-bias[2])}
        if "dampratio" in tag.attributes:
            changed["dampratio"] = None
        self._edit(tag, changed)

    def _smoothing(self, k: int, mine: set[str]) -> None:
        """What smooths a drive's commands, and the largest torque that it gives."""
        shown = {
            name: self.values[ParameterId(name, k)]
            for name in ("filter", "force_limit")
            if name in mine
        }
        if not shown:
            return
        joint = self.user.joints[k]
        tag = None if self.user.law_outside else self._actuator(k)
        if tag is None or (tag.name not in ("position", "general") and "filter" in shown):
            listed = ", ".join(f"{name} {value:.3g}" for name, value in shown.items())
            self.left_out.append(f"{listed} of {joint}: to be given to the controller")
            return
        changed: dict[str, str | None] = {}
        if "filter" in shown and tag.name == "position":
            changed["timeconst"] = _number(self._time_constant(shown["filter"]))
        elif "filter" in shown:
            constant = _number(self._time_constant(shown["filter"]))
            changed |= {"dyntype": "filterexact", "dynprm": constant}
        if "force_limit" in shown:
            actuator = self.user.actuators[k]
            changed["forcerange"] = _numbers(self.candidate.actuator_forcerange[actuator])
            if "forcelimited" in tag.attributes:
                changed["forcelimited"] = "true"
        self._edit(tag, changed)

    def _time_constant(self, late: float) -> float:
        """The time constant of MuJoCo's filter that is late by so much in the mean [s].

        Its drives act on the activation of the step before.
        """
        step = self.user.timestep
        return float(-step / np.log1p(-step / max(late, 1.01 * step)))

    def _damping_ratios(self) -> None:
        """A ratio of damping would follow other inertias, so it becomes the gain that it was."""
        if self.user.law_outside or not self.values:
            return
        for k in range(len(self.user.joints)):
            if "dampratio" in self._actuator(k).attributes:
                self._gains(k)

    def _delays(self) -> None:
        """Delays as the actuators' own, where this MuJoCo has them."""
        user, delays = self.user, delays_with(self.user, self.values)
        late = {user.joints[k]: delay for k, delay in enumerate(delays) if delay > 0.0}
        if not late:
            return
        if user.law_outside or not hasattr(user.model, "actuator_delay"):
            shown = ", ".join(f"{joint} {1e3 * delay:.3g} ms" for joint, delay in late.items())
            self.left_out.append(f"delays of commands, to be given to the controller: {shown}")
            return
        for k, delay in enumerate(delays):
            if delay > 0.0:
                whole = float(user.model.actuator_delay[user.actuators[k]]) + delay
                count = int(np.ceil(whole / user.timestep)) + 2
                changed = {"delay": _number(whole), "nsample": str(count), "interp": "linear"}
                self._edit(self._actuator(k), changed)

    def _body(self, body: int) -> None:
        name, candidate = self.user.model.body(body).name, self.candidate
        changed: dict[str, str | None] = {
            "mass": _number(candidate.body_mass[body]),
            "pos": _numbers(candidate.body_ipos[body]),
        }
        whole = {
            **changed,
            "quat": _numbers(candidate.body_iquat[body]),
            "diaginertia": _numbers(candidate.body_inertia[body]),
        }
        found = [tag for tag in self.tags if tag.name == "inertial" and tag.owner == name]
        if not found:
            tag = self._one("body", name)
            attributes = " ".join(f'{key}="{value}"' for key, value in whole.items())
            self._inserts[tag.end] = f"<inertial {attributes}/>"
            return
        if np.array_equal(candidate.body_inertia[body], self.user.model.body_inertia[body]):
            self._edit(found[0], changed)
            return
        gone = {key: None for key in _TURNED if key in found[0].attributes}
        self._edit(found[0], {**whole, **gone})

    def _folders(self) -> None:
        """Meshes are found from wherever the patched file lies."""
        if not isinstance(self.user.source, Path):
            return
        for tag in self.tags:
            if tag.name == "compiler":
                home = self.user.source.parent
                folders: dict[str, str | None] = {
                    key: str((home / tag.attributes[key]).resolve())
                    for key in ("meshdir", "texturedir", "assetdir")
                    if key in tag.attributes
                }
                if folders:
                    self._edit(tag, folders)

    def _joint(self, k: int) -> Tag:
        return self._one("joint", self.user.joints[k])

    def _actuator(self, k: int) -> Tag:
        name = self.user.model.actuator(self.user.actuators[k]).name
        joint = self.user.joints[k]
        for tag in self.tags:
            if tag.name in _ACTUATORS and "actuator" in tag.inside:
                named = tag.attributes.get("name", "")
                if named == name if name else tag.attributes.get("joint") == joint:
                    return tag
        raise self._missing(f"the actuator of {joint!r}")

    def _one(self, kind: str, name: str) -> Tag:
        """The joint or body of a name, in the machine itself."""
        for tag in self.tags:
            named = tag.name == kind and tag.attributes.get("name") == name
            if named and "worldbody" in tag.inside:
                return tag
        raise self._missing(f"{kind} {name!r}")

    def _missing(self, what: str) -> LoadError:
        return LoadError(
            f"{self.user.name}: {what} is not in this file itself; to have it patched, give the"
            " model as one file (MuJoCo's 'compile' writes one)"
        )


def _number(value: float) -> str:
    return f"{float(value):.12g}"


def _numbers(values: Any) -> str:
    return " ".join(map(_number, values))
