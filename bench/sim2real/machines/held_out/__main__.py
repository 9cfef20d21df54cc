"""Command line: held-out residuals of a run's diagnoses over the true law's.

    python -m bench.sim2real.machines.held_out --worlds build/bench/machines [--tool DIGEST]

Of joints that carry no fault and of those that do, on the recordings that only judge, in the band
of the diagnosis; worlds whose fault no law of torques has (contacts, logs with glitches, loose or
limited drives) are left out.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer

from bench.common.commands import console, plain_errors, show
from bench.common.markdown import markdown_table
from bench.sim2real.machines.held_out.residuals import rows_of
from bench.sim2real.proof.conceal import SEALED, STUDIES

_LAWFUL = {
    *("coulomb_friction", "viscous_friction", "stribeck_friction", "asymmetric_friction"),
    *("load_dependent_friction", "gear_efficiency", "presliding_hysteresis", "joint_coupling"),
    *("torque_gain", "torque_ripple", "joint_offset", "position_dependent_spring"),
    *("link_inertial_error", "payload", "gravity_direction"),
}
"""Kinds that the true law has, and that act throughout."""


def main(
    worlds: Annotated[Path, typer.Option(help="Folder of a run of bench.sim2real.machines.")],
    tool: Annotated[str, typer.Option(help="First letters of the digest of the tool.")] = "",
) -> None:
    """Work out, print."""
    with plain_errors():
        (folder,) = worlds.glob(f"said-{tool}*")
        rows = []
        for path in sorted((worlds / SEALED).glob("*.json")):
            truth = json.loads(path.read_text())
            begun = any(fault["begins"] for fault in truth["faults"])
            if begun or not {fault["kind"] for fault in truth["faults"]} <= _LAWFUL:
                continue
            said = json.loads((folder / path.name).read_text()).get("diagnosis")
            if said is not None:
                study = worlds / STUDIES / path.stem / "study.yaml"
                rows += rows_of(path.stem, study, truth, said)
                console.print(path.stem)
        names = ["world", "joint", "faulty", "before", "after", "true"]
        table = pd.DataFrame(rows, columns=names)
        shown = []
        for what, part in (
            ("without a fault", table[~table.faulty]),
            ("faulty", table[table.faulty]),
        ):
            over, at_first = part.after / part.true, part.before / part.true
            shown.append(
                [
                    what,
                    str(len(part)),
                    f"{at_first.median():.2f}",
                    f"{over.median():.2f}",
                    f"{over.quantile(0.9):.2f}",
                    f"{(over <= 1.15).mean():.2f}",
                ]
            )
        header = ["joints", "number", "as the model is, median", "by the diagnosis, median"]
        show(markdown_table([*header, "nine of ten below", "at most 1.15 times"], shown))


if __name__ == "__main__":
    typer.run(main)
