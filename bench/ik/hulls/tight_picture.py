"""Draw capsules over the meshes they hold: the Panda's hand and link 5, as published.

python -m bench.ik.hulls.tight_picture
"""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from bench.common.arrays import FloatArray
from bench.humanoid.hulls import capsule_mesh
from bench.ik.judges.arm_meshes import public_robot
from bench.ik.pictures import cube, faces, plt, save
from pdoik.occupancy_fit import Capsules, Solid, fit_capsules, load_geometry, overhang_of, subdivide

LARGEST = 0.008  # edge of what is drawn: larger ones are sorted wrongly [m]
SECTIONS = 28  # of a capsule's circles
VIEWS = ((20, -60), (10, 40))  # elevation and azimuth [degrees]


def draw(ax: Any, triangles: FloatArray, capsules: Capsules) -> None:
    """The mesh opaque, the capsules over it as glass; one collection, so that depths are sorted."""
    drawn, colors = [subdivide(triangles, LARGEST)], [[0.95, 0.55, 0.2, 1.0]]
    for k, capsule in enumerate(zip(*capsules, strict=True)):
        drawn.append(subdivide(np.asarray(capsule_mesh(*capsule, SECTIONS).triangles), LARGEST))
        colors.append([*plt.get_cmap("tab20")(k % 20)[:3], 0.3])
    every = np.repeat(colors, [len(part) for part in drawn], axis=0)
    faces(ax, np.concatenate(drawn), facecolors=every, edgecolors="none")
    corners = triangles.reshape(-1, 3)
    center, reach = (corners.min(axis=0) + corners.max(axis=0)) / 2, np.ptp(corners, axis=0).max()
    cube(ax, center, 0.36 * reach)
    ax.set_axis_off()


def main(
    robot: str = "panda",
    links: Annotated[list[str], typer.Option(help="Repeatable.")] = ("panda_hand", "panda_link5"),
    out: Path = Path("bench/ik/hulls/capsules.png"),
) -> None:
    """Draw capsules over the meshes they hold."""
    public = public_robot(robot, Path("build"))
    meshes = {link.name: link.triangles for link in load_geometry(public.xml, public.package_dirs)}
    figure = plt.figure(figsize=(9, 4.5 * len(links)))
    for row, link in enumerate(links):
        found = fit_capsules(meshes[link])
        capsules = Capsules(*(np.array([hull[i] for hull in found]) for i in range(3)))
        out_by = overhang_of(Solid.of(meshes[link]), capsules)
        for column, view in enumerate(VIEWS, start=1):
            ax = figure.add_subplot(len(links), 2, 2 * row + column, projection="3d")
            draw(ax, meshes[link], capsules)
            ax.view_init(*view)
            if column == 1:
                ax.set_title(
                    f"{link}: {len(found)} capsules\n"
                    f"{1e3 * out_by.mean:.1f} mm out in the mean, {1e3 * out_by.worst:.1f} at worst"
                )
    figure.tight_layout()
    save(figure, out, dpi=80)


if __name__ == "__main__":
    typer.run(main)
