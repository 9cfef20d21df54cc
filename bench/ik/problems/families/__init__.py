"""Families of scenes, in the order in which they register themselves.

A family draws a scene and the target's pose from random numbers; `bench.ik.problems.make` finds the
configuration that is valid there and draws again where there is none.
"""

from bench.ik.problems.families import motion_bench_maker, on_surfaces, standing
from bench.ik.problems.families.family import FAMILIES, Draft, Family

__all__ = ["FAMILIES", "Draft", "Family", "motion_bench_maker", "on_surfaces", "standing"]
