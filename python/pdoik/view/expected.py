"""What a proposed motion is expected to settle, as `pdoik propose` writes it next to the motion."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

SCHEMA = "pdoik.proposal/1"


def expected_of(log: Path) -> str:
    """Markdown of the JSON next to a CSV; "" where there is none, or it is of something else."""
    file = log.with_suffix(".json")
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        return ""
    try:
        return "\n\n".join(_lines(content))
    except (KeyError, TypeError, ValueError):
        return ""


def _lines(content: dict[str, Any]) -> list[str]:
    kind = "A random motion" if content["random"] else "The next motion"
    lines = [f"**{kind}**, {content['seconds']:.3g} s, from rest to rest"]
    for each in content["expected"]:
        before, after = each["confidence_before"], each["confidence"]
        lines.append(
            f"{each['finding']}: confidence {before:.2f}, **expected {after:.2f}** after it"
            f" ({each['why']})"
        )
        lines += [f"- against {rival['rival']}: {_ratio(rival)}" for rival in each["rivalries"]]
    lines += [f"no motion settles {said}" for said in content["unsettled"]]
    return lines


def _ratio(rival: dict[str, Any]) -> str:
    known = [rival[name] for name in ("if_own", "if_rival") if rival[name] is not None]
    return f"log likelihood ratio {min(known):.0f}" if known else "not known"
