"""Steps of all robots, with every kind of speed limits and budgets: the soak's, judged by it."""

import pandas as pd

from bench.ik.lines import Jobs, Line
from bench.ik.soak import tracking
from bench.ik.soak.__main__ import jobs_of

SIZES = (7_000, 200_000)
A_JOB = 1_000  # steps: more of them are more jobs, and those that are done stay

run_job = tracking.run_job


def jobs(size: int, seed: int) -> Jobs:
    """The families by turns."""
    return jobs_of("tracking", size, A_JOB, seed)


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of steps that are deeper, and of any that break another promise."""
    steps, struck = int(trials.n.sum()), int(trials.deadline_struck.sum())
    deeper = int(trials["fault deeper"].sum())
    others = {
        name: int(trials[f"fault {name}"].sum()) for name in tracking.FAULTS if name != "deeper"
    }
    found = ", ".join(f"{count} {name}" for name, count in others.items() if count)
    cases = f"{steps:,} steps, {struck:,} struck"
    deepest = f"{deeper} of {steps:,}, at most {max(0.0, trials.deeper.max()):.1g} m"
    return [
        Line(
            what="deeper than standing still, and than contact",
            asked="0",
            measured=deepest,
            cases=cases,
            failures=deeper,
        ),
        Line(
            what="beyond limits or step bounds, through something, or said otherwise",
            asked="0",
            measured=found or "0",
            cases=cases,
            failures=sum(others.values()),
        ),
    ]
