"""A run of these worlds: what makes them and what scores them."""

from pathlib import Path
from typing import Any

from bench.sim2real.frame.sealed import Plan, Room, ToolsRun
from bench.sim2real.machines.build import make_study
from bench.sim2real.machines.plan import FIRST_PROOF_SEED, WorldSpec, spec_of
from bench.sim2real.machines.score import score
from bench.sim2real.machines.tables import all_tables, summary

HERE = Path(__file__).parent
SCORERS = ("score.py", "background.py", "tables.py")
LATER = (  # of worlds that are there
    *("stages.py", "__main__.py", "ablations.py", "variants.py", "regression.py", "worlds.py"),
    *("held_out.py", "replayed.py"),
)
ROOM = Room(
    schema="pdoik.machines.seal/1",
    make_study=make_study,
    spec=WorldSpec,
    generators=[path for path in HERE.glob("*.py") if path.name not in SCORERS + LATER],
    scorers=[HERE / name for name in SCORERS],
    score=score,
    tables=all_tables,
    summary=summary,
    record=HERE / "record.jsonl",
    first_proof_seed=FIRST_PROOF_SEED,
)


def run_of(out: Path, seed: int, count: int, **cluster: Any) -> ToolsRun:
    """A run on one row of seeds."""
    worlds = {f"world{k:04d}": spec_of(seed + k) for k in range(count)}
    return ToolsRun(out=out, plan=Plan(seed=seed, specs=worlds), room=__name__, **cluster)
