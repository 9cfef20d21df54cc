"""Fit the hulls of a robot's links: the paper's spheroids, or a few tighter ones; and capsules."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .._addresses import Packages
from ..errors import LoadError
from .capsules import warn_of_overhang
from .geometry import LinkGeometry, links_left_out, load_geometry
from .hulls import Point, Shape, Sphere, Spheroid, around, convex_volume, tidy_point
from .kept import folder_of_fits
from .overhang import Overhang
from .report import FitReport, HullReport, LinkReport
from .result import OccupancyFit
from .surface_fit import Cover, SurfaceFit, Wanted, cover_of
from .surfaces import Tell, fit_surfaces

_ORIGIN: Point = (0.0, 0.0, 0.0)


class _LinkFit(NamedTuple):
    """The hulls chosen for one link; `child` names the link whose origin is the second focus."""

    link: LinkGeometry
    cover: Cover
    child: str | None = None


def fit_occupancy(
    urdf: str | Path,
    packages: Packages = (),
    max_volume_factor: float = 2.0,
    base_link: str | None = None,
    tip_link: str | None = None,
    *,
    max_parts: int = 4,
    max_hulls: int | None = None,
    paper: bool = False,
    capsules: bool = True,
    pieces: bool = True,
    cache: str | os.PathLike[str] | bool | None = None,
    processes: int = 1,
    progress: Tell | None = None,
) -> OccupancyFit:
    """Spheres and spheroids that hold the collision geometry of a robot's links.

    The paper gives link i one spheroid whose foci are the joint origins u_i and u_(i+1)
    (Eq. link_coll_avoid). It is kept where its volume is within `max_volume_factor` of the
    geometry's. Elsewhere the foci are freed, and if that is not enough the link is cut into
    parts with a hull each, until the hulls' union is within the factor or a cut gains too little.

    The geometry's volume is that of its convex hull, since most packages treat collision geometry
    as convex. What the hulls hold is the geometry itself: surface and enclosed solid, vertex by
    vertex, with 1e-6 m to spare; cut links may come out below their convex hull's volume.

    Besides them, capsules hold the same geometry as it is, concave or not, and stick out far less
    (`fit_capsules`): about ten per link, in some seconds each.

    Links of the same geometry, moved or mirrored, are fitted once. Each link's fit is kept by its
    content as soon as it is done: a second call takes a second, and one that was interrupted goes
    on.

    Args:
        urdf: Robot description with collision primitives or meshes: a file, or XML text.
        packages: Folders by the names of packages in `package://` addresses, or folders that hold
            packages; see `pdoik.urdf_text` for where else they are looked for.
        max_volume_factor: Hull volume over geometry volume that is good enough, at least 1.
        base_link: First link of the chain to fit; None for the root.
        tip_link: Last link of the chain; None for every link below the base.
        max_parts: Most hulls per link.
        max_hulls: Most hulls in all; where it binds, they go where they save most volume.
        paper: Exactly one spheroid per link, foci at joint origins, whatever its volume, and at
            each joint the largest sphere within the adjacent spheroids: it has the paper's count
            of constraints and adds no volume. No capsules then.
        capsules: Fit capsules too.
        pieces: With capsules, convex pieces that together are the link within 1 mm (`fit_pieces`):
            where capsules touch something, they say whether the link does.
        cache: Folder where fits are kept; None for the user's (`PDOIK_CACHE`, which turns it off
            where it is empty, or pdoik in `XDG_CACHE_HOME` or ~/.cache), False for none.
        processes: How many links are fitted at a time; hulls are the same. With more than 1 a
            script needs `if __name__ == "__main__":`, as for Python's multiprocessing.
        progress: Called when a link is begun and when it is done.

    Warns:
        OverhangWarning: A link's capsules stick out farther than they should; `report` says so too.

    Raises:
        LoadError: The description or a mesh cannot be read, or it has no collision geometry.
        ValueError: An argument is out of range, or a link is not in the description.
    """
    if not max_volume_factor >= 1:
        raise ValueError(f"max_volume_factor must be at least 1, got {max_volume_factor}")
    for name, value in (("max_parts", max_parts), ("processes", processes)):
        if value < 1:
            raise ValueError(f"{name} must be at least 1, got {value}")
    links = load_geometry(urdf, packages, base_link, tip_link)
    solid = [link for link in links if len(link.triangles)]
    skipped = tuple(link.name for link in links if not len(link.triangles))
    if not solid:
        raise LoadError(f"none of the links has collision geometry: {list(skipped)}")
    if max_hulls is not None and max_hulls < len(solid):
        raise ValueError(f"max_hulls is {max_hulls}, but {len(solid)} links have geometry")

    left_out = links_left_out(urdf, base_link, tip_link)
    first = [_joint_to_joint(link) for link in solid]
    if paper:
        return _result(first, skipped, left_out, _joint_spheres(first), {})
    surfaces = {}
    for fit in first:
        limit = max_volume_factor * convex_volume(fit.link.triangles.reshape(-1, 3))
        covers = fit.cover.volume > limit
        wanted = Wanted(max_volume_factor, max_parts, covers, capsules, pieces)
        surfaces[fit.link.name] = fit.link.triangles, wanted
    found = fit_surfaces(surfaces, folder_of_fits(cache), processes, progress)
    for link, surface in found.items():
        warn_of_overhang(link, len(surface.capsules), surface.overhang)
    stages = []
    for fit in first:
        covers_of = found[fit.link.name].covers
        stages.append([_LinkFit(fit.link, cover) for cover in covers_of] or [fit])
    return _result(_within_budget(stages, max_hulls), skipped, left_out, [], found)


def _joint_to_joint(link: LinkGeometry) -> _LinkFit:
    """The paper's spheroid; of several child joints, the one that makes it smallest.

    The last link has no child joint: its foci coincide.
    """
    points = link.triangles.reshape(-1, 3)
    candidates: list[tuple[Shape, str | None]] = [
        (around(points, np.zeros(3), np.array(origin)), child)
        for child, origin in link.child_joints
    ] or [(around(points, np.zeros(3), np.zeros(3)), None)]
    shape, child = min(candidates, key=lambda candidate: candidate[0].volume)
    return _LinkFit(link, cover_of([(link.triangles, shape)]), child)


def _within_budget(stages: list[list[_LinkFit]], max_hulls: int | None) -> list[_LinkFit]:
    """One stage per link: the last one, or as far as the budget goes where it saves most."""
    if max_hulls is None:
        return [link_stages[-1] for link_stages in stages]
    volumes = [[fit.cover.volume for fit in link_stages] for link_stages in stages]
    chosen = [0] * len(stages)
    spare = max_hulls - len(stages)
    while True:
        gains = []
        for i, at in enumerate(chosen):
            for ahead in range(at + 1, len(stages[i])):
                cost = len(stages[i][ahead].cover.hulls) - len(stages[i][at].cover.hulls)
                if cost <= spare:
                    gains.append(((volumes[i][at] - volumes[i][ahead]) / cost, cost, i, ahead))
        if not gains:
            return [link_stages[at] for link_stages, at in zip(stages, chosen, strict=True)]
        _, cost, i, ahead = max(gains)
        chosen[i] = ahead
        spare -= cost


def _joint_spheres(fits: list[_LinkFit]) -> list[Sphere]:
    """Spheres, the largest about each joint's origin inside an adjacent spheroid: a - c."""
    radii: dict[str, float] = {}
    for fit in fits:
        shape = fit.cover.hulls[0].shape
        c = float(np.linalg.norm(shape.focus_b - shape.focus_a)) / 2
        for link in {fit.link.name, fit.child} - {None}:
            radii[str(link)] = max(radii.get(str(link), 0.0), round(shape.semi_major - c, 9))
    return [Sphere(link, _ORIGIN, radius) for link, radius in radii.items()]


def _result(
    fits: list[_LinkFit],
    skipped: tuple[str, ...],
    left_out: tuple[str, ...],
    joint_spheres: list[Sphere],
    found: dict[str, SurfaceFit],
) -> OccupancyFit:
    spheres, spheroids, rows = list(joint_spheres), [], []
    for fit in fits:
        name = fit.link.name
        for shape, geometry_volume in fit.cover.hulls:
            a, b = tidy_point(shape.focus_a), tidy_point(shape.focus_b)
            is_sphere = shape.is_ball and not joint_spheres
            if is_sphere:
                spheres.append(Sphere(name, a, shape.semi_major))
            elif fit.child is not None:
                spheroids.append(Spheroid(name, a, fit.child, _ORIGIN, shape.semi_major))
            else:
                spheroids.append(Spheroid(name, a, name, b, shape.semi_major))
            rows.append(
                HullReport(
                    link=name,
                    kind="sphere" if is_sphere else "spheroid",
                    geometry_volume=geometry_volume,
                    hull_volume=shape.volume,
                )
            )
    report = FitReport(
        hulls=tuple(rows),
        links=tuple(_link_report(fit, found.get(fit.link.name)) for fit in fits),
        skipped=skipped,
        left_out=left_out,
    )
    return OccupancyFit(
        spheres=tuple(spheres),
        spheroids=tuple(spheroids),
        report=report,
        capsules=tuple(capsule for fit in found.values() for capsule in fit.capsules),
        pieces=tuple(piece for fit in found.values() for piece in fit.pieces),
    )


def _link_report(fit: _LinkFit, found: SurfaceFit | None) -> LinkReport:
    out = Overhang(0.0, 0.0) if found is None else found.overhang
    return LinkReport(
        link=fit.link.name,
        n_hulls=len(fit.cover.hulls),
        geometry_volume=convex_volume(fit.link.triangles.reshape(-1, 3)),
        covered_volume=fit.cover.volume,
        n_capsules=0 if found is None else len(found.capsules),
        mean_overhang=out.mean,
        worst_overhang=out.worst,
        n_pieces=0 if found is None else len(found.pieces),
    )
