"""pdoik occupancy: hulls for a robot that has none."""

from __future__ import annotations

import warnings
from os import sched_getaffinity
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from pdoik._extras import asks_for
from pdoik.descriptions import shipped_name

from .fit_progress import fit_story
from .messages import err, fail, misuse_fails, out, tell, warn
from .robots import PackageDirs, RobotArgument, XacroArguments, described
from .solve_files import check_picture

if TYPE_CHECKING:
    from pdoik.occupancy_fit import FitReport, LinkGeometry, OccupancyFit


def occupancy(
    robot: RobotArgument,
    out_file: Annotated[
        Path | None, typer.Option("--out", help="Write the hulls into this YAML file.")
    ] = None,
    package_dir: PackageDirs = None,
    xacro_arg: XacroArguments = None,
    base_link: Annotated[str | None, typer.Option(help="First link; the root otherwise.")] = None,
    tip_link: Annotated[str | None, typer.Option(help="Last link; all of them otherwise.")] = None,
    max_volume_factor: Annotated[
        float, typer.Option(help="Hull volume over geometry volume that is good enough.")
    ] = 2.0,
    max_parts: Annotated[int, typer.Option(help="Most hulls per link.")] = 4,
    max_hulls: Annotated[int | None, typer.Option(help="Most hulls in all.")] = None,
    paper: Annotated[
        bool,
        typer.Option("--paper", help="One spheroid per link from joint to joint, as in the paper."),
    ] = False,
    capsules: Annotated[
        bool,
        typer.Option("--capsules/--no-capsules", help="Hold each link closely by capsules too."),
    ] = True,
    pieces: Annotated[
        bool,
        typer.Option("--pieces/--no-pieces", help="Fit convex pieces of links, to 1 mm, too."),
    ] = True,
    picture: Annotated[
        Path | None,
        typer.Option(help="Draw where each link's capsules stick out most into this .png file."),
    ] = None,
    cache: Annotated[
        Path | None,
        typer.Option(help="Folder where fits are kept; the user's (PDOIK_CACHE) otherwise."),
    ] = None,
    no_cache: Annotated[
        bool, typer.Option("--no-cache", help="Fit all links anew, and keep nothing.")
    ] = False,
    processes: Annotated[
        int | None, typer.Option(help="Links fitted at a time; one per processor otherwise.")
    ] = None,
) -> None:
    """Fit hulls around a robot's collision geometry, and say what they cost.

    Fits are kept link by link: after Ctrl-C the same command goes on.

    [bold]Example[/]: pdoik occupancy arm.urdf --package-dir share --out arm.occupancy.yaml
    """
    from pdoik.errors import OverhangWarning
    from pdoik.occupancy_fit import (  # SciPy and trimesh take long to import
        AIM,
        fit_occupancy,
        load_geometry,
    )

    if shipped_name(robot) is not None:
        fail(f"{robot} is shipped and has its hulls; expected a file or an installed description")
    if out_file is not None and not out_file.parent.is_dir():
        fail(f"--out: there is no folder {out_file.parent}")
    if cache is not None and no_cache:
        fail("--cache and --no-cache exclude each other")
    check_picture(picture)
    if picture is not None and (paper or not capsules):
        fail("--picture shows capsules; leave out --paper and --no-capsules")
    with (
        misuse_fails(),
        TemporaryDirectory(prefix="pdoik-meshes-") as folder,
        fit_story() as story,
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore", OverhangWarning)  # reported under the table
        urdf = described(robot, package_dir, xacro_arg, folder)
        fit = fit_occupancy(
            urdf,
            max_volume_factor=max_volume_factor,
            base_link=base_link,
            tip_link=tip_link,
            max_parts=max_parts,
            max_hulls=max_hulls,
            paper=paper,
            capsules=capsules,
            pieces=pieces,
            cache=False if no_cache else cache,
            processes=processes or len(sched_getaffinity(0)),
            progress=story,
        )
        meshes = [] if picture is None else load_geometry(urdf, (), base_link, tip_link)

    named = Path(robot).name
    table = Table(
        "link", "hull", title=f"{escape(named)}: what the hulls add", title_justify="left"
    )
    for name in ("geometry [l]", "hull [l]", "empty [l]", "factor"):
        table.add_column(name, justify="right")
    for row in fit.report.hulls:
        volumes = (row.geometry_volume, row.hull_volume, row.empty_volume)
        cells = [f"{1e3 * volume:.3f}" for volume in volumes]
        table.add_row(escape(row.link), row.kind, *cells, f"{row.factor:.2f}", style="dim")
    table.add_section()
    for link in fit.report.links:
        volumes = (
            link.geometry_volume,
            link.covered_volume,
            link.covered_volume - link.geometry_volume,
        )
        cells = [f"{1e3 * volume:.3f}" for volume in volumes]
        table.add_row(escape(link.link), f"all {link.n_hulls}", *cells, f"{link.factor:.2f}")
    out.print(table)
    out.print(
        f"{len(fit.report.hulls)} hulls that fill {fit.report.factor:.2f} times the links' convex"
        " hulls\ngeometry: the convex hull of what a row holds; overlaps count once per link",
        highlight=False,
    )
    if fit.capsules:
        out.print(_capsule_table(fit.report))
        for link in fit.report.links:
            if not link.overhang.meets(AIM):
                warn(f"{link.link}: capsules stick out {link.overhang}, the aims are {AIM}")
    for name in fit.report.skipped:
        out.print(f"{escape(name)}: no collision geometry, skipped", highlight=False)
    if fit.report.left_out:
        links = ", ".join(fit.report.left_out)
        warn(f"left out, for --base-link and --tip-link: {links}; they collide unseen")
    if picture is not None:
        _draw(picture, fit, meshes)
    if out_file is not None:
        with misuse_fails("--out"):
            fit.write(out_file, comment=f"Hulls of {named}, made by pdoik occupancy.")
        err.print(f"wrote {escape(str(out_file))}", highlight=False)


def _draw(picture: Path, fit: OccupancyFit, links: list[LinkGeometry]) -> None:
    with asks_for("plot"):
        from pdoik.picture import draw_overhangs  # Matplotlib takes long to import
    with misuse_fails("--picture"):
        draw_overhangs(picture, fit.capsules, {link.name: link.triangles for link in links})
    tell(f"wrote {picture}")


def _capsule_table(report: FitReport) -> Table:
    """Per link, how many capsules there are and how far their union sticks out."""
    table = Table("link", title="capsules, and how far they stick out", title_justify="left")
    for name in ("capsules", "mean [mm]", "worst [mm]", "pieces"):
        table.add_column(name, justify="right")
    for link in report.links:
        distances = [f"{1e3 * value:.2f}" for value in (link.mean_overhang, link.worst_overhang)]
        count = str(link.n_pieces) if link.n_pieces else "-"
        table.add_row(escape(link.link), str(link.n_capsules), *distances, count)
    table.add_section()
    capsules = str(sum(link.n_capsules for link in report.links))
    pieces = str(sum(link.n_pieces for link in report.links))
    table.add_row("all", capsules, "", "", pieces)
    return table
