"""Is what `pdoik study check` predicts so? Effects as large as that, smaller and larger, sought.

    python -m bench.sim2real.diagnosis.visible --out build/bench/visible

Machines of concealed, every joint of which rubs, are checked first, with nothing else wrong.
Then each effect is put into one joint, at half, once, twice and four times its smallest size as the
check says it, and the recordings are diagnosed. Results are kept as they come, and the same command
goes on where it was stopped. One process; needs the extras bench and sim2real.
"""

import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import typer

from bench.common.campaign import Campaign, Row
from bench.common.commands import BUILD, OutFolder, Quick, console, plain_errors, show, write_report
from bench.common.digests import code_digest
from bench.common.intervals import share
from bench.common.markdown import markdown_table
from bench.sim2real.concealed.build import write_machine
from bench.sim2real.concealed.draft import Draft, draft_of
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.effects_body import GravityDirection, Payload
from bench.sim2real.concealed.effects_drive import Ripple, Spring, TorqueOffset
from bench.sim2real.concealed.effects_friction import Coulomb, Viscous
from bench.sim2real.concealed.effects_late import Delay
from bench.sim2real.concealed.effects_transmission import Backlash
from bench.sim2real.concealed.score import ONE_NAME
from bench.sim2real.concealed.spec import WorldSpec
from pdoik.sim2real import Finding, check_study, diagnose

TIMES = (0.5, 1.0, 2.0, 4.0)
RUBS = 0.02  # of the drive's effort: dry friction, and viscous at 1 rad/s, in every joint
HARMONIC = 24  # cycles per turn of a ripple, as the check has it


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """An effect at a joint of a machine."""

    robot: str
    seed: int
    effect: str
    joint: int  # or the link it moves; of the base any


_PLACES = {
    ("random3", 11): {
        "coulomb_friction": 1,
        "viscous_friction": 0,
        "torque_offset": 1,
        "torque_ripple": 2,
        "position_dependent_spring": 0,
        "payload": 2,
        "gravity_direction": 0,
        "command_delay": 1,
        "backlash": 1,
    },
    ("random4", 12): {
        "coulomb_friction": 2,
        "viscous_friction": 3,
        "torque_offset": 0,
        "torque_ripple": 1,
        "payload": 3,
        "command_delay": 2,
    },
}
CASES = tuple(
    Case(robot=robot, seed=seed, effect=effect, joint=joint)
    for (robot, seed), places in _PLACES.items()
    for effect, joint in places.items()
)


def main(out: OutFolder = BUILD / "visible", quick: Quick = False) -> None:
    """Check, conceal, diagnose, count."""
    cases = CASES[:2] if quick else CASES
    out = out.with_name(out.name + "-quick") if quick else out
    settings = {"experiment": "visible", "code": code_digest("concealed"), "times": TIMES}
    with plain_errors():
        campaign = Campaign(out, {**settings, "times": list(TIMES)})
        jobs = {f"{case.robot}-{case.effect}-{case.joint}": case for case in cases}
        table = tables(campaign.run_here(lambda case: list(_rows(case)), jobs, console))
    write_report(out / "tables.md", table)
    show(table)


def _rows(case: Case) -> Iterator[Row]:
    draft = draft_of(WorldSpec(seed=case.seed, robot=case.robot))
    smallest = predicted(case, draft)
    for times in TIMES:
        with tempfile.TemporaryDirectory(prefix="pdoik-visible-") as folder:
            hidden = _hidden(case, draft, times * smallest)
            write_machine(Path(folder), draft, (hidden, *_ordinary(case, draft)))
            begin = time.perf_counter()
            diagnosis = diagnose(Path(folder) / "study.yaml")
            seconds = time.perf_counter() - begin
        found = [each for each in diagnosis.findings if _is(each, case, draft.arm.n)]
        said = [f"{e.effect} {','.join(e.joints or e.links)}" for e in diagnosis.findings]
        yield {
            **asdict(case),
            "smallest": smallest,
            "times": times,
            "found": bool(found),
            "listed": bool(found)
            or any(_lists(each, case) for each in diagnosis.findings)
            or any(_is(each, case, draft.arm.n) for each in diagnosis.suspected),
            "said": "; ".join(said),
            "seconds": seconds,
        }


def predicted(case: Case, draft: Draft) -> float:
    """The smallest size by the check of the machine without the effect."""
    with tempfile.TemporaryDirectory(prefix="pdoik-visible-") as folder:
        write_machine(Path(folder), draft, _ordinary(case, draft))
        check = check_study(Path(folder) / "study.yaml")
    joint = "" if case.effect == "gravity_direction" else f"joint{case.joint + 1}"
    (said,) = [e for e in check.of(case.effect, joint) if e.variant in ("", "position")]
    if said.smallest is None:
        raise RuntimeError(f"{case}: {said.reason}")
    return said.smallest


def _ordinary(case: Case, draft: Draft) -> tuple[Effect, ...]:
    """Friction in all joints, but for the kind that is sought at its own."""
    effects: list[Effect] = []
    for j, joint in enumerate(draft.arm.joints):
        level = RUBS * joint.effort
        if (case.effect, case.joint) != ("coulomb_friction", j):
            effects.append(Coulomb(joint=j, size=level, native=True))
        if (case.effect, case.joint) != ("viscous_friction", j):
            effects.append(Viscous(joint=j, coefficient=level))
    return tuple(effects)


_MAKERS: dict[str, Callable[[int, float, Draft], Effect]] = {
    "coulomb_friction": lambda j, size, draft: Coulomb(joint=j, size=size, native=True),
    "viscous_friction": lambda j, size, draft: Viscous(joint=j, coefficient=size),
    "torque_offset": lambda j, size, draft: TorqueOffset(joint=j, size=size),
    "torque_ripple": lambda j, size, draft: Ripple(joint=j, size=size, harmonic=HARMONIC),
    "position_dependent_spring": lambda j, size, draft: Spring(
        joint=j, stiffness=size, side=0, onset=float(np.median(draft.ref.q[:, j]))
    ),
    "payload": lambda j, size, draft: Payload(mass=size, com=draft.arm.T_last_tip[:3, 3]),
    "gravity_direction": lambda j, size, draft: GravityDirection(
        tilt=size * np.sqrt(2.0), heading=np.pi / 4
    ),
    "command_delay": lambda j, size, draft: Delay(
        places=(j,), delay=size, kp=tuple(map(float, draft.control.kp))
    ),
    "backlash": lambda j, size, draft: Backlash(joint=j, gap=size),
}


def _hidden(case: Case, draft: Draft, size: float) -> Effect:
    return _MAKERS[case.effect](case.joint, size, draft)


def _is(finding: Finding, case: Case, n: int) -> bool:
    """Whether its name is the effect's, or one that counts as the same, at the place."""
    name = ONE_NAME.get(finding.effect, finding.effect)
    if case.effect == "gravity_direction":
        return name == case.effect
    here = f"joint{case.joint + 1}" in finding.joints or f"link{n}" in finding.links
    return name == ONE_NAME.get(case.effect, case.effect) and here


def _lists(finding: Finding, case: Case) -> bool:
    names = {each.effect for each in finding.equivalents}
    return case.effect in names and f"joint{case.joint + 1}" in finding.joints


def tables(rows: pd.DataFrame) -> str:
    found = [
        [f"{times:g}", *(share(part[what]) for what in ("found", "listed"))]
        for times, part in rows.groupby("times")
    ]
    head = ["times the smallest size", "found by name", "named among others, or suspected"]
    by_case = [
        [effect, robot, joint + 1, f"{part.smallest.iloc[0]:.3g}"]
        + ["yes" if each else "no" for each in part.sort_values("times").found]
        for (effect, robot, joint), part in rows.groupby(["effect", "robot", "joint"], sort=False)
    ]
    return f"{markdown_table(head, found)}\n" + markdown_table(
        ["effect", "machine", "joint", "smallest, SI", *(f"{t:g} times" for t in TIMES)], by_case
    )


if __name__ == "__main__":
    typer.run(main)
