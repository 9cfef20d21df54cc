"""Scenes as YAML that `own_yaml` reads."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pdoik._core import Scene, Shape
from pdoik._extras import asks_for
from pdoik._files import write_whole
from pdoik.scenes import fields
from pdoik.scenes.contacts import rule_entry


@asks_for("files")
def save_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write shapes and rules of contact as YAML that `load_scene` reads; the cloud is left out.

    Args:
        scene: What to write.
        path: The file, whole or not at all; one that is there is replaced. The values of a distance
            field are in a file next to it, scene.NAME.npz of scene.yaml.

    Raises:
        OSError: It cannot be written.
    """
    import yaml

    field_files: dict[str, str] = {}  # files of distance fields, by shapes' names
    for shape in scene.shapes:
        if shape.kind == "distance_field":
            field_files[shape.name] = fields.write_field(shape, Path(path), field_files.values())
    content = {
        "shapes": [_entry_of(shape, field_files) for shape in scene.shapes],
        "contacts": [rule_entry(rule) for rule in scene.contacts],
    }
    text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, allow_unicode=True)
    write_whole(path, text)


def _entry_of(shape: Shape, field_files: Mapping[str, str]) -> dict[str, Any]:
    """What `_read_piece` reads.

    Args:
        shape: What is written.
        field_files: The files of distance fields, by shapes' names.
    """
    T = np.asarray(shape.T_base_shape)
    entry: dict[str, Any] = {"name": shape.name}
    if shape.kind == "half_space":
        return entry | {"half_space": {"normal": T[:3, 2].tolist(), "point": T[:3, 3].tolist()}}
    if shape.kind == "distance_field":
        entry[shape.kind] = {"file": field_files[shape.name]}
    else:
        entry[shape.kind] = _size_of(shape)
    entry["position"] = T[:3, 3].tolist()
    if not np.array_equal(T[:3, :3], np.eye(3)):
        from scipy.spatial.transform import Rotation

        entry["xyzw"] = Rotation.from_matrix(T[:3, :3]).as_quat().tolist()
    return entry


def _size_of(shape: Shape) -> Any:
    size = list(shape.size)
    match shape.kind:
        case "box":
            return size
        case "sphere":
            return {"radius": size[0]}
        case "boxes":
            return {"low": shape.vertices[0::2].tolist(), "high": shape.vertices[1::2].tolist()}
        case "convex_mesh" | "mesh":
            return {"vertices": shape.vertices.tolist(), "triangles": shape.triangles.tolist()}
    return {"radius": size[0], "length": size[1]}
