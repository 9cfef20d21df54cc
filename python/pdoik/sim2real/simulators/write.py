"""The files of a comparison: comparison.json, patched.xml, patch.md, pictures and the page."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pdoik._files import write_whole
from pdoik.recordings import FloatArray

from ..report import AFTER, BEFORE, MEASURED, Picture, house_style, number, picture, short
from .compare import Comparison, Trace
from .differences import BANDS, in_bands
from .findings import Step, place_of
from .words import finding_line, headline, patch_table

_WINDOW = 2.0  # numerics: shown about the largest error [s]


def overlay(trace: Trace, joints: tuple[str, ...], name: str) -> Picture:
    """A row for each joint: where the error is largest, and the error by frequency."""
    n = len(joints)
    figure = Figure(figsize=(9.0, 1.0 + 1.45 * n), layout="constrained")
    grid = figure.subplots(n, 2, squeeze=False, width_ratios=(2.2, 1.0))
    for k, joint in enumerate(joints):
        _motion(grid[k, 0], trace, k, joint)
        _bands(grid[k, 1], trace, k)
    grid[0, 0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.12), ncols=3, borderaxespad=0.1)
    grid[0, 1].set_title("error by frequency [rad rms]")
    grid[-1, 0].set_xlabel("time [s]")
    grid[-1, 1].set_xlabel("[Hz]")
    after = "" if trace.patched is None else ", and the simulator with the patch (blue)"
    caption = (
        f"{trace.recording.name}: positions of the machine (dark), the simulator as it is (red)"
        f"{after}, {_WINDOW:g} s about the largest error of each joint."
    )
    return picture(figure, name, caption)


def _motion(axes: Axes, trace: Trace, k: int, joint: str) -> None:
    time, q = trace.recording.time, trace.recording.q[:, k]
    error = np.abs(q - trace.simulator[:, k])
    middle = float(time[int(np.nanargmax(error))]) if np.isfinite(error).any() else 0.0
    first = float(np.clip(middle - 0.5 * _WINDOW, 0.0, max(time[-1] - _WINDOW, 0.0)))
    at = (time >= first) & (time <= first + _WINDOW)
    axes.plot(time[at], q[at], color=MEASURED, lw=1.6, label="machine")
    axes.plot(time[at], trace.simulator[at, k], color=BEFORE, lw=1.0, label="simulator")
    said = number(_rms(q - trace.simulator[:, k]))
    if trace.patched is not None:
        axes.plot(time[at], trace.patched[at, k], color=AFTER, lw=1.0, label="patched")
        said += f" → {number(_rms(q - trace.patched[:, k]))}"
    axes.set_title(f"{short(joint, 24)}: {said} rad rms")
    axes.set_ylabel("[rad]")
    axes.set_xlim(first, first + _WINDOW)


def _bands(axes: Axes, trace: Trace, k: int) -> None:
    place = np.arange(len(BANDS))
    sides = [(trace.simulator, BEFORE, -0.2)]
    if trace.patched is not None:
        sides.append((trace.patched, AFTER, 0.2))
    for values, color, aside in sides:
        error = trace.recording.q[:, k] - values[:, k]
        there = np.isfinite(error)
        axes.bar(
            place + aside, in_bands(error[there], trace.recording.period), width=0.38, color=color
        )
    names = [f"<{high:g}" if np.isfinite(high) else f">{low:g}" for low, high in BANDS]
    axes.set_xticks(place, names)


def _rms(error: FloatArray) -> float:
    return float(np.sqrt(np.nanmean(error**2)))


SCHEMA = "pdoik.comparison/1"
_MOST_PICTURES = 3


def write(folder: str | Path, comparison: Comparison) -> Path:
    """Write the comparison; returns the page's path.

    Raises:
        OSError: the folder cannot be made or written to.
    """
    folder = Path(folder)
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    write_whole(folder / "comparison.json", to_json(comparison))
    if comparison.patch is not None:
        write_whole(folder / "patched.xml", comparison.patch.text)
    else:
        (folder / "patched.xml").unlink(missing_ok=True)  # of another comparison
    if comparison.machine is not None:
        left_out = comparison.patch.left_out if comparison.patch else ()
        write_whole(folder / "patch.md", patch_table(comparison.machine, left_out))
    if comparison.simulator is not None:
        table = patch_table(comparison.simulator, ())
        write_whole(folder / "simulator_beyond_description.md", table)
    with house_style():
        pictures = _pictures(comparison)
    for each in pictures:
        write_whole(folder / "figures" / f"{each.name}.png", each.png)
    write_whole(folder / "compare.html", _page(comparison, pictures))
    return folder / "compare.html"


def to_json(comparison: Comparison) -> str:
    """Text of comparison.json."""
    content = {
        "schema": SCHEMA,
        "pairs": [
            {
                "machine": pair.machine.name,
                "simulation": pair.simulation.name,
                "shift": pair.shift,
                "drift": pair.drift,
                "likeness": pair.likeness,
                "by": pair.by,
            }
            for pair in comparison.pairs
        ],
        "bands": [list(band) for band in BANDS[:-1]] + [[BANDS[-1][0], None]],
        "differences": [asdict(each) for each in comparison.differences],
        "simulator_beyond_description": _step(comparison.simulator),
        "machine_beyond_simulator": _step(comparison.machine),
        "patch_left_out": list(comparison.patch.left_out) if comparison.patch else [],
        "notes": list(comparison.notes),
    }
    return json.dumps(content, indent=1) + "\n"


def _step(step: Step | None) -> Mapping[str, Any] | None:
    if step is None:
        return None
    user = step.explained.user
    return {
        "model": step.model,
        "verdict": step.verdict,
        "findings": [asdict(each) for each in step.findings],
        "suspected": [asdict(each) for each in step.suspected],
        "joints": {name: asdict(fit) for name, fit in step.joints.items()},
        "changed": [
            {
                "property": each.parameter_id.property,
                "at": place_of(user, each.parameter_id),
                "before": each.before,
                "after": each.after,
            }
            for each in step.changed
        ],
    }


def _pictures(comparison: Comparison) -> list[Picture]:
    held_out = [t for t in comparison.traces if t.recording.role == "validate"]
    shown = (held_out or list(comparison.traces))[:_MOST_PICTURES]
    joints = comparison.study.joints
    return [overlay(trace, joints, f"overlay_{k + 1}") for k, trace in enumerate(shown)]


def _page(comparison: Comparison, pictures: list[Picture]) -> str:
    report = Path(__file__).parents[1] / "report"
    environment = Environment(
        loader=FileSystemLoader([Path(__file__).parent, report]),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["number"] = number
    environment.filters["line"] = finding_line
    machine = comparison.machine
    steps = [each for each in (comparison.simulator, comparison.machine) if each is not None]
    return environment.get_template("compare.html.j2").render(
        comparison=comparison,
        steps=[(headline(each), each) for each in steps],
        changed=[
            (place_of(machine.explained.user, each.parameter_id), each) for each in machine.changed
        ]
        if machine is not None
        else [],
        bands=[f"{low:g} to {high:g} Hz" for low, high in BANDS[:-1]]
        + [f"over {BANDS[-1][0]:g} Hz"],
        pictures=pictures,
    )
