"""Makes study folders and, next to them, their truths.

    python -m bench.sim2real.generate concealed --out DIR --seed 0 --count 20
    python -m bench.sim2real.generate concealed --out DIR --effect payload --robot panda
    python -m bench.sim2real.generate machines --out DIR --fault backlash --robot panda
    python -m bench.sim2real.generate legged --out DIR --kind payload --background plain --robot go2

DIR/studies/00000/ holds study.yaml, robot.urdf and recordings; DIR/truth/00000.json the answer.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.catalogue import EFFECTS, ways_of
from bench.sim2real.concealed.effects_outside import KINDS
from bench.sim2real.concealed.effects_sensor import LIES
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.robots import NAMES
from bench.sim2real.legged.build import make_study as make_legged
from bench.sim2real.legged.spec import BACKGROUNDS, HEALTHY, ROBOTS, draw
from bench.sim2real.legged.spec import KINDS as LEGGED
from bench.sim2real.machines import build
from bench.sim2real.machines.kinds import KINDS as FAULTS
from bench.sim2real.machines.plan import spec_of

DECOYS = (*(f"outside:{kind}" for kind in KINDS), *(f"lying:{kind}" for kind in LIES), "still")

Out = Annotated[Path, typer.Option(help="Folder of studies/ and truth/.")]
Seed = Annotated[int, typer.Option(min=0, help="The first.")]
Count = Annotated[int, typer.Option(min=1)]
Robots = StrEnum("Robots", {name: name for name in NAMES})
Robot = Annotated[Robots | None, typer.Option(help="Drawn without it.")]

Legged = StrEnum("Legged", {name: name for name in ROBOTS})
Backgrounds = StrEnum("Backgrounds", {name: name for name in BACKGROUNDS})
Kinds = StrEnum("Kinds", {name: name for name in (HEALTHY, *LEGGED)})

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
        truth = _made(out, f"{each:05d}", make_study, spec)
        if truth is not None:
            print(f"{what} {way} {arm} x{truth.size:.1f}", flush=True)


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
        truth = _made(out, f"{each:05d}", build.make_study, spec)
        if truth is not None:
            seen = " ".join(f"x{one['most']:.1f}" for one in truth["visibility"])
            names = ", ".join(faults) or "none"
            made = f"{spec.robot} {truth['gear']} {truth['controller']} {seen}"
            print(f"{names} {made}", flush=True)


@app.command()
def legged(
    out: Out,
    seed: Seed = 0,
    count: Count = 1,
    robot: Annotated[Legged | None, typer.Option(help="Drawn without it.")] = None,
    background: Annotated[Backgrounds | None, typer.Option(help="Drawn without it.")] = None,
    kind: Annotated[Kinds | None, typer.Option(help="Drawn without it.")] = None,
) -> None:
    """Robots with a floating base."""
    for each in range(seed, seed + count):
        spec = draw(each, robot, background, kind)
        world = _made(out, spec.name, make_legged, spec)
        if world is not None:
            print(f"{world.attempts} attempts", flush=True)


def _made(out: Path, name: str, make: Callable[..., Any], spec: Any) -> Any:
    """What a generator gives; None where no machine bears what is hidden."""
    begin = time.perf_counter()
    try:
        result = make(out / "studies" / name, spec, out / "truth")
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    except RuntimeError as error:
        print(f"{name}: {error}", flush=True)
        return None
    print(f"{name} {time.perf_counter() - begin:.1f} s", end=" ", flush=True)
    return result


if __name__ == "__main__":
    app()
