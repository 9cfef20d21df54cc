"""The seal: digests of truths and studies, written before anything is diagnosed."""

from __future__ import annotations

import json
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from bench.common.campaign import CampaignError
from bench.common.digests import digest_of_files, digest_of_folder, tool_digest
from bench.common.whole_files import write_text
from bench.sim2real.proof.conceal import SEALED, STUDIES
from bench.sim2real.proof.digests import generator_digest, scoring_digest
from bench.sim2real.proof.plan import Plan

FILE = "seal.json"


def digests(plan: Plan) -> dict[str, str]:
    """Of all that is frozen before anything is scored."""
    return {
        "tool": tool_digest(),
        "generator": generator_digest(),
        "scoring": scoring_digest(),
        "plan": plan.digest(),
    }


def seals(out: Path, names: Iterable[str]) -> dict[str, str]:
    """Digests of the truths and of the studies as they lie there.

    Raises:
        CampaignError: there are other truths or studies than the plan's.
    """
    names = sorted(names)
    for folder, there in (
        (SEALED, sorted(path.stem for path in (out / SEALED).glob("*"))),
        (STUDIES, sorted(path.name for path in (out / STUDIES).glob("*"))),
    ):
        if there != names:
            wrong = sorted({*there} ^ {*names})
            raise CampaignError(f"{out / folder}: not the plan's studies ({', '.join(wrong[:5])})")
    truths = digest_of_files((f"{name}.json", out / SEALED / f"{name}.json") for name in names)
    return {"truths": truths, "studies": digest_of_folder(out / STUDIES)}


def write_seal(
    out: Path, plan: Plan, frozen: dict[str, str], not_made: Iterable[str] = ()
) -> dict[str, Any]:
    """What was sealed, kept in the run's folder, and the plan's worlds that could not be made."""
    missing = sorted(not_made)
    there = [name for name in plan.specs if name not in missing]
    seal = {
        "schema": "pdoik.proof.seal/1",
        "sealed_at": datetime.now(UTC).isoformat(timespec="seconds"),
        "seed": plan.seed,
        "count": len(there),
        "not_made": missing,
        **seals(out, there),
        "digests": frozen,
    }
    write_text(out / FILE, json.dumps(seal, indent=1) + "\n")
    return seal


def read_seal(out: Path) -> dict[str, Any] | None:
    """The seal of a run; None before there is one."""
    path = out / FILE
    return json.loads(path.read_text()) if path.is_file() else None


def made(plan: Plan, seal: dict[str, Any]) -> list[str]:
    """The studies that were sealed, by name."""
    return sorted({*plan.specs} - {*seal["not_made"]})


def verify(out: Path, plan: Plan, seal: dict[str, Any]) -> None:
    """That truths and studies are those that were sealed.

    Raises:
        CampaignError: they are not; nothing is scored.
    """
    for what, digest in seals(out, made(plan, seal)).items():
        if digest != seal[what]:
            raise CampaignError(
                f"{out}: the {what} are not those that were sealed"
                f" (sealed {seal[what][:16]}, found {digest[:16]}): nothing is scored"
            )
