"""pdoik pairs: which links of a robot need no test against each other."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

import pdoik
from pdoik.descriptions import shipped_name

from .messages import err, fail, misuse_fails, out
from .robots import (
    PackageDirs,
    RobotArgument,
    XacroArguments,
    described,
    load_robot,
)

if TYPE_CHECKING:
    from pdoik.link_pairs import PairReport


def pairs(
    robot: RobotArgument,
    occupancy: Annotated[Path, typer.Option(help="Its hulls, as pdoik occupancy writes them.")],
    out_file: Annotated[
        Path | None, typer.Option("--out", help="Write the pairs into this SRDF.")
    ] = None,
    srdf: Annotated[
        Path | None, typer.Option(help="SRDF whose pairs are left out in any case.")
    ] = None,
    package_dir: PackageDirs = None,
    xacro_arg: XacroArguments = None,
    base_link: Annotated[str | None, typer.Option(help="First link; the root otherwise.")] = None,
    tip_link: Annotated[
        list[str] | None, typer.Option(help="Last link; repeatable. Needed where several end.")
    ] = None,
    meshes: Annotated[
        bool, typer.Option("--meshes/--no-meshes", help="Judge by meshes, or by hulls alone.")
    ] = True,
    samples: Annotated[int, typer.Option(min=1, help="Random configurations.")] = 5000,
    seed: Annotated[int, typer.Option(min=0)] = 0,
) -> None:
    """Find the pairs of links that self-collision may leave out, and say what is left.

    [bold]Example[/]: pdoik pairs arm.urdf --occupancy arm.occupancy.yaml --out arm.srdf
    """
    from pdoik.link_pairs import sample_pairs  # SciPy and trimesh take long to import

    if shipped_name(robot) is not None:
        fail(f"{robot} is shipped and has its pairs; expected a file or an installed description")
    if out_file is not None and not out_file.parent.is_dir():
        fail(f"--out: there is no folder {out_file.parent}")
    loaded = load_robot(
        robot, base_link, tip_link, occupancy, packages=package_dir, arguments=xacro_arg
    )
    with misuse_fails(), TemporaryDirectory(prefix="pdoik-meshes-") as folder:
        listed = [] if srdf is None else pdoik.load_srdf_pairs(srdf, loaded)
        text = described(robot, package_dir, xacro_arg, folder) if meshes else None
        with err.status("sampling configurations"):
            report = sample_pairs(loaded, text, listed=listed, samples=samples, seed=seed)
    _print(report)
    if out_file is not None:
        with misuse_fails("--out"):
            report.write(out_file)
        err.print(f"wrote {escape(str(out_file))}", highlight=False)


def _print(report: PairReport) -> None:
    table = Table("links", "", title="pairs whose hulls touch", title_justify="left")
    for name in ("hulls touch", "meshes meet"):
        table.add_column(name, justify="right")
    for pair in report.pairs:
        if pair.hulls:
            meet = "" if pair.meshes is None else str(pair.meshes)
            table.add_row(escape(" and ".join(pair.links)), pair.verdict, str(pair.hulls), meet)
    out.print(table)
    counted = report.samples if report.free is None else report.free
    kind = "configurations" if report.free is None else "free configurations"
    out.print(
        f"{len(report.ignored)} pairs left out; the hulls refuse {report.flagged} of {counted}"
        f" {kind} ({100 * report.flagged_share:.2f} %)",
        highlight=False,
    )
    if report.free is None:
        return
    for row in report.clearances:
        out.print(
            f"self_clearance {1e3 * row.clearance:g} mm: refuses {row.flagged} of {report.free}"
            f" that are free, misses {row.missed} of {report.samples - report.free} that collide",
            highlight=False,
        )
