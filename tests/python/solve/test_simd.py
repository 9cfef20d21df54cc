"""What the environment variable PDOIK_SIMD does to a process."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


def name_in_a_process(asked: str | None) -> str:
    environment = {name: value for name, value in os.environ.items() if name != "PDOIK_SIMD"}
    if asked is not None:
        environment["PDOIK_SIMD"] = asked
    command = [sys.executable, "-c", "import pdoik; print(pdoik.simd_name())"]
    return subprocess.check_output(command, env=environment, text=True).strip()


def test_the_variable_lowers_the_level_and_never_raises_it() -> None:
    levels = ["baseline", "avx2", "avx512"]
    best = levels.index(name_in_a_process(None))
    for level, asked in enumerate(levels):
        assert levels.index(name_in_a_process(asked)) == min(level, best)


@pytest.mark.parametrize("asked", ["", "AVX2", "sse"])
def test_a_value_that_names_no_level_counts_as_none(asked: str) -> None:
    assert name_in_a_process(asked) == name_in_a_process(None)
