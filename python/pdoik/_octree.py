"""OctoMap's trees as their files have them: .bt, which knows free and taken, and .ot, with odds.

Both write the nodes depth first. In .bt every inner node is 16 bits, two for each child: nothing
known, taken, free, or an inner node. In .ot every node is its data, of which the first four bytes
are the logarithm of its odds, and a byte that says which children there are.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

IntArray = npt.NDArray[np.int64]

_FIRST_LINES = {"# Octomap OcTree binary file": True, "# Octomap OcTree file": False}
_DATA = {"OcTree": 4, "ColorOcTree": 7, "OcTreeStamped": 4}  # bytes of a node in .ot, by class
_DEPTH = 16
_HALF = 2 ** (_DEPTH - 1)  # from the middle to a side, in cells
_INNER = 3  # the first bit of a child in .bt: free; the second: taken; both: an inner node


class OctreeError(ValueError):
    """What is wrong with a tree, without the name of its file."""


@dataclass(frozen=True, slots=True, eq=False)
class Octree:
    """The leaves of a tree, cubes that do not overlap.

    Attributes:
        resolution: Edge of the smallest cells [m].
        low: The lowest corner of each, (N, 3), counted in cells from the origin.
        size: The edge of each, (N,), in cells.
        taken: Whether it is, or is free, (N,); what no leaf holds is unknown.
    """

    resolution: float
    low: IntArray
    size: IntArray
    taken: npt.NDArray[np.bool_]


def read_octree(content: bytes) -> Octree:
    """The tree of a .bt or .ot file, distinguished by its first line.

    Raises:
        OctreeError: It is none, cut short, or of a class with other nodes.
    """
    first, _, rest = content.partition(b"\n")
    line = first.decode("utf-8", errors="replace").strip()
    if line not in _FIRST_LINES:
        raise OctreeError("is no OctoMap file: convert older ones with OctoMap's convert_octree")
    header, mark, data = rest.partition(b"\ndata")
    fields = {
        words[0]: words[1]
        for text in header.decode("utf-8", errors="replace").splitlines()
        if len(words := text.split()) == 2 and not text.startswith("#")
    }
    if not mark or not {"id", "size", "res"} <= set(fields):
        raise OctreeError("expected id, size, res and data in its header")
    try:
        count, resolution = int(fields["size"]), float(fields["res"])
    except ValueError:
        raise OctreeError(
            f"size {fields['size']!r} or res {fields['res']!r} is no number"
        ) from None
    data = data[data.find(b"\n") + 1 :]
    return octree_of_data(data, fields["id"], resolution, binary=_FIRST_LINES[line], count=count)


def octree_of_data(
    data: bytes, kind: str, resolution: float, *, binary: bool, count: int | None = None
) -> Octree:
    """The tree of the nodes alone, as octomap_msgs/Octomap has them.

    Args:
        data: Its nodes.
        kind: The class it is of, such as "OcTree".
        resolution: Edge of the smallest cells [m].
        binary: Whether the nodes are those of .bt.
        count: How many there are to be, the root included; None if that is not given.

    Raises:
        OctreeError: As `read_octree`.
    """
    if kind not in _DATA:
        raise OctreeError(f"its class is {kind!r}, expected one of {', '.join(_DATA)}")
    if not (np.isfinite(resolution) and resolution > 0):
        raise OctreeError(f"expected a resolution above 0 m, got {resolution}")
    if not data:
        empty = np.empty(0, dtype=np.int64)
        return Octree(resolution, empty.reshape(0, 3), empty, empty.astype(bool))
    nodes = _Nodes()
    try:
        (nodes.read_binary if binary else nodes.read_full)(data, _DATA[kind])
    except (IndexError, struct.error):
        raise OctreeError("the file is cut short") from None
    if count is not None and nodes.count != count:
        raise OctreeError(f"its header promises {count} nodes, got {nodes.count}")
    leaves = np.array(nodes.leaves, dtype=np.int64).reshape(-1, 5)
    return Octree(resolution, leaves[:, :3], leaves[:, 3], leaves[:, 4] > 0)


class _Nodes:
    """A tree as it is read."""

    def __init__(self) -> None:
        self.leaves: list[tuple[int, int, int, int, bool]] = []  # low, size, taken
        self.count = 0

    def read_binary(self, data: bytes, _: int) -> None:
        at, leaves = 0, self.leaves
        stack = [(-_HALF, -_HALF, -_HALF, 2 * _HALF)]
        self.count = 1
        while stack:
            x, y, z, size = stack.pop()
            bits = data[at] | data[at + 1] << 8
            at += 2
            size >>= 1
            inner: list[tuple[int, int, int, int]] = []
            for child, state in _KNOWN_CHILDREN[bits & 0xFF]:
                _place(child, state, x, y, z, size, leaves, inner)
            for child, state in _KNOWN_CHILDREN[bits >> 8]:
                _place(child + 4, state, x, y, z, size, leaves, inner)
            self.count += len(_KNOWN_CHILDREN[bits & 0xFF]) + len(_KNOWN_CHILDREN[bits >> 8])
            if inner and size == 1:
                raise OctreeError(f"it is deeper than {_DEPTH} levels")
            stack.extend(reversed(inner))

    def read_full(self, data: bytes, node_size: int) -> None:
        at, leaves = 0, self.leaves
        stack = [(-_HALF, -_HALF, -_HALF, 2 * _HALF)]
        while stack:
            x, y, z, size = stack.pop()
            (odds,) = struct.unpack_from("<f", data, at)
            children = data[at + node_size]
            at += node_size + 1
            self.count += 1
            if not children:
                leaves.append((x, y, z, size, odds >= 0))
                continue
            size >>= 1
            if not size:
                raise OctreeError(f"it is deeper than {_DEPTH} levels")
            stack.extend(
                (x + size * (c & 1), y + size * (c >> 1 & 1), z + size * (c >> 2), size)
                for c in range(7, -1, -1)
                if children >> c & 1
            )


def _known_children(bits: int) -> list[tuple[int, int]]:
    """Those of four children that are known, and what they are."""
    states = [(child, bits >> 2 * child & 3) for child in range(4)]
    return [(child, state) for child, state in states if state]


_KNOWN_CHILDREN = [_known_children(bits) for bits in range(256)]


def _place(
    child: int,
    state: int,
    x: int,
    y: int,
    z: int,
    size: int,
    leaves: list[tuple[int, int, int, int, bool]],
    inner: list[tuple[int, int, int, int]],
) -> None:
    """A child of a node whose lowest corner this is, among leaves or inner nodes."""
    x, y, z = x + size * (child & 1), y + size * (child >> 1 & 1), z + size * (child >> 2)
    if state == _INNER:
        inner.append((x, y, z, size))
    else:
        leaves.append((x, y, z, size, state == 2))
