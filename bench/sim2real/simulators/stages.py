"""A run of pairs: what makes them and what scores them."""

from pathlib import Path

from bench.sim2real.frame.sealed import Room
from bench.sim2real.proof import run as proof
from bench.sim2real.simulators.scores import all_tables, score
from bench.sim2real.simulators.worlds import WorldSpec, make_study

HERE = Path(__file__).parent
ROOM = Room(
    schema="pdoik.simulators.seal/1",
    make_study=make_study,
    spec=WorldSpec,
    generators=[*proof.ROOM.generators, HERE / "worlds.py"],
    scorers=[HERE / "scores.py"],
    longest=1800.0,
    score=score,
    tables=all_tables,
)
