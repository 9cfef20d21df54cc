"""One diagnosis in a process of its own, run by path: python -I one.py STUDY RESULT.

It calls what `pdoik diagnose` calls, leaves out the page and its figures, and replays a held-out
recording before and after; of a compare.yaml it calls what `pdoik compare` calls.
Nothing of bench can be imported here, and every file that is opened outside of the working folder
and the installation is written down.
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
    from pdoik.errors import PdoikError

    compares = Path(study).name == "compare.yaml"
    if compares:
        from pdoik.sim2real.simulators import compare as examine
    else:
        from pdoik.sim2real import examine
    said: dict[str, Any] = {}
    begin, used = time.perf_counter(), time.process_time()
    try:
        examination = examine(study)
    except (PdoikError, ValueError) as error:
        said["error"] = f"{type(error).__name__}: {error}"
    said["seconds"] = time.perf_counter() - begin
    said["processor_seconds"] = time.process_time() - used
    if "error" not in said:
        said |= compared(examination.machine) if compares else diagnosed(examination)
    said["peak_gib"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    said["elsewhere"] = sorted(elsewhere)
    Path(result).write_text(json.dumps(said, indent=1) + "\n")
    return 0


def diagnosed(examination: Any) -> dict[str, Any]:
    """The diagnosis as its file has it, and errors of replayed motion."""
    from pdoik.sim2real import model_of
    from pdoik.sim2real.evidence import replays_of

    begin = time.perf_counter()
    try:
        replays, notes = replays_of(examination, model_of(examination))
    except Exception as error:  # a model that does not run is kept as that
        replays, notes = (), (f"{type(error).__name__}: {error}",)
    return {
        "diagnosis": json.loads(examination.diagnosis.to_json()),
        "replay_seconds": time.perf_counter() - begin,
        "replay_notes": list(notes),
        "replays": [
            {
                "recording": each.recording,
                "how": each.how,
                "before": _rms(each.before - each.recorded),
                "after": _rms(each.after - each.recorded),
            }
            for each in replays
        ],
    }


def compared(step: Any) -> dict[str, Any]:
    """What a comparison says of the machine: errors before and after, findings and suspicions."""
    return {
        "comparison": {
            "verdict": step.verdict,
            **{
                side: _rms([getattr(fit, side) for fit in step.joints.values()])
                for side in ("before", "after")
            },
            "findings": [
                *(_finding(each, claimed=True) for each in step.findings),
                *(_finding(each, claimed=False) for each in step.suspected),
            ],
        }
    }


def _finding(finding: Any, *, claimed: bool) -> dict[str, Any]:
    return {
        "effect": finding.effect,
        "joints": list(finding.joints),
        "links": list(finding.links),
        "claimed": claimed,
        "confidence": finding.confidence,
        "gain": finding.evidence.validation_gain,
        "values": {name: each.value for name, each in finding.parameters.items()},
        "intervals": {name: list(each.interval95) for name, each in finding.parameters.items()},
        "equivalents": [
            {"effect": each.effect, "joints": list(each.joints), "links": list(each.links)}
            for each in finding.equivalents
        ],
    }


def _rms(values: Any) -> float:
    import numpy as np

    return float(np.sqrt(np.mean(np.square(values))))


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
