"""The <state> that Gazebo's older editor saves with a world: where models and links really are."""

from __future__ import annotations

from xml.etree.ElementTree import Element

import numpy as np
import numpy.typing as npt

from pdoik.scenes.sdf.frames import Scope
from pdoik.scenes.values import EntryError
from pdoik.scenes.xml import numbers_of

FloatArray = npt.NDArray[np.float64]


def apply_state(world: Scope) -> None:
    """Put models and their links where the world's state has them, all in the world's frame.

    Raises:
        EntryError: The state has a model or link that is not there, or one that is scaled.
    """
    for state in world.element.findall("state"):
        if state.find("insertions/*") is not None:
            what = "has insertions, which are not read: put them into the world, and save it again"
            raise EntryError(world.file, what, "state")
        for model in state.findall("model"):
            _place(model, world, np.eye(4), "state")


def _place(state: Element, outer: Scope, T_world_outer: FloatArray, entry: str) -> None:
    """A model, and what is in it."""
    name = str(state.get("name", ""))
    entry = f"{entry}, model {name}"
    if name not in outer.models:
        raise EntryError(outer.file, "there is no such model", entry)
    scale = numbers_of(state, "scale", 3, outer.file, entry, "1 1 1")
    if not np.allclose(scale, 1.0):
        raise EntryError(outer.file, f"is scaled by {scale.tolist()}: scale it itself", entry)
    in_world = Scope(Element("state"), outer.file)  # its poses are relative to nothing else
    if state.find("pose") is not None:
        outer.place(name, np.linalg.inv(T_world_outer) @ in_world.pose_in(state))
    T_world_model, model = T_world_outer @ outer.pose_of(name), outer.models[name]
    for link in state.findall("link"):
        if link.find("pose") is not None:
            T_model_link = np.linalg.inv(T_world_model) @ in_world.pose_in(link)
            model.place(str(link.get("name", "")), T_model_link)
    for inner in state.findall("model"):
        _place(inner, model, T_world_model, entry)
