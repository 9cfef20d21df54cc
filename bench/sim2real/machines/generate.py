"""Command line: makes study folders and, beside them, their truths.

    python -m bench.sim2real.machines.generate --out DIR --seed 0 --count 20
    python -m bench.sim2real.machines.generate --out DIR --fault backlash --robot panda

DIR/studies/00000/ holds study.yaml, robot.urdf and recordings; DIR/truth/00000.json the answer.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from bench.sim2real.machines.build import make_study
from bench.sim2real.machines.plan import ROBOTS, spec_of
from bench.sim2real.machines.spec import WorldSpec


def main(arguments: list[str] | None = None) -> int:
    """Runs the command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=1)
    parser.add_argument("--fault", help="a kind, or none; else drawn")
    parser.add_argument("--robot", choices=ROBOTS)
    options = parser.parse_args(arguments)
    for seed in range(options.seed, options.seed + options.count):
        spec = spec_of(seed)
        if options.fault or options.robot:
            kinds = spec.faults if not options.fault else (options.fault,)
            faults = () if kinds == ("none",) else kinds
            spec = WorldSpec(seed=seed, faults=faults, robot=options.robot or spec.robot)
        begin = time.perf_counter()
        try:
            truth = make_study(options.out / "studies" / f"{seed:05d}", spec, options.out / "truth")
        except RuntimeError as error:
            print(f"{seed:05d} {', '.join(spec.faults)} {spec.robot}: {error}", flush=True)
            continue
        seen = " ".join(f"x{each['most']:.1f}" for each in truth["visibility"])
        took = time.perf_counter() - begin
        names = ", ".join(spec.faults) or "none"
        machine = f"{spec.robot} {truth['gear']} {truth['controller']}"
        print(f"{seed:05d} {names} {machine} {seen} {took:.1f} s")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
