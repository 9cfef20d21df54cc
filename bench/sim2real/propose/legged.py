"""Does the proposed motion tell more of a robot whose base floats than what is moved without it?

    python -m bench.sim2real.propose.legged --out build/bench/propose-legged

Go2s of ../legged with four things wrong at once stood for a short while. Each is diagnosed, then
moved for some seconds more: as ../legged moves them, hanging or standing, and by
`pdoik propose --figures`. Then all is diagnosed again and scored.
"""

import json
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import pandas as pd
import typer

from bench.common import commands as cli
from bench.common.campaign import Campaign, Row
from bench.common.digests import code_digest
from bench.common.markdown import markdown_table
from bench.sim2real.frame.study_files import write_study
from bench.sim2real.legged import draw_joint
from bench.sim2real.legged.build import legs_of, study_of
from bench.sim2real.legged.draw_joint import Scene
from bench.sim2real.legged.machine import Hidden, Machine, as_given
from bench.sim2real.legged.postures import Path as Posture
from bench.sim2real.legged.postures import State, grid, hang, home, stand
from bench.sim2real.legged.robots import robot
from bench.sim2real.legged.run import Policy, simulate
from bench.sim2real.legged.score import CLAIMED, figures_of, is_right
from bench.sim2real.legged.sensors import measured, sensors, write_log
from bench.sim2real.legged.spec import Array, Spec
from bench.sim2real.legged.world import GRAVITY, build
from pdoik.sim2real import Diagnosis, Model, examine, load_study, model_of, prepare
from pdoik.sim2real.identify import recorded
from pdoik.sim2real.propose import NothingToSettleError, Proposal, Wishes, propose

KINDS = ("coulomb_friction", "viscous_friction", "rotor_inertia", "torque_offset", "torque_gain")
WRONG = 4  # of the joints
SHARE = 0.5  # of the sizes of ../legged
FIRST, SECONDS = 4.0, 8.0  # that it stood, and that it is moved once more [s]
HOLD = np.array([0.0, 0.0, 1.2, 1.0, 0.0, 0.0, 0.0])

Carried = Literal["hang", "stand"]
WAYS: tuple[tuple[str, Carried], ...] = (
    ("none", "stand"),
    ("own", "stand"),
    ("proposed", "stand"),
    ("own", "hang"),
    ("proposed", "hang"),
)
"""How a machine is moved once more, and how its base is carried."""


def main(
    out: cli.OutFolder = cli.BUILD / "propose-legged",
    quick: cli.Quick = False,
    count: Annotated[int, typer.Option(min=1, help="Machines.")] = 6,
    search: Annotated[float, typer.Option(help="Seconds that each search takes.")] = 40.0,
    seed: cli.Seed = 500,
    fit_only: Annotated[
        bool, typer.Option("--fit-only", help="Ordinary figures fitted to the logs, no diagnosis.")
    ] = False,
) -> None:
    """Diagnose, propose, run, diagnose again, score."""
    if quick:
        count, search, out = 1, 5.0, out.with_name(out.name + "-quick")
    settings = {"experiment": "propose legged", "code": code_digest("legged"), "search": search}
    settings["fit only"] = fit_only
    with cli.plain_errors():
        campaign, names = Campaign(out, settings), []
        for number in range(seed, seed + count):
            for way, base in WAYS:
                names.append(f"{number}-{way}-{base}")
                if not campaign.has(names[-1]):
                    campaign.keep(names[-1], [row_of(number, way, base, search, out, fit_only)])
                row = campaign.gather(names[-1:]).iloc[0]
                cli.console.print(
                    f"{names[-1]}: {row.right} of {WRONG} right, {row.false} false, figures off"
                    f" {row.off:.2f} ({row.seconds:.0f} s) {row.error}",
                    highlight=False,
                )
        text = tables(campaign.gather(names))
    cli.write_report(out / "tables.md", text)
    cli.show(text)


@dataclass(frozen=True, kw_only=True, eq=False)
class Wrong:
    """A machine with several things wrong, and how it is logged."""

    spec: Spec
    machine: Machine
    hidden: tuple[Hidden, ...]

    @classmethod
    def drawn(cls, seed: int) -> "Wrong":
        """Draws a seed's errors: kinds and joints vary, sizes are shares of those of ../legged."""
        spec = Spec(seed=seed)
        rng, given = spec.stream("wrong"), as_given(robot(spec.robot))
        machine, hidden = given, []
        kinds = rng.choice(KINDS, WRONG, replace=False)
        joints = rng.choice(given.robot.n, WRONG, replace=False)
        for kind, j in zip(kinds, joints, strict=True):
            scene = Scene(machine=machine, rng=rng, peaks=lambda: given.robot.load)
            figures, said = getattr(draw_joint, kind)(scene, int(j))
            usual = {name: float(getattr(given, name)[j]) for name in figures}
            for name, value in figures.items():
                machine = machine.at(name, int(j), usual[name] + SHARE * (value - usual[name]))
            hidden.append(_hidden(kind, given.robot.joints[j], said, machine, int(j)))
        return cls(spec=spec, machine=machine, hidden=tuple(hidden))

    def write(self, folder: Path, *more: tuple[Policy, Carried]) -> Path:
        """The study with two short logs of standing, and more; gives study.yaml."""
        folder.mkdir(parents=True)
        legs, spec, entries = legs_of(self.spec.robot), self.spec, []
        weight = GRAVITY * float(legs.model.body_mass.sum())
        sense = sensors(self.machine, weight, spec.stream("sensors"))
        first = [stand(legs, FIRST, spec.stream(f"first{k}")) for k in range(2)]
        runs: list[tuple[str, Policy, Carried, float]] = [
            ("fit", first[0], "stand", FIRST),
            ("validate", first[1], "stand", FIRST),
        ]
        runs += [("fit", policy, base, SECONDS) for policy, base in more]
        for k, (role, policy, base, seconds) in enumerate(runs):
            hold = HOLD if base == "hang" else None
            where = HOLD if hold is not None else home(self.machine.robot)[0]
            q = policy.command(0.0, _AT_REST)
            rows = simulate(build(self.machine, hold), policy, seconds, sense.rate, (where, q))
            held, noise = hold is not None, spec.stream(f"noise{k}")
            write_log(folder / f"rec{k}.csv", measured(rows, self.machine, sense, noise, held=held))
            held_entry = {"base": "held"} if held else {}
            entries.append({"file": f"rec{k}.csv", "role": role, **held_entry})
        robot = self.machine.robot
        write_study(folder, robot.urdf.read_text(), study_of(robot, entries))
        return folder / "study.yaml"


def _hidden(kind: str, joint: str, said: dict[str, float], machine: Machine, j: int) -> Hidden:
    """The truth in a finding's words, at the size that it has."""
    rotor = machine.robot.rotor[j]
    figures = {
        "coulomb_friction": lambda: {"level": machine.coulomb[j]},
        "viscous_friction": lambda: {"coefficient": machine.viscous[j]},
        "rotor_inertia": lambda: {"inertia": machine.rotor[j] - rotor},
        "torque_offset": lambda: {"offset": machine.sensor_offset[j]},
        "torque_gain": lambda: {"gain": machine.sensor_gain[j] / machine.drive_gain[j]},
    }[kind]()
    assert figures.keys() == said.keys()
    values = {name: float(value) for name, value in figures.items()}
    return Hidden(effect=kind, joints=(joint,), parameters=values)


_AT_REST = State(
    base=np.array([0.0, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0]),
    velocity=np.zeros(3),
    omega=np.zeros(3),
    q=np.zeros(12),
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Sent:
    """A proposal's rows as they are."""

    proposal: Proposal

    def command(self, t: float, state: State) -> Array:
        return np.asarray(self.proposal.at(np.array([min(t, self.proposal.time[-1])]))[0])


def policy_of(wrong: Wrong, way: str, base: Carried, proposal: Proposal | None) -> Policy:
    """Who moves a machine once more."""
    legs, rng = legs_of(wrong.spec.robot), wrong.spec.stream(f"{way}{base}")
    if way == "own":
        return hang(legs, HOLD, SECONDS, rng) if base == "hang" else stand(legs, SECONDS, rng)
    assert proposal is not None
    if base == "stand":
        return Sent(proposal=proposal)
    time_ = grid(SECONDS)  # drives that compensate gravity, as those of ../legged do
    q = proposal.at(time_)
    torques = np.empty_like(q)
    for k in range(len(q)):
        legs.put(HOLD, q[k])
        torques[k] = legs.gravity()
    return Posture(wrong.machine.robot, time_, q, torques)


def row_of(seed: int, way: str, base: Carried, search: float, out: Path, fit_only: bool) -> Row:
    """Row of one machine moved once more; the report of its first logs is kept for all ways."""
    wrong, begin = Wrong.drawn(seed), time.perf_counter()
    row: Row = {"seed": seed, "way": way, "base": base}
    first = out / f"machine {seed}"
    with tempfile.TemporaryDirectory(prefix="pdoik-propose-") as name:
        study, report = Path(name) / "study", Path(name) / "report"
        try:
            if way == "none":
                if not first.is_dir():
                    begun = wrong.write(first / "study")
                    (_unasked if fit_only else _diagnosed)(begun, first / "report")
                if fit_only:
                    return {**EMPTY, **row, "off": fitted(wrong, first / "study" / "study.yaml")}
                text = (first / "report" / "diagnosis.json").read_text()
                return {**EMPTY, **scored(wrong, Diagnosis.from_json(text)), **row}
            proposal = None
            if way == "proposed":
                wishes = Wishes(
                    seconds=SECONDS, base=base, figures=True, search=search, max_speed=15.0
                )
                proposal = propose(first / "report", wishes)
                row["expected"] = float(np.median([each.gain for each in proposal.figures]))
            policy = policy_of(wrong, way, base, proposal)
            made = wrong.write(study, (policy, base))
            if fit_only:
                row["off"] = fitted(wrong, made)
            else:
                row = scored(wrong, _diagnosed(made, report)) | row
        except (NothingToSettleError, ValueError, RuntimeError) as error:
            row["error"] = f"{type(error).__name__}: {error}"
    return {**EMPTY, **row, "seconds": time.perf_counter() - begin}


EMPTY: Row = {
    **{"way": "none", "base": "-", "right": 0, "false": 0, "off": 1.0, "error": ""},
    **{"said": "[]", "hidden": "[]", "expected": float("nan"), "seconds": 0.0},
}


def _unasked(study: Path, report: Path) -> Diagnosis:
    """A report in which nothing was looked for."""
    nothing = Diagnosis(verdict="cannot_tell", findings=(), joints={})
    report.mkdir()
    (report / "diagnosis.json").write_text(nothing.to_json())
    Model.of_study(load_study(study)).save(report)
    return nothing


def _diagnosed(study: Path, report: Path) -> Diagnosis:
    examination = examine(study)
    report.mkdir()
    (report / "diagnosis.json").write_text(examination.diagnosis.to_json())
    model_of(examination).save(report)
    return examination.diagnosis


def scored(wrong: Wrong, diagnosis: Diagnosis) -> Row:
    """Causes that are named at their place, others that are claimed, and how far figures are off.

    A cause's figure is off by as much as it is, as a share of it; one that is not named by all.
    """
    content = json.loads(diagnosis.to_json())
    claimed = [each for each in content["findings"] if each["confidence"] >= CLAIMED]
    hidden = [asdict(each) | {"joints": list(each.joints)} for each in wrong.hidden]
    named = [[f for f in claimed if is_right(f, each)] for each in hidden]
    off = [_off(found, each) for found, each in zip(named, hidden, strict=True)]
    right = [f for found in named for f in found]
    return {
        "right": sum(bool(found) for found in named),
        "false": sum(f not in right for f in claimed),
        "off": float(np.mean(off)),
        "said": json.dumps([[f["effect"], f["joints"], f["confidence"]] for f in claimed]),
        "hidden": json.dumps([[each["effect"], each["joints"]] for each in hidden]),
    }


def fitted(wrong: Wrong, study: Path) -> float:
    """How far figures of joints are off where ordinary physics alone is fitted to the logs.

    Of dry and viscous friction, rotor and zero of every joint, each as a share of what is usual.
    """
    read = load_study(study)
    fit = prepare(read).fit
    model, machine, off = recorded(fit, read.thresholds.priors.bodies), wrong.machine, []
    true = {
        "coulomb_friction": machine.coulomb,
        "viscous_friction": machine.viscous,
        "rotor_inertia": machine.rotor - machine.robot.rotor,
        "torque_offset": machine.sensor_offset,
    }
    usual = {
        "coulomb_friction": machine.robot.load,
        "viscous_friction": machine.robot.load / machine.robot.speed,
        "rotor_inertia": machine.robot.rotor,
        "torque_offset": machine.robot.load,
    }
    for each, span in model.placed:
        name, joints = each.term.effect, each.term.place.joints
        if each.ordinary and name in true:
            j = joints[0]
            off.append(abs(float(model.beta[span][0]) - true[name][j]) / usual[name][j])
    return float(np.mean(off))


def _off(found: list[dict[str, Any]], hidden: dict[str, Any]) -> float:
    if not found:
        return 1.0
    ((name, true),) = figures_of(hidden).items()
    nothing = 1.0 if name == "gain" else 0.0
    said = found[0]["parameters"][name]["value"]
    return float(min(abs(said - true) / abs(true - nothing), 1.0))


def tables(rows: pd.DataFrame) -> str:
    """Table by way and base."""
    head = ["moved once more", "machines", "causes right", "false", "figures off, mean"]
    lines = []
    for (base, way), some in rows.groupby(["base", "way"], sort=False):
        name = "not at all" if way == "none" else f"{base}: {way}"
        made = some[some.error == ""]
        right = f"{made.right.sum()} of {WRONG * len(made)}"
        lines.append([name, len(made), right, int(made.false.sum()), f"{made.off.mean():.3f}"])
    failed = "".join(
        f"\n{row.seed} {row.way} {row.base}: {row.error}"
        for row in rows[rows.error != ""].itertuples()
    )
    return f"{markdown_table(head, lines)}\n{failed}\n"


if __name__ == "__main__":
    typer.run(main)
