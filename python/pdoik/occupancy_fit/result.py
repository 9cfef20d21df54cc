"""The outcome of a fit, and its occupancy file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .._files import write_whole
from .capsules import Capsule
from .hulls import DECIMALS, FloatArray, Point, Sphere, Spheroid, tidy_point
from .pieces import Piece
from .report import FitReport

_PLAIN_NAME = re.compile(r"(?!(?:true|false|yes|no|on|off|null|y|n)$)[a-z_][\w/-]*", re.IGNORECASE)


@dataclass(frozen=True, slots=True, kw_only=True)
class OccupancyFit:
    """The hulls of a robot, ready for `pdoik.Occupancy.load`."""

    spheres: tuple[Sphere, ...]
    spheroids: tuple[Spheroid, ...]
    report: FitReport
    capsules: tuple[Capsule, ...] = ()  # hold the same links, closer
    pieces: tuple[Piece, ...] = ()  # the links themselves

    def to_yaml(self, comment: str = "") -> str:
        """The occupancy file's text; reading it back gives these very numbers."""
        lines = [f"# {line}".rstrip() for line in comment.splitlines()]
        lines.append("spheres:" if self.spheres else "spheres: []")
        lines += [
            f"  - {{link: {_name(hull.link)}, center: {_row(hull.center)},"
            f" radius: {_number(hull.radius)}}}"
            for hull in self.spheres
        ]
        lines.append("spheroids:" if self.spheroids else "spheroids: []")
        for hull in self.spheroids:
            a = f"link_a: {_name(hull.link_a)}, focus_a: {_row(hull.focus_a)}"
            b = f"link_b: {_name(hull.link_b)}, focus_b: {_row(hull.focus_b)}"
            lines.append(f"  - {{{a}, {b}, semi_major: {_number(hull.semi_major)}}}")
        if self.capsules:
            lines.append("capsules:")
        lines += [
            f"  - {{link: {_name(hull.link)}, a: {_row(hull.a)}, b: {_row(hull.b)},"
            f" radius: {_number(hull.radius)}"
            + (f", overhang: {_number(hull.overhang)}" if hull.overhang else "")
            + "}"
            for hull in self.capsules
        ]
        if self.pieces:
            lines.append("pieces:")
        for piece in self.pieces:
            vertices = " ".join(_number(value) for vertex in piece.vertices for value in vertex)
            triangles = " ".join(str(k) for triangle in piece.triangles for k in triangle)
            lines += [
                f"  - link: {_name(piece.link)}",
                f"    tolerance: {_number(piece.tolerance)}",
                f'    vertices: "{vertices}"',
                f'    triangles: "{triangles}"',
            ]
        return "\n".join(lines) + "\n"

    def write(self, path: str | Path, comment: str = "") -> None:
        """Write the file whole or not at all: under a temporary name, then renamed."""
        write_whole(path, self.to_yaml(comment))

    def moved(self, frames: Mapping[str, tuple[str, FloatArray]]) -> OccupancyFit:
        """The same hulls in the link frames of another description of the same robot.

        Args:
            frames: Per link of this description, the other description's link and the constant
                4x4 pose T_other_this of this link's frame in it.

        Raises:
            ValueError: A hull sits on a link that `frames` lacks.
        """

        def move(link: str, point: Point) -> tuple[str, Point]:
            if link not in frames:
                raise ValueError(f"frames lacks the link {link!r}, which carries a hull")
            other, T = frames[link]
            return other, tidy_point(T[:3, :3] @ np.asarray(point) + T[:3, 3])

        return OccupancyFit(
            spheres=tuple(
                Sphere(*move(hull.link, hull.center), hull.radius) for hull in self.spheres
            ),
            spheroids=tuple(
                Spheroid(
                    *move(hull.link_a, hull.focus_a),
                    *move(hull.link_b, hull.focus_b),
                    hull.semi_major,
                )
                for hull in self.spheroids
            ),
            report=self.report,
            capsules=tuple(
                Capsule(
                    *move(hull.link, hull.a),
                    move(hull.link, hull.b)[1],
                    hull.radius,
                    hull.overhang,
                )
                for hull in self.capsules
            ),
            pieces=tuple(
                Piece(
                    move(piece.link, piece.vertices[0])[0],
                    tuple(move(piece.link, vertex)[1] for vertex in piece.vertices),
                    piece.triangles,
                    piece.tolerance,
                )
                for piece in self.pieces
            ),
        )


def _number(value: float) -> str:
    text = f"{value:.{DECIMALS}f}".rstrip("0")  # never 1e-05, which YAML 1.1 takes for a word
    return text + "0" if text.endswith(".") else text


def _row(point: Point) -> str:
    return f"[{', '.join(_number(value) for value in point)}]"


def _name(link: str) -> str:
    return link if _PLAIN_NAME.fullmatch(link) else json.dumps(link)
