"""Obstacles as a report has them: points to the bit, shapes, rules of contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._core import Cloud, ContactRule, Scene, Shape
from .contacts import read_allowed, read_rule, rule_entry
from .values import Entry, FloatArray, packed, plain

SHAPE_KINDS = (  # in C++'s order
    "sphere", "box", "cylinder", "capsule", "half_space", "convex_mesh", "mesh", "boxes",
    "distance_field",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Obstacles:
    """What a solver gets, and what a judge looks at.

    Attributes:
        given: For `obstacles=`.
        points: Centres and radii, (N, 4) [m].
        shapes: Solids.
        contacts: Rules of contact.
    """

    given: Any
    points: FloatArray
    shapes: tuple[Shape, ...] = ()
    contacts: tuple[ContactRule, ...] = ()


def obstacles_entry(obstacles: Any) -> dict[str, Any] | None:
    """What `read_obstacles` reads, of whatever a solve takes as obstacles."""
    if obstacles is None:
        return None
    if isinstance(obstacles, Cloud):
        return {"cloud": _rows(obstacles)}
    if isinstance(obstacles, Scene):
        return {
            "shapes": [shape_entry(shape) for shape in obstacles.shapes],
            "contacts": [rule_entry(rule) for rule in obstacles.contacts],
            "cloud": None if obstacles.cloud is None else _rows(obstacles.cloud),
        }
    if isinstance(obstacles, Sequence) and obstacles and isinstance(obstacles[0], Shape):
        return obstacles_entry(Scene(list(obstacles)))
    return {"points": plain(np.asarray(obstacles, dtype=np.float64))}


def _rows(cloud: Cloud) -> list[list[float]]:
    """Rows of x y z radius [m], in the order that the points came in, that of their ids."""
    rows: list[list[float]] = plain(cloud.points[np.argsort(cloud.ids)])
    return rows


def read_obstacles(entry: Entry) -> Obstacles:
    """The same obstacles again.

    Raises:
        LoadError: Names the entry and what is wrong with it.
    """
    if entry.value is None:
        return Obstacles(None, np.empty((0, 4)))
    if "points" in entry.names():
        points = entry["points"].array(None, None)
        points = points if points.size else np.empty((0, 3))
        if points.shape[1] not in (3, 4):
            raise entry["points"].wrong(f"expected 3 or 4 numbers a row, got {points.shape[1]}")
        radii = np.zeros((len(points), 4 - points.shape[1]))
        return Obstacles(points, np.column_stack([points, radii]))
    points, cloud = np.empty((0, 4)), None
    try:
        if entry["cloud"].value is not None:
            points = entry["cloud"].array(None, 4)
            cloud = Cloud(points)
        if "shapes" not in entry.names():
            return Obstacles(cloud, points)
        shapes = [read_shape(each) for each in entry["shapes"].items()]
        if "contacts" in entry.names():
            contacts = [read_rule(each) for each in entry["contacts"].items()]
        else:  # of before there were rules
            contacts = [read_allowed(each) for each in entry["allowed"].items()]
        scene = Scene(shapes, cloud=cloud, contacts=contacts)
    except ValueError as error:
        if type(error) is not ValueError:  # it names its entry already
            raise
        raise entry.wrong(str(error)) from error
    return Obstacles(scene, points, tuple(shapes), tuple(contacts))


def shape_entry(shape: Shape) -> dict[str, Any]:
    """What `read_shape` reads."""
    entry = {
        "name": shape.name,
        "kind": shape.kind,
        "T_base_shape": plain(shape.T_base_shape),
        "size": plain(shape.__getstate__()[3]),
    }
    if len(shape.vertices):
        entry |= {"vertices": plain(shape.vertices), "triangles": plain(shape.triangles)}
    if shape.cell is not None:
        entry |= {"values": packed(shape.values), "cell": shape.cell}
    return entry


def read_shape(entry: Entry) -> Shape:
    """The same shape again; a scene or a solver looks whether it makes sense."""
    kind = entry["kind"].text(*SHAPE_KINDS)
    vertices, triangles = np.empty((0, 3)), np.empty((0, 3), np.int32)
    if kind in ("convex_mesh", "mesh", "boxes"):
        vertices = entry["vertices"].array(None, 3)
        places = entry["triangles"].array(None, 3)
        if places.size and not (places.min() >= 0 and places.max() < len(vertices)):
            raise entry["triangles"].wrong("a triangle has a vertex that is not there")
        triangles = places.astype(np.int32)
    values, cell = np.empty((0, 0, 0), np.float32), 0.0
    if kind == "distance_field":
        values, cell = entry["values"].packed(3), entry["cell"].number()
    shape = Shape.__new__(Shape)
    pose, size = entry["T_base_shape"].array(4, 4), entry["size"].array(3)
    name = entry["name"].text()
    state = (name, SHAPE_KINDS.index(kind), pose, size, vertices, triangles, values, cell)
    try:
        shape.__setstate__(state)
    except ValueError as error:
        raise entry.wrong(str(error)) from error
    return shape
