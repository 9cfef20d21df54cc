"""The problem sets' command, in small: made, solved, judged, and what failed drawn."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("coal")
pytest.importorskip("pinocchio")


REPOSITORY = Path(__file__).parents[2]


def problems(*arguments: str | Path) -> str:
    command = [sys.executable, "-m", "bench.ik.problems", *map(str, arguments)]
    run = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout


def test_sets_are_solved_and_judged_and_failures_drawn(tmp_path: Path) -> None:
    sets, budgets = ("box", "flat_table"), ("--budget", "50", "--budget", "0.0001")
    table = problems(
        *("run", *sets, "--robot", "panda", "--count", "3", "--method", "shapes"),
        *(*budgets, "--out", tmp_path),
    )
    (results,) = tmp_path.glob("*.json")
    rows = json.loads(results.read_text())["rows"]
    assert [(row["set"], row["budget"]) for row in rows] == [
        (name, budget) for name in sets for budget in (50.0, 0.0001)
    ]
    for row in rows:
        assert row["total"] == row["ceiling"] == 3
        assert row["wrong"] == 0
        assert row["solved"] + row["none"] == 3
        assert f"| {row['set']} | panda | shapes | {row['budget']:g} |" in table
    assert all(row["solved"] == 3 for row in rows if row["budget"] == 50.0)
    assert any(row["none"] for row in rows)  # no time to find anything
    picture = tmp_path / "failed.png"
    assert "problems drawn" in problems("draw", "--failed", results, "--out", picture)
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert picture.stat().st_size > 20_000
