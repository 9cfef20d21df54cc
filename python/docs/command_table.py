"""The table of command_line.md, made of the commands: python python/docs/command_table.py.

It is the part of the page between its two marks; a test says when it is out of date.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import typer

from pdoik.cli import app

PAGE = Path(__file__).parent / "command_line.md"
BEGIN, END = "<!-- commands -->\n", "<!-- end of commands -->\n"
USEFUL = {  # at most four that most readers need, by command
    "view": ("--cloud", "--scene", "--replay", "--port"),
    "solve": ("--target", "--goals", "--scene", "--all"),
    "path": ("--robot", "--free", "--scene", "--out"),
    "place": ("--robot", "--x", "--yaw", "--picture"),
    "info": ("--tip-link", "--json"),
    "occupancy": ("--out", "--max-hulls"),
    "pairs": ("--occupancy", "--out"),
    "bench": ("--robot", "--targets", "--seed"),
    "study new": ("--out", "--entry", "--columns"),
    "study check": ("--out",),
    "study keys": (),
    "diagnose": ("--out", "--quick", "--seed"),
    "propose": ("--out", "--seconds", "--cloud"),
    "predict": ("--out", "--without-findings"),
    "simulate": ("--out", "--without-findings"),
    "watch": ("--once", "--calibrate", "--out"),
    "compare": ("--out",),
    "effects list": (),
    "effects show": (),
    "effects check": (),
    "thresholds": ("--json",),
}


def table() -> str:
    """Markdown.

    Raises:
        KeyError: `USEFUL` has an option that is gone.
    """
    lines = ["| command | what for | most useful options |", "| --- | --- | --- |"]
    for name, command in _commands(typer.main.get_command(app)):
        options = {flag for each in command.params for flag in each.opts}
        if gone := set(USEFUL.get(name, ())) - options:
            raise KeyError(f"pdoik {name} has no option {min(gone)}")
        arguments = [_argument(each) for each in command.params if _is_argument(each)]
        called = " ".join(["pdoik", name, *arguments])
        useful = " ".join(f"`{each}`" for each in USEFUL.get(name, ()))
        first = re.split(r"\n\s*\n", (command.help or "").strip())[0]
        what_for = " ".join(first.split())
        lines.append(f"| `{called}` | {what_for} | {useful} |")
    return "\n".join(lines) + "\n"


def page(text: str) -> str:
    """The page with the table as it is now."""
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}{table()}{END}{after}"


def _commands(group: Any, above: str = "") -> list[tuple[str, Any]]:
    found = []
    for name, command in group.commands.items():
        if command.hidden:
            continue
        if hasattr(command, "commands"):
            found += _commands(command, f"{above}{name} ")
        else:
            found.append((f"{above}{name}", command))
    return sorted(found, key=lambda each: list(USEFUL).index(each[0]) if each[0] in USEFUL else 99)


def _is_argument(parameter: Any) -> bool:
    return bool(parameter.param_type_name == "argument")


def _argument(parameter: Any) -> str:
    name = parameter.metavar or parameter.name.upper()
    name = name.strip("[]{}").replace("|", "/")
    name = name if parameter.required or parameter.metavar == "ROBOT" else f"[{name}]"
    return f"{name} ..." if parameter.nargs == -1 else name


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
