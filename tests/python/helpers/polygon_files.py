"""PLY files with faces of many corners, written by the tests byte by byte."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def prism(outline: npt.ArrayLike, height: float) -> tuple[npt.NDArray[np.float64], list[list[int]]]:
    """The solid over an outline in x and y, counter-clockwise: two faces of n corners, n quads."""
    flat = np.asarray(outline, dtype=np.float64)
    n = len(flat)
    vertices = np.vstack([np.c_[flat, np.zeros(n)], np.c_[flat, np.full(n, height)]])
    sides = [[i, (i + 1) % n, (i + 1) % n + n, i + n] for i in range(n)]
    return vertices, [list(range(n))[::-1], list(range(n, 2 * n)), *sides]


def ply_bytes(
    vertices: npt.ArrayLike, faces: Sequence[Sequence[int]], layout: str, colors: bool = False
) -> bytes:
    """A file of these faces; with colours before and a flag after the corners of each face."""
    points = np.asarray(vertices, dtype=np.float64)
    color = "property uchar red\n" if colors else ""
    flag = "property short flag\n" if colors else ""
    header = (
        f"ply\nformat {layout} 1.0\ncomment by hand\nelement vertex {len(points)}\n"
        f"property double x\nproperty double y\nproperty double z\n{color}"
        f"element face {len(faces)}\n{color}property list uchar int vertex_indices\n{flag}"
        "end_header\n"
    )
    if layout == "ascii":
        extra = ["7"] if colors else []
        rows = [" ".join([*map(repr, map(float, point)), *extra]) for point in points]
        rows += [
            " ".join([*extra, str(len(face)), *map(str, face), *(["-3"] if colors else [])])
            for face in faces
        ]
        return (header + "\n".join(rows) + "\n").encode()
    order = "<" if "little" in layout else ">"
    one = struct.pack("B", 7) if colors else b""
    last = struct.pack(f"{order}h", -3) if colors else b""
    body = [struct.pack(f"{order}3d", *point) + one for point in points]
    body += [one + struct.pack(f"{order}B{len(face)}i", len(face), *face) + last for face in faces]
    return header.encode() + b"".join(body)
