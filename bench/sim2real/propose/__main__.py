"""Does the proposed motion settle it? Poor logs of concealed machines, and one motion more.

    python -m bench.sim2real.propose --out build/bench/propose

Machines of ../concealed, moved so that a diagnosis ends in equivalents or in a confidence below
0.9, are given one motion of 20 s by `pdoik propose`, and besides it a random one within the same
limits. Each is run on the machine, its log added, and all diagnosed again. A study whose diagnosis
leaves nothing open is passed over. Results are kept as they come, and the same command goes on
where it was stopped. One process; needs the extras bench and sim2real.
"""

import json
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer

from bench.common import commands as cli
from bench.common.campaign import Campaign, Row
from bench.common.digests import code_digest
from bench.common.intervals import share
from bench.common.markdown import markdown_table
from bench.sim2real.concealed.score import last_link, name_of, placed
from bench.sim2real.concealed.spec import FIRST_PROOF_SEED, WorldSpec
from bench.sim2real.frame.motion import STEP, Motion
from bench.sim2real.frame.study_files import joint_names
from bench.sim2real.propose.worlds import WAYS, PoorWorld, Way, poor_world
from pdoik.sim2real import CATALOGUE, Diagnosis, examine, model_of
from pdoik.sim2real.effects import Effect
from pdoik.sim2real.propose import NothingToSettleError, Proposal, Wishes, open_findings, propose
from pdoik.sim2real.propose import said as in_words

SECONDS = 20.0
SURE = 0.9
MEASURES = ("strict", "hopeful", "lenient")
EFFECTS = (
    *("coulomb_friction", "presliding_hysteresis", "payload", "asymmetric_friction"),
    *("torque_gain", "torque_offset", "rotor_inertia", "load_dependent_friction"),
    *("gravity_direction", "position_dependent_spring", "joint_elasticity"),
    *("stribeck_friction", "backlash", "viscous_friction", "link_inertial_error"),
    *("joint_offset", "torque_ripple", "joint_coupling"),
)
"""What a motion alone may settle: no event, no channel, nothing that needs tip poses."""
ROBOTS = ("random2", "random3", "random2")


def main(
    out: cli.OutFolder = cli.BUILD / "propose",
    quick: cli.Quick = False,
    wanted: Annotated[int, typer.Option(min=1, help="Studies that leave something open.")] = 60,
    effort: Annotated[int, typer.Option(min=1, help="Motions that each search looks at.")] = 60,
    seed: cli.Seed = 8000,
    table: Annotated[bool, typer.Option("--table", help="Only of what is there so far.")] = False,
) -> None:
    """Diagnose, propose, run, diagnose again, count."""
    if table:
        cli.show(tables(pd.concat(map(pd.read_parquet, sorted((out / "parts").glob("*.parquet"))))))
        return
    if quick:
        wanted, out = 2, out.with_name(out.name + "-quick")
    if seed + 1000 > FIRST_PROOF_SEED:
        raise typer.BadParameter("is a proof's: these are for development", param_hint="--seed")
    settings = {
        "experiment": "propose",
        "code": code_digest("concealed"),
        "seed": seed,
        "effort": effort,
    }
    with cli.plain_errors():
        campaign = Campaign(out, settings)
        names: list[str] = []
        done = 0
        for spec, way in specs(seed):
            name = f"{spec.seed}-{spec.effect}-{way.replace(' ', '-')}"
            names.append(name)
            if not campaign.has(name):
                campaign.keep(name, [study_row(spec, way, effort)])
            row = campaign.gather([name]).iloc[0]
            done += bool(row.open)
            cli.console.print(f"{done} {name} {spec.robot}: {line(row)}", highlight=False)
            if done >= wanted:
                break
        rows = campaign.gather(names)
    cli.write_report(out / "tables.md", tables(rows))
    cli.show(tables(rows))


def specs(first: int) -> Iterator[tuple[WorldSpec, Way]]:
    """Effects, ways and robots in turn; a seed belongs to one study for good."""
    for k in range(1000):
        effect, turn = EFFECTS[k % len(EFFECTS)], k // len(EFFECTS)
        way, robot = WAYS[(k + turn) % len(WAYS)], ROBOTS[(k + turn) % len(ROBOTS)]
        hide = "noise" if k % 3 == 2 else "plain"
        yield WorldSpec(seed=first + k, effect=effect, robot=robot, hide=hide), way


def study_row(spec: WorldSpec, way: Way, effort: int) -> Row:
    row: Row = {**asdict(spec), "way": way, "size": 0.0, "open": False, "error": ""}
    row |= dict.fromkeys(("before", "expected", "hidden"), "[]") | {"hopeless": False}
    for kind in ("proposed", "random"):
        row |= {f"{kind}_{what}": False for what in ("strict", "hopeful", "lenient")}
        row |= {f"{kind}_said": "[]", f"{kind}_confidence": np.nan, f"{kind}_ratio": np.nan}
    begin = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="pdoik-propose-") as folder:
        try:
            row |= _followed(spec, way, effort, Path(folder))
        except Exception as error:  # a study the tool breaks on counts as not settled
            row["error"] = f"{type(error).__name__}: {error}"
    return row | {"seconds": time.perf_counter() - begin}


def _followed(spec: WorldSpec, way: Way, effort: int, folder: Path) -> Row:
    world = poor_world(spec, way)
    report = folder / "report"
    before = _diagnosed(world.write(folder / "before"), report)
    row: Row = {"before": said(before), "hidden": json.dumps([world.hidden, *world.beside])}
    row["open"] = bool(open_findings(before))
    if not row["open"]:
        return row
    hopeless: frozenset[str] = frozenset()  # as the proposal said beforehand
    for kind in ("proposed", "random"):
        random = kind == "random"
        wishes = Wishes(seconds=SECONDS, random=random, effort=effort, search=np.inf)
        try:
            proposal = propose(report, wishes)
        except NothingToSettleError as error:
            return row | {"open": False, "hopeless": True, "error": str(error)}
        study = world.write(folder / kind, run_of(proposal, world))
        after = _diagnosed(study, folder / f"report {kind}")
        hopeless = hopeless | {rival for _, rival in proposal.hopeless}
        row |= {
            f"{kind}_strict": settled(after, world, strict=True),
            f"{kind}_hopeful": settled(after, world, strict=True, but=hopeless),
            f"{kind}_lenient": settled(after, world, strict=False),
            f"{kind}_said": said(after),
            f"{kind}_confidence": proposal.confidence,
            f"{kind}_ratio": min(each.ratio for each in proposal.prospects),
        }
        if kind == "proposed":
            row["expected"] = json.dumps(json.loads(proposal.to_json())["expected"])
    return row


def run_of(proposal: Proposal, world: PoorWorld) -> Motion:
    """The motion on the grid of the machine's commands, in the order of its joints."""
    order = [proposal.joints.index(name) for name in joint_names(world.draft.arm)]
    times = np.arange(0.0, proposal.time[-1] + 0.5 * STEP, STEP)
    return Motion.of(proposal.at(times)[:, order])


def _diagnosed(study: Path, report: Path) -> Diagnosis:
    examination = examine(study)
    report.mkdir()
    (report / "diagnosis.json").write_text(examination.diagnosis.to_json())
    model_of(examination).save(report)
    return examination.diagnosis


def settled(
    diagnosis: Diagnosis, world: PoorWorld, *, strict: bool, but: frozenset[str] = frozenset()
) -> bool:
    """Whether the true cause is named at its place with confidence, and no alternative is listed.

    A payload in the hand and an error of the hand's link count as one, for they are one body.
    Leniently other names may still be listed as alternatives; or those of `but`, in words, may.
    """
    hidden = world.hidden
    last = last_link(joint_names(world.draft.arm))
    for finding in diagnosis.findings:
        entry = as_entry(finding)
        others = [
            each
            for each in finding.equivalents
            if not _same(as_entry(each), hidden, last)
            and in_words(_one_body(each.effect), each.joints, each.links) not in but
        ]
        right = _same(entry, hidden, last) and finding.confidence >= SURE
        if right and not (strict and others):
            return True
    return False


def _one_body(effect: str) -> Effect:
    """A payload and an error of the link that holds it are one body."""
    found = CATALOGUE[effect]
    return CATALOGUE["link_inertial_error"] if found.is_body else found


def as_entry(finding: Any) -> dict[str, Any]:
    """A finding or an equivalent as a truth has it."""
    return {
        "effect": finding.effect,
        "joints": list(finding.joints),
        "links": list(finding.links),
        "recordings": None,
        "window": None,
    }


def _same(entry: dict[str, Any], hidden: dict[str, Any], last: str) -> bool:
    return name_of(entry, last) == name_of(hidden, last) and placed(entry, hidden)


def said(diagnosis: Diagnosis) -> str:
    """Findings with the alternatives listed for them, as JSON."""
    return json.dumps(
        [
            [
                each.effect,
                [*each.joints, *each.links],
                round(each.confidence, 3),
                [[other.effect, [*other.joints, *other.links]] for other in each.equivalents],
            ]
            for each in (*diagnosis.findings, *diagnosis.suspected)
        ]
    )


def line(row: Any) -> str:
    if not row.open:
        return f"nothing open ({row.seconds:.0f} s) {row.error}"
    marks = ", ".join(
        f"{kind} {'settled' if row[f'{kind}_strict'] else 'open'}"
        f"{' but for the hopeless' * bool(row[f'{kind}_hopeful'] and not row[f'{kind}_strict'])}"
        f"{' (leniently settled)' * bool(row[f'{kind}_lenient'] and not row[f'{kind}_hopeful'])}"
        for kind in ("proposed", "random")
    )
    return f"{marks} ({row.seconds:.0f} s) {row.error}"


def tables(rows: pd.DataFrame) -> str:
    """Shares, by way and by effect, then what was not settled."""
    some = rows[rows.open]
    head = ["", "studies"]
    head += [f"{kind}, {what}" for what in MEASURES for kind in ("proposed", "random")]
    head += ["expected confidence, median"]

    def figures(name: str, part: pd.DataFrame) -> list[Any]:
        shares = [
            share(part[f"{kind}_{what}"].astype(bool))
            for what in MEASURES
            for kind in ("proposed", "random")
        ]
        return [name, len(part), *shares, f"{part.proposed_confidence.median():.2f}"]

    lines = [figures("all", some)]
    sure = some.proposed_confidence >= SURE
    lines += [figures("expected 0.9 or more", some[sure]), figures("less", some[~sure])]
    lines += [figures(way, part) for way, part in some.groupby("way", sort=False)]
    lines += [figures(effect, part) for effect, part in some.groupby("effect", sort=False)]
    said_so = int(rows.hopeless.sum())
    passed = f"{len(rows)} studies made: {len(rows) - len(some) - said_so} left nothing open, of"
    passed += f" {said_so} it was said that no motion tells what is open.\n"
    return f"{passed}\n{markdown_table(head, lines)}\n{failures(some)}"


def failures(some: pd.DataFrame) -> str:
    """What was hidden, said before and said after, where the proposed motion settled nothing."""
    text = ["Not settled by the proposed motion:\n"]
    for row in some[~some.proposed_strict.astype(bool)].itertuples():
        text.append(f"{row.seed} {row.effect} {row.way} {row.robot} {row.error}")
        text += [f"    hidden {row.hidden}", f"    before {row.before}"]
        text += [f"    after {row.proposed_said}", f"    random {row.random_said}"]
    return "\n".join(text) + "\n"


if __name__ == "__main__":
    typer.run(main)
