"""Command that diagnoses recordings of real machines, by one version of the tool or by two.

    python -m bench.sim2real.proof.real --recordings DIR --out build/bench/real
    python -m bench.sim2real.proof.real --recordings DIR --out build/bench/real --before OTHER

real.md has what was found, what is left, what was not claimed, and what counts of it.
"""

import json
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

import pdoik
from bench.common.commands import OutFolder, console, plain_errors, show, write_report
from bench.common.digests import digest_of_folder
from bench.common.whole_files import write_text
from bench.sim2real.frame.blind import blind
from bench.sim2real.proof.real_machine import Machine, write_study
from bench.sim2real.proof.real_report import report, totals_table
from bench.sim2real.proof.real_studies import MACHINES

INSTALLED = Path(pdoik.__file__).parents[1]

Said = dict[str, Any]
Tool = Annotated[
    Path | None,
    typer.Option(exists=True, file_okay=False, help="Folder that holds a package pdoik."),
]


def diagnose_real(
    recordings: Path, out: Path, tools: Mapping[str, Path | None] | None = None
) -> str:
    """Writes real.md, and real/TOOL/NAME.json for each machine whose recordings are there.

    Args:
        recordings: folder with the machines' folders.
        out: of the results.
        tools: by name, folders that hold a package pdoik, None for the one that is installed.

    Returns:
        the table of totals.
    """
    tools = tools or {"": None}
    there = [each for each in MACHINES if each.recorded(recordings).is_dir()]
    said: dict[str, dict[str, Said]] = {each.name: {} for each in there}
    digests = {}
    for name, tool in tools.items():
        with tempfile.TemporaryDirectory(prefix="pdoik-tool-") as folder:
            still = _still(tool, Path(folder))
            digest = digest_of_folder((still or INSTALLED) / "pdoik" / "sim2real")
            digests[f"digest of the tool {name}".strip()] = digest
            for machine in there:
                kept = out / "real" / name / f"{machine.name}.json"
                with console.status(f"{machine.title} {name}"):
                    said[machine.name][name] = _said(machine, recordings, kept, still, digest)
    missing = [each for each in MACHINES if each not in there]
    out.mkdir(parents=True, exist_ok=True)
    write_report(out / "real.md", report(there, said, list(tools), missing), digests)
    console.print(f"real machines: {out}/real.md")
    return totals_table(there, said, list(tools))


def _still(tool: Path | None, folder: Path) -> Path | None:
    """A copy of a tool, so that nobody changes it while it is measured."""
    if tool is None:
        return None
    without = shutil.ignore_patterns("__pycache__")
    shutil.copytree(tool / "pdoik", folder / "pdoik", ignore=without)
    return folder


def _said(machine: Machine, recordings: Path, kept: Path, tool: Path | None, digest: str) -> Said:
    """The diagnosis; that of the same tool on the same study is kept."""
    with tempfile.TemporaryDirectory(prefix="pdoik-real-") as folder:
        study = Path(folder) / machine.name
        write_study(machine, recordings, study)
        made = {"tool": digest, "study": digest_of_folder(study)}
        if kept.is_file() and made.items() <= (old := json.loads(kept.read_text())).items():
            return dict(old)
        said = {**made, **blind(study, tool=tool)}
    kept.parent.mkdir(parents=True, exist_ok=True)
    write_text(kept, json.dumps(said, indent=1) + "\n")
    return said


def main(
    recordings: Annotated[
        Path, typer.Option(exists=True, file_okay=False, help="Folder of the machines' folders.")
    ],
    out: OutFolder,
    before: Tool = None,
    after: Tool = None,
) -> None:
    """Diagnose recordings of real machines, and hold what is said against what is known.

    With --before, two versions of the tool; the second is --after, or the one that is installed.
    """
    tools = {"": after} if before is None else {"before": before, "after": after}
    with plain_errors():
        show(diagnose_real(recordings.resolve(), out.resolve(), tools))


if __name__ == "__main__":
    typer.run(main)
