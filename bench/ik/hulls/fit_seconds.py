"""How long `pdoik occupancy` takes for a robot of the problem sets, and how tight its fit is.

python -m bench.ik.hulls.fit_seconds ur5 --processes 2
"""

import resource
import time
from typing import Annotated

import typer

from bench.ik.problems.robots import robot_files
from pdoik.occupancy_fit import LinkNews, fit_occupancy


def _tell(news: LinkNews) -> None:
    if news.state != "begun":
        print(f"{news.link:<24} {news.state:<7} {news.seconds:6.1f} s", flush=True)


def _processor_seconds() -> float:
    """Processor time of this process and of those it has waited for [s]."""
    who = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    used = [resource.getrusage(each) for each in who]
    return sum(each.ru_utime + each.ru_stime for each in used)


def main(
    robot: str,
    processes: Annotated[int, typer.Option(help="Links fitted at a time.")] = 2,
) -> None:
    """Fit hulls to a robot's collision geometry, anew, and print a row of the README's table."""
    files = robot_files(robot)
    start, before = time.perf_counter(), _processor_seconds()
    fit = fit_occupancy(
        files.urdf, files.package_dirs, cache=False, processes=processes, progress=_tell
    )
    seconds, used = time.perf_counter() - start, _processor_seconds() - before
    print(fit.report)
    worst = max(link.worst_overhang for link in fit.report.links)
    mean = max(link.mean_overhang for link in fit.report.links)
    print(
        f"| {robot} | {processes} | {len(fit.capsules)} | {1e3 * mean:.2f} | {1e3 * worst:.1f}"
        f" | {seconds:.0f} | {used:.0f} |"
    )


if __name__ == "__main__":
    typer.run(main)
