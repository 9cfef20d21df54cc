"""Command line: makes study folders and, beside them, their truths.

    python -m bench.sim2real.concealed.generate --out DIR --seed 0 --count 20
    python -m bench.sim2real.concealed.generate --out DIR --effect payload --robot panda

DIR/studies/00000/ holds study.yaml, robot.urdf and recordings; DIR/truth/00000.json the answer.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.catalogue import EFFECTS, WAYS, ways_of
from bench.sim2real.concealed.effects_outside import KINDS
from bench.sim2real.concealed.effects_sensor import LIES
from bench.sim2real.concealed.robots import NAMES
from bench.sim2real.concealed.spec import WorldSpec

DECOYS = (*(f"outside:{kind}" for kind in KINDS), *(f"lying:{kind}" for kind in LIES), "still")


def main(arguments: list[str] | None = None) -> int:
    """Runs the command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=1)
    parser.add_argument("--effect", help="an effect's id, clean, still, outside:KIND, lying:KIND")
    parser.add_argument("--hide", help=f"one of {', '.join(WAYS)}; else drawn")
    parser.add_argument("--robot", choices=NAMES)
    parser.add_argument("--size", type=float, help="multiple of the noise floor")
    options = parser.parse_args(arguments)
    for seed in range(options.seed, options.seed + options.count):
        spec = _spec(options, seed)
        begin = time.perf_counter()
        truth = make_study(options.out / "studies" / f"{seed:05d}", spec, options.out / "truth")
        took = time.perf_counter() - begin
        print(f"{seed:05d} {spec.effect} {spec.hide} {spec.robot} x{truth.size:.1f} {took:.1f} s")
        sys.stdout.flush()
    return 0


def _spec(options: argparse.Namespace, seed: int) -> WorldSpec:
    """What the command asks for; what it leaves open is drawn by the seed."""
    rng = np.random.default_rng([seed, 77])
    group = rng.choice(["effect", "clean", "decoy"], p=[0.75, 0.1, 0.15])
    names = {"effect": list(EFFECTS), "clean": ["clean"], "decoy": list(DECOYS)}[str(group)]
    effect = options.effect or str(rng.choice(names))
    ways = ways_of(effect) if effect in EFFECTS else ("plain",)
    hide = options.hide or str(rng.choice(ways))
    robot = options.robot or str(rng.choice(NAMES))
    return WorldSpec(seed=seed, effect=effect, hide=hide, robot=robot, size=options.size)


if __name__ == "__main__":
    sys.exit(main())
