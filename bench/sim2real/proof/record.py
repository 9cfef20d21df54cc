"""Every run of the proof's seeds, bad ones too: one line each in record.jsonl."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd

from bench.sim2real.proof.reach import ASKED, reached, verdict

FILE = Path(__file__).with_name("record.jsonl")


def entries(path: Path = FILE) -> list[dict[str, Any]]:
    """All lines, the oldest first."""
    if not path.is_file():
        return []
    return [json.loads(line) for line in path.read_text().splitlines() if line.strip()]


def sealed_line(seal: Mapping[str, Any]) -> dict[str, Any]:
    """That a run began: it is kept even where it is never scored."""
    return {"event": "sealed", "pdoik": version("pdoik"), **_of(seal)}


def scored_line(seal: Mapping[str, Any], scoring: str, studies: pd.DataFrame) -> dict[str, Any]:
    """That it was scored, by which code, and how it came out."""
    scores = {}
    for asked in ASKED:
        value, interval, total = reached(studies, asked)
        scores[asked.what] = {
            "value": round(value, 4) if total else None,
            "interval95": interval,
            "of": total,
            "verdict": verdict(value, asked),
        }
    counts = {str(name): int(count) for name, count in studies.group.value_counts().items()}
    return {
        "event": "scored",
        "pdoik": version("pdoik"),
        **_of(seal),
        "scored_by": scoring,
        "counts": counts,
        "wrong": int((~studies.right).sum()),
        "scores": scores,
    }


def append(line: Mapping[str, Any], path: Path = FILE) -> bool:
    """Adds a line unless it is there but for its date; whether it did."""
    bare = dict(line)
    if any({k: v for k, v in old.items() if k != "date"} == bare for old in entries(path)):
        return False
    date = datetime.now(UTC).isoformat(timespec="seconds")
    with path.open("a") as file:
        file.write(json.dumps({"date": date, **bare}) + "\n")
    return True


def earlier_runs(seal: Mapping[str, Any], path: Path = FILE) -> list[str]:
    """When this same tool was run on these seeds before, in other runs than this one."""
    return [
        f"{old['date']} ({old['event']})"
        for old in entries(path)
        if old["seed"] == seal["seed"]
        and old["digests"]["tool"] == seal["digests"]["tool"]
        and old["sealed_at"] != seal["sealed_at"]
    ]


def _of(seal: Mapping[str, Any]) -> dict[str, Any]:
    return {
        key: seal[key] for key in ("sealed_at", "seed", "count", "truths", "studies", "digests")
    }
