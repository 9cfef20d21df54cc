"""The robot's hulls on the page: what it fills, and the wide hulls around its capsules."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
import viser

import pdoik
from pdoik._hulls import PlacedCapsule, PlacedSpheroid, placed_hulls, wide_hulls

from .instances import add_instances
from .shapes import capsule_instances, spheroid_instances

FloatArray = npt.NDArray[np.float64]

_HULL, _TIGHT, _BROKEN = (38, 98, 184), (240, 140, 20), (224, 20, 20)
_SHELLS = ((112, 152, 214), (62, 98, 160))
_OPACITY = 0.38
_GLASS = 1.02  # by which hulls are drawn wider around meshes, which may lie in their surface


class HullScene:
    """The nodes /robot/hulls, /robot/capsules and /robot/wide_hulls, which follow the posture.

    A capsule is a tube and two caps, for its shape does not scale with its length.

    Args:
        server: Where to draw.
        robot: Whose hulls.
        solid: Whether they are all that there is to see of the robot.
    """

    def __init__(
        self, server: viser.ViserServer, robot: pdoik.Robot, *, solid: bool = False
    ) -> None:
        self._server, self._robot = server, robot
        occupancy = robot.occupancy
        n_spheroids = len(occupancy.spheres) + len(occupancy.spheroids)
        n_capsules = len(occupancy.capsules)
        self._solid, self._wider = solid, 1.0 if solid else _GLASS
        self._colors = _colors(robot) if solid else np.tile(_HULL, (n_spheroids + n_capsules, 1))
        self._wide = np.zeros(n_spheroids, dtype=bool)
        self._wide[sorted(wide_hulls(robot))] = True
        n_wide = int(self._wide.sum())
        ball, coarse = (trimesh.creation.icosphere(subdivisions=n, radius=1.0) for n in (3, 2))
        self._spheroids = self._add("hulls", ball, n_spheroids - n_wide)
        self._tubes = self._add("capsules/tubes", _tube(), n_capsules)
        self._caps = self._add("capsules/caps", _cap(), 2 * n_capsules)
        # Of wire: glass would hide what is drawn within it later.
        self._wide_hulls = self._add("wide_hulls", coarse, n_wide, wireframe=True)

    def show_parts(self, *, hulls: bool, wide_hulls: bool) -> None:
        """Show or hide what the robot fills, and what is around its capsules."""
        for node in (self._spheroids, self._tubes, self._caps):
            if node is not None:
                node.visible = hulls
        if self._wide_hulls is not None:
            self._wide_hulls.visible = wide_hulls

    def show(self, q: FloatArray, tight: Collection[int], *, fails: bool) -> None:
        """Pose everything; tight hulls turn orange, or red if their constraint fails.

        Args:
            q: The posture, (n,).
            tight: Numbers of the hulls of the binding constraint.
            fails: Whether it is violated.
        """
        hulls = placed_hulls(self._robot, q)
        colors = self._colors.astype(np.uint8)
        colors[list(tight)] = _BROKEN if fails else _TIGHT
        n = len(self._wide)
        spheroids = [hull for hull in hulls if isinstance(hull, PlacedSpheroid)]
        capsules = [hull for hull in hulls if isinstance(hull, PlacedCapsule)]
        wxyz, centers, axes = spheroid_instances(spheroids)
        for node, mine in ((self._spheroids, ~self._wide), (self._wide_hulls, self._wide)):
            _place(node, wxyz[mine], centers[mine], self._wider * axes[mine], colors[:n][mine])
        wxyz, ends, lengths, radii = capsule_instances(capsules)
        radii = self._wider * radii
        tube = np.column_stack([lengths, radii, radii])
        _place(self._tubes, wxyz, ends.mean(axis=1), tube, colors[n:])
        w, x, y, z = wxyz.T
        back = np.column_stack([-y, -z, w, x])  # half a turn about the local y first
        _place(
            self._caps,
            np.concatenate([back, wxyz]),
            np.concatenate([ends[:, 0], ends[:, 1]]),
            np.repeat(np.tile(radii, 2)[:, None], 3, axis=1),
            np.tile(colors[n:], (2, 1)),
        )

    def _add(self, name: str, mesh: Any, n: int, *, wireframe: bool = False) -> Any:
        if not n:
            return None
        return add_instances(
            self._server,
            f"/robot/{name}",
            mesh,
            n,
            _HULL,
            opacity=None if self._solid and not wireframe else _OPACITY,
            wireframe=wireframe,
            cast_shadow=False,
            receive_shadow=False,
        )


def _colors(robot: pdoik.Robot) -> npt.NDArray[np.int_]:
    """Colours of solid hulls in the order of `placed_hulls`: one link lighter, the next darker."""
    occupancy = robot.occupancy
    hulls = (*occupancy.spheres, *occupancy.spheroids, *occupancy.capsules)
    place = {link: k for k, link in enumerate(dict.fromkeys(hull[0] for hull in hulls))}
    return np.array([_SHELLS[place[hull[0]] % 2] for hull in hulls], dtype=int).reshape(-1, 3)


def _place(
    node: Any,
    wxyz: FloatArray,
    positions: FloatArray,
    scales: FloatArray,
    colors: npt.NDArray[np.uint8],
) -> None:
    if node is None:
        return
    node.batched_wxyzs = wxyz
    node.batched_positions = positions
    node.batched_scales = scales
    node.batched_colors = colors


def _tube() -> Any:
    """An open cylinder of radius and length 1 along x, about the origin."""
    tube = trimesh.creation.cylinder(radius=1.0, height=1.0, sections=24)
    tube.update_faces(np.abs(tube.face_normals[:, 2]) < 0.5)
    tube.remove_unreferenced_vertices()
    tube.apply_transform(np.eye(4)[[2, 0, 1, 3]])  # z, its axis, becomes x
    return tube


def _cap() -> Any:
    """The half of the unit sphere where x > 0."""
    polar, around = np.linspace(0, np.pi / 2, 7), np.linspace(0, 2 * np.pi, 25)[:-1]
    rows = [
        [np.cos(p), np.sin(p) * np.cos(t), np.sin(p) * np.sin(t)] for p in polar for t in around
    ]
    i, j = np.meshgrid(np.arange(6) * 24, np.arange(24), indexing="ij")
    a, b = (i + j).ravel(), (i + (j + 1) % 24).ravel()
    faces = np.concatenate([np.column_stack([a, a + 24, b]), np.column_stack([b, a + 24, b + 24])])
    return trimesh.Trimesh(np.array(rows), faces)
