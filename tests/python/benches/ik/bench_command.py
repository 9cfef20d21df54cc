"""A bench's command as a user runs it."""

import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).parents[4]


def tables_of(module: str, row: str, jobs: int, out: Path, timeout: float = 300) -> str:
    """The tables of one row of a short run, which is run once more and has nothing left to do."""
    command = [sys.executable, "-m", module, "--quick", "--only", row, "--out", str(out)]
    for done in ("", f"{jobs} of {jobs} jobs are done already"):
        run = subprocess.run(
            command,
            cwd=REPOSITORY,
            capture_output=True,
            text=True,
            check=False,
            timeout=timeout,
        )
        assert run.returncode == 0, run.stdout + run.stderr
        assert done in run.stdout
    return (out.with_name(out.name + "-quick") / "tables.md").read_text()
