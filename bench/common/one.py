"""One diagnosis in a process of its own, run by path: python -I one.py STUDY RESULT.

It calls what `pdoik diagnose` calls, leaves out the page and its figures, and replays a held-out
recording before and after. Nothing of bench can be imported here, and every file that is opened
outside of the working folder and the installation is written down.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from pathlib import Path
from typing import Any

SYSTEM = ("/usr", "/lib", "/lib64", "/etc", "/proc", "/sys", "/dev", "/opt")
INSTALLED = [sys.prefix, sys.base_prefix, *filter(None, sys.path)]


def main(study: str, result: str) -> int:
    """Writes the result; a study that cannot be read is one too."""
    elsewhere = watch_files()
    import numpy as np

    from pdoik.errors import PdoikError
    from pdoik.sim2real import examine, model_of
    from pdoik.sim2real.evidence.replays import replays_of

    said: dict[str, Any] = {}
    begin, used = time.perf_counter(), time.process_time()
    try:
        examination = examine(study)
    except (PdoikError, ValueError) as error:
        said["error"] = f"{type(error).__name__}: {error}"
    said["seconds"] = time.perf_counter() - begin
    said["processor_seconds"] = time.process_time() - used
    if "error" not in said:
        said["diagnosis"] = json.loads(examination.diagnosis.to_json())
        begin = time.perf_counter()
        try:
            replays, notes = replays_of(examination, model_of(examination))
        except Exception as error:  # a model that does not run is kept as that
            replays, notes = (), (f"{type(error).__name__}: {error}",)
        said["replay_seconds"] = time.perf_counter() - begin
        said["replay_notes"] = list(notes)
        said["replays"] = [
            {
                "recording": each.recording,
                "how": each.how,
                "before": float(np.sqrt(np.mean((each.before - each.recorded) ** 2))),
                "after": float(np.sqrt(np.mean((each.after - each.recorded) ** 2))),
            }
            for each in replays
        ]
    said["peak_gib"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    said["elsewhere"] = sorted(elsewhere)
    Path(result).write_text(json.dumps(said, indent=1) + "\n")
    return 0


def watch_files() -> set[str]:
    """Files opened from now on that are neither the study's nor the installation's."""
    elsewhere: set[str] = set()
    roots = [Path(each).resolve() for each in (Path.cwd(), *SYSTEM, *INSTALLED)]

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if event != "open" or not isinstance(arguments[0], str | bytes):
            return
        name = arguments[0]
        path = Path(name if isinstance(name, str) else name.decode(errors="replace")).absolute()
        if not any(path.is_relative_to(root) for root in roots):
            elsewhere.add(str(path))

    sys.addaudithook(hook)
    return elsewhere


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
