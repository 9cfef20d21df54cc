"""Where the frames of a Gazebo world or model are: poses, what they are relative to, placements."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import numpy.typing as npt

from pdoik.scenes.asked import some
from pdoik.scenes.values import EntryError, rotation
from pdoik.scenes.xml import text_of

FloatArray = npt.NDArray[np.float64]

MODEL, WORLD = "__model__", "world"
_FRAMES = ("link", "joint", "frame", "model")


@dataclass(slots=True, eq=False)
class Scope:
    """A world or a model: what is in it has poses in its frame.

    Attributes:
        element: <world> or <model>, what it includes put in its place.
        file: Where it is written.
        name: What it is called from outside, such as room::table.
        models: Those in it, by the names they have here.
    """

    element: Element
    file: Path
    name: str = ""
    models: dict[str, Scope] = field(default_factory=dict)
    _found: dict[str, FloatArray] = field(default_factory=dict)
    _open: list[str] = field(default_factory=list)

    def pose_of(self, name: str) -> FloatArray:
        """T_scope_frame of a frame by its name, (4, 4).

        Raises:
            EntryError: There is none, or it stands on itself.
        """
        if name in ("", MODEL) or (name == WORLD and self.element.tag == WORLD):
            return np.eye(4)
        if name not in self._found:
            if name in self._open:
                loop = " on ".join([*self._open, name])
                raise EntryError(self.file, f"poses stand on each other: {loop}", self._entry)
            self._open.append(name)
            self._found[name] = self._resolved(name)
            self._open.pop()
        return self._found[name]

    def pose_in(self, element: Element, default: str = "") -> FloatArray:
        """T_scope_element of what has a <pose> here, (4, 4).

        Args:
            element: It.
            default: The frame that it is relative to, if it does not say.
        """
        pose = element.find("pose")
        stands_on = "" if pose is None else pose.get("relative_to", pose.get("frame", ""))
        T = self.pose_of(stands_on or default)
        return T if pose is None else T @ self._raw(pose)

    def place(self, name: str, T: FloatArray) -> None:
        """Put a frame at T_scope_frame, (4, 4), whatever its pose says."""
        self._element(name)
        self._found[name] = T

    def _resolved(self, name: str) -> FloatArray:
        first, _, rest = name.partition("::")
        if rest and first in self.models:
            return self.pose_of(first) @ self.models[first].pose_of(rest)
        element = self._element(name)
        default = ""
        if element.tag == "frame":
            default = element.get("attached_to", "")
        elif element.tag == "joint":
            default = text_of(element, "child")
            if element.find("pose") is None:
                return self.pose_of(default)
        T = self.pose_in(element, default)
        if element.tag == "model":
            placed = self.models[name].pose_of(element.get("placement_frame", ""))
            T = T @ np.linalg.inv(placed)
        return T

    def _element(self, name: str) -> Element:
        named = [each for each in self.element if each.tag in _FRAMES]
        for each in named:
            if each.get("name") == name:
                return each
        known = some(str(each.get("name")) for each in named)
        raise EntryError(self.file, f"no frame {name!r} in it: {known}", self._entry)

    def _raw(self, pose: Element) -> FloatArray:
        text = (pose.text or "").split() or ["0"] * 6
        turned = pose.get("rotation_format", "euler_rpy")
        count = {"euler_rpy": 6, "quat_xyzw": 7}.get(turned, 0)
        try:
            values = np.array(text, dtype=np.float64)
        except ValueError:
            values = np.empty(0)
        if values.shape != (count,) or not np.isfinite(values).all():
            said = " ".join(text)
            raise EntryError(self.file, f"a <pose> of {turned} is {said!r}", self._entry)
        T = np.eye(4)
        T[:3, 3] = values[:3]
        if count == 7:
            T[:3, :3] = rotation(values[3:].tolist(), self.file, self._entry)
        else:
            T[:3, :3] = _turned(values[3:], degrees=pose.get("degrees", "false").strip() in _TRUE)
        return T

    @property
    def _entry(self) -> str:
        return f"{self.element.tag} {self.element.get('name', '')}".strip()


_TRUE = ("true", "1")


def _turned(rpy: FloatArray, *, degrees: bool) -> FloatArray:
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_euler("xyz", rpy, degrees=degrees).as_matrix())
