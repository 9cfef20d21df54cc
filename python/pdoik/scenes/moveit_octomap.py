"""The octomap of MoveIt's PlanningScene: an octomap_msgs/OctomapWithPose as YAML."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik._octomaps import boxes_of
from pdoik._octree import OctreeError, octree_of_data
from pdoik.scenes.pieces import Thing, boxes
from pdoik.scenes.values import EntryError, numbers, read_pose

FloatArray = npt.NDArray[np.float64]

NAME = "<octomap>"  # what MoveIt calls it, in the allowed collision matrix too


def read_octomap(item: Mapping[str, Any], T: FloatArray, file: Path) -> Thing:
    """What it takes, under MoveIt's name for it.

    Args:
        item: header, origin and octomap.
        T: Takes its header's frame to the base frame, (4, 4).
        file: Where it comes from, for messages.

    Raises:
        EntryError: An entry cannot be read.
    """
    entry = "world.octomap"
    T = T @ read_pose(item.get("origin"), file, f"{entry}.origin")
    tree, entry = item["octomap"], f"{entry}.octomap"
    resolution = numbers([tree.get("resolution")], "r", file, f"{entry}.resolution")
    kind, binary = str(tree.get("id", "OcTree")), str(tree.get("binary", True)).lower()
    if binary not in ("true", "false", "1", "0"):
        raise EntryError(file, f"expected true or false, got {binary!r}", f"{entry}.binary")
    data = _data(tree.get("data"), file, f"{entry}.data")
    try:
        found = octree_of_data(data, kind, float(resolution[0]), binary=binary in ("true", "1"))
        low, high = boxes_of(found)
    except OctreeError as error:
        raise EntryError(file, str(error), entry) from error
    return Thing(name=NAME, pieces=(boxes(low, high, T, entry),))


def _data(value: Any, file: Path, entry: str) -> bytes:
    """Bytes as int8 each, or as robowflex writes them: packed by zlib, in hexadecimal digits."""
    try:
        if isinstance(value, bytes):
            return value
        if isinstance(value, str):
            return zlib.decompress(bytes.fromhex(value))
        return (np.array(value, dtype=np.int64) & 0xFF).astype(np.uint8).tobytes()
    except (TypeError, ValueError, OverflowError, zlib.error) as error:
        what = "expected a list of bytes, or hexadecimal digits of what zlib packed"
        raise EntryError(file, f"{what}: {error}", entry) from error
