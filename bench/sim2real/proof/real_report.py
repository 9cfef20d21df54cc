"""What was said of real machines' recordings, as tables, by the tools that said it."""

from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from operator import add
from pathlib import Path
from typing import Any

from bench.common.markdown import markdown_table
from bench.sim2real.frame.score import as_diagnosis
from bench.sim2real.proof.real_counts import Tally, broken, tally
from bench.sim2real.proof.real_machine import Machine

Said = Mapping[str, Any]  # what one tool said of one machine
Saids = Mapping[str, Mapping[str, Said]]  # by the machine's name, by the tool's

HEAD = """# On real machines

Nobody knows the whole truth here. Each model lacks some physics, by choice or because nobody knows
it; what was found is held against recordings, or parts of them, that nothing was fitted to, and
against what is known of the machine. These recordings were used while the tool was developed.
"""
COUNTED: dict[str, Callable[[Tally], object]] = {
    "needed causes named": lambda each: each.needed,
    "wrong or needless names": lambda each: each.wrong,
    "figures in range": lambda each: each.figures,
    "held-out residuals in range": lambda each: each.residuals,
    "known facts that agree": lambda each: each.agree,
    "findings their interval contradicts": lambda each: each.contradicted,
    "joints worse held out": lambda each: each.worse,
    "crashed": lambda each: each.crashed,
}


def report(
    machines: Sequence[Machine], said: Saids, tools: Sequence[str], missing: Sequence[Machine] = ()
) -> str:
    """All tables, and a section for each machine and tool."""
    parts = [
        HEAD,
        "## Counted\n\n" + totals_table(machines, said, tools),
        "## By machine\n\n" + machines_table(machines, said, tools),
        "## What is known\n\n" + known_table(machines, said, tools),
        "## What must not be\n\n" + broken_table(machines, said, tools),
    ]
    parts += [section(each, said[each.name][tool], tool) for each in machines for tool in tools]
    for each in missing:
        where = each.recorded(Path("recordings"))
        parts.append(f"## {each.title}\n\nSkipped: no {where} there.\n")
    return "\n".join(parts)


def totals_table(machines: Sequence[Machine], said: Saids, tools: Sequence[str]) -> str:
    """What counts over all machines, by tool."""
    sums = [
        reduce(add, (counted(each, said[each.name][tool]) for each in machines), Tally())
        for tool in tools
    ]
    rows = [[words, *(count(each) for each in sums)] for words, count in COUNTED.items()]
    return markdown_table([f"over {len(machines)} machines", *map(_headed, tools)], rows)


def machines_table(machines: Sequence[Machine], said: Saids, tools: Sequence[str]) -> str:
    """What counts of each machine; of two tools, one after the other."""
    rows = []
    for machine in machines:
        by_tool = [said[machine.name][tool] for tool in tools]
        counts = [counted(machine, each) for each in by_tool]
        cells = [", ".join(str(count(each)) for each in counts) for count in COUNTED.values()]
        rows.append([machine.name, *cells, ", ".join(f"{e['seconds']:.0f}" for e in by_tool)])
    both = f" ({', '.join(tools)})" if len(tools) > 1 else ""
    return markdown_table(["machine" + both, *COUNTED, "seconds"], rows)


def known_table(machines: Sequence[Machine], said: Saids, tools: Sequence[str]) -> str:
    """Table of what is known of machines and what was said of it."""
    rows = []
    for machine in machines:
        outcomes = [machine.told(as_diagnosis(said[machine.name][tool])) for tool in tools]
        for fact in machine.known:
            cells = [cell for t in outcomes for cell in (t[fact].words, _yes(t[fact].agrees))]
            rows.append([machine.name, fact, *cells])
    heads = [cell for tool in tools for cell in (_headed(tool), "agrees")]
    return markdown_table(["machine", "known to be true", *heads], rows)


def broken_table(machines: Sequence[Machine], said: Saids, tools: Sequence[str]) -> str:
    """What must not be said of any machine, and was."""
    rows = [
        [machine.name, *([tool] if tool else []), *each]
        for tool in tools
        for machine in machines
        for each in broken(as_diagnosis(said[machine.name][tool]))
    ]
    heads = ["machine", *(["tool"] if any(tools) else []), "asked", "said"]
    return markdown_table(heads, rows or [["none", *[""] * (len(heads) - 1)]])


def counted(machine: Machine, said: Said) -> Tally:
    """What counts of one diagnosis."""
    diagnosis = as_diagnosis(said)
    return tally(machine.told(diagnosis).values(), diagnosis)


def section(machine: Machine, said: Said, tool: str = "") -> str:
    """One diagnosis of a machine: findings, residuals, notes, and what they prove."""
    diagnosis = as_diagnosis(said)
    lines = [
        f"## {machine.title}" + (f": {tool}" if tool else ""),
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
    """Says what held-out rows confirm, and no more."""
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


def _headed(tool: str) -> str:
    return tool or "said"


def _yes(agrees: bool) -> str:
    return "yes" if agrees else "NO"
