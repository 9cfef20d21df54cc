"""Every kind of fault by its name."""

import inspect
from collections.abc import Callable
from dataclasses import replace
from types import ModuleType

from bench.sim2real.machines import faults_body, faults_joint, faults_outside
from bench.sim2real.machines.fault import Fault, Scene

Make = Callable[[Scene], Fault]


def _of(module: ModuleType, effect: str = "") -> dict[str, Make]:
    def named(name: str, make: Make) -> Make:
        def fault(scene: Scene) -> Fault:
            made = make(scene)
            return replace(made, kind=name, effect=effect or made.effect or name)

        return fault

    return {
        name: named(name, make)
        for name, make in inspect.getmembers(module, inspect.isfunction)
        if not name.startswith("_") and make.__module__ == module.__name__
    }


NAMED: dict[str, Make] = {**_of(faults_joint), **_of(faults_body)}
"""Faults that a catalogue of machines' faults has."""

OUTSIDE: dict[str, Make] = _of(faults_outside, "outside")
"""Faults that none has."""

KINDS: dict[str, Make] = NAMED | OUTSIDE
