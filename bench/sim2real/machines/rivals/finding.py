"""Findings of methods that state no confidence, as diagnoses have them."""

from __future__ import annotations

from typing import Any

SURE = 0.95  # stated for them


def finding(
    effect: str, joints: list[str], links: list[str], parameters: dict[str, Any]
) -> dict[str, Any]:
    """A name at a place, with its estimates."""
    return {
        "effect": effect,
        "joints": joints,
        "links": links,
        "parameters": parameters,
        "confidence": SURE,
        "equivalents": [],
        "window": None,
    }
