"""The files of a comparison: comparison.json, patched.xml, patch.md, figures and the page."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from pdoik._files import write_whole

from ..report import Picture, house_style, number
from .compare import Comparison
from .differences import BANDS
from .figures import overlay
from .findings import Step, place_of
from .words import finding_line, headline, patch_table

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
