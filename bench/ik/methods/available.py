"""Which methods can be made on this computer."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bench.common.commands import console
from bench.ik.experiment import Arm
from bench.ik.methods import COMPILED, Terms, make_method


def available(names: Sequence[str], libraries: Path) -> list[str]:
    """Those methods that can be made here; a line for each other."""
    available = []
    for name in names:
        try:
            make_method(name, Arm.builtin("panda"), Terms(goal="pose"), libraries)
        except ImportError as error:
            console.print(f"without {name}: {error}", highlight=False)
            if name in COMPILED:
                raise
        else:
            available.append(name)
    return available
