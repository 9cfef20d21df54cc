"""Small proof of `pdoik diagnose`: worlds with one thing hidden, diagnosed and scored.

    python -m bench.sim2real.diagnosis --out build/bench/diagnosis

Every effect of ../concealed/catalogue.py, in plain view and near the noise floor, and studies
with nothing wrong, on development seeds. Results are kept as they come, and the same command
continues where it was stopped. --quick is a two-minute version; --times measures seconds and
memory of long studies instead. Needs the extras bench and sim2real.
"""

import json
from collections.abc import Iterator
from dataclasses import asdict
from typing import Annotated

import numpy as np
import pandas as pd
import typer

from bench.common import commands as cli
from bench.common.digests import code_digest
from bench.common.intervals import share
from bench.common.markdown import markdown_table
from bench.common.whole_files import write_text
from bench.sim2real.concealed.catalogue import EFFECTS
from bench.sim2real.concealed.robots import NAMES
from bench.sim2real.concealed.spec import FIRST_PROOF_SEED, WorldSpec
from bench.sim2real.diagnosis.long_studies import times_table
from bench.sim2real.diagnosis.score import run_study

ROOM = 50  # seeds between two effects, half of them for each way of hiding
QUICK = (
    *("coulomb_friction", "viscous_friction", "payload", "torque_offset", "command_delay"),
    *("backlash",),
)


def main(
    out: cli.OutFolder = cli.BUILD / "diagnosis",
    quick: cli.Quick = False,
    plain: Annotated[int, typer.Option(min=0, max=ROOM // 2, help="In plain view, each.")] = 2,
    noise: Annotated[int, typer.Option(min=0, max=ROOM // 2, help="Near the noise, each.")] = 2,
    clean: Annotated[int, typer.Option(min=0, max=1000, help="With nothing wrong.")] = 20,
    times: Annotated[bool, typer.Option("--times", help="Seconds and memory instead.")] = False,
    seed: cli.Seed = 5000,
    scheduler: cli.Scheduler = None,
    workers: cli.Workers = 2,
) -> None:
    """Diagnose worlds with something concealed, and score it."""
    effects = QUICK if quick else tuple(EFFECTS)
    if quick:
        plain, noise, clean, out = 1, 0, 2, out.with_name(out.name + "-quick")
    if seed + ROOM * len(EFFECTS) + 1000 > FIRST_PROOF_SEED:
        raise typer.BadParameter("is a proof's: these are for development", param_hint="--seed")
    if times:
        table = times_table(seed)
        out.mkdir(parents=True, exist_ok=True)
        cli.write_report(out / "times.md", table)
        cli.show(table)
        return
    jobs = {
        f"{spec.seed}-{spec.effect}-{spec.hide}": {"spec": asdict(spec)}
        for spec in specs(seed, effects, {"plain": plain, "noise": noise}, clean)
    }
    with cli.plain_errors():
        settings = {"experiment": "diagnosis", "seed": seed, "code": code_digest("concealed")}
        studies = cli.run_campaign(out, settings, run_study, jobs, scheduler, workers)
    tables = f"{way_table(studies)}\n{effect_table(studies)}"
    cli.write_report(out / "tables.md", tables)
    write_text(out / "failures.md", "".join(map(failure, failed(studies).itertuples())))
    cli.show(tables)
    cli.console.print(f"tables: {out}/tables.md; failures: failures.md; studies: trials.parquet")


def specs(
    first: int, effects: tuple[str, ...], ways: dict[str, int], clean: int
) -> Iterator[WorldSpec]:
    """Of each effect by each way, then with nothing wrong; a seed belongs to one study for good."""
    for effect in effects:
        start = ROOM * list(EFFECTS).index(effect)
        for step, (way, count) in enumerate(ways.items()):
            for k in range(count):
                number = start + ROOM // 2 * step + k
                turn = 7 * list(EFFECTS).index(effect) + 3 * k + step
                robot = NAMES[turn % len(NAMES)]
                yield WorldSpec(seed=first + number, effect=effect, hide=way, robot=robot)
    for k in range(clean):
        yield WorldSpec(seed=first + ROOM * len(EFFECTS) + k, robot=NAMES[7 * k % len(NAMES)])


def way_table(studies: pd.DataFrame) -> str:
    """One row per way of hiding, with 95 % intervals."""
    header = ["way", "studies", "named first [95%]", "named or equivalent", "placed"]
    header += ["extra findings", "inside the 95 % interval", "error", "left / floor", "seconds"]
    hidden = studies[studies.effect != "clean"]
    groups = {way: hidden[hidden.hide == way] for way in dict.fromkeys(hidden.hide)}
    rows = []
    for way, some in {**groups, "both": hidden}.items():
        shares = [share(some[column]) for column in ("named", "listed", "placed")]
        inside = np.repeat([True, False], [some.inside.sum(), (some.intervals - some.inside).sum()])
        rows.append([way, len(some), *shares, int(some.extra.sum()), share(inside), *medians(some)])
    clean = studies[studies.effect == "clean"]
    alarms = f"Nothing wrong: {int((~clean.named).sum())} false alarms in {len(clean)} studies, "
    alarms += f"{share(~clean.named)}; {int(clean.extra.sum())} findings."
    return f"{markdown_table(header, rows)}\n{alarms}\n"


def effect_table(studies: pd.DataFrame) -> str:
    """One row per effect; shares by way of hiding."""
    ways = list(dict.fromkeys(studies.hide))
    header = ["effect", f"studies ({', '.join(ways)})", "named first", "named or equivalent"]
    header += ["placed", "extra findings", "inside the 95 % interval", "error", "left / floor"]
    rows = []
    for effect, some in studies.groupby("effect", sort=False):
        groups = [some[some.hide == way] for way in dict.fromkeys(some.hide)]
        counts = [
            ", ".join(str(int(group[column].sum())) for group in groups)
            for column in ("named", "listed", "placed", "extra")
        ]
        inside = f"{int(some.inside.sum())} of {int(some.intervals.sum())}"
        studied = ", ".join(str(len(group)) for group in groups)
        rows.append([effect, studied, *counts, inside, *medians(some)])
    return markdown_table([*header, "seconds"], rows)


def medians(some: pd.DataFrame) -> list[str]:
    """The main parameter's relative error, the residual left over the noise floor, seconds."""
    error = some.error.median()
    return [
        f"{100.0 * error:.2g} %" if np.isfinite(error) else "",
        f"{some.left.median():.2f}",
        f"{some.seconds.median():.1f}",
    ]


def failed(studies: pd.DataFrame) -> pd.DataFrame:
    """Studies with a wrong name or place first, or a finding too many."""
    return studies[~(studies.named & studies.placed) | (studies.extra > 0)]


def failure(study: tuple) -> str:
    """What was hidden and what was said."""
    lines = [f"{study.seed} {study.effect}, {study.hide}, {study.robot}, x{study.size:.1f}: "]
    lines[0] += study.verdict
    lines += [
        f"    hidden {each['effect']} {place(each)} {each['parameters']}"
        for each in json.loads(study.hidden)
    ]
    for each in json.loads(study.findings):
        values = {k: f"{e['value']:.3g}+-{e['std']:.1g}" for k, e in each["parameters"].items()}
        low, high = each["evidence"]["interval95"]
        gain = f"{each['evidence']['validation_gain']:.3f} [{low:.3f}, {high:.3f}]"
        others = [other["effect"] for other in each["equivalents"]]
        lines.append(f"    found {each['effect']} {place(each)} {values} gain {gain} or {others}")
    joints = json.loads(study.joints).items()
    lines.append("    " + ", ".join(f"{name} {residuals(each)}" for name, each in joints))
    return "\n".join(lines) + "\n"


def place(entry: dict) -> str:
    window = entry["window"]
    parts = [*entry["joints"], *entry["links"]]
    return " ".join(parts) + (f" {window} of {entry['recordings']}" if window else "")


def residuals(joint: dict) -> str:
    return " ".join(f"{joint[name]:.3g}" for name in ("before", "after", "noise_floor"))


if __name__ == "__main__":
    typer.run(main)
