"""pdoik pairs: which links of a robot need no test against each other."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

import pdoik

from .messages import err, fail, misuse_fails, out
from .robots import BUILTIN, load_robot

if TYPE_CHECKING:
    from pdoik.link_pairs import PairReport


def pairs(
    urdf: Annotated[
        Path, typer.Argument(help="Robot with collision geometry.", metavar="FILE.urdf")
    ],
    occupancy: Annotated[Path, typer.Option(help="Its hulls, as pdoik occupancy writes them.")],
    out_file: Annotated[
        Path | None, typer.Option("--out", help="Write the pairs into this SRDF.")
    ] = None,
    srdf: Annotated[
        Path | None, typer.Option(help="SRDF whose pairs are left out in any case.")
    ] = None,
    package_dir: Annotated[
        list[Path] | None,
        typer.Option(help="Folder that holds the packages of package:// addresses; repeatable."),
    ] = None,
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

    if str(urdf) in BUILTIN:
        fail(f"{urdf} is built in and has its pairs; expected a URDF file")
    if out_file is not None and not out_file.parent.is_dir():
        fail(f"--out: there is no folder {out_file.parent}")
    with misuse_fails():
        robot = load_robot(str(urdf), base_link, tip_link, occupancy)
        listed = [] if srdf is None else pdoik.load_srdf_pairs(srdf, robot)
        with err.status("sampling configurations"):
            report = sample_pairs(
                robot,
                urdf if meshes else None,
                package_dir or (),
                listed=listed,
                samples=samples,
                seed=seed,
            )
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
