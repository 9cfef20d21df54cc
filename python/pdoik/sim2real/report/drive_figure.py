"""What drives do not exceed: torques over speed, below a level or a line that falls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pdoik.sim2real.findings import Diagnosis, Finding

from .curves import sample
from .data import ReportData
from .style import AFTER, MEASURED, Picture, picture, quiet_legend, short

COLUMNS = 3
POINTS = 3000  # of a panel
_LEVELS = {"torque_saturation": "level", "torque_speed_limit": "stall_torque"}


def drives_picture(diagnosis: Diagnosis, data: ReportData) -> Picture | None:
    """A panel for each limit that was found; None without any, or without torques."""
    shown = [
        (finding, data.joints.index(joint))
        for finding in diagnosis.findings
        if finding.effect in _LEVELS
        for joint in finding.joints
        if data.residual_of == "torque" and joint in data.joints
    ]
    if not shown or any(traces.measured is None for traces in data.recordings):
        return None
    columns = min(len(shown), COLUMNS)
    lines = -(-len(shown) // columns)
    height = 0.75 + 2.6 * lines
    figure = Figure(figsize=(10.6, height))
    grid = figure.add_gridspec(
        lines, columns, left=0.07, right=0.99, top=1 - 0.36 / height, bottom=0.5 / height,
        wspace=0.25, hspace=0.45,
    )  # fmt: skip
    for k, (finding, joint) in enumerate(shown):
        _panel(figure.add_subplot(grid[k // columns, k % columns]), data, finding, joint)
    return picture(
        figure, "drives", "Torques as recorded, over speed, and what the drive does not exceed."
    )


def _panel(axes: Axes, data: ReportData, finding: Finding, joint: int) -> None:
    torque = np.concatenate([each[:, joint] for each in _measured(data)])
    speed = np.concatenate([traces.dq[:, joint] for traces in data.recordings])
    chosen = sample(len(speed), POINTS)
    axes.plot(
        speed[chosen], torque[chosen], ".", ms=2.0, mew=0, alpha=0.4, color=MEASURED,
        label="recorded", rasterized=True,
    )  # fmt: skip
    along = np.linspace(float(np.nanmin(speed)), float(np.nanmax(speed)), 200)
    level = finding.parameters[_LEVELS[finding.effect]].value
    fastest = finding.parameters.get("no_load_speed")
    fall = 0.0 if fastest is None else 1.0 / fastest.value
    for sign in (1.0, -1.0):
        most = sign * level * np.maximum(1.0 - sign * along * fall, 0.0)
        axes.plot(along, most, color=AFTER, lw=1.8, label="limit" if sign > 0 else None)
    highest = 1.3 * max(level, float(np.nanquantile(np.abs(torque), 0.999)))
    name = short(data.joints[joint], 20)
    axes.set(
        xlabel=f"speed [{data.position_unit(joint)}/s]", ylabel=f"torque [{data.units[joint]}]",
        ylim=(-highest, highest), title=name,
    )  # fmt: skip
    quiet_legend(axes)


def _measured(data: ReportData) -> Sequence[np.typing.NDArray[np.float64]]:
    return [each.measured for each in data.recordings if each.measured is not None]
