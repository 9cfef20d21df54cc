"""Draw capsules over the meshes they hold: the Panda's hand and link 5, as published.

python -m bench.ik.hulls.tight_picture [--links LINK ...] [--out bench/ik/hulls/capsules.png]
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib import pyplot as plt
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from bench.ik.judges.arm_meshes import public_robot
from pdoik.occupancy_fit import fit_capsules
from pdoik.occupancy_fit.geometry import load_geometry
from pdoik.occupancy_fit.overhang import overhang
from pdoik.occupancy_fit.segments import Capsules
from pdoik.occupancy_fit.solid import Solid, subdivide

FloatArray = npt.NDArray[np.float64]
LARGEST = 0.008  # edge of what is drawn: larger ones are sorted wrongly [m]
VIEWS = ((20, -60), (10, 40))  # elevation and azimuth [degrees]


def capsule_grid(a: FloatArray, b: FloatArray, radius: float) -> FloatArray:
    """Corners of quadrilaterals on the capsule, (Q, 4, 3) [m]."""
    length = float(np.linalg.norm(b - a))
    axis = (b - a) / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
    across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    across /= np.linalg.norm(across)
    cap = np.linspace(-np.pi / 2, 0, 7)
    side = np.linspace(0, length, 2 + int(length / LARGEST))[1:-1]
    along = np.concatenate([radius * np.sin(cap), side, length - radius * np.sin(cap[::-1])])
    wide = radius * np.concatenate([np.cos(cap), np.ones(len(side)), np.cos(cap[::-1])])
    turn = np.linspace(0, 2 * np.pi, 29)
    ring = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(axis, across)
    grid = a + along[:, None, None] * axis + wide[:, None, None] * ring
    corners = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
    return np.stack(corners, axis=2).reshape(-1, 4, 3)


def draw(ax: Any, triangles: FloatArray, capsules: Capsules) -> None:
    """The mesh opaque, the capsules over it as glass; one collection, so that depths are sorted."""
    triangles = subdivide(triangles, LARGEST)
    closed = np.concatenate([triangles, triangles[:, 2:]], axis=1)
    faces, colors = [closed], [np.tile([0.95, 0.55, 0.2, 1.0], (len(closed), 1))]
    for k, (a, b, radius) in enumerate(zip(*capsules, strict=True)):
        faces.append(capsule_grid(a, b, radius))
        colors.append(np.tile([*plt.get_cmap("tab20")(k % 20)[:3], 0.3], (len(faces[-1]), 1)))
    everything = np.concatenate(colors)
    ax.add_collection3d(
        Poly3DCollection(np.concatenate(faces), facecolors=everything, edgecolors="none")
    )
    corners = triangles.reshape(-1, 3)
    center, reach = (corners.min(axis=0) + corners.max(axis=0)) / 2, np.ptp(corners, axis=0).max()
    for i, name in enumerate("xyz"):
        getattr(ax, f"set_{name}lim")(center[i] - 0.36 * reach, center[i] + 0.36 * reach)
    ax.set_box_aspect((1, 1, 1))
    ax.set_axis_off()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--robot", default="panda")
    parser.add_argument("--links", nargs="+", default=["panda_hand", "panda_link5"])
    parser.add_argument("--out", type=Path, default=Path("bench/ik/hulls/capsules.png"))
    options = parser.parse_args()
    mpl.use("Agg")
    public = public_robot(options.robot, Path("build"))
    meshes = {link.name: link.triangles for link in load_geometry(public.xml, public.package_dirs)}
    figure = plt.figure(figsize=(9, 4.5 * len(options.links)))
    for row, link in enumerate(options.links):
        found = fit_capsules(meshes[link])
        capsules = Capsules(*(np.array([hull[i] for hull in found]) for i in range(3)))
        out = overhang(Solid.of(meshes[link]), capsules)
        for column, (elevation, azimuth) in enumerate(VIEWS):
            place = 2 * row + column + 1
            ax: Any = figure.add_subplot(len(options.links), 2, place, projection="3d")
            draw(ax, meshes[link], capsules)
            ax.view_init(elevation, azimuth)
            if column == 0:
                ax.set_title(
                    f"{link}: {len(found)} capsules\n"
                    f"{1e3 * out.mean:.1f} mm out in the mean, {1e3 * out.worst:.1f} at worst"
                )
    figure.tight_layout()
    figure.savefig(options.out, dpi=80)


if __name__ == "__main__":
    main()
