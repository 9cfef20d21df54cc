"""Studies diagnosed blind: a fresh process in a fresh folder that holds a copy of one study."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import pdoik
from bench.common.campaign import Job, Row
from bench.common.digests import tool_digest

ONE = Path(__file__).with_name("one.py")
LONGEST = 600.0  # of one diagnosis [s]
STOPPED = (-signal.SIGINT, -signal.SIGTERM, 128 + signal.SIGINT)  # no result: to be tried again
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def diagnose(job: Job) -> list[Row]:
    """What was said of one study, as JSON.

    Raises:
        RuntimeError: the tool installed on this worker is not the frozen one.
    """
    said = blind(Path(job["study"]), job.get("longest", LONGEST))
    if tool_digest() != job["tool"]:
        raise RuntimeError("the pdoik.sim2real installed here is not the one that was frozen")
    return [{"name": job["name"], "said": json.dumps(said)}]


def blind(study: Path, longest: float = LONGEST, tool: Path | None = None) -> dict[str, Any]:
    """The result of one.py on a copy of a study's folder; a crash or a timeout is a result too.

    Neither arguments, environment nor folder of the process lead to the truth. A study with a
    compare.yaml is compared with its simulator, any other diagnosed.

    Args:
        study: its folder.
        longest: that it may take [s].
        tool: folder that holds the package pdoik; without it the one that is imported here.
    """
    tool = tool or _not_installed()
    file = "compare.yaml" if (study / "compare.yaml").is_file() else "study.yaml"
    isolated = "-I" if tool is None else "-P"
    path = {} if tool is None else {"PYTHONPATH": str(tool)}
    with tempfile.TemporaryDirectory(prefix="pdoik-blind-") as folder:
        shutil.copytree(study, Path(folder) / "study")
        command = [sys.executable, isolated, str(ONE), f"study/{file}", "result.json"]
        begin = time.perf_counter()
        try:
            done = subprocess.run(
                command,
                cwd=folder,
                env=environment(folder) | path,
                capture_output=True,
                text=True,
                timeout=longest,
                check=False,
            )
            if done.returncode in STOPPED:
                raise RuntimeError("the diagnosis was stopped from outside")
            last = (done.stderr.strip().splitlines() or ["nothing said"])[-1]
            ended = f"status {done.returncode}: {last}"
        except subprocess.TimeoutExpired:
            ended = f"no answer within {longest:g} s"
        took = time.perf_counter() - begin
        result = Path(folder) / "result.json"
        if not result.is_file():
            return {"error": ended, "seconds": took, "process_seconds": took, "elsewhere": []}
        return {**json.loads(result.read_text()), "process_seconds": took}


def _not_installed() -> Path | None:
    """The folder of the package pdoik, where it is a checkout's and not this Python's own."""
    folder = Path(pdoik.__file__).absolute().parents[1]
    return None if folder.is_relative_to(sys.prefix) else folder


def environment(home: str) -> dict[str, str]:
    """One thread, and nothing that tells where this came from."""
    names = ("PATH", "LANG", "LD_LIBRARY_PATH")
    kept = {name: os.environ[name] for name in names if name in os.environ}
    return {**kept, "HOME": home, "TMPDIR": home, **dict.fromkeys(THREADS, "1")}
