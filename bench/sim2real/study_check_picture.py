"""The table of `pdoik study check` as a picture: sizes by effect and joint, grey for none.

    python -m bench.sim2real.study_check_picture STUDY.yaml --out bench/sim2real/study_check.png

A row's colours compare its joints: the lighter, the smaller an effect is seen there.
"""

from pathlib import Path
from typing import Annotated

import matplotlib.pyplot as plt
import numpy as np
import typer

from pdoik._files import renamed_when_whole
from pdoik.sim2real import StudyCheck, check_study
from pdoik.sim2real.report import house_style
from pdoik.sim2real.study_check import Visible

Row = tuple[str, str, str]  # effect, variant, unit
_WIDEST = 1.5  # decades between the darkest and the lightest cell of a row


def main(
    study: Annotated[Path, typer.Argument(help="YAML: robot, joints, recordings.")],
    out: Annotated[Path, typer.Option(help="PNG.")],
) -> None:
    """Check the study and draw it."""
    check = check_study(study)
    with house_style(), renamed_when_whole(out) as path:
        figure = picture(check)
        figure.savefig(path, dpi=110, bbox_inches="tight")


def picture(check: StudyCheck) -> plt.Figure:
    """Figure of what is seen at one joint or more."""
    joints = [joint.name for joint in check.joints]
    rows: dict[Row, dict[str, Visible]] = {}
    for each in check.effects:
        if not each.joint:
            continue
        cells = rows.setdefault((each.effect, each.variant, each.unit), {})
        if each.joint not in cells or (each.smallest or np.inf) < (
            cells[each.joint].smallest or np.inf
        ):
            cells[each.joint] = each
    rows = {
        row: cells
        for row, cells in rows.items()
        if any(each.smallest is not None for each in cells.values())
    }
    sizes = np.array(
        [
            [_size(cells.get(joint)) * (-1.0 if _below(cells) else 1.0) for joint in joints]
            for cells in rows.values()
        ]
    )
    shade = np.log10(np.abs(sizes))
    shade = np.where(sizes < 0.0, -shade, shade)  # a limit is seen the better, the higher it is
    shade = shade - np.nanmin(shade, axis=1, keepdims=True)
    figure, axes = plt.subplots(figsize=(2.2 + 1.15 * len(joints), 0.9 + 0.27 * len(rows)))
    axes.set_facecolor("0.88")
    axes.imshow(shade, cmap="YlOrBr", vmin=0.0, vmax=_WIDEST, aspect="auto")
    for i, line in enumerate(sizes):
        for j, size in enumerate(line):
            if np.isfinite(size):
                said = f"{'<' if size < 0.0 else ''}{float(f'{abs(size):.2g}'):g}"
                dark = shade[i, j] > 0.65 * _WIDEST
                axes.text(j, i, said, ha="center", va="center", color="white" if dark else "black")
    axes.set_xticks(range(len(joints)), [name.removesuffix("_joint") for name in joints])
    axes.xaxis.tick_top()
    axes.set_yticks(range(len(rows)), [_label(row) for row in rows])
    axes.tick_params(length=0)
    axes.grid(visible=False)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.set_title("Smallest size that would be seen", loc="left", pad=24)
    return figure


def _size(each: Visible | None) -> float:
    return np.nan if each is None or each.smallest is None else each.smallest


def _below(cells: dict[str, Visible]) -> bool:
    return any(each.below for each in cells.values())


def _label(row: Row) -> str:
    effect, variant, unit = row
    name = effect.replace("_", " ") + (f" ({variant})" if variant else "")
    return name if unit == "-" else f"{name} [{unit}]"


if __name__ == "__main__":
    typer.run(main)
