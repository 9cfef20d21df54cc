"""A page per class of failure: what was hidden, what was said instead, study by study."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pandas as pd

from bench.common.markdown import markdown_table

Entry = dict[str, Any]


def failed(studies: pd.DataFrame) -> pd.DataFrame:
    """Studies with a wrong answer, or with a finding too many, and a column with their class."""
    extra = (studies.group == "effect") & (studies.extra > 0)
    some = studies[~studies.right | extra].copy()
    some["failure"] = [class_of(row) for row in some.itertuples()]
    return some


def class_of(row: Any) -> str:
    """What was hidden, and in what way the answer was wrong."""
    if row.right:
        return f"{row.effect}: a finding too many"
    if row.group == "effect" and row.named:
        return f"{row.effect}: in the wrong place"
    if row.group == "effect" and row.listed:
        return f"{row.effect}: listed, not first"
    return f"{row.effect}: said {row.first.replace('_', ' ')}"


def write_pages(studies: pd.DataFrame, folder: Path) -> int:
    """README.md with counts and one page per class, most frequent first; the number of failures."""
    making = folder.with_name(f".{folder.name}")
    shutil.rmtree(making, ignore_errors=True)
    making.mkdir(parents=True)
    some = failed(studies)
    frequent = some.failure.value_counts()
    rows = []
    for name, count in sorted(frequent.items(), key=lambda each: (-each[1], each[0])):
        each = some[some.failure == name]
        page = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-") + ".md"
        parts = [f"# {name}\n\nStudies: {len(each)}.\n"]
        parts += [study_of(row) for row in each.sort_values(["hide", "seed"]).itertuples()]
        (making / page).write_text("\n".join(parts))
        ways = each.hide.value_counts()
        by_way = ", ".join(f"{way} {number}" for way, number in ways.items())
        rows.append([f"[{name}]({page})", count, by_way])
    index = f"# Failures\n\n{len(some)} of {len(studies)} studies.\n\n"
    index += markdown_table(["class", "studies", "by way"], rows) if rows else ""
    (making / "README.md").write_text(index)
    shutil.rmtree(folder, ignore_errors=True)
    making.rename(folder)
    return len(some)


def study_of(row: Any) -> str:
    """One study: spec, truth, findings, notes and residuals."""
    lines = [
        f"## {row.name}: {row.effect}, {row.hide}, {row.robot}, seed {row.seed}",
        "",
        f"{row.size:.1f} times the noise{f', corner {row.corner}' if row.corner else ''}."
        f" Verdict: {row.verdict}.",
        "",
        "```",
    ]
    lines += [f"hidden  {truth_in_words(each)}" for each in json.loads(row.hidden)]
    lines += [f"found   {finding_in_words(each)}" for each in json.loads(row.findings)]
    for joint, fit in json.loads(row.joints).items():
        figures = " ".join(f"{fit[key]:.3g}" for key in ("before", "after", "noise_floor"))
        judged = "" if fit["excited"] else " (not judged)"
        lines.append(f"{joint}  before, after, floor: {figures} {fit['unit']}{judged}")
    lines.append("```")
    lines += [f"- {note}" for note in json.loads(row.notes)]
    return "\n".join(lines) + "\n"


def truth_in_words(entry: Entry) -> str:
    """Name, place, parameters and window of what was hidden."""
    parts = [entry["effect"], *entry["joints"][:7], *entry["links"]]
    parts += [f"{name}={value:.4g}" for name, value in entry["parameters"].items()]
    optional = ("kind", "channel", "recordings", "window", "position_window")
    parts += [f"{key} {entry[key]}" for key in optional if entry.get(key)]
    return " ".join(parts) + (f" ({entry['role']})" if entry["role"] != "hidden" else "")


def finding_in_words(finding: Entry) -> str:
    """The same of what was found, with errors, gain and equivalents."""
    parts = [finding["effect"], *finding["joints"], *finding["links"]]
    for name, each in finding["parameters"].items():
        parts.append(f"{name}={each['value']:.4g}+-{each['std']:.1g}")
    optional = ("variant", "window", "positions")
    parts += [f"{key} {finding[key]}" for key in optional if finding.get(key)]
    low, high = finding["evidence"]["interval95"]
    parts.append(f"gain {finding['evidence']['validation_gain']:.3f} [{low:.3f}, {high:.3f}]")
    others = ", ".join(each["effect"] for each in finding["equivalents"])
    return " ".join(parts) + (f" or {others}" if others else "")
