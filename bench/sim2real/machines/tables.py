"""The scores as tables: asked and measured, by kind, false names, confidence against truth."""

import json
from collections import Counter
from collections.abc import Sequence

import numpy as np
import pandas as pd

from bench.common.markdown import markdown_table, table_of
from bench.sim2real.frame.score import by_confidence
from bench.sim2real.machines.score import FEW

CLEAR = 6.0  # a clear fault moves its channel by so many times what is left without it
KEYS = ("named", "sized", "listed", "relative", "unknown", "suspected")


def faults_of(worlds: pd.DataFrame) -> pd.DataFrame:
    """A row per fault."""
    rows = [
        {"name": world.name, "group": world.group, "confused": world.alarm, **fault}
        for world in worlds.itertuples(index=False)
        for fault in json.loads(world.faults)
    ]
    return pd.DataFrame(rows)


def _asked(worlds: pd.DataFrame) -> list[tuple[str, str, float, float]]:
    """What is counted: name, what is asked, how many, of how many."""
    faults = faults_of(worlds)
    named = faults[faults.effect != "outside"] if len(faults) else faults
    outside = faults[faults.effect == "outside"] if len(faults) else faults
    none = worlds[worlds.group == "none"]
    rows: list[tuple[str, str, float, float]] = []
    if len(named):
        clear, listed = named[named.most >= CLEAR], named.listed > 0
        rows += [
            ("fault named or listed, at its place", "0.80", listed.sum(), len(named)),
            ("the same, a relative counted", "", (named.relative > 0).sum(), len(named)),
            ("the same by name, in its size", "", (named.sized > 0).sum(), len(named)),
            (f"among the first {FEW}", "", named.listed.between(1, FEW).sum(), len(named)),
            ("where it is clear", "0.90", (clear.listed > 0).sum(), len(clear)),
        ]
    rows += [
        ("precision of what is stated at 0.9", "0.92", worlds.sure_right.sum(), worlds.sure.sum()),
        ("the same in its size", "", worlds.sure_strict.sum(), worlds.sure.sum()),
        ("precision of all findings", "", worlds.right.sum(), worlds.findings.sum()),
        ("the same in its size", "", worlds.strict.sum(), worlds.findings.sum()),
        ("friction found, joints", "", worlds.rubbing.sum(), worlds.joints.sum()),
        ("its intervals hold", "0.90 to 0.98", worlds.covered.sum(), worlds.sized_joints.sum()),
        ("nothing on top, a false name", "at most 0.05", none.alarm.sum(), len(none)),
    ]
    if len(outside):
        alone = outside[(outside.unknown > 0) & (outside.others == 0)]
        rows += [
            ("unnamed cause, no false name beside", "0.70", len(alone), len(outside)),
            ("unnamed cause recognised", "", (outside.unknown > 0).sum(), len(outside)),
        ]
    return [*rows, ("crashes, refusals", "0", worlds.crash.sum(), len(worlds))]


def asked_table(worlds: pd.DataFrame) -> str:
    """What is asked of the second generation, and how it came out."""
    rows = [
        [what, asked, f"{part / whole:.2f} ({part:.0f} of {whole:.0f})" if whole else "none"]
        for what, asked, part, whole in _asked(worlds)
    ]
    rows += [
        ["friction's size off by, median", "", f"{worlds.friction_error.median():.3f}"],
        ["seconds, median", "", f"{worlds.seconds.median():.1f}"],
        ["seconds, worst", "60", f"{worlds.seconds.max():.1f}"],
        ["memory, worst [GiB]", "2", f"{worlds.peak_gib.max():.2f}"],
    ]
    return markdown_table(["what", "asked", "measured"], rows)


def summary(worlds: pd.DataFrame) -> dict[str, list[float]]:
    """For the record: how many of how many."""
    return {what: [float(part), float(whole)] for what, _, part, whole in _asked(worlds)}


def all_tables(worlds: pd.DataFrame, not_made: Sequence[str] = ()) -> str:
    """Everything: asked and measured, by kind, false names, confidence against truth."""
    faults = faults_of(worlds)
    by_kind = {"faults": len, "moves, median": lambda some: f"{some.most.median():.1f}"} | {
        key: lambda some, key=key: int((some[key] > 0).sum()) for key in KEYS
    }
    kinds = faults.groupby("kind", sort=True) if len(faults) else ()
    false = [each for world in worlds.false for each in json.loads(world)]
    counts = Counter(effect for effect, _, _ in false)
    sure = Counter(effect for effect, _, confidence in false if confidence >= 0.9)
    names = [[effect, count, sure[effect]] for effect, count in counts.most_common()]
    parts = {
        "Asked and measured": asked_table(worlds),
        "By kind": table_of("kind", kinds, by_kind),
        "False names": markdown_table(["false name", "findings", "of these at 0.9 or more"], names),
        "Confidence": confidence_table(worlds),
    }
    text = "\n".join(f"## {title}\n\n{table}" for title, table in parts.items())
    return text + (f"\nNot made: {', '.join(not_made)}.\n" if not_made else "")


def confidence_table(worlds: pd.DataFrame) -> str:
    """Stated confidence against truth."""
    pairs = np.array([row for world in worlds.confidences for row in json.loads(world)], float)
    rows = [
        [name, inside.sum(), *(f"{mean:.3f}" for mean in pairs[inside].mean(axis=0))]
        for name, inside in by_confidence(pairs[:, 0], (0.75, 0.85, 0.9, 0.95, 0.98, 1.01))
    ]
    return markdown_table(["stated", "findings", "mean", "true", "in its size"], rows)
