"""What tests of the command line share."""

from pathlib import Path
from typing import Any

from typer.testing import CliRunner

from pdoik.cli import app

REACHABLE = "0.4 0.1 0.5 1 0 0 0"
PANDA = ("--robot", "panda", "--max-time", "1")


def run(*arguments: str | Path) -> Any:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def solve(*arguments: str | Path, target: str | Path = REACHABLE) -> Any:
    return run("solve", *PANDA, "--target", target, *arguments)


def misuse(invocation: Any, *words: str) -> None:
    """Status 2, nothing on stdout, one line on stderr with these words."""
    assert invocation.exit_code == 2, invocation.output
    assert invocation.stdout == ""
    lines = invocation.stderr.strip().splitlines()
    assert len(lines) == 1, invocation.stderr
    assert lines[0].startswith("error:")
    for word in words:
        assert word in lines[0]
