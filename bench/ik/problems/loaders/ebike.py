"""EBIKE's scenarios: NAME.ply, what stands around the robot, and NAME.pcd, targets on surfaces."""

from pathlib import Path

import numpy as np
import trimesh
from pypcd4 import PointCloud

from bench.common.arrays import FloatArray
from bench.ik.problems.families.on_surfaces import facing
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import RobotFiles
from bench.ik.problems.solids import Solid, mesh
from pdoik._ply import PlyError, read_ply
from pdoik._polygons import triangulated
from pdoik.scenes import EntryError as LoaderError

FIELDS = ("x", "y", "z", "normal_x", "normal_y", "normal_z")


def read_ebike(folder: Path, files: RobotFiles) -> dict[str, list[Problem]]:
    """Problems by the name of their scenario, one for each point of its .pcd.

    The tool's z axis goes against the point's normal, its x axis lies along the base's x (or y)
    as nearly as it can; which of the two ways z goes is a guess (README). The tool may touch the
    scenario's mesh. No configuration is known beforehand. A scenario without a .ply is empty.

    Raises:
        LoaderError: A file cannot be read, or has no normals.
    """
    sets = {}
    for file in sorted(folder.glob("*.pcd")):
        solids = _solids(file.with_suffix(".ply"))
        allowed = frozenset((link, solid.name) for link in files.touch_links for solid in solids)
        sets[file.stem] = [
            Problem(
                name=f"{file.stem}/{k}",
                robot=files.name,
                solids=solids,
                targets={files.tips[0]: facing(row[:3], row[3:])},
                allowed=allowed,
            )
            for k, row in enumerate(_points_and_normals(file))
        ]
    return sets


def _points_and_normals(file: Path) -> FloatArray:
    try:
        table = PointCloud.from_path(file)
    except Exception as error:  # the reader raises whatever its parsing stumbles over
        raise LoaderError(file, f"not a PCD file that can be read: {error}") from error
    if missing := [field for field in FIELDS if field not in table.fields]:
        raise LoaderError(file, f"has no fields {missing}")
    rows = np.asarray(table.numpy(FIELDS), dtype=np.float64)
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1) | (np.abs(rows[:, 3:]).max(axis=1) < 1e-6))
    if len(bad):
        raise LoaderError(file, "has no finite position and normal", f"point {bad[0]}")
    return rows


def _solids(file: Path) -> tuple[Solid, ...]:
    """The connected pieces of a mesh, each a solid of its own."""
    if not file.is_file():
        return ()
    try:
        ply = read_ply(file.read_bytes())
    except (OSError, PlyError) as error:
        raise LoaderError(file, f"not a mesh that can be read: {error}") from error
    if not len(ply.counts):
        return ()  # such as empty.ply
    faces = triangulated(ply.vertices, ply.corners, ply.counts)
    surface = trimesh.Trimesh(ply.vertices, faces)  # joins equal vertices
    pieces = surface.split(only_watertight=False)
    return tuple(mesh(f"{file.stem}/{k}", piece, np.eye(4)) for k, piece in enumerate(pieces))
