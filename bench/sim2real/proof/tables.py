"""The scores as tables: by way of hiding, by effect, by robot, and of the decoys."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from bench.common.intervals import share
from bench.common.markdown import markdown_table
from bench.sim2real.concealed.catalogue import EFFECTS, WAYS
from bench.sim2real.proof.reach import chosen, median, reach_table

SCORES = ["named first [95 %]", "named or equivalent", "placed", "window told", "extra findings"]
FIGURES = [
    "within 95 % interval",
    "error",
    "after / true model",
    "after / floor",
    "motion error before [mrad]",
    "after",
    "seconds",
]


def all_tables(studies: pd.DataFrame, notes: Sequence[str]) -> str:
    """Everything that tables.md has below its head."""
    parts = [
        "## Asked and measured\n\n" + reach_table(studies),
        "## By way of hiding\n\n" + way_table(studies),
        "## By effect\n\nAll ways but poor.\n\n" + effect_table(studies),
        "## By robot\n\nAll ways but poor.\n\n" + robot_table(studies),
        "## Poor excitation: the right answer is that it cannot be told\n\n" + poor_table(studies),
        "## Nothing wrong\n\n" + clean_table(studies),
        "## Decoys\n\n" + decoy_table(studies),
    ]
    return "\n".join(parts) + "".join(f"\n{note}\n" for note in notes)


def way_table(studies: pd.DataFrame) -> str:
    """One row per way of hiding."""
    hidden = chosen(studies, "effects")
    groups = {way: hidden[hidden.hide == way] for way in WAYS}
    groups |= {"all but poor": chosen(studies, "seen")}
    rows = [[way, len(some), *_row(some)] for way, some in groups.items() if len(some)]
    return markdown_table(["way", "studies", *SCORES, *FIGURES], rows)


def effect_table(studies: pd.DataFrame) -> str:
    """One row per effect of the catalogue; counts, since studies are few."""
    seen = chosen(studies, "seen")
    rows = []
    for effect in EFFECTS:
        some = seen[seen.effect == effect]
        if len(some):
            counts = [str(int(some[name].sum())) for name in ("named", "listed", "placed")]
            rows.append([effect, len(some), *counts, *_row(some)[3:]])
    return markdown_table(
        ["effect", "studies", "named first", *SCORES[1:], *FIGURES],
        rows,
    )


def robot_table(studies: pd.DataFrame) -> str:
    """One row per arm."""
    seen = chosen(studies, "seen")
    rows = [[robot, len(some), *_row(some)] for robot, some in seen.groupby("robot", sort=True)]
    return markdown_table(["robot", "studies", *SCORES, *FIGURES], rows)


def poor_table(studies: pd.DataFrame) -> str:
    """How studies with poor motion were answered."""
    hidden = chosen(studies, "effects")
    poor = hidden[hidden.hide == "poor"]
    rows = []
    for effect, some in [*poor.groupby("effect", sort=False), ("all", poor)]:
        counts = [int((some.answer == kind).sum()) for kind in ("named", "not judged", "wrong")]
        rows.append([effect, len(some), share(some.right), *counts])
    header = ["effect", "studies", "right [95 %]", "named or listed", "said not judged", "wrong"]
    return markdown_table(header, rows)


def clean_table(studies: pd.DataFrame) -> str:
    """False alarms by the way in which nothing was hidden."""
    clean = studies[studies.group == "clean"]
    rows = []
    for way, some in [*clean.groupby("hide", sort=False), ("all", clean)]:
        findings = int(some.extra.sum())
        told = int((some.verdict == "cannot_tell").sum())
        rows.append([way, len(some), int(some.alarm.sum()), share(some.alarm), findings, told])
    header = ["way", "studies", "false alarms", "share [95 %]", "findings", "said cannot tell"]
    return markdown_table(header, rows)


def decoy_table(studies: pd.DataFrame) -> str:
    """Right answers to physics outside the catalogue, lying channels and joints at rest."""
    rows = []
    for group in ("outside", "lying", "still"):
        some = studies[studies.group == group]
        kinds = list(some.groupby("effect", sort=True))
        for kind, each in [*kinds, (f"all {group}", some)] if len(kinds) > 1 else kinds:
            beside = int((each.beside_unknown > 0).sum()) if group == "outside" else ""
            said = each.verdict.str.partition(":")[0].value_counts()
            words = ", ".join(f"{count} {verdict}" for verdict, count in said.items())
            rows.append([kind, len(each), int(each.right.sum()), share(each.right), beside, words])
    header = ["decoy", "studies", "right", "share [95 %]", "names claimed beside unknown"]
    return markdown_table([*header, "verdicts"], rows)


def _row(some: pd.DataFrame) -> list[str]:
    shares = [share(some[name]) for name in ("named", "listed", "placed")]
    hidden = some[some.window_hidden]
    told = f"{int(hidden.window_told.sum())} of {len(hidden)}" if len(hidden) else ""
    inside = np.repeat([True, False], [some.inside.sum(), (some.intervals - some.inside).sum()])
    error = some.error.median()
    return [
        *shares,
        told,
        str(int(some.extra.sum())),
        share(inside) if len(inside) else "",
        f"{100.0 * error:.2g} %" if np.isfinite(error) else "",
        _median(some.over_true),
        _median(some.left),
        _median(1e3 * some.replay_before, "{:.3g}"),
        _median(1e3 * some.replay_after, "{:.3g}"),
        _median(some.seconds, "{:.1f}"),
    ]


def _median(values: pd.Series[float], form: str = "{:.2f}") -> str:
    value, _, count = median(values)
    return form.format(value) if count else ""


def notes_of(studies: pd.DataFrame) -> list[str]:
    """What the tables do not say by themselves."""
    seen = chosen(studies, "seen")
    errors = studies[studies.verdict.str.startswith("error")]
    crashed = errors[~errors.verdict.str.contains("LoadError", regex=False)]
    return [
        *_of_true_models(seen),
        f"{len(errors)} studies were refused or ended in an error, {len(crashed)} of them without"
        " a question to the user (crash or timeout).",
    ]


def _of_true_models(seen: pd.DataFrame) -> list[str]:
    within = seen.over_true.dropna()
    if not len(within):
        return ["No study was held against its true model."]
    reasons = seen.why_not[seen.by_floor].value_counts()
    why = "; ".join(f"{count} times {reason}" for reason, count in reasons.items() if reason)
    return [
        f"No true model could be refitted in {int(seen.by_floor.sum())} of {len(seen)} studies: the"
        f" noise floor stands for it there{f' ({why})' if why else ''}.",
        "Held-out residual after is within 1.15 times the true model's in"
        f" {share(within <= 1.15)} of studies; 90 % of them are below {within.quantile(0.9):.2f}.",
    ]
