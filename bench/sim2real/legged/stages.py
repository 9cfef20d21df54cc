"""A run of these worlds: what makes them and what scores them."""

from pathlib import Path

from bench.sim2real.frame.sealed import Room
from bench.sim2real.legged.build import make_study
from bench.sim2real.legged.score import all_tables, score
from bench.sim2real.legged.spec import Spec

HERE = Path(__file__).parent
OTHERS = ("score.py", "stages.py", "picture.py", "__main__.py")
ROOM = Room(
    schema="pdoik.legged.seal/1",
    make_study=make_study,
    spec=Spec,
    generators=[path for path in HERE.glob("*.py") if path.name not in OTHERS],
    scorers=[HERE / "score.py"],
    longest=1800.0,
    score=score,
    tables=all_tables,
)
