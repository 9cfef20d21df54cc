"""The user's own simulator beside the machine: what differs, and by which of its properties.

Comes in: a `Study` with a log of the simulator (`simulation:`), or its model (`simulator:`), and
recordings of the machine. Goes out: a `Comparison`, with runs paired by their commands, errors by
joint and frequency, findings in the simulator's own words, and a patch of its MJCF. The simulator
is taken as it is: candidates are copies of its model with other properties, run under the
recorded commands. Bases are fixed.

    from pdoik.sim2real.simulators import compare

    comparison = compare("study.yaml")
    for finding in comparison.machine.findings:
        print(finding.statement)
"""

from .compare import Comparison, compare

__all__ = ["Comparison", "compare"]
