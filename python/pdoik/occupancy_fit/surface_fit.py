"""All that is fitted to one link's surface: covers by wide hulls, capsules, convex pieces."""

from __future__ import annotations

import warnings
from typing import NamedTuple

from ..errors import OverhangWarning
from .capsules import Capsule, fit_link
from .hulls import FloatArray, Shape, convex_volume
from .overhang import Overhang
from .pieces import Piece, fit_pieces
from .split import cover_stages, union_volume


class Wanted(NamedTuple):
    """What to fit, and how; what `fit_occupancy` was given."""

    max_volume_factor: float = 2.0
    max_parts: int = 4
    covers: bool = True  # by one and more hulls each
    capsules: bool = True
    pieces: bool = True


class Hull(NamedTuple):
    """A wide hull and the volume of the convex hull of what it holds."""

    shape: Shape
    geometry_volume: float  # [m^3]


class Cover(NamedTuple):
    """Hulls that together hold the surface, and the volume of their union."""

    hulls: tuple[Hull, ...]
    volume: float  # [m^3]


class SurfaceFit(NamedTuple):
    """What was fitted, in the frame of the triangles; empty where it was not wanted."""

    covers: tuple[Cover, ...]  # with ever more hulls
    capsules: tuple[Capsule, ...]
    overhang: Overhang  # of the capsules
    pieces: tuple[Piece, ...]

    def named(self, link: str) -> SurfaceFit:
        """The same, fixed to another link."""
        return self._replace(
            capsules=tuple(capsule._replace(link=link) for capsule in self.capsules),
            pieces=tuple(piece._replace(link=link) for piece in self.pieces),
        )


def cover_of(parts: list[tuple[FloatArray, Shape]]) -> Cover:
    """Cover of parts of the surface, (T, 3, 3) each, and the hulls that hold them."""
    return Cover(
        tuple(Hull(shape, convex_volume(part.reshape(-1, 3))) for part, shape in parts),
        union_volume([shape for _, shape in parts]),
    )


def fit_surface(link: str, triangles: FloatArray, wanted: Wanted) -> SurfaceFit:
    """Fit what is wanted to a link's triangles (T, 3, 3); warns of nothing."""
    covers: tuple[Cover, ...] = ()
    capsules: list[Capsule] = []
    out, pieces = Overhang(0.0, 0.0), []
    if wanted.covers:
        stages = cover_stages(triangles, wanted.max_volume_factor, wanted.max_parts)
        covers = tuple(cover_of([(p.triangles, p.shape) for p in parts]) for parts in stages)
    if wanted.capsules:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", OverhangWarning)
            capsules, out = fit_link(link, triangles)
    if wanted.capsules and wanted.pieces:
        pieces = fit_pieces(link, triangles)
    return SurfaceFit(covers, tuple(capsules), out, tuple(pieces))
