"""Families of scenes: one file each, that registers itself.

A family draws a scene and the target's pose from random numbers; `bench.ik.problems.make` finds the
configuration that is valid there and draws again where there is none. The first seven are of the
kinds and sizes of MotionBenchMaker's sets, the next three of EBIKE's.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from bench.ik.problems.families import (
    barrel,
    bookshelf_small,
    bookshelf_tall,
    bookshelf_thin,
    box,
    cage,
    cubby_shelf,
    flat_table,
    humanoid_table,
    table_pick,
    table_top,
    table_under_pick,
)
from bench.ik.problems.families.family import Draft, Family

FAMILIES: Mapping[str, Family] = MappingProxyType(
    {
        family.name: family
        for family in (
            bookshelf_small.FAMILY,
            bookshelf_tall.FAMILY,
            bookshelf_thin.FAMILY,
            box.FAMILY,
            cage.FAMILY,
            table_pick.FAMILY,
            table_under_pick.FAMILY,
            table_top.FAMILY,
            cubby_shelf.FAMILY,
            barrel.FAMILY,
            flat_table.FAMILY,
            humanoid_table.FAMILY,
        )
    }
)

__all__ = ["FAMILIES", "Draft", "Family"]
