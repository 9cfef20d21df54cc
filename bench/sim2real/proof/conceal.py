"""Worlds made under neutral names: studies in one folder, their truths in another."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Any

from bench.common.campaign import Job, Row
from bench.common.digests import digest_of_folder
from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.proof.digests import generator_digest

STUDIES, SEALED = "studies", "sealed"


def conceal(job: Job) -> list[Row]:
    """One study and its truth; neither is there before both are whole.

    A world that cannot be made (no arm comes through its motion) is a row that says so.

    Raises:
        RuntimeError: the generator on this worker is not the frozen one.
    """
    if generator_digest() != job["generator"]:
        raise RuntimeError("bench/sim2real/concealed is not the one that was frozen here")
    out, name = Path(job["out"]), str(job["name"])
    study, truth = out / STUDIES / name, out / SEALED / f"{name}.json"
    with tempfile.TemporaryDirectory(prefix=".making-", dir=out) as folder:
        made = Path(folder)
        try:
            make_study(made / name, WorldSpec(**job["spec"]), made / SEALED)
        except RuntimeError as error:
            return [{"name": name, "study": "", "not_made": str(error)}]
        digest = digest_of_folder(made / name)
        for parent in (study.parent, truth.parent):
            parent.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(study, ignore_errors=True)  # of a run that was stopped in between
        (made / name).rename(study)
        (made / SEALED / truth.name).replace(truth)
    return [{"name": name, "study": digest, "not_made": ""}]


def conceal_jobs(out: Path, specs: dict[str, dict[str, Any]], generator: str) -> dict[str, Job]:
    """By name, in the names' order, so that no file's time tells what is in it."""
    common = {"out": str(out), "generator": generator}
    return {name: {**common, "name": name, "spec": specs[name]} for name in sorted(specs)}
