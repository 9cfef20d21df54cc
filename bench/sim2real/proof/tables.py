"""The scores as tables: by way of hiding, by effect, by robot, and of the decoys."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
import pandas as pd

from bench.common.intervals import share
from bench.common.markdown import markdown_table, table_of
from bench.sim2real.concealed.catalogue import EFFECTS, WAYS
from bench.sim2real.proof.reach import chosen, median, reach_table

Column = Callable[[pd.DataFrame], object]


def _inside(some: pd.DataFrame) -> str:
    inside = np.repeat([True, False], [some.inside.sum(), (some.intervals - some.inside).sum()])
    return share(inside) if len(inside) else ""


def _told(some: pd.DataFrame) -> str:
    hidden = some[some.window_hidden]
    return f"{int(hidden.window_told.sum())} of {len(hidden)}" if len(hidden) else ""


def _error(some: pd.DataFrame) -> str:
    error = some.error.median()
    return f"{100.0 * error:.2g} %" if np.isfinite(error) else ""


def _median(values: pd.Series, form: str = "{:.2f}") -> str:
    value, _, count = median(values)
    return form.format(value) if count else ""


def _count(name: str) -> Column:
    return lambda some: str(int(some[name].sum()))


NAMED: dict[str, Column] = {
    "named first [95 %]": lambda some: share(some.named),
    "named or equivalent": lambda some: share(some.listed),
    "placed": lambda some: share(some.placed),
}
COUNTED: dict[str, Column] = {  # where studies are few
    "named first": _count("named"),
    "named or equivalent": _count("listed"),
    "placed": _count("placed"),
}
FIGURES: dict[str, Column] = {
    "window told": _told,
    "extra findings": _count("extra"),
    "within 95 % interval": _inside,
    "error": _error,
    "after / true model": lambda some: _median(some.over_true),
    "after / floor": lambda some: _median(some.left),
    "motion error before [mrad]": lambda some: _median(1e3 * some.replay_before, "{:.3g}"),
    "after": lambda some: _median(1e3 * some.replay_after, "{:.3g}"),
    "seconds": lambda some: _median(some.seconds, "{:.1f}"),
}
STUDIES: dict[str, Column] = {"studies": len}


def all_tables(studies: pd.DataFrame, notes: Sequence[str]) -> str:
    """Everything that tables.md has below its head."""
    hidden, seen = chosen(studies, "effects"), chosen(studies, "seen")
    ways = [(way, hidden[hidden.hide == way]) for way in WAYS]
    effects = [(effect, seen[seen.effect == effect]) for effect in EFFECTS]
    by_name, by_count = STUDIES | NAMED | FIGURES, STUDIES | COUNTED | FIGURES
    ways.append(("all but poor", seen))
    robots = list(seen.groupby("robot", sort=True))
    parts = {
        "Asked and measured": reach_table(studies),
        "By way of hiding": table_of("way", _there(ways), by_name),
        "By effect\n\nAll ways but poor.": table_of("effect", _there(effects), by_count),
        "By robot\n\nAll ways but poor.": table_of("robot", robots, by_name),
        "Poor excitation: the right answer is that it cannot be told": poor_table(hidden),
        "Nothing wrong": clean_table(studies[studies.group == "clean"]),
        "Decoys": decoy_table(studies),
    }
    text = "\n".join(f"## {title}\n\n{table}" for title, table in parts.items())
    return text + "".join(f"\n{note}\n" for note in notes)


def _there(groups: Iterable[tuple[str, pd.DataFrame]]) -> list[tuple[str, pd.DataFrame]]:
    return [(name, some) for name, some in groups if len(some)]


def poor_table(hidden: pd.DataFrame) -> str:
    """How studies with poor motion were answered."""
    poor = hidden[hidden.hide == "poor"]

    def answered(kind: str) -> Column:
        return lambda some: int((some.answer == kind).sum())

    columns = {
        "right [95 %]": lambda some: share(some.right),
        "named or listed": answered("named"),
        "said not judged": answered("not judged"),
        "wrong": answered("wrong"),
    }
    groups = [*poor.groupby("effect", sort=False), ("all", poor)]
    return table_of("effect", groups, STUDIES | columns)


def clean_table(clean: pd.DataFrame) -> str:
    """False alarms by the way in which nothing was hidden."""
    columns = {
        "false alarms": lambda some: int(some.alarm.sum()),
        "share [95 %]": lambda some: share(some.alarm),
        "findings": lambda some: int(some.extra.sum()),
        "said cannot tell": lambda some: int((some.verdict == "cannot_tell").sum()),
    }
    return table_of("way", [*clean.groupby("hide", sort=False), ("all", clean)], STUDIES | columns)


def decoy_table(studies: pd.DataFrame) -> str:
    """Right answers to physics outside the catalogue, lying channels and joints at rest."""
    rows = []
    for group in ("outside", "lying", "still"):
        some = studies[studies.group == group]
        kinds = list(some.groupby("effect", sort=True))
        for kind, each in [*kinds, (f"all {group}", some)] if len(kinds) > 1 else kinds:
            further = int((each.beside_unknown > 0).sum()) if group == "outside" else ""
            said = each.verdict.str.partition(":")[0].value_counts()
            words = ", ".join(f"{count} {verdict}" for verdict, count in said.items())
            rows.append([kind, len(each), int(each.right.sum()), share(each.right), further, words])
    header = ["decoy", "studies", "right", "share [95 %]", "names claimed beside unknown"]
    return markdown_table([*header, "verdicts"], rows)


def notes_of(studies: pd.DataFrame) -> list[str]:
    """What the tables do not say by themselves."""
    seen = chosen(studies, "seen")
    errors = studies[studies.verdict.str.startswith("error")]
    crashed = errors[~errors.verdict.str.contains("LoadError", regex=False)]
    last = (
        f"{len(errors)} studies were refused or ended in an error, {len(crashed)} of them without"
        " a question to the user (crash or timeout)."
    )
    within = seen.over_true.dropna()
    if not len(within):
        return ["No study was held against its true model.", last]
    reasons = seen.why_not[seen.by_floor].value_counts()
    why = "; ".join(f"{count} times {reason}" for reason, count in reasons.items() if reason)
    return [
        f"No true model could be refitted in {int(seen.by_floor.sum())} of {len(seen)} studies: the"
        f" noise floor stands for it there{f' ({why})' if why else ''}.",
        "Held-out residual after is within 1.15 times the true model's in"
        f" {share(within <= 1.15)} of studies; 90 % of them are below {within.quantile(0.9):.2f}.",
        last,
    ]
