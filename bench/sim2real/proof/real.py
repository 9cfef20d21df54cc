"""Recordings of real machines: what was found, what is left, what was not claimed."""

import json
import tempfile
from pathlib import Path
from typing import Any

from bench.common.blind import as_diagnosis, blind
from bench.common.commands import BUILD, console
from bench.common.digests import tool_digest
from bench.common.markdown import markdown_table
from bench.common.provenance import provenance
from bench.common.whole_files import write_text
from bench.sim2real.proof.real_studies import MACHINES, Machine, write_study

HEAD = """# On real machines

Nobody knows the whole truth here. Each model lacks some physics, by choice or because nobody knows
it; what was found is held against recordings, or parts of them, that nothing was fitted to, and
against what is known of the machine. These recordings were used while the tool was developed.
"""


def diagnose_real(recordings: Path, out: Path) -> None:
    """Writes real.md, and real/NAME.json for each machine whose recordings are there."""
    facts = {**provenance(BUILD), "digest of the tool": tool_digest()}
    parts = [HEAD, "".join(f"- {name}: {value}\n" for name, value in facts.items())]
    rows: list[list[str]] = []
    (out / "real").mkdir(parents=True, exist_ok=True)
    for machine in MACHINES:
        if not (recordings / machine.name).is_dir():
            parts.append(f"## {machine.title}\n\nSkipped: no recordings/{machine.name} there.\n")
            continue
        with console.status(machine.title):
            said = _said(machine, recordings, out / "real" / f"{machine.name}.json")
        rows += known_rows(machine, said)
        parts.append(section(machine, said))
    heads = ["machine", "known to be true", "said", "agrees"]
    parts.insert(2, "## What is known\n\n" + markdown_table(heads, rows))
    write_text(out / "real.md", "\n".join(parts))
    console.print(f"real machines: {out}/real.md")


def _said(machine: Machine, recordings: Path, kept: Path) -> dict[str, Any]:
    """The diagnosis; that of the same tool on the same study is kept."""
    with tempfile.TemporaryDirectory(prefix="pdoik-real-") as folder:
        study = Path(folder) / machine.name
        write_study(machine, recordings, study)
        key = tool_digest()
        if kept.is_file() and (old := json.loads(kept.read_text()))["tool"] == key:
            return dict(old)
        said = {"tool": key, **blind(study)}
    write_text(kept, json.dumps(said, indent=1) + "\n")
    return said


def known_rows(machine: Machine, said: dict[str, Any]) -> list[list[str]]:
    """What is known of a machine beside what was said of it."""
    diagnosis = as_diagnosis(said)
    said_of = {fact: said(diagnosis) for fact, said in machine.known.items()}
    return [
        [machine.name, fact, words, "yes" if agrees else "NO"]
        for fact, (words, agrees) in said_of.items()
    ]


def section(machine: Machine, said: dict[str, Any]) -> str:
    diagnosis = as_diagnosis(said)
    lines = [
        f"## {machine.title}",
        "",
        f"Withheld: {machine.withheld}",
        f"Doubtful: {machine.doubtful}",
        "",
        f"Verdict: {diagnosis['verdict']}, in {said['seconds']:.0f} s.",
        "",
        findings_table(diagnosis["findings"]),
        joints_table(diagnosis["joints"]),
    ]
    lines += [
        f"{each['recording']} replayed ({each['how']}): motion error"
        f" {1e3 * each['before']:.3g} mrad before, {1e3 * each['after']:.3g} mrad after."
        for each in said.get("replays", ())
    ]
    lines += ["", "Not claimed, assumed or doubted:", ""]
    lines += [f"- {note}" for note in (*diagnosis["notes"], *said.get("replay_notes", ()))]
    unknown = [each for each in diagnosis["findings"] if each["effect"] == "unknown"]
    if unknown:
        joints = ", ".join(name for each in unknown for name in each["joints"])
        lines.append(f"- No name for what is left of {joints}: `unknown` is all that is said.")
    lines += ["", f"Proved: {proved(diagnosis)}", ""]
    return "\n".join(lines)


def findings_table(findings: list[dict[str, Any]]) -> str:
    """Statements, figures with intervals, and what they are worth on held-out rows."""
    if not findings:
        return "Nothing was found.\n"
    rows = []
    for each in findings:
        figures = []
        named = each["effect"] != "unknown"  # the nodes of a nameless curve tell a reader nothing
        for name, estimate in each["parameters"].items() if named else ():
            low, high = estimate["interval95"]
            figures.append(
                f"{name} {estimate['value']:.4g} [{low:.4g}, {high:.4g}] {estimate['unit']}"
            )
        others = ", ".join(other["effect"] for other in each["equivalents"])
        gain = f"{each['evidence']['validation_gain']:.3f}"
        rows.append([each["statement"], "; ".join(figures), others, gain])
    return markdown_table(["found", "figures [95 %]", "or as well", "held-out gain"], rows)


def joints_table(joints: dict[str, dict[str, Any]]) -> str:
    """Residual of each joint on held-out rows."""
    rows = [
        [
            name,
            *(f"{each[key]:.3g}" for key in ("before", "after", "noise_floor")),
            f"{each['after'] / each['before']:.2f}" if each["before"] > 0.0 else "",
            each["unit"],
            "" if each["excited"] else "not judged",
        ]
        for name, each in joints.items()
    ]
    header = ["joint", "held-out residual before", "after", "noise floor", "after / before", "unit"]
    return markdown_table([*header, ""], rows)


def proved(diagnosis: dict[str, Any]) -> str:
    """What held-out rows bear out, and no more."""
    judged = {n: e for n, e in diagnosis["joints"].items() if e["excited"] and e["before"] > 0.0}
    better = [name for name, each in judged.items() if each["after"] < 0.9 * each["before"]]
    if not better:
        return (
            "nothing. No joint is predicted better by a tenth on rows that nothing was fitted to."
        )
    rest = [name for name in judged if name not in better]
    said = f"with what was found, {len(better)} of {len(judged)} joints are predicted better by a"
    said += " tenth or more on rows that nothing was fitted to"
    said += f"; not {', '.join(rest)}" if rest else ""
    return f"{said}. That the names are the true causes is not: nobody opened the machine."
