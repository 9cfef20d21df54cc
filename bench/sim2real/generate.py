"""Makes study folders and, beside them, their truths.

    python -m bench.sim2real.generate concealed --out DIR --seed 0 --count 20
    python -m bench.sim2real.generate concealed --out DIR --effect payload --robot panda
    python -m bench.sim2real.generate machines --out DIR --fault backlash --robot panda

DIR/studies/00000/ holds study.yaml, robot.urdf and recordings; DIR/truth/00000.json the answer.
"""

import time
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.catalogue import EFFECTS, ways_of
from bench.sim2real.concealed.effects_outside import KINDS
from bench.sim2real.concealed.effects_sensor import LIES
from bench.sim2real.concealed.robots import NAMES
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.machines import build
from bench.sim2real.machines.kinds import KINDS as FAULTS
from bench.sim2real.machines.plan import spec_of

DECOYS = (*(f"outside:{kind}" for kind in KINDS), *(f"lying:{kind}" for kind in LIES), "still")

Out = Annotated[Path, typer.Option(help="Folder of studies/ and truth/.")]
Seed = Annotated[int, typer.Option(min=0, help="The first.")]
Count = Annotated[int, typer.Option(min=1)]
Robots = StrEnum("Robots", {name: name for name in NAMES})
Robot = Annotated[Robots | None, typer.Option(help="Drawn without it.")]

app = typer.Typer(add_completion=False, no_args_is_help=True, help=__doc__)


@app.command()
def concealed(
    out: Out,
    seed: Seed = 0,
    count: Count = 1,
    effect: Annotated[str, typer.Option(help="Id, clean, still, outside:KIND, lying:KIND.")] = "",
    hide: Annotated[str, typer.Option(help="Way of hiding; else drawn.")] = "",
    robot: Robot = None,
    size: Annotated[float | None, typer.Option(help="Multiple of the noise floor.")] = None,
) -> None:
    """Machines that are their models but for what is hidden; what is left open the seed draws."""
    for each in range(seed, seed + count):
        rng = np.random.default_rng([each, 77])
        group = str(rng.choice(["effect", "clean", "decoy"], p=[0.75, 0.1, 0.15]))
        names = {"effect": list(EFFECTS), "clean": ["clean"], "decoy": list(DECOYS)}[group]
        what = effect or str(rng.choice(names))
        way = hide or str(rng.choice(ways_of(what) if what in EFFECTS else ("plain",)))
        arm = robot or str(rng.choice(NAMES))
        spec = WorldSpec(seed=each, effect=what, hide=way, robot=arm, size=size)
        begin = time.perf_counter()
        try:
            truth = make_study(out / "studies" / f"{each:05d}", spec, out / "truth")
        except ValueError as error:
            raise typer.BadParameter(str(error)) from None
        took = time.perf_counter() - begin
        print(f"{each:05d} {what} {way} {arm} x{truth.size:.1f} {took:.1f} s", flush=True)


@app.command()
def machines(
    out: Out,
    seed: Seed = 0,
    count: Count = 1,
    fault: Annotated[str, typer.Option(help="A kind, or none; else drawn.")] = "",
    robot: Robot = None,
) -> None:
    """Machines as they stand in workshops, with a fault on top or none."""
    for each in range(seed, seed + count):
        spec = spec_of(each)
        if fault not in ("", "none", *FAULTS):
            raise typer.BadParameter(f"fault is {fault!r}, expected one of {', '.join(FAULTS)}")
        faults = {"": spec.faults, "none": ()}.get(fault, (fault,))
        spec = replace(spec, faults=faults, robot=robot or spec.robot)
        begin, names = time.perf_counter(), ", ".join(faults) or "none"
        try:
            truth = build.make_study(out / "studies" / f"{each:05d}", spec, out / "truth")
        except RuntimeError as error:
            print(f"{each:05d} {names} {spec.robot}: {error}", flush=True)
            continue
        seen = " ".join(f"x{one['most']:.1f}" for one in truth["visibility"])
        made = f"{spec.robot} {truth['gear']} {truth['controller']} {seen}"
        print(f"{each:05d} {names} {made} {time.perf_counter() - begin:.1f} s", flush=True)


if __name__ == "__main__":
    app()
